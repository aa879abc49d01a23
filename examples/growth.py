"""Disorder grows wave by wave.

Near disorder the force is of third order, so that there is no flow, and each wave of filament order grows
independently: those of P_z at the rate α_p - d_r - d_s k², those of P_θ at that rate minus κ. Long waves
along the cell grow fastest, and order around the axis decays. Each point is a wave of one run from faint
noise, and the lines are the rates of theory.
"""

from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

import cyclosis as cy


def main(folder="."):
    params = cy.Parameters(alpha_p=0.5)
    grid = cy.CylinderGrid(32, 32, 5.0)
    state = cy.initial.disordered(grid, filaments_per_square=1e12, seed=1)
    run = cy.simulate(params, grid, state, t_end=4.0, save_every=4.0)

    m, q = np.meshgrid(grid.m, grid.q, indexing="ij")
    near = np.abs(m) + np.abs(q) < 8
    first, last = (np.fft.fft2(frame)[:, near] for frame in (run.frames[0], run.frames[-1]))
    measured = np.log(np.abs(last / first)) / 4.0
    theory = cy.stability.growth_rates(params, "disorder", m, q).real[near].T[::-1]

    figure = Figure(figsize=(5, 3.4), layout="constrained")
    ax = figure.add_subplot(xlabel="wavenumber k", ylabel="growth rate")
    k = np.hypot(m, q)[near]
    for rates, exact, name in zip(measured, theory, ("$P_θ$", "$P_z$"), strict=True):
        ax.plot(k, rates, "o", markersize=3, label=f"{name}, run")
        ax.plot(np.sort(k), exact[np.argsort(k)], "k-", linewidth=0.8)
    ax.axhline(0, color="grey", linewidth=0.5)
    ax.legend()
    figure.savefig(Path(folder) / "growth.png", dpi=150)
    return {
        "waves": measured.size,
        "largest difference of a rate from theory": np.abs(measured - theory).max(),
        "fastest rate": measured.max(),
        "alpha_p - d_r": params.alpha_p - params.d_r,
    }


if __name__ == "__main__":
    print(*(f"{name}: {value:.6g}" for name, value in main().items()), sep="\n")
