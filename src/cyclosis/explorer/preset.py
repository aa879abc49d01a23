"""A cell to begin with as one value, and the tables and steps that such cells are made of."""

from __future__ import annotations

from dataclasses import dataclass, field
from math import pi
from typing import Any, Literal

Table = dict[str, Any]
UP, DOWN = round(pi / 2, 6), round(-pi / 2, 6)


@dataclass(frozen=True)
class Preset:
    """A cell: `tables` as in `run.toml`, the steps of its protocol as tables, and a text on what to see."""

    name: str
    group: Literal["figures", "regimes", "experiments"]
    title: str
    text: str
    tables: dict[str, Table] = field(default_factory=dict)
    protocol: tuple[Table, ...] = ()


def cell(
    start: Table | None = None, grid: Table | None = None, every: float | None = None, **parameters: float
) -> dict[str, Table]:
    """Return the tables of a cell on a cylinder."""
    run = {"save_every": every} if every else {}
    tables = {"parameters": parameters, "grid": grid, "initial": start, "run": run}
    return {name: table for name, table in tables.items() if table}


def closed_cell(start: Table, shape: str, more: Table | None = None, **parameters: float) -> dict[str, Table]:
    """Return the tables of a closed cell, with 16 waves."""
    grid = {"shape": shape, "k_max": 16} | (more or {})
    return {"model": {"kind": "closed"}} | cell(start, grid, **parameters)


def change(at: float, **more: Any) -> Table:
    """Return the step that changes parameters at a time."""
    return {"at": at, "action": "change"} | more


def fragment(at: float, **more: Any) -> Table:
    """Return the step that fragments filaments at a time."""
    return {"at": at, "action": "fragment"} | more


def align(at: float, angle: float, magnitude: float, start: float, stop: float) -> Table:
    """Return the step that aligns filaments in a band of theta."""
    where = {"shape": "band", "axis": "theta", "start": start, "stop": stop}
    return {"at": at, "action": "align", "angle": angle, "magnitude": magnitude, "where": where}


def turn_over(at: float, where: Table) -> Table:
    """Return the step that turns filaments down in a region."""
    return {"at": at, "action": "align", "angle": DOWN, "magnitude": 0.9, "where": where}


def wash_out(at: float, **more: Any) -> Table:
    """Return the step that washes out all drugs at a time."""
    return {"at": at, "action": "wash_out"} | more


# Established stripes, with the noise of as many filaments as leave |P| <= 1.
STRIPES = {"kind": "stripes", "filaments_per_square": 4000.0}
# The longest cell that the explorer's finest grid resolves well: 9 points per radius.
LONG = {"n_theta": 48, "n_z": 128}
