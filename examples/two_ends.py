"""The same cell ends with one stream or with two.

Where both streaming regimes are stable, the initial noise decides between them: cells whose first wave
around the axis is large compared with the mean of P_z become cyclosis, and the others become unidirectional.
Forty cells at α_p = 0.3, α_u = 0.1 are integrated until their end is certain. The ratio 1.8, found in 2800
runs, predicts nearly all of them.
"""

from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

import cyclosis as cy

RATIO = 1.8


def main(folder="."):
    params = cy.Parameters(alpha_p=0.3, alpha_u=0.1)
    grid = cy.CylinderGrid(32, 32, 5.0)
    states = [cy.initial.disordered(grid, seed=seed) for seed in range(40)]
    members = [cy.ensemble.Member(params, grid, lambda state=state: state) for state in states]
    outcomes = cy.ensemble.follow(members, cy.ensemble.EnsembleSettings(rtol=1e-3))

    spectra = np.fft.fft2(np.array(states)[:, 1], norm="forward")
    mean, wave = np.abs(spectra[:, 0, 0]), 2 * np.abs(spectra[:, 1, 0])
    striped = np.array([outcome.regime == "cyclosis" for outcome in outcomes])

    figure = Figure(figsize=(4.4, 3.6), layout="constrained")
    ax = figure.add_subplot(xlabel="mean of $P_z$, in thousandths", ylabel="wave of $P_z$ around the axis")
    ax.plot(1e3 * mean[striped], 1e3 * wave[striped], "o", label="cyclosis")
    ax.plot(1e3 * mean[~striped], 1e3 * wave[~striped], "s", label="unidirectional")
    ax.axline((0, 0), slope=RATIO, color="grey", linewidth=0.8)
    figure.legend(loc="outside upper center", ncols=2)
    figure.savefig(Path(folder) / "two_ends.png", dpi=150)
    return {
        "cells": len(outcomes),
        "certain of their end": sum(outcome.status == "certified" for outcome in outcomes),
        "share that became cyclosis": striped.mean(),
        "share foretold": np.mean((wave > RATIO * mean) == striped),
    }


if __name__ == "__main__":
    print(*(f"{name}: {value:.6g}" for name, value in main().items()), sep="\n")
