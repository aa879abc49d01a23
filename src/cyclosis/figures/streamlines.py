"""Streamlines of a flow on a surface: evenly spread short lines, each directed downstream."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

import numpy as np
import numpy.typing as npt

from ..model.doors import door
from ..model.errors import number
from ..model.grid import Array, CylinderGrid, interpolate

__all__ = [
    "FINE",
    "ROOM",
    "SHORTEST",
    "STEP",
    "Streamline",
    "Taken",
    "Unrolled",
    "Wall",
    "even_fractions",
    "even_points",
    "filled",
    "streamlines",
    "traced",
    "velocity_of",
]


def __dir__() -> list[str]:
    return sorted(__all__)


STEP = 0.04
"""Arc length between the points of a line, in radii."""
FINE = 192
"""Flows are refined to at least this many points in each direction before lines are traced."""
ROOM = 1.15
"""A line starts only this many separations away from others, so that it has room to run."""
SHORTEST = 0.35
"""Lines shorter than this fraction of the requested length are not kept."""

Velocity = Callable[[Array], Array]
Line = tuple[Array, Array]
"""Points (d, n) along a streamline, in the direction of the flow, and the speed (n,) there."""


class Wall(Protocol):
    """A surface on which lines are drawn, with points (d, ...): unrolled, d = 2, or in space, d = 3."""

    @property
    def period(self) -> Array:
        """The periods (d,) of the coordinates, or lengths that hold the whole surface."""
        ...

    @property
    def area(self) -> float:
        """The area, in radii squared."""
        ...

    def velocity(self, flow: Array) -> Velocity:
        """Return the function that interpolates a flow at points (d, ...)."""
        ...

    def places(self, fractions: Array) -> Array:
        """Return the points (d, n) of fractions (2, n) in 0 to 1: equal areas are equally likely."""
        ...

    def onto(self, points: Array) -> Array:
        """Return points (d, ...) on the surface that were moved along it, and a little off it."""
        ...

    def across(self, points: Array, along: Array) -> Array:
        """Return the unit vectors (d, n) to the left of the directions `along` (d, n) at points (d, n)."""
        ...

    def headings(self, paths: Array) -> Array:
        """Return the angle (steps, n) by which paths (d, steps + 1, n) have turned."""
        ...


@dataclass(frozen=True)
class Unrolled:
    """The wall of the cylinder: points are (theta, z)."""

    grid: CylinderGrid

    @property
    def period(self) -> Array:
        """(2π, length)."""
        return np.array([2 * np.pi, self.grid.length])

    @property
    def area(self) -> float:
        """2π times the length."""
        return 2 * np.pi * self.grid.length

    def velocity(self, flow: Array) -> Velocity:
        """Return `velocity_of` the flow."""
        return velocity_of(self.grid, flow)

    def places(self, fractions: Array) -> Array:
        """Return fractions of the two periods."""
        return fractions * self.period[:, None]

    def onto(self, points: Array) -> Array:
        """Return the points: all are on the surface."""
        return points

    def across(self, points: Array, along: Array) -> Array:
        """Return the vectors turned by a right angle."""
        return np.stack([-along[1], along[0]])

    def headings(self, paths: Array) -> Array:
        """Return the angle to the direction of theta, since the first step."""
        along = np.diff(paths, axis=1)
        heading = np.unwrap(np.arctan2(along[1], along[0]), axis=0)
        return heading - heading[0]


@dataclass(frozen=True, eq=False)
class Streamline:
    """Points along a streamline, in the direction of the flow.

    `theta` and `z` (n,) are unwrapped (they leave the fundamental domain where the line crosses its
    edge), `speed` (n,) is |u| there. Dimensionless.
    """

    theta: Array
    z: Array
    speed: Array

    @property
    def arc_length(self) -> float:
        """Length of the line on the cylinder of radius 1."""
        return float(np.sum(np.hypot(np.diff(self.theta), np.diff(self.z))))


@door
def streamlines(
    grid: CylinderGrid,
    u: npt.ArrayLike,
    *,
    separation: float = 0.1,
    length: float = 1.2,
    slowest: float = 0.0,
) -> list[Streamline]:
    """Return streamlines of a flow (2, n_theta, n_z) that fill the surface evenly.

    No two lines, nor two turns of one, come closer than `separation`; no line is longer than `length`
    or enters places where |u| <= `slowest`. Lines are traced by fourth-order Runge-Kutta steps along
    u/|u|, with u refined by Fourier and then by bilinear interpolation, from fixed seeds: the same flow
    gives the same lines. Everything is dimensionless, lengths in radii. Raises `InputError` for a
    mismatched flow.

    Example:
        >>> import cyclosis as cy
        >>> from cyclosis.figures.streamlines import streamlines
        >>> grid = cy.CylinderGrid(16, 16)
        >>> u = cy.flow(cy.Parameters(), grid, cy.initial.stripes(grid))
        >>> lines = streamlines(grid, u, separation=0.5, length=1.0)
        >>> max(line.arc_length for line in lines) < 1.01
        True
        >>> bool(max(abs(line.theta - line.theta[0]).max() for line in lines) < 1e-6)  # along the cell
        True
    """
    flow = grid.check_state(u, "the flow")
    separation = number("separation", separation, 0.02, 3.0, "choose a distance in radii")
    length = number("length", length, 2 * STEP, 100.0, "choose an arc length in radii")
    slowest = number("slowest", slowest, 0.0, 1e9, "choose a speed")
    found = filled(Unrolled(grid), flow, separation, length, slowest)
    return [Streamline(points[0], points[1], speed) for points, speed in found]


def filled(wall: Wall, flow: Array, separation: float, length: float, slowest: float) -> list[Line]:
    """Return streamlines that fill a wall evenly, as `streamlines` describes them."""
    velocity = wall.velocity(flow)
    seeds = wall.places(even_fractions(wall.area, separation))
    seeds = seeds[:, np.hypot.reduce(velocity(seeds)) > slowest]
    steps = max(1, round(0.5 * length / STEP))
    upstream, downstream = (traced(velocity, seeds, steps, step) for step in (-STEP, STEP))
    points = wall.onto(np.concatenate([upstream[:, :0:-1], downstream], axis=1))
    speed = np.hypot.reduce(velocity(points))
    return _spread(wall.period, points, speed, speed <= slowest, separation, length)


@door
def even_points(grid: CylinderGrid, separation: float) -> Array:
    """Return points (2, n) of a low-discrepancy sequence, about four per line that fits."""
    wall = Unrolled(grid)
    return wall.places(even_fractions(wall.area, separation))


def even_fractions(area: float, separation: float) -> Array:
    """Return points (2, n) of a low-discrepancy sequence in the unit square, for a surface of an area."""
    count = max(64, int(4 * area / (ROOM * separation) ** 2))
    plastic = 1.324717957244746  # the real root of x³ = x + 1 gives the most even two-dimensional sequence
    return np.mod(0.5 + np.outer([1 / plastic, 1 / plastic**2], np.arange(count)), 1.0)


def _refined(n: int) -> int:
    return n * -(-FINE // n)


@door
def velocity_of(grid: CylinderGrid, flow: Array) -> Velocity:
    """Return the function that interpolates a flow (2, n_theta, n_z) at points (2, ...)."""
    fine = interpolate(flow, (_refined(grid.n_theta), _refined(grid.n_z)))
    n, m = fine.shape[1:]
    packed = (fine[0] + 1j * fine[1]).ravel()

    def velocity(points: Array) -> Array:
        x, y = points[0] * (n / (2 * np.pi)), points[1] * (m / grid.length)
        i, j = np.floor(x).astype(np.int64), np.floor(y).astype(np.int64)
        a, b = x - i, y - j
        row, after = np.mod(i, n) * m, np.mod(i + 1, n) * m
        left, right = np.mod(j, m), np.mod(j + 1, m)
        low = packed[row + left] * (1 - b) + packed[row + right] * b
        high = packed[after + left] * (1 - b) + packed[after + right] * b
        v = low * (1 - a) + high * a
        return np.stack([v.real, v.imag])

    return velocity


def traced(velocity: Velocity, starts: Array, steps: int, step: Array | float) -> Array:
    """Trace lines along u/|u| from all `starts` (d, n) at once; return points (d, steps + 1, n).

    Fourth-order Runge-Kutta. `step` is an arc length for all or for each line (n,), negative upstream.
    """

    def direction(points: Array) -> Array:
        v = velocity(points)
        return v / np.maximum(np.hypot.reduce(v, axis=0), 1e-300)

    path = [starts]
    for _ in range(steps):
        x = path[-1]
        a = direction(x)
        b = direction(x + 0.5 * step * a)
        c = direction(x + 0.5 * step * b)
        d = direction(x + step * c)
        path.append(x + step / 6 * (a + 2 * b + 2 * c + d))
    return np.stack(path, axis=1)


def _spread(
    period: Array,
    points: Array,
    speed: Array,
    slow: npt.NDArray[np.bool_],
    separation: float,
    length: float,
) -> list[Line]:
    """Keep lines one by one, cut where they come too close to those kept before."""
    near_line, near_seed = (Taken(period, distance) for distance in (separation, ROOM * separation))
    cells, seed_cells = near_line.cells(points), near_seed.cells(points)
    middle = points.shape[1] // 2
    starts = seed_cells[middle].tolist()
    left = list(range(len(starts)))
    lines: list[Line] = []
    # Full lines first: short ones then only fill the gaps.
    for least in (0.95 * length, SHORTEST * length):
        # Occupied places stay occupied, so the second round need not try those seeds again.
        left = [k for k in left if not near_seed.taken[starts[k]]]
        for k in left:
            if near_seed.taken[starts[k]]:
                continue
            stopped = np.flatnonzero(near_line.taken[cells[:, k]] | slow[:, k])
            cut = int(np.searchsorted(stopped, middle))
            start = int(stopped[cut - 1]) + 1 if cut > 0 else 0
            stop = int(stopped[cut]) if cut < stopped.size else points.shape[1]
            if (stop - start - 1) * STEP < least:
                continue
            stop = start + _before_return(points[:, start:stop, k], separation)
            if (stop - start - 1) * STEP < least:
                continue
            kept = slice(start, stop)
            lines.append((points[:, kept, k], speed[kept, k]))
            near_line.add(cells[kept, k])
            near_seed.add(seed_cells[kept, k])
    return lines


def _before_return(line: Array, separation: float) -> int:
    """Return how many points (d, n) of a line come before it meets its own beginning."""
    gap = int(np.ceil(1.5 * separation / STEP))
    distance = np.hypot.reduce(line[:, :, None] - line[:, None, :])
    meets = np.flatnonzero(np.any(np.tril(distance < separation, -gap), axis=1))
    return int(meets[0]) if meets.size else line.shape[1]


class Taken:
    """The small cells of the surface that are within a distance of the lines kept so far."""

    def __init__(self, period: Array, distance: float, fineness: int = 6) -> None:
        self.period = period
        self.shape = np.ceil(self.period / (distance / fineness)).astype(np.int64)
        size = self.period / self.shape
        self.taken = np.zeros(int(self.shape.prod()), dtype=bool)
        # The distance plus a cell's diagonal, because points may be anywhere in their cells.
        reach = distance + float(np.hypot.reduce(size))
        most = np.minimum(np.ceil(reach / size).astype(np.int64), self.shape // 2)
        steps = np.stack(np.meshgrid(*(np.arange(-n, n + 1) for n in most), indexing="ij"))
        inside = np.hypot.reduce([step * width for step, width in zip(steps, size, strict=True)]) <= reach
        self.disc = steps[:, inside]

    def cells(self, points: Array) -> npt.NDArray[np.int64]:
        """Return the numbers (...) of the cells in which points (d, ...) lie."""
        places = [
            np.floor(x * (n / p)).astype(np.int64)
            for x, n, p in zip(points, self.shape, self.period, strict=True)
        ]
        return self._numbers(places)

    def _numbers(self, places: list[npt.NDArray[np.int64]]) -> npt.NDArray[np.int64]:
        number = np.mod(places[0], self.shape[0])
        for place, n in zip(places[1:], self.shape[1:], strict=True):
            number = number * n + np.mod(place, n)
        return np.asarray(number)

    def clear(self) -> None:
        """Forget all lines."""
        self.taken[:] = False

    def add(self, cells: npt.NDArray[np.int64]) -> None:
        """Mark everything near the points in `cells` (n,)."""
        places = np.unravel_index(cells[:, None], tuple(self.shape))
        self.taken[self._numbers([at + steps for at, steps in zip(places, self.disc, strict=True)])] = True
