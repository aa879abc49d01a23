"""Regions drawn as images."""

from __future__ import annotations

import base64
import binascii
import zlib
from dataclasses import dataclass
from typing import Any

import numpy as np

from ...display.shown import shown
from ..errors import InputError
from .points import ROUNDING
from .shapes import Mask, Region

LARGEST_IMAGE = 4096
"""Pixels along either side of an image."""
LARGEST_TEXT = 24_000
"""Characters of a packed image: it is stored with every run, in an attribute of at most 64 kB."""


@shown
@dataclass(frozen=True)
class Image(Region):
    """The light pixels of an image, `width` x `height`; `pixels` holds them packed as text.

    Example:
        >>> import PIL.Image
        >>> import cyclosis as cy
        >>> PIL.Image.new("L", (8, 4), "white").save("white.png")
        >>> print(cy.regions.image("white.png"))
        image (8 x 4, light 100.0%)
    """

    shape = "image"
    width: int
    height: int
    pixels: str

    def __post_init__(self) -> None:
        rule = f"the packed pixels of an image of {self.width} x {self.height}"
        try:
            self._light()
        except (TypeError, ValueError, binascii.Error, zlib.error) as error:
            raise InputError("pixels", self.pixels, rule, "give path instead") from error

    def inside(self, theta: Any, z: Any, length: float) -> Any:
        """Return whether points lie on a light pixel."""
        column = np.floor(theta / (2 * np.pi) * self.width + ROUNDING).astype(int) % self.width
        row = np.floor(z / length * self.height + ROUNDING).astype(int) % self.height
        return self._light()[self.height - 1 - row, column]

    def _light(self) -> Mask:
        size = self.width * self.height
        if not 1 <= self.width <= LARGEST_IMAGE or not 1 <= self.height <= LARGEST_IMAGE:
            raise ValueError("sides of an image")
        packed = zlib.decompressobj().decompress(base64.b64decode(self.pixels, validate=True), size)
        return np.unpackbits(np.frombuffer(packed, np.uint8))[:size].reshape(self.height, self.width) == 1

    def __str__(self) -> str:
        return f"image ({self.width} x {self.height}, light {self._light().mean():.1%})"


def image(path: str) -> Region:
    """Return the light pixels (at least half as bright as white, and not transparent) of an image.

    It is laid over the unwrapped surface: theta from 0 to 2π to the right, z from 0 to the length upwards;
    each point takes the pixel at its place. The region holds the pixels: the file is not needed again.
    Raises `InputError` for a file that is not an image, or too large or intricate to be stored.

    Example:
        >>> import numpy as np
        >>> import PIL.Image
        >>> import cyclosis as cy
        >>> PIL.Image.fromarray(np.uint8([[255, 0, 0, 0]])).save("stripe.png")  # a quarter of the turn
        >>> float(cy.regions.image("stripe.png").mask(cy.CylinderGrid(64, 64)).mean())
        0.25
    """
    light = _light_pixels(path)
    packed = base64.b64encode(zlib.compress(np.packbits(light).tobytes(), 9)).decode()
    if len(packed) > LARGEST_TEXT:
        rule = f"an image that packs to at most {LARGEST_TEXT} characters, not {len(packed)}"
        raise InputError("path", str(path), rule, "make it smaller or smoother")
    return Image(light.shape[1], light.shape[0], packed)


def _light_pixels(path: str) -> Mask:
    """Return which pixels are light, shape (height, width), the upper row first."""
    from PIL import Image as pictures

    rule = f"an image (such as PNG) of at most {LARGEST_IMAGE} x {LARGEST_IMAGE} pixels"
    try:
        with pictures.open(path) as picture:
            if max(picture.size) > LARGEST_IMAGE:
                raise InputError("path", str(path), rule, "make it smaller")
            if picture.mode.startswith("I"):  # sixteen bits of grey
                return np.asarray(picture, dtype=np.float64) >= 0.5 * 65535
            grey, opaque = picture.convert("LA").split()
            return (np.asarray(grey) >= 128) & (np.asarray(opaque) >= 128)
    except (
        OSError,
        ValueError,
        SyntaxError,
        TypeError,
        AttributeError,
        pictures.DecompressionBombError,
    ) as error:
        if isinstance(error, InputError):
            raise
        reason = getattr(error, "strerror", None) or "not an image, or damaged"
        raise InputError("path", str(path), rule, f"check the file ({reason})") from error
