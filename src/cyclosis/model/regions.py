"""Regions of the surface, stated without a grid: boxes, discs, bands, strips, images, and combinations.

A region is a value; `mask(grid)` says which points of a grid lie in it. `~a`, `a | b` and `a & b` are the
complement, the union and the intersection. Angles in radians, lengths in radii; both directions are periodic.
"""

from __future__ import annotations

import base64
import binascii
import zlib
from dataclasses import dataclass, fields
from typing import Any, ClassVar

import numpy as np
import numpy.typing as npt

from .errors import InputError
from .grid import CylinderGrid
from .interventions import SHAPES

Mask = npt.NDArray[np.bool_]

ROUNDING = 1e-9
"""What a point may lie before an edge and still count as on it."""
LARGEST_IMAGE = 4096
"""Pixels along either side of an image."""
LARGEST_TEXT = 24_000
"""Characters of a packed image: it is stored with every run, in an attribute of at most 64 kB."""


@dataclass(frozen=True)
class Region:
    """A part of the surface. Make one with the functions of this module, not with its classes."""

    shape: ClassVar[str]

    def __post_init__(self) -> None:
        for item in SHAPES[self.shape][1]:
            if hasattr(self, item.name):
                object.__setattr__(self, item.name, item.check(getattr(self, item.name)))

    def mask(self, grid: CylinderGrid) -> Mask:
        """Return which points of a grid lie in the region, shape (n_theta, n_z).

        Raises `InputError` for a region that is not on the cell.
        """
        self.check(grid)
        return np.broadcast_to(
            self.inside(grid.theta[:, None], grid.z[None, :], grid.length), grid.shape
        ).copy()

    def check(self, grid: CylinderGrid) -> None:
        """Raise `InputError` if the region is not on the cell."""

    def inside(self, theta: Any, z: Any, length: float) -> Any:
        """Return whether points lie in the region; `theta` and `z` broadcast."""
        raise NotImplementedError

    def as_table(self) -> dict[str, Any]:
        """Return the region as a plain table, from which `region_tables.from_table` makes it again."""
        return {"shape": self.shape} | {item.name: getattr(self, item.name) for item in fields(self)}

    def __invert__(self) -> Region:
        return Complement(self)

    def __or__(self, other: Region) -> Region:
        return Union((self, other))

    def __and__(self, other: Region) -> Region:
        return Intersection((self, other))

    def __str__(self) -> str:
        values = (f"{item.name} = {_shown(getattr(self, item.name))}" for item in fields(self))
        return f"{self.shape} ({', '.join(values)})"


@dataclass(frozen=True)
class Box(Region):
    """theta0 <= theta < theta1 and z0 <= z < z1, either going round if the first end is beyond the second."""

    shape = "box"
    theta0: float
    theta1: float
    z0: float
    z1: float

    def __post_init__(self) -> None:
        super().__post_init__()
        _refuse_nothing("theta1", self.theta0, self.theta1)
        _refuse_nothing("z1", self.z0, self.z1)

    def check(self, grid: CylinderGrid) -> None:
        """Raise `InputError` if the box ends beyond the cell."""
        _on_the_cell("z0", self.z0, grid)
        _on_the_cell("z1", self.z1, grid)

    def inside(self, theta: Any, z: Any, length: float) -> Any:
        """Return whether points lie in the box."""
        return _between(theta, self.theta0, self.theta1, 2 * np.pi) & _between(z, self.z0, self.z1, length)


@dataclass(frozen=True)
class Disc(Region):
    """All points within `radius` of (theta, z), measured on the surface."""

    shape = "disc"
    theta: float
    z: float
    radius: float

    def check(self, grid: CylinderGrid) -> None:
        """Raise `InputError` if the centre is not on the cell."""
        _on_the_cell("z", self.z, grid)

    def inside(self, theta: Any, z: Any, length: float) -> Any:
        """Return whether points lie in the disc."""
        around = _nearest(theta - self.theta, 2 * np.pi)
        along = _nearest(z - self.z, length)
        return np.hypot(around, along) <= self.radius + ROUNDING


@dataclass(frozen=True)
class Band(Region):
    """start <= axis < stop, going round if start is beyond stop."""

    shape = "band"
    axis: str
    start: float
    stop: float

    def __post_init__(self) -> None:
        super().__post_init__()
        _refuse_nothing("stop", self.start, self.stop)
        if self.axis == "theta":
            for name in ("start", "stop"):
                if getattr(self, name) > 6.3:
                    rule = "an angle from -6.3 to 6.3 radians where axis is theta"
                    raise InputError(name, getattr(self, name), rule, "give it in radians, or axis = z")

    def check(self, grid: CylinderGrid) -> None:
        """Raise `InputError` if the band ends beyond the cell."""
        if self.axis == "z":
            _on_the_cell("start", self.start, grid)
            _on_the_cell("stop", self.stop, grid)

    def inside(self, theta: Any, z: Any, length: float) -> Any:
        """Return whether points lie in the band."""
        if self.axis == "theta":
            return _between(theta, self.start, self.stop, 2 * np.pi) & (z == z)
        return _between(z, self.start, self.stop, length) & (theta == theta)


@dataclass(frozen=True)
class Strips(Region):
    """`count` strips at even distances along an axis that cover a `share` of the surface."""

    shape = "strips"
    count: int
    share: float
    axis: str
    offset: float

    def inside(self, theta: Any, z: Any, length: float) -> Any:
        """Return whether points lie in a strip."""
        place = theta / (2 * np.pi) + 0 * z if self.axis == "theta" else z / length + 0 * theta
        return (place * self.count - self.offset + ROUNDING) % 1.0 < self.share


