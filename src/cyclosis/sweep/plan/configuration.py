"""The tables of a sweep, checked and completed: all rules for a configuration are here."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from ... import config, models
from ...contract.model import Model
from ...dynamics.schedule import Schedule
from ...model.definitions import RUN
from ...model.errors import InputError, closest, shown
from ...model.instants import instant
from ...model.units import of_table
from ...model.wording import beside
from . import axes, step_axes, variables
from .definitions import AXES, MAX_MEMBERS, TABLES
from .step_axes import place, setting

Tables = dict[str, Any]
"""Tables by name, and under "protocol" the list of a protocol's steps if there is a protocol."""

USUAL_BLOCK = 64
"""Approximate number of members of a block by default."""
USUAL_BYTES = 2**28
"""Largest memory of the final states of a block by default."""
MOST_BYTES = 2**31 - 4
"""Largest size of one variable of a classic NetCDF file."""
UNDECISIVE = ("path", "stretch")
"""Keys of [initial] that do not affect a sweep's results: where its file is, and what may be done with it."""


def completed(given: Mapping[str, Any], files: bool = True) -> Tables:
    """Return the tables of a sweep with every value checked and every default filled in.

    The result is plain (it can be written as JSON), and completing it again changes nothing. Without `files`
    the file of an initial state is not opened, so that a store can be read without it. Raises
    `InputError` for any mistake.
    """
    if not isinstance(given, Mapping):
        raise InputError("configuration", given, "a table of tables", "give it as sweep.toml would hold it")
    steps = given.get("protocol", [])
    swept = _axes(given.get("axes"), steps)
    rest = {name: table for name, table in given.items() if name not in ("axes", "protocol")}
    _refuse_other_places(rest, swept)
    tables = config.check(rest, TABLES)
    model = models.of_tables(tables)
    starts = models.starts_of(model)
    grid = _grids(model, tables, swept)[0]
    protocol = next(step_axes.protocols(steps, swept))
    out: Tables = {
        "parameters": _parameters(model, tables, swept, grid),
        "grid": _grid(model, tables, swept),
        "initial": starts.filled(tables["initial"], _ends("initial", swept)),
        "axes": swept,
        "ensemble": _filled("ensemble", tables),
        "run": _run(model, tables, bool(protocol)),
        "record": _record(model, tables),
    }
    if model is not models.polar:
        out["model"] = {"kind": model.name, **model.options}
    if of_table(tables["scales"]) is not None:
        out["scales"] = tables["scales"]
    if protocol:
        varied = any(map(step_axes.is_step_axis, swept))
        # As they are written where they are swept: their order in time, and so their seeds, may vary.
        out["protocol"] = step_axes.completed(steps, swept) if varied else protocol.as_tables()
        _refuse_impossible_steps(model, out)
    ends, seeds = _ends("initial", swept), out["ensemble"]["seeds"]
    if seeds > 1 and not starts.noisy(out["initial"], ends) and not protocol.random:
        _refuse_pointless_seeds(out)
    _refuse_crowds(out)
    out["ensemble"]["block"] = _block(out, model, grid)
    starts.refuse_impossible(out["initial"], ends, seeds, _grids(model, out, swept), files)
    return out


def grid_of(tables: Tables, point: Mapping[str, float]) -> Any:
    """Return the grid at a point of the axes."""
    swept = {key: point[key] for key in point if place(key) == "grid"}
    return models.of_tables(tables).grid_from(tables["grid"] | swept)


def _axes(given: Any, steps: Any) -> dict[str, dict[str, Any]]:
    if given is None or (isinstance(given, Mapping) and not given):
        raise InputError(
            "axes", given, "a table with at least one axis", "add [axes] with a parameter to sweep"
        )
    if not isinstance(given, Mapping):
        raise InputError("axes", given, "a table", "write [axes] on a line of its own")
    out = {}
    for name, table in given.items():
        if place(name) is None:
            rule = "one of " + ", ".join(AXES) + ", or protocol.STEP.KEY"
            raise InputError("axes key", name, rule, closest(name, AXES))
        out[name] = axes.checked(setting(name, steps), table)
    return out


