"""Draw what instruments record of a cell: images/observe-*.png.

python docs/observing_pictures.py    # two minutes
"""

from pathlib import Path

from PIL import Image

import cyclosis as cy
from cyclosis.figures import style

IMAGES = Path(__file__).parent / "images"
WIDTH = 1000
"""Pixels across a picture."""
SHOTS = {
    "film": {"frames": 12, "start": 36.0, "depth_um": 120.0, "chloroplasts": True},
    "piv": {"times": [12.0]},
    "tracks": {"frames": 30, "start": 36.0},
    "kymograph": {"frames": 90, "start": 34.0, "at": 20.0},
    "orientation": {"times": [20.0]},
    "mrv": {"times": [40.0]},
}


def small(path):
    """Make a picture small enough for a page: noise does not compress."""
    with Image.open(path) as picture:
        size = (WIDTH, round(WIDTH * picture.height / picture.width))
        drawn = picture.convert("RGB").resize(size, Image.Resampling.LANCZOS)
    drawn.quantize(96, dither=Image.Dither.NONE).save(path, optimize=True)


def main() -> None:
    """Simulate the emergence of streaming, and look at it."""
    grid = cy.CylinderGrid(64, 64, 5.0)
    start = cy.initial.disordered(grid, seed=0, noise_grid=(32, 32))
    run = cy.simulate(cy.Parameters(), grid, start, t_end=40.0, save_every=0.25)
    data = run.to_dataset()
    view = cy.observations.View(radius_px=100.0, axis_deg=17.0)
    for kind, options in SHOTS.items():
        seen = cy.observations.observe(data, view, kind, **options)
        path = style.save(seen.figure(), IMAGES / f"observe-{kind}.png")
        small(path)


if __name__ == "__main__":
    main()
