"""What a run shows: the surface of its cell, its frames as drawings take them, and their best side."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from ..model.grid import Array, CylinderGrid, interpolate
from .frames import facing_zone, grid_of, is_closed
from .portraits import Look, Portrait, portrait
from .skin import Skin


@dataclass(frozen=True, eq=False)
class Subject:
    """The cell of a run.

    `surface` is its shape, `look(P, u)` a state and its flow as drawings take them, and `facing(P)` a viewing
    angle, in radians, that shows an indifferent zone. `turns` is how far it turns in a movie by default.
    """

    surface: CylinderGrid | Skin
    look: Callable[[Array, Array], Look]
    facing: Callable[[Array], float]
    turns: float

    @property
    def portrait(self) -> Portrait:
        """How it is drawn."""
        return portrait(self.surface)


def subject_of(dataset: Any, finest: int | None = None) -> Subject:
    """Return the cell of a run's dataset, on at most `finest` points in each direction if it is a cylinder.

    Raises `InputError` for anything that is not the dataset of a run of a whole cell, with P and u.
    """
    if is_closed(dataset):
        from .closed_cells import closed_subject  # loads JAX, by way of `cyclosis.closed`

        return closed_subject(dataset)
    grid = grid_of(dataset)
    if finest is None:
        return Subject(grid, Look, facing_zone, 0.5)
    light = grid.resized(min(grid.n_theta, finest), min(grid.n_z, finest))

    def look(P: Array, u: Array) -> Look:
        return Look(interpolate(P, light.shape), interpolate(u, light.shape))

    return Subject(light, look, facing_zone, 0.5)