def _refuse_other_places(given: Mapping[str, Any], swept: Mapping[str, Any]) -> None:
    """Refuse settings of a run that a sweep has in another table or not at all."""
    start = given.get("initial")
    if isinstance(start, Mapping) and "seed" in start:
        raise InputError(
            "seed", start["seed"], "left out in a sweep", "write seeds and first_seed in [ensemble]"
        )
    for name in swept:
        table = given.get(place(name) or "")
        if isinstance(table, Mapping) and name in table:
            rule = f"either in [{place(name)}] or in [axes]"
            raise InputError(name, table[name], rule, "remove one of the two")
    run = given.get("run")
    if isinstance(run, Mapping):
        for item in RUN:
            if item.name in run and item.name not in {own.name for own in TABLES["run"]}:
                rule = "left out in a sweep, which integrates every member with adaptive steps to its end"
                raise InputError(item.name, run[item.name], rule, "remove it")


def _ends(table: str, swept: Mapping[str, Any]) -> dict[str, tuple[float, float]]:
    """Return the smallest and the largest value of every swept key of a table, by name."""
    return {key: axes.ends(swept[key]) for key in swept if place(key) == table}


def _grids(model: Model, tables: Tables, swept: Mapping[str, Any]) -> list[Any]:
    """Return the grid, or the grids at the first and the last values if it is swept."""
    ends = _ends("grid", swept)
    chosen = ({key: values[k] for key, values in ends.items()} for k in ((0, 1) if ends else (0,)))
    return [model.grid_from(tables["grid"] | values) for values in chosen]


def _grid(model: Model, tables: Tables, swept: Mapping[str, Any]) -> Tables:
    """Return the [grid] table, without what is swept and what follows from it: what differs at its ends."""
    first, *last = (model.table_of(grid) for grid in _grids(model, tables, swept))
    same = {key: value for key, value in first.items() if all(other.get(key) == value for other in last)}
    return {key: value for key, value in same.items() if key not in swept}


def _parameters(model: Model, tables: Tables, swept: Mapping[str, Any], grid: Any) -> dict[str, Any]:
    params = model.parameters(**tables["parameters"])
    params.require_grid(grid)
    return {
        name: value.tolist() if isinstance(value, np.ndarray) else value
        for name, value in params.items()
        if name not in swept
    }


def _filled(table: str, tables: Tables) -> dict[str, Any]:
    return {item.name: tables[table].get(item.name, item.default) for item in TABLES[table]}


def _run(model: Model, tables: Tables, protocol: bool) -> dict[str, Any]:
    from ...ensemble.members import UNCERTIFIED, EnsembleSettings, refuse_adaptive

    out = _filled("run", tables)
    if protocol or not model.certifies:
        out["finish"] = tables["run"].get("finish", "t_end")
        if out["finish"] == "certified" and protocol:
            raise InputError("finish", out["finish"], "t_end where there is a protocol", UNCERTIFIED)
        if out["finish"] == "certified":
            raise InputError("finish", out["finish"], f"t_end with the model {model.wording}", "set it so")
    out["terms"] = list(out["terms"])
    _refuse_repeats("terms", out["terms"])
    EnsembleSettings(**(out | {"terms": tuple(out["terms"])}))
    if out["axial_resolution"] == "adaptive":
        refuse_adaptive(model, protocol)
    else:  # left out, so that sweeps from before there was a choice are the same sweeps
        del out["axial_resolution"]
    return out


def _record(model: Model, tables: Tables) -> dict[str, Any]:
    out = _filled("record", tables)
    if out["quantities"] is not None:
        out["quantities"] = list(out["quantities"])
        _refuse_repeats("quantities", out["quantities"])
        variables.further(model, out["quantities"])
    return out


