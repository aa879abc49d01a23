"""Where points of a grid lie along the cell and around it, both of which may be periodic."""

from __future__ import annotations

from typing import Any

from ..errors import InputError
from ..wording import beside

ROUNDING = 1e-9
"""A point no farther than this before an edge counts as on it."""


def refuse_nothing(name: str, start: float, stop: float) -> None:
    """Raise `InputError` if an interval has no width."""
    if start == stop:
        raise InputError(name, stop, "different from the first end", "leave some room between the two")


def surface_of(grid: Any) -> Any:
    """Return the surface of a closed grid, None of a cylinder's."""
    return getattr(grid, "surface", None)


def unrolled(grid: Any) -> tuple[Any, float]:
    """Return the positions (n,) of a grid along the cell, and the length of the cell in that direction."""
    surface = surface_of(grid)
    return (grid.z, grid.length) if surface is None else (grid.s, surface.meridian_length)


def on_the_cell(name: str, z: float, grid: Any) -> None:
    """Raise `InputError` for a position `z` beyond the ends of a grid."""
    length = unrolled(grid)[1]
    if not 0 <= z <= length * (1 + ROUNDING):
        what = "its length" if surface_of(grid) is None else "the length of its meridian"
        remedy = "move the region, or lengthen the cell"
        raise InputError(name, z, f"on the cell, from 0 to {what} {beside(length, z)}", remedy)


def between(x: Any, start: float, stop: float, period: float) -> Any:
    """Return where x lies between two ends, around a period if `stop` is before `start`."""
    width = stop - start if stop > start else stop - start + period
    return ((x - start + ROUNDING) % period < width) | (width >= period)


def nearest(distance: Any, period: float) -> Any:
    """Return distances in a period as the shortest way, from minus to plus half of it."""
    return (distance + 0.5 * period) % period - 0.5 * period


def in_short(value: Any) -> str:
    """Return a value in a few letters."""
    return f"{value:g}" if isinstance(value, float) else str(value)
