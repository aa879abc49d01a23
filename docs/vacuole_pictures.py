"""Draw the pictures of what the vacuole's flow carries: images/vacuole-*.png and vacuole-dye.gif.

python docs/vacuole_pictures.py    # a minute
"""

from pathlib import Path

import numpy as np

import cyclosis as cy
from cyclosis.figures import style
from cyclosis.figures.dye import dye
from cyclosis.figures.vacuole_bands import mean_bands
from cyclosis.figures.vacuole_dispersion import vacuole_dispersion
from cyclosis.figures.vacuole_poincare import vacuole_poincare
from cyclosis.figures.vacuole_uptake import vacuole_uptake

IMAGES = Path(__file__).parent / "images"
PITCH, PECLET, SHOWN = 5.0, 500.0, np.linspace(0.0, 24.0, 49)


def drop(r, theta, z):
    """Return a drop of dye in the middle of the cell."""
    return np.exp(-4 * (r**2 + (z - 2.5) ** 2)) + 0 * theta


def main() -> None:
    """Simulate the emergence of streaming, and draw."""
    params, grid = cy.Parameters(), cy.CylinderGrid(32, 32, 5.0)
    start = cy.initial.disordered(grid, seed=3)
    run = cy.simulate(params, grid, start, t_end=60.0, save_at=np.arange(0.0, 61.0))
    early, late = (cy.vacuole.flow(run, t=t) for t in (10.0, 60.0))
    bands, _ = mean_bands(late)
    helix = cy.vacuole.flow(grid, cy.vacuole.helical_bands(grid, bands, PITCH))
    figures = {
        "uptake": vacuole_uptake(late, PITCH),
        "dispersion": vacuole_dispersion(late, PITCH),
        "poincare-helix": vacuole_poincare(helix, 2.5),
        "poincare-emerging": vacuole_poincare(early, 2.5),
    }
    for name, figure in figures.items():
        style.save(figure, IMAGES / f"vacuole-{name}.png")
    flow = cy.vacuole.flow(run)
    carried = cy.vacuole.transport(
        flow, PECLET, start=drop, t_end=SHOWN[-1], times=SHOWN, frames=SHOWN, n_r=24
    )
    dye(carried, IMAGES / "vacuole-dye.gif", seconds=6.0, height=240)


if __name__ == "__main__":
    main()