def _refuse_repeats(name: str, listed: list[str]) -> None:
    for item in listed:
        if listed.count(item) > 1:
            raise InputError(name, item, "a list without repeats", "name each once")


def _refuse_impossible_steps(model: Model, tables: Tables) -> None:
    """Refuse steps after the end, and regions that do not fit the cell at either end of an axis."""
    end, grids = instant(tables["run"]["t_end"]), _grids(model, tables, tables["axes"])
    for protocol in step_axes.protocols(tables["protocol"], tables["axes"]):
        for step in protocol:
            if step.at > end:
                rule = f"at most t_end = {beside(end, step.at)} in a sweep"
                raise InputError(f"at of {step.action}", step.at, rule, "raise t_end, or leave the step out")
        for grid in grids:
            Schedule(model.parameters(), grid, protocol)


def _refuse_pointless_seeds(tables: Tables) -> None:
    rule = f"1 if the initial state has no noise, as with kind = {tables['initial']['kind']} alone"
    remedy = "add filaments_per_square to [initial], or noise to the protocol"
    raise InputError("seeds", tables["ensemble"]["seeds"], rule, remedy)


def _refuse_crowds(tables: Tables) -> None:
    sizes = {name: axes.size(table) for name, table in tables["axes"].items()}
    sizes["seeds"] = tables["ensemble"]["seeds"]
    members = math.prod(sizes.values())
    if members > MAX_MEMBERS:
        rule = f"at most {MAX_MEMBERS:,} in one sweep"
        remedy = "split it, or shorten " + " x ".join(f"{name} ({size})" for name, size in sizes.items())
        raise InputError("number of members", members, rule, remedy)


def _block(tables: Tables, model: Model, grid: Any) -> int:
    """Return the number of members of a block: as given, or that of whole points, or of slices of a point."""
    along = model.coordinates(grid, None)
    each = 8 * math.prod(along[dim].values.size for dim in model.stored[0].dims)
    asked, seeds = tables["ensemble"]["block"], tables["ensemble"]["seeds"]
    if asked is None:
        most = max(1, min(USUAL_BLOCK, USUAL_BYTES // each))
        asked = most // seeds * seeds if seeds <= most else _slice(seeds, most)
    largest = MOST_BYTES // each
    if tables["record"]["fields"] and asked > largest:
        rule = f"at most {largest} with fields on this grid, since a file cannot hold more"
        raise InputError("block", asked, rule, "lower it, or store no fields")
    return int(asked)


def _slice(seeds: int, most: int) -> int:
    """Return the members of a slice of a point: equal slices if at most twice as many are needed."""
    fewest = math.ceil(seeds / most)
    even = (slices for slices in range(fewest, 2 * fewest + 1) if seeds % slices == 0)
    return math.ceil(seeds / next(even, fewest))


def differences(there: Mapping[str, Any], here: Mapping[str, Any]) -> list[str]:
    """Return the differences between two complete configurations in words, in the order of their keys."""
    out = []
    for table in dict.fromkeys([*there, *here]):
        one, other = _keyed(there.get(table, {})), _keyed(here.get(table, {}))
        for key in dict.fromkeys([*one, *other]):
            a, b = one.get(key, "-"), other.get(key, "-")
            if a != b and key not in UNDECISIVE:
                out.append(f"{table}.{key} is {_text(a)} there and {_text(b)} here")
    if sorted(there["axes"]) == sorted(here["axes"]) and list(there["axes"]) != list(here["axes"]):
        orders = (" x ".join(tables["axes"]) for tables in (there, here))
        out.append("the axes are {} there and {} here".format(*orders))
    return out


def _keyed(table: Any) -> Mapping[Any, Any]:
    """Return a table, or the steps of a protocol by their number."""
    return table if isinstance(table, Mapping) else dict(enumerate(table, 1))


def _text(value: Any) -> str:
    if isinstance(value, Mapping):
        return "{" + ", ".join(f"{key} = {_text(item)}" for key, item in value.items()) + "}"
    return value if isinstance(value, str) else shown(value)
