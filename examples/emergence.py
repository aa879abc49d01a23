"""Cyclosis emerges from disorder.

Randomly oriented filaments order in patches, the patches merge into streams, and the streams into two
stripes that share the cell equally, one up, one down. The final state is the steady state
that theory finds by Newton's method, with the same peak speed. This is the cell of the paper's Figure 4, on
48 x 48 points.
"""

from pathlib import Path

import cyclosis as cy
from cyclosis.figures.emergence import emergence


def main(folder="."):
    params = cy.Parameters()
    grid = cy.CylinderGrid(48, 48, 5.0)
    state = cy.initial.disordered(grid, seed=0)
    run = cy.simulate(params, grid, state, t_end=200.0, save_every=2.0)

    emergence(run.to_dataset()).savefig(Path(folder) / "emergence.png", dpi=110)
    found = cy.regime(params, grid, run.final_state)
    return {
        "stripes": len(found.zones),
        "width of one stripe": found.widths[0],
        "width of the other": found.widths[1],
        "peak speed": cy.diagnose(params, grid, run.final_state)["peak_speed"],
        "peak speed in theory": cy.stability.cyclosis(params).u.max(),
    }


if __name__ == "__main__":
    print(*(f"{name}: {value:.6g}" for name, value in main().items()), sep="\n")
