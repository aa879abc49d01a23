"""Regions with edges, and combinations of regions: complement, union and intersection."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Any, ClassVar

import numpy as np
import numpy.typing as npt

from ...display.shown import shown
from ..doors import door
from ..errors import InputError
from ..interventions import SHAPES
from .points import ROUNDING, between, in_short, nearest, on_the_cell, refuse_nothing, surface_of, unrolled

Mask = npt.NDArray[np.bool_]


@shown
@dataclass(frozen=True)
class Region:
    """A part of the surface. Make one with the functions of this module, not with its classes.

    Example:
        >>> import cyclosis as cy
        >>> grid = cy.CylinderGrid(64, 64, length=5.0)
        >>> disc, half = cy.regions.disc(3.0, 2.5, 0.5), cy.regions.band("z", 0.0, 2.5)
        >>> print(disc & ~half)
        (disc (theta = 3, z = 2.5, radius = 0.5) and all but band (axis = z, start = 0, stop = 2.5))
        >>> bool((disc | ~disc).mask(grid).all()), bool((disc & ~disc).mask(grid).any())
        (True, False)
        >>> bool((disc.covers(grid) == disc.mask(grid)).all())
        True
        >>> disc.as_table(), bool(disc.inside(3.0, 2.9, grid.length))
        ({'shape': 'disc', 'theta': 3.0, 'z': 2.5, 'radius': 0.5}, True)
        >>> cy.regions.disc(3.0, 7.0, 0.5).check(grid)
        Traceback (most recent call last):
            ...
        cyclosis.model.errors.InputError: z = 7.0 cannot be used: ...
    """

    shape: ClassVar[str]

    def __post_init__(self) -> None:
        for item in SHAPES[self.shape][1]:
            if hasattr(self, item.name):
                object.__setattr__(self, item.name, item.check(getattr(self, item.name)))

    @door
    def mask(self, grid: Any) -> Mask:
        """Return which points of a grid lie in the region, shape (n_theta, n_z).

        On a `cyclosis.ClosedGrid`, (n_theta, n_s), z is the arc length s from the south pole. Raises
        `InputError` for a region that is not on the cell.
        """
        self.check(grid)
        return np.broadcast_to(self.covers(grid), grid.shape).copy()

    def check(self, grid: Any) -> None:
        """Raise `InputError` if the region is not on the cell."""

    def covers(self, grid: Any) -> Any:
        """Return whether points of a grid lie in the region, of a shape that broadcasts to the grid's."""
        along, length = unrolled(grid)
        return self.inside(grid.theta[:, None], along[None, :], length)

    def inside(self, theta: Any, z: Any, length: float) -> Any:
        """Return whether points lie in the region; `theta` and `z` broadcast."""
        raise NotImplementedError

    def as_table(self) -> dict[str, Any]:
        """Return the region as a plain table, from which `region_tables.from_table` recreates it."""
        return {"shape": self.shape} | {item.name: getattr(self, item.name) for item in fields(self)}

    def __invert__(self) -> Region:
        return Complement(self)

    def __or__(self, other: Region) -> Region:
        return Union((self, other))

    def __and__(self, other: Region) -> Region:
        return Intersection((self, other))

    def __str__(self) -> str:
        values = (f"{item.name} = {in_short(getattr(self, item.name))}" for item in fields(self))
        return f"{self.shape} ({', '.join(values)})"


@shown
@dataclass(frozen=True)
class Box(Region):
    """theta0 <= theta < theta1 and z0 <= z < z1, each wrapping around if its first end is beyond the second.

    Example:
        >>> import cyclosis as cy
        >>> print(cy.regions.box(6.0, 0.3, 1.0, 2.0))
        box (theta0 = 6, theta1 = 0.3, z0 = 1, z1 = 2)
    """

    shape = "box"
    theta0: float
    theta1: float
    z0: float
    z1: float

    def __post_init__(self) -> None:
        super().__post_init__()
        refuse_nothing("theta1", self.theta0, self.theta1)
        refuse_nothing("z1", self.z0, self.z1)

    def check(self, grid: Any) -> None:
        """Raise `InputError` if the box ends beyond the cell."""
        on_the_cell("z0", self.z0, grid)
        on_the_cell("z1", self.z1, grid)

    def inside(self, theta: Any, z: Any, length: float) -> Any:
        """Return whether points lie in the box."""
        return between(theta, self.theta0, self.theta1, 2 * np.pi) & between(z, self.z0, self.z1, length)


