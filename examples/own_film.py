"""Your own film tells how the cell streams.

A microscope records particles on the near side of a cell that lies askew in the picture. The film alone gives
velocities, and the outline of the cell puts them on its surface, where they are compared with a run. Here
the film is one of a model cell, so that the answer is known. Your own film takes the same path.

    cyclosis measure cell.avi --radius-px 60 --axis 17 --centre 59,163 --out cell.nc
"""

from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

import cyclosis as cy
from cyclosis.figures.unwrapped import draw_map


def main(folder="."):
    params, grid = cy.Parameters(d_s=0.05), cy.CylinderGrid(32, 32, 5.0)
    times = np.linspace(9.0, 9.5, 5)
    run = cy.simulate(params, grid, cy.initial.disordered(grid, seed=0), 9.5, save_at=times)
    view = cy.observations.View(radius_px=60.0, axis_deg=17.0)
    made = cy.observations.observe(run, view, "film", pixel_um=8.0, frames=4, start=9.0)
    made.write(folder, "avi", force=True)

    film = cy.observations.film(Path(folder) / "film.avi", frame_s=0.3, pixel_um=8.0)
    outline = made.camera.view.centre_px
    cell = film.view(radius_px=60.0, axis_deg=17.0, centre_px=outline, mirrored=False)
    fit = cy.observations.compare(cell.on_surface(), run)

    figure = Figure(figsize=(7, 3.2), layout="constrained")
    left, right = figure.subplots(1, 2, width_ratios=(1.5, 1))
    left.imshow(made.data["frames"][1], cmap="gray_r", vmax=300)
    frame = cell.frames[0]
    shown = np.flatnonzero(frame.good)[::3]
    for part, colour in ((shown[frame.vx[shown] > 0], "#9757c8"), (shown[frame.vx[shown] <= 0], "#458951")):
        x, y, vx, vy = (values[part] for values in (frame.x, frame.y, frame.vx, frame.vy))
        left.quiver(x, y, vx, -vy, color=colour, pivot="mid", width=0.0045, scale=250)
    left.set(xticks=[], yticks=[])
    left.set_title("a film, and the velocities it tells", fontsize=9)
    draw_map(right, grid, run.frames[0], cy.flow(params, grid, run.frames[0]))
    right.set_title("the cell that was filmed", fontsize=9)
    figure.savefig(Path(folder) / "own_film.png", dpi=150)
    return {
        "vectors that can be used, of all in the picture": np.mean([one.good.mean() for one in cell.frames]),
        "speed U from the film, of the true one": fit.speed * made.camera.scales.time_s,
        "rotation of the cell, in radians": fit.rotation,
        "shift along the cell, in radii": fit.shift,
        "mirror image": fit.mirrored,
    }


if __name__ == "__main__":
    print(*(f"{name}: {value:.6g}" for name, value in main().items()), sep="\n")
