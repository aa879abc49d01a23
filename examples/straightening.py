"""Bent borders between streams straighten.

Zones that bend along the cell straighten, and the longest wave decays last. The decay rate of a small bend
in a run is that of the leading mode with one wave along the cell, -0.0541 at the parameters of Figure 4.
"""

from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

import cyclosis as cy
from cyclosis.figures.unwrapped import draw_map


def main(folder="."):
    params = cy.Parameters()
    grid = cy.CylinderGrid(64, 32, 5.0)
    profile = cy.stability.cyclosis(params)
    bend = 0.5 * np.sin(2 * np.pi * grid.z / grid.length)
    P = profile.at(grid.theta[:, None] - bend)[0]
    run = cy.simulate(params, grid, np.stack([0 * P, P]), 140.0, save_every=2.0, rtol=1e-6)

    wave = np.fft.fft2(np.stack([frame[1] for frame in run.frames]))[:, 1]
    size = np.abs(wave[:, 1] / wave[:, 0])
    late = run.times >= 110.0
    rate = np.polyfit(run.times[late], np.log(size[late]), 1)[0]

    figure = Figure(figsize=(8, 2.6), layout="constrained")
    axes = figure.subplots(1, 3)
    for ax, index in zip(axes, (0, 10), strict=False):
        draw_map(ax, grid, run.frames[index], cy.flow(params, grid, run.frames[index]))
        ax.set_title(f"t = {run.times[index]:g}", fontsize=9)
    axes[2].semilogy(run.times, size)
    axes[2].set(xlabel="time t", ylabel="bend")
    figure.savefig(Path(folder) / "straightening.png", dpi=150)
    return {
        "decay rate of the bend": rate,
        "the same in theory": profile.spectrum(1, axial_mode=1).eigenvalues[0].real,
    }


if __name__ == "__main__":
    print(*(f"{name}: {value:.6g}" for name, value in main().items()), sep="\n")