@shown
@dataclass(frozen=True)
class Disc(Region):
    """All points within `radius` of (theta, z), measured on the surface; radians and radii.

    On a closed surface the distance is measured straight through space.

    Example:
        >>> import cyclosis as cy
        >>> print(cy.regions.disc(3.0, 2.5, 0.5))
        disc (theta = 3, z = 2.5, radius = 0.5)
    """

    shape = "disc"
    theta: float
    z: float
    radius: float

    def check(self, grid: Any) -> None:
        """Raise `InputError` if the centre is not on the cell."""
        on_the_cell("z", self.z, grid)

    def covers(self, grid: Any) -> Any:
        """Return whether points of a grid lie in the disc."""
        if surface_of(grid) is None:
            return super().covers(grid)
        apart = grid.xyz - grid.position(self.theta, self.z)[:, None, None]
        return np.sqrt(np.sum(apart**2, axis=0)) <= self.radius + ROUNDING

    def inside(self, theta: Any, z: Any, length: float) -> Any:
        """Return whether points lie in the disc, on a cylinder."""
        around = nearest(theta - self.theta, 2 * np.pi)
        along = nearest(z - self.z, length)
        return np.hypot(around, along) <= self.radius + ROUNDING


@shown
@dataclass(frozen=True)
class Band(Region):
    """start <= axis < stop, wrapping around if start is beyond stop.

    Example:
        >>> import cyclosis as cy
        >>> print(cy.regions.band("z", 4.0, 1.0))
        band (axis = z, start = 4, stop = 1)
    """

    shape = "band"
    axis: str
    start: float
    stop: float

    def __post_init__(self) -> None:
        super().__post_init__()
        refuse_nothing("stop", self.start, self.stop)
        if self.axis == "theta":
            for name in ("start", "stop"):
                if getattr(self, name) > 6.3:
                    rule = "an angle from -6.3 to 6.3 radians where axis is theta"
                    raise InputError(name, getattr(self, name), rule, "give it in radians, or axis = z")

    def check(self, grid: Any) -> None:
        """Raise `InputError` if the band ends beyond the cell."""
        if self.axis == "z":
            on_the_cell("start", self.start, grid)
            on_the_cell("stop", self.stop, grid)

    def inside(self, theta: Any, z: Any, length: float) -> Any:
        """Return whether points lie in the band."""
        if self.axis == "theta":
            return between(theta, self.start, self.stop, 2 * np.pi) & (z == z)
        return between(z, self.start, self.stop, length) & (theta == theta)


@shown
@dataclass(frozen=True)
class Strips(Region):
    """`count` strips at even distances along an axis that cover a `share` of the surface.

    Example:
        >>> import cyclosis as cy
        >>> print(cy.regions.strips(4, share=0.25))
        strips (count = 4, share = 0.25, axis = theta, offset = 0)
    """

    shape = "strips"
    count: int
    share: float
    axis: str
    offset: float

    def inside(self, theta: Any, z: Any, length: float) -> Any:
        """Return whether points lie in a strip."""
        place = theta / (2 * np.pi) + 0 * z if self.axis == "theta" else z / length + 0 * theta
        return (place * self.count - self.offset + ROUNDING) % 1.0 < self.share


@shown
@dataclass(frozen=True)
class Complement(Region):
    """All points outside a region.

    Example:
        >>> import cyclosis as cy
        >>> print(~cy.regions.disc(3.0, 2.5, 0.5))
        all but disc (theta = 3, z = 2.5, radius = 0.5)
    """

    region: Region

    def __post_init__(self) -> None:
        _require_regions((self.region,))

    def check(self, grid: Any) -> None:
        """Raise `InputError` if the region is not on the cell."""
        self.region.check(grid)

    def covers(self, grid: Any) -> Any:
        """Return whether points of a grid lie outside the region."""
        return ~self.region.covers(grid)

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
    combine: ClassVar[Any]

    def __post_init__(self) -> None:
        _require_regions(self.parts)

    def check(self, grid: Any) -> None:
        """Raise `InputError` if a part is not on the cell."""
        for part in self.parts:
            part.check(grid)

    def covers(self, grid: Any) -> Any:
        """Return whether points of a grid lie in the combination of the parts."""
        return self.combine([np.broadcast_to(part.covers(grid), grid.shape) for part in self.parts])

    def inside(self, theta: Any, z: Any, length: float) -> Any:
        """Return whether points lie in the combination of the parts."""
        return self.combine([part.inside(theta, z, length) for part in self.parts])

    def as_table(self) -> dict[str, Any]:
        """Return the region as a table with the tables of its parts."""
        return {"shape": self.shape, "parts": [part.as_table() for part in self.parts]}

    def __str__(self) -> str:
        return "(" + f" {self.word} ".join(map(str, self.parts)) + ")"


