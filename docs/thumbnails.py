"""Draw the pictures of the gallery's cards: images/gallery/*.png.

python docs/thumbnails.py          # runs every script of the gallery, three minutes
python docs/thumbnails.py helix    # or some of them
"""

import sys
import tempfile
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path

from generate import EXAMPLES
from PIL import Image, ImageOps

FOLDER = Path(__file__).parent / "images" / "gallery"
SIZE = (480, 270)
"""Pixels of a card's picture: twice those on the page, for fine screens."""


SHOWN = {
    "circumferential": 0.665,
    "closure": 0.5,
    "drifting_stripes": 0.5,
    "mixing": 0.6,
    "straightening": 0.645,
    "transport": 0.5,
    "wound": 0.5,
}
"""The share of the width that a card shows of a long row of panels: the first of them."""


def thumbnail(picture: Image.Image, share: float = 1.0) -> Image.Image:
    """Return the left part of a picture, in `SIZE`, on white."""
    shown = picture.convert("RGB").crop((0, 0, round(share * picture.width), picture.height))
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
                drawn = thumbnail(picture, SHOWN.get(path.stem, 1.0)).quantize(128, dither=Image.Dither.NONE)
        drawn.save(FOLDER / f"{path.stem}.png", optimize=True)


if __name__ == "__main__":
    main(sys.argv[1:])
