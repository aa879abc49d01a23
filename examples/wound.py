"""A wound heals to the old pattern.

All filaments in a disc of one radius are fragmented. The flow around it aligns the new filaments
within a few R/U, and the indifferent zones return to their old place.
"""

from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

import cyclosis as cy
from cyclosis.figures.unwrapped import draw_map

TIMES = (1.0, 2.0, 3.0, 31.0)


def main(folder="."):
    params = cy.Parameters()
    grid = cy.CylinderGrid(48, 48, 5.0)
    before = cy.simulate(params, grid, cy.initial.stripes(grid), 30.0, save_every=30.0).final_state
    disc = cy.regions.disc(theta=np.pi, z=2.5, radius=1.0)
    times = np.arange(0.0, 31.1, 0.25)
    run = cy.simulate(params, grid, before, 31.0, save_at=times, protocol=[cy.fragment(at=1.0, where=disc)])

    figure = Figure(figsize=(8, 2.2), layout="constrained")
    for ax, time in zip(figure.subplots(1, len(TIMES)), TIMES, strict=True):
        P = run.frames[int(4 * time)]
        draw_map(ax, grid, P, cy.flow(params, grid, P))
        ax.set_title(f"t = {time:g}", fontsize=9)
    figure.savefig(Path(folder) / "wound.png", dpi=150)

    inside = disc.mask(grid)
    usual = np.sum(before**2, axis=0)[inside].mean()
    course = np.array([np.sum(P * before, axis=0)[inside].mean() for P in run.frames]) / usual
    low = int(np.flatnonzero(course < 0.9)[-1])
    zones = [cy.zones.zone_angles(P[1].mean(axis=1)) for P in (before, run.final_state)]
    return {
        "order in the wound, of that before": course[times == 1.0][0],
        "time after which nine tenths are back": times[low + 1] - 1.0,
        "order at the end, of that before": course[-1],
        "shift of the zones in radians": np.abs(np.angle(np.exp(1j * (zones[1] - zones[0])))).max(),
    }


if __name__ == "__main__":
    print(*(f"{name}: {value:.6g}" for name, value in main().items()), sep="\n")
