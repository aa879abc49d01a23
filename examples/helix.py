"""A tilted cue keeps the streams helical.

Old cells of Chara stream along helices. With the repulsive direction tilted by 0.4, stripes that wind once
about the axis of a cell of one pitch keep their turn. They are the stripes of an untilted cell that is
narrower by the cosine of the tilt, so that one-dimensional theory gives their speed.
"""

from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

import cyclosis as cy
from cyclosis.figures.unwrapped import draw_map

TILT = 0.4


def main(folder="."):
    params = cy.Parameters(repulsion_angle=TILT)
    grid = cy.CylinderGrid(48, 48, 2 * np.pi / np.tan(TILT))
    phase = grid.theta[:, None] + 2 * np.pi * grid.z / grid.length
    state = 0.8 * np.sin(phase) * np.array([-np.sin(TILT), np.cos(TILT)])[:, None, None]
    state = cy.initial.with_noise(state, grid, filaments_per_square=4000, seed=1)
    run = cy.simulate(params, grid, state, 150.0, save_every=150.0)

    P, u = run.final_state, cy.flow(params, grid, run.final_state)
    figure = Figure(figsize=(3, 5), layout="constrained")
    draw_map(figure.add_subplot(), grid, P, u)
    figure.savefig(Path(folder) / "helix.png", dpi=150)

    zones = [zone.winding for zone in cy.zones.indifferent_zones(grid, P) if zone.winding != (0, 0)]
    narrower = np.cos(TILT) ** 2
    straight = cy.Parameters(d_s=0.025 / narrower, mu=0.05 / narrower)
    return {
        "zones": len(zones),
        "turns of a zone along the cell": abs(zones[0][0]),
        "peak speed": np.hypot(*u).max(),
        "the same in theory": cy.stability.cyclosis(straight).u.max(),
    }


if __name__ == "__main__":
    print(*(f"{name}: {value:.6g}" for name, value in main().items()), sep="\n")
