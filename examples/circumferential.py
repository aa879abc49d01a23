"""Without a cue, cells stream around the axis.

The repulsion κ keeps cables along the cell. Without it a disordered cell starts to stream around its axis,
where no pressure opposes the flow. Order and speed are those of the uniform state.
"""

from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

import cyclosis as cy
from cyclosis.figures.unwrapped import draw_map


def main(folder="."):
    params = cy.Parameters(kappa=0.0)
    grid = cy.CylinderGrid(32, 32, 5.0)
    run = cy.simulate(params, grid, cy.initial.disordered(grid, seed=0), 150.0, save_every=5.0)
    P = run.final_state

    figure = Figure(figsize=(7, 2.8), layout="constrained")
    axes = figure.subplots(1, 3)
    for ax, index in zip(axes, (2, 5), strict=False):
        draw_map(ax, grid, run.frames[index], cy.flow(params, grid, run.frames[index]))
        ax.set_title(f"t = {run.times[index]:g}", fontsize=9)
    axes[2].plot(run.record_times, np.abs(run.records["mean_P"]), label=["$<P_θ>$", "$<P_z>$"])
    axes[2].set(xlabel="time t")
    axes[2].legend()
    figure.savefig(Path(folder) / "circumferential.png", dpi=150)

    order = cy.stability.orders(params, "circumferential")[0]
    return {
        "circumferential": cy.regime(params, grid, P).name == "circumferential",
        "mean of P around the axis": abs(P[0].mean()),
        "the same in theory": order,
        "peak speed": cy.diagnose(params, grid, P)["peak_speed"],
        "its theory, the cube of order": order**3,
    }


if __name__ == "__main__":
    print(*(f"{name}: {value:.6g}" for name, value in main().items()), sep="\n")
