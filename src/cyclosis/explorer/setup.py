"""The set-up of a cell of the explorer: tables, a protocol, and the time that it has reached.

A link contains a complete set-up, and so does a `run.toml`: both reproduce the same trajectory.
"""

from __future__ import annotations

import base64
import binascii
import json
import zlib
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from math import prod
from typing import Any

from .. import config
from ..dynamics.protocol import Change, Protocol
from ..model.definitions import INITIAL, defaults, definition
from ..model.errors import InputError, number
from ..models import closed, of_tables, polar
from .surfaces import FINEST, surface_of

MODELS = (polar.name, closed.name)
"""The models of cells in the explorer."""
WAVES = (12, 16, 24)
"""k_max of closed cells that the page offers; the largest is the most there is in the explorer."""
USUAL_WAVES = 16
"""k_max of a closed cell that does not give it."""
MOST = {"n_theta": FINEST, "n_z": FINEST, "k_max": WAVES[-1]}
"""Largest values of some settings of [grid]."""
MOST_FRAMES = 20_000
"""Most frames of a cell in the explorer."""
INTERVAL = replace(
    definition("run", "save_every"),
    meaning="time between frames; actions happen at frames",
    default=0.1,
    minimum=0.02,
    maximum=5.0,
)
MOST_PLACED = 2**19
"""Most grid points times steps if one step changes parameters in a region: all then keep them as fields."""
LONGEST_LINK, LONGEST_TEXT = 40_000, 200_000
"""Most characters of a link, and of the text compressed in it."""
KIND = INITIAL[0].default
"""The default initial state of a cell."""
KINDS = tuple(kind for kind in INITIAL[0].allowed if kind != "file")
"""Initial states that a cell of the explorer may have: visitors must not read files of the server."""


@dataclass(frozen=True, eq=False)
class SetUp:
    """A cell as tables (see `cyclosis.config`), the steps of its protocol as tables, and the time reached."""

    tables: config.Tables
    steps: tuple[dict[str, Any], ...] = ()
    t: float = 0.0

    @property
    def every(self) -> float:
        """Time between frames, dimensionless (R/U)."""
        interval: float = self.tables["run"][INTERVAL.name]
        return interval

    def until(self, t: float) -> SetUp:
        """Return the set-up at a later time. Raises `InputError` if that takes more than `MOST_FRAMES`."""
        end = number("t", t, 0.0, self.every * MOST_FRAMES, "begin again")
        return replace(self, t=max(self.t, end))

    def scaled(self, scales: Mapping[str, float] | None) -> SetUp:
        """Return the set-up with the scales in whose units it is shown; without, it is dimensionless.

        Raises `InputError` for scales that no cell has.
        """
        table = config.check({"scales": dict(scales or {})})["scales"]
        return replace(self, tables={**self.tables, "scales": table})

    def ready(self) -> config.Setup:
        """Return the arguments of `simulate`. Raises `InputError` for settings that are inconsistent."""
        surface_of(self.grid).check(self.grid)
        ready = config.setup(self.tables, list(self.steps))
        check_memory(ready.protocol, ready.grid)
        return ready

    def is_dear(self) -> bool:
        """Whether `ready` would take seconds now. Raises `InputError` for a grid that cannot be used."""
        surface = surface_of(self.grid)
        surface.check(self.grid)
        return not surface.known(self.grid)

    @cached_property
    def grid(self) -> Any:
        """The grid of the cell. Raises `InputError` for settings that its surface does not have."""
        return of_tables(self.tables).grid_from(self.tables["grid"])

    def filled(self) -> dict[str, dict[str, Any]]:
        """Return the tables with every default that has a value filled in."""
        model = of_tables(self.tables)
        filled = {
            "model": {"kind": model.name, **model.options},
            "parameters": defaults("parameters") | self.tables["parameters"],
            "grid": model.table_of(self.grid),
        }
        initial = self.tables["initial"]
        kind = initial.get("kind", KIND)
        # In an ordered state, noise that is left out is zero, not its default.
        noise = () if kind == KIND else ("seed", "filaments_per_square", "noise_grid")
        used = {"kind", *config.USED_BY[kind]} - set(noise)
        filled["initial"] = {name: value for name, value in defaults("initial").items() if name in used}
        filled["initial"] |= initial
        return filled | {name: dict(self.tables[name]) for name in ("run", "scales")}

    def link(self) -> str:
        """Return the set-up as a short text for use in an address."""
        whole = {name: table for name, table in self.tables.items() if table}
        text = json.dumps(whole | {"protocol": self.steps, "t": self.t}, separators=(",", ":"))
        return base64.urlsafe_b64encode(zlib.compress(text.encode(), 9)).decode().rstrip("=")

    def toml(self) -> str:
        """Return the set-up as a configuration for `cyclosis run`."""
        import tomli_w

        whole: dict[str, Any] = {name: dict(table) for name, table in self.tables.items() if table}
        whole["run"] = whole["run"] | {"t_end": self.t}
        if self.steps:
            whole["protocol"] = list(self.steps)
        return tomli_w.dumps(_without_none(whole))


