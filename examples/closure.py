"""Filaments order more slowly than their mean.

The equation for the mean direction P closes the kinetic equation, which follows every angle of the filaments.
On a ring of the cell of Figure 4 the closed equation is ordered first. Filaments first line up along the
cell, as many up as down, and few turn round. Uniform order is as theory says in both.

    cyclosis experiment closure
"""

from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

import cyclosis as cy


def half(run):
    """Return the time at which the order exceeds a half."""
    order = run.records["order"]
    return run.record_times[np.argmax(order > 0.5)]


def main(folder="."):
    params, ring = cy.Parameters(), cy.CylinderGrid(32, 1)
    closed = cy.simulate(params, ring, cy.initial.disordered(ring, seed=0), 30.0, save_every=0.5)
    start = cy.kinetic.disordered(ring, seed=0)
    kinetic = cy.simulate(params, ring, start, 30.0, save_every=0.5, model=cy.models.kinetic)

    weak, point = cy.Parameters(alpha_p=0.1, kappa=0.0), cy.CylinderGrid(8, 1)
    uniform = cy.kinetic.dressed(cy.initial.unidirectional(point, 0.9))
    settled = cy.simulate(weak, point, uniform, 100.0, save_every=100.0, model=cy.models.kinetic)

    figure = Figure(figsize=(7, 2.8), layout="constrained")
    left, right = figure.subplots(1, 2)
    left.plot(closed.record_times, closed.records["order"], color="#2a5fa6", label="closed equation, P")
    left.plot(kinetic.record_times, kinetic.records["order"], color="#9757c8", label="every angle, Ψ")
    left.set(xlabel="time t", ylabel="order |P|", xlim=(0, 30))
    left.legend(fontsize=8)
    angles = np.linspace(0, 360, 361)
    for time, colour in ((3.0, "#c9a2ee"), (8.0, "#9757c8"), (30.0, "#472860")):
        state = kinetic.frames[np.argmin(np.abs(kinetic.times - time))]
        column = state[:, np.argmax(state[1, :, 0].imag), 0]
        waves = np.exp(-1j * np.outer(np.radians(angles), np.arange(1, len(column))))
        density = (column[0].real + 2 * (waves @ column[1:]).real) / (2 * np.pi)
        right.plot(angles, density, color=colour, label=f"t = {time:g}")
    right.set(
        xlabel="angle of the filaments",
        ylabel="density Ψ, in an upward stream",
        xticks=(0, 90, 180, 270, 360),
    )
    right.set_xticklabels(("0", "up", "180°", "down", "360°"))
    right.legend(fontsize=8)
    figure.savefig(Path(folder) / "closure.png", dpi=150)

    return {
        "time to half the order, closed equation": half(closed),
        "time to half the order, every angle": half(kinetic),
        "uniform order at alpha_p = 0.1": abs(settled.final_state[1]).mean(),
        "the same in theory": abs(cy.kinetic.uniform_state(weak)[1]),
        "the same, closed equation": np.sqrt(1 - weak.d_r / weak.alpha_p),
    }


if __name__ == "__main__":
    print(*(f"{name}: {value:.6g}" for name, value in main().items()), sep="\n")
