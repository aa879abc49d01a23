"""Draw the pictures of the gallery's cards: images/gallery/*.png.

python docs/thumbnails.py          # runs every script of the gallery, three minutes
python docs/thumbnails.py helix    # or some of them
"""

import sys
import tempfile
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path

import numpy as np
from generate import EXAMPLES
from PIL import Image, ImageOps

FOLDER = Path(__file__).parent / "images" / "gallery"
SIZE = (480, 270)
"""Pixels of a card's picture: twice those on the page, for fine screens."""


def thumbnail(picture: Image.Image) -> Image.Image:
    """Return a picture of `SIZE` on white: of a long row of panels, the first that fit."""
    shown = picture.convert("RGB")
    widest = round(2.2 * shown.height)
    if shown.width > widest:
        blank = (np.asarray(shown).min(axis=(0, 2)) > 250).nonzero()[0]
        gaps = blank[(blank > 0.8 * shown.height) & (blank <= widest)]
        shown = shown.crop((0, 0, int(gaps[-1]) if len(gaps) else shown.width, shown.height))
    return ImageOps.pad(shown, SIZE, Image.Resampling.LANCZOS, color="white")


def main(names: list[str]) -> None:
    """Run the scripts of those names, or all, and store what they draw."""
    FOLDER.mkdir(exist_ok=True)
    for path in EXAMPLES:
        if names and path.stem not in names:
            continue
        spec = spec_from_file_location(path.stem, path)
        assert spec is not None
        assert spec.loader is not None
        module = module_from_spec(spec)
        spec.loader.exec_module(module)
        with tempfile.TemporaryDirectory() as folder:
            module.main(folder)
            with Image.open(f"{folder}/{path.stem}.png") as picture:
                drawn = thumbnail(picture).quantize(128, dither=Image.Dither.NONE)
        drawn.save(FOLDER / f"{path.stem}.png", optimize=True)


if __name__ == "__main__":
    main(sys.argv[1:])