@shown
@dataclass(frozen=True)
class Union(_Combined):
    """All points in any of the parts.

    Example:
        >>> import cyclosis as cy
        >>> print(cy.regions.disc(1.0, 2.5, 0.5) | cy.regions.disc(4.0, 2.5, 0.5))
        (disc (theta = 1, z = 2.5, radius = 0.5) or disc (theta = 4, z = 2.5, radius = 0.5))
    """

    shape = "union"
    word = "or"
    combine = np.logical_or.reduce


@shown
@dataclass(frozen=True)
class Intersection(_Combined):
    """All points in every one of the parts.

    Example:
        >>> import cyclosis as cy
        >>> print(cy.regions.disc(1.0, 2.5, 0.5) & cy.regions.band("z", 0.0, 2.5))
        (disc (theta = 1, z = 2.5, radius = 0.5) and band (axis = z, start = 0, stop = 2.5))
    """

    shape = "intersection"
    word = "and"
    combine = np.logical_and.reduce


def box(theta0: float, theta1: float, z0: float, z1: float) -> Region:
    """Return the region theta0 <= theta < theta1, z0 <= z < z1; a first end beyond the second wraps around.

    Raises `InputError` for ends that are equal or out of range; `mask` does for a region that is not on the
    cell. The same holds for the functions below.

    Example:
        >>> import cyclosis as cy
        >>> where = cy.regions.box(6.0, 0.3, 1.0, 2.0).mask(cy.CylinderGrid(64, 64))  # across theta = 0
        >>> where.shape, bool(where[0, 20]), bool(where[32, 20])
        ((64, 64), True, False)
    """
    return Box(theta0, theta1, z0, z1)


def disc(theta: float, z: float, radius: float) -> Region:
    """Return all points within `radius` (in radii of the cell) of (theta, z), measured on the surface.

    On a closed surface the distance is measured straight through space, and z is the arc length s.

    Example:
        >>> import cyclosis as cy
        >>> grid = cy.CylinderGrid(256, 256, length=5.0)
        >>> covered = cy.regions.disc(3.0, 2.5, 1.0).mask(grid).mean()
        >>> round(float(covered * 2 * 3.14159 * grid.length), 2)  # π radius²
        3.14
    """
    return Disc(theta, z, radius)


def band(axis: str, start: float, stop: float) -> Region:
    """Return the region start <= axis < stop for `axis` "theta" or "z"; start beyond stop wraps around.

    Example:
        >>> import cyclosis as cy
        >>> grid = cy.CylinderGrid(64, 64, length=5.0)
        >>> float(cy.regions.band("z", 3.75, 1.25).mask(grid).mean())  # both ends of the cell
        0.5
    """
    return Band(axis, start, stop)


def strips(count: int, share: float = 0.5, axis: str = "theta", offset: float = 0.0) -> Region:
    """Return `count` strips at even distances along an axis that together cover a `share` of the surface.

    With axis "theta" they run along the cell, with "z" around it. The first begins `offset` spacings from 0.
    On a closed surface, rings cover that share of the meridian, which is not the share of the area.

    Example:
        >>> import cyclosis as cy
        >>> grid = cy.CylinderGrid(64, 64)
        >>> where = cy.regions.strips(4, share=0.25).mask(grid)
        >>> where[:20, 0].astype(int)
        array([1, 1, 1, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 1, 1, 1])
    """
    return Strips(count, share, axis, offset)


def _require_regions(parts: tuple[Any, ...]) -> None:
    for part in parts:
        if not isinstance(part, Region):
            raise InputError(
                "region", part, "a region of cyclosis.regions", "make it with regions.disc, for example"
            )