def from_tables(given: Any, steps: Any = (), t: Any = 0.0) -> SetUp:
    """Return the set-up that tables describe. Raises `InputError` for any mistake, and beyond the limits."""
    if not isinstance(given, Mapping):
        raise InputError("cell", given, "a set of tables", "give parameters, grid, initial or run")
    run = given.get("run", {})
    for name in run if isinstance(run, Mapping) else ():
        if name != INTERVAL.name:
            raise InputError("run key", name, INTERVAL.name, "the explorer decides on the others")
    tables = config.check(given)
    tables["run"] = {INTERVAL.name: INTERVAL.check(tables["run"].get(INTERVAL.name, INTERVAL.default))}
    for name, most in MOST.items():
        if (found := tables["grid"].get(name) or 0) > most:
            raise InputError(name, found, f"at most {most} in the explorer", "use cyclosis run for more")
    _refuse_other_models(tables["model"])
    if of_tables(tables).name == closed.name and tables["grid"].get("k_max") is None:
        tables["grid"]["k_max"] = USUAL_WAVES  # in the exported configuration too
    kind = tables["initial"].get("kind", KIND)
    if kind not in KINDS:
        raise InputError("kind", kind, "one of " + ", ".join(KINDS) + " in the explorer", "choose another")
    shape = tables["initial"].get("noise_grid") or ()
    if any(points > FINEST for points in shape) or tables["initial"].get("stripes", 2) > FINEST:
        raise InputError("initial", tables["initial"], f"at most {FINEST} points or stripes", "use fewer")
    if any(isinstance(value, list | tuple) for value in tables["parameters"].values()):
        raise InputError("parameters", "a field", "numbers in the explorer", "use a step with where")
    _refuse_dear(steps)
    end = number("t", t, 0.0, tables["run"][INTERVAL.name] * MOST_FRAMES, "begin again")
    return SetUp(tables, tuple(steps), end)


def from_link(link: str) -> SetUp:
    """Return the set-up of a link. Raises `InputError` for a text that is not a link."""
    rule = "the part of an address of the explorer after #"
    try:
        if len(link) > LONGEST_LINK:
            raise ValueError
        packed = base64.urlsafe_b64decode(link + "=" * (-len(link) % 4))
        unpacking = zlib.decompressobj()
        text = unpacking.decompress(packed, LONGEST_TEXT)
        if not unpacking.eof:
            raise ValueError
        given = json.loads(text)
        steps, t = given.pop("protocol", ()), given.pop("t", 0.0)
    except (ValueError, TypeError, AttributeError, binascii.Error, zlib.error, RecursionError) as error:
        raise InputError("link", link, rule, "copy the whole address") from error
    return from_tables(given, steps, t)


def is_placed(protocol: Protocol) -> bool:
    """Whether a step changes parameters in a region, so that all later steps keep them as fields."""
    return any(isinstance(step, Change) and step.where is not None for step in protocol)


def check_memory(protocol: Protocol, grid: Any) -> None:
    """Raise `InputError` for a protocol that would take much memory."""
    placed = is_placed(protocol)
    most, points = MOST_PLACED // prod(grid.shape), surface_of(grid).points(grid)
    if placed and len(protocol) > most:
        rule = f"at most {most} on {points} points where a step changes parameters in a region"
        raise InputError("steps", len(protocol), rule, "use fewer steps or points")


def _refuse_other_models(table: Mapping[str, Any]) -> None:
    """Refuse models that the explorer does not show."""
    usual = defaults("model")
    for name, value in table.items():
        shown = value in MODELS if name == "kind" else name == "repulsion" or value == usual[name]
        if not shown:
            rule = (
                "left out in the explorer, with its closed cells and the polar model by the paper's closure"
            )
            raise InputError(name, value, rule, "use cyclosis run for others")


def _refuse_dear(steps: Any) -> None:
    """Refuse steps that would read a file of the server, or draw more random numbers than the grid needs."""
    if isinstance(steps, Mapping):
        if "path" in steps:
            raise InputError("path", steps["path"], "left out in the explorer", "use cyclosis run for images")
        shape = steps.get("noise_grid")
        if isinstance(shape, list | tuple) and any(isinstance(n, int) and n > FINEST for n in shape):
            rule = f"at most {FINEST} x {FINEST} in the explorer"
            raise InputError("noise_grid", shape, rule, "use cyclosis run for more")
        steps = list(steps.values())
    if isinstance(steps, list | tuple):
        for item in steps:
            _refuse_dear(item)


def _without_none(value: Any) -> Any:
    if isinstance(value, Mapping):
        return {key: _without_none(item) for key, item in value.items() if item is not None}
    return [_without_none(item) for item in value] if isinstance(value, list | tuple) else value
