"""Two streams turn round at the ends.

A closed cell needs no condition of zero net flux: on its surface nothing can flow in or out. Filaments cannot
be aligned everywhere on it. The places without a direction have indices that always add up to 2. Disorder has
many, which vanish in pairs until two are left, one on each zone between the streams.

    cyclosis run --model closed --shape capsule --length 2 --t-end 40 --out closed.nc
"""

from pathlib import Path

import cyclosis as cy
from cyclosis.figures import style
from cyclosis.figures.emergence import emergence


def main(folder="."):
    params = cy.Parameters(d_s=0.05)
    grid = cy.ClosedGrid(cy.Capsule(length=2.0, smoothing=0.4), k_max=12)
    run = cy.simulate(params, grid, cy.closed.disordered(grid, seed=1), 40.0, save_at=(0, 2, 4, 8, 16, 40))
    style.save(emergence(run.to_dataset()), Path(folder) / "ends.png")

    defects = [cy.closed.defects(grid, P) for P in run.frames]
    return {
        "places without a direction at first": len(defects[0]),
        "the same at the end": len(defects[-1]),
        "least sum of their indices": min(sum(one.index for one in found) for found in defects),
        "greatest sum of their indices": max(sum(one.index for one in found) for found in defects),
        "two streams": cy.regime(params, grid, run.final_state).name == "cyclosis",
    }


if __name__ == "__main__":
    print(*(f"{name}: {value:.6g}" for name, value in main().items()), sep="\n")