@dataclass(frozen=True)
class Image(Region):
    """The light pixels of an image, `width` x `height`; `pixels` holds them packed as text."""

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


@dataclass(frozen=True)
class Complement(Region):
    """All that does not lie in a region."""

    region: Region

    def __post_init__(self) -> None:
        _require_regions((self.region,))

    def check(self, grid: CylinderGrid) -> None:
        """Raise `InputError` if the region is not on the cell."""
        self.region.check(grid)

    def inside(self, theta: Any, z: Any, length: float) -> Any:
        """Return whether points lie outside the region."""
        return ~self.region.inside(theta, z, length)

    def as_table(self) -> dict[str, Any]:
        """Return the table of the region, marked as inverted."""
        return self.region.as_table() | {"invert": True}

    def __invert__(self) -> Region:
        return self.region

    def __str__(self) -> str:
        return f"all but {self.region}"


@dataclass(frozen=True)
class _Combined(Region):
    parts: tuple[Region, ...]
    word: ClassVar[str]

    def __post_init__(self) -> None:
        _require_regions(self.parts)

    def check(self, grid: CylinderGrid) -> None:
        """Raise `InputError` if a part is not on the cell."""
        for part in self.parts:
            part.check(grid)

    def as_table(self) -> dict[str, Any]:
        """Return the region as a table with the tables of its parts."""
        return {"shape": self.shape, "parts": [part.as_table() for part in self.parts]}

    def __str__(self) -> str:
        return "(" + f" {self.word} ".join(map(str, self.parts)) + ")"


@dataclass(frozen=True)
class Union(_Combined):
    """All that lies in any of the parts."""

    shape = "union"
    word = "or"

    def inside(self, theta: Any, z: Any, length: float) -> Any:
        """Return whether points lie in any of the parts."""
        return np.logical_or.reduce([part.inside(theta, z, length) for part in self.parts])


@dataclass(frozen=True)
class Intersection(_Combined):
    """All that lies in every one of the parts."""

    shape = "intersection"
    word = "and"

    def inside(self, theta: Any, z: Any, length: float) -> Any:
        """Return whether points lie in all the parts."""
        return np.logical_and.reduce([part.inside(theta, z, length) for part in self.parts])


def box(theta0: float, theta1: float, z0: float, z1: float) -> Region:
    """Return the region theta0 <= theta < theta1, z0 <= z < z1; a first end beyond the second goes round."""
    return Box(theta0, theta1, z0, z1)


def disc(theta: float, z: float, radius: float) -> Region:
    """Return all points within `radius` of (theta, z), measured on the surface."""
    return Disc(theta, z, radius)


def band(axis: str, start: float, stop: float) -> Region:
    """Return the region start <= axis < stop for `axis` "theta" or "z"; start beyond stop goes round."""
    return Band(axis, start, stop)


def strips(count: int, share: float = 0.5, axis: str = "theta", offset: float = 0.0) -> Region:
    """Return `count` strips at even distances along an axis that together cover a `share` of the surface.

    With axis "theta" they run along the cell, with "z" around it. The first begins `offset` spacings from 0.
    """
    return Strips(count, share, axis, offset)


def image(path: str) -> Region:
    """Return the light pixels (at least half as bright as white, and not transparent) of an image.

    It is laid over the unwrapped surface: theta from 0 to 2π to the right, z from 0 to the length upwards; a
    point takes the pixel that it falls on. The region holds the pixels, so that the file is not needed again.
    Raises `InputError` for a file that is no image, or too large or too intricate to be stored with a run.
    """
    light = _read(path)
    packed = base64.b64encode(zlib.compress(np.packbits(light).tobytes(), 9)).decode()
    if len(packed) > LARGEST_TEXT:
        rule = f"an image that packs to at most {LARGEST_TEXT} characters, and it takes {len(packed)}"
        raise InputError("path", str(path), rule, "make it smaller or smoother")
    return Image(light.shape[1], light.shape[0], packed)


def _read(path: str) -> Mask:
    from PIL import Image as pictures

    rule = f"an image (PNG, say) of at most {LARGEST_IMAGE} x {LARGEST_IMAGE} pixels"
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
        reason = getattr(error, "strerror", None) or "it is none, or damaged"
        raise InputError("path", str(path), rule, f"check the file ({reason})") from error


def _require_regions(parts: tuple[Any, ...]) -> None:
    for part in parts:
        if not isinstance(part, Region):
            raise InputError("region", part, "a region of cyclosis.regions", "make it with regions.disc, say")


def _refuse_nothing(name: str, start: float, stop: float) -> None:
    if start == stop:
        raise InputError(name, stop, "another number than the first end", "leave some room between the two")


def _on_the_cell(name: str, z: float, grid: CylinderGrid) -> None:
    if not 0 <= z <= grid.length * (1 + ROUNDING):
        remedy = "move the region, or lengthen the cell"
        raise InputError(name, z, f"on the cell, from 0 to its length {grid.length:g}", remedy)


def _between(x: Any, start: float, stop: float, period: float) -> Any:
    width = stop - start if stop > start else stop - start + period
    return ((x - start + ROUNDING) % period < width) | (width >= period)


def _nearest(distance: Any, period: float) -> Any:
    return (distance + 0.5 * period) % period - 0.5 * period


def _shown(value: Any) -> str:
    return f"{value:g}" if isinstance(value, float) else str(value)
