"""What the explorer needs to know of a cell's surface, which its session, messages and page ask for."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np

from ..contract.model import Array
from ..model.errors import InputError
from ..models import closed, of_grid, polar

FINEST = 128
"""Most grid points in each direction of a cell in the explorer; on a closed cell most of their square."""


class Judged(NamedTuple):
    """A regime: its name and the reason in words, the widths of its stripes, and numbers for the page."""

    name: str
    reason: str
    widths: Array
    numbers: dict[str, Any]


class Surface(ABC):
    """One kind of surface: what its pictures hold, and what has no meaning on it."""

    traces: tuple[str, ...]
    """The quantities recorded at every frame, after the time; components as `name_component`."""
    unused: tuple[str, ...] = ()
    """The parameters that have no meaning on it."""
    straight = False
    """Whether it is the paper's cylinder, with a vacuole to look into and a computed phase diagram."""

    def words(self, grid: Any) -> str:
        """Return what a cell on a grid is, in words."""
        return f"a cell of {self.points(grid)} points"

    def points(self, grid: Any) -> str:
        """Return the numbers of points of a grid in words."""
        return " x ".join(map(str, grid.shape))

    def check(self, grid: Any) -> None:
        """Raise `InputError` for a grid of more points than the explorer has time for."""
        if np.prod(grid.shape) > FINEST**2:
            rule = f"at most {FINEST**2} in the explorer"
            raise InputError("grid points", self.points(grid), rule, "use cyclosis run for more")

    @abstractmethod
    def program(self, grid: Any) -> tuple[Any, ...]:
        """Return what compiled programs depend on: the sizes of arrays."""

    @abstractmethod
    def known(self, grid: Any) -> bool:
        """Whether what takes seconds to compute of a grid is known already; afterwards it is."""

    @abstractmethod
    def nearest(self, grid: Any, z: float) -> float:
        """Return the place on the cell, along its axis or meridian, that the brush means by z."""

    @abstractmethod
    def size(self, grid: Any) -> tuple[int, int, float]:
        """Return the points of the page's pictures around the cell and along it, and their length."""

    @abstractmethod
    def drawn(self, grid: Any, field: Array) -> Array:
        """Return a vector field (2, ...) on the points of the page's pictures."""

    @abstractmethod
    def outline(self, grid: Any) -> dict[str, Any] | None:
        """Return the meridian of a closed cell for the page, or None for the cylinder."""

    @abstractmethod
    def row(self, record: Mapping[str, Any]) -> list[float]:
        """Return the `traces` of a record."""

    @abstractmethod
    def judged(self, params: Any, grid: Any, P: Array) -> Judged:
        """Return the regime of a state."""


def surface_of(grid: Any) -> Surface:
    """Return what the explorer needs to know of a grid."""
    return surfaces()[of_grid(grid).name]


def surfaces() -> dict[str, Surface]:
    """Return every kind of surface by the name of its model."""
    from .on_closed import OnClosed
    from .on_cylinder import OnCylinder

    return {polar.name: OnCylinder(), closed.name: OnClosed()}
