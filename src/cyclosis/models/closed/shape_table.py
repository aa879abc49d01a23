"""A closed grid as the [grid] table of a configuration, and back."""

from __future__ import annotations

from typing import Any

from ...closed.grid import ClosedGrid
from ...closed.shapes import KINDS, shape_of
from ...model.errors import InputError

OWN = ("k_max", "n_theta", "n_s")
SETTINGS = ("length", "smoothing", "aspect")


def grid_of(**table: Any) -> ClosedGrid:
    """Return the grid of a [grid] table: `shape` and its settings, `k_max`, `n_theta` and `n_s`."""
    given = {key: value for key, value in table.items() if value is not None}
    kind = given.pop("shape", "capsule")
    own = {key: given.pop(key) for key in OWN if key in given}
    for key in given:
        if key not in SETTINGS:
            rule = f"used only where [model] kind is not closed; a closed surface has {', '.join(OWN)}"
            raise InputError(key, given[key], rule, "remove it")
        known = tuple(getattr(KINDS.get(kind), "__dataclass_fields__", SETTINGS))
        if key not in known:
            users = ", ".join(
                k for k, made in KINDS.items() if key in getattr(made, "__dataclass_fields__", {})
            )
            raise InputError(key, given[key], f"used only where shape is {users}", "remove it")
    return ClosedGrid(shape_of({"kind": kind, **given}), **own)


def table_of(grid: ClosedGrid) -> dict[str, Any]:
    """Return the [grid] table of a grid."""
    surface = dict(grid.surface.table)
    return {"shape": surface.pop("kind"), **surface, **{key: getattr(grid, key) for key in OWN}}
