"""The tables of a sweep, checked and completed: every refusal of a configuration is here."""

from __future__ import annotations

import hashlib
import math
import os
from collections.abc import Mapping
from typing import Any

import numpy as np

from .. import config
from ..dynamics.protocol import Protocol
from ..dynamics.schedule import Schedule
from ..model import initial
from ..model.definitions import RUN, definition
from ..model.errors import InputError, closest, shown
from ..model.grid import Array, CylinderGrid
from ..model.parameters import Parameters
from . import axes, variables
from .definitions import AXES, MAX_MEMBERS, TABLES

Tables = dict[str, Any]
"""Tables by name, and under "protocol" the list of a protocol's steps where there is one."""

USUAL_BLOCK = 64
"""Members of a block, about, if the configuration does not say."""
USUAL_BYTES = 2**28
"""Memory that the final states of a block take at most, if the configuration does not say."""
MOST_BYTES = 2**31 - 4
"""Size of one variable of a classic NetCDF file."""
ALMOST_NEVER = 0.01
"""Expected number of points with |P| > 1 among the initial states of a sweep that is accepted."""


def completed(given: Mapping[str, Any], files: bool = True) -> Tables:
    """Return the tables of a sweep with every value checked and every default filled in.

    The result is plain (it can be written as JSON), and completing it again changes nothing. Without `files`
    the file of an initial state is not looked at, so that a store can be read without it. Raises
    `InputError` for any mistake, in one sentence.
    """
    if not isinstance(given, Mapping):
        raise InputError("configuration", given, "a table of tables", "give it as sweep.toml would hold it")
    swept = _axes(given.get("axes"))
    rest = {name: table for name, table in given.items() if name not in ("axes", "protocol")}
    _refuse_other_places(rest, swept)
    tables = config.check(rest, TABLES)
    grid = _grid(tables, swept)
    protocol = Protocol.from_tables(given.get("protocol", []))
    out: Tables = {
        "parameters": _parameters(tables, swept, grid),
        "grid": {key: value for key, value in _plain(grid).items() if key not in swept},
        "initial": _initial(tables, swept),
        "axes": swept,
        "ensemble": _filled("ensemble", tables),
        "run": _run(tables, bool(protocol)),
        "record": _record(tables),
    }
    if protocol:
        out["protocol"] = protocol.as_tables()
        _refuse_impossible_steps(out, protocol)
    _refuse_pointless_seeds(out, protocol.random)
    _refuse_crowds(out)
    out["ensemble"]["block"] = _block(out, grid)
    if out["initial"]["kind"] != "file":
        _refuse_impossible_states(out, grid, _magnitude(out, grid))
    elif files:
        _refuse_impossible_states(out, grid, _read_file(out["initial"], grid))
    return out


def grid_of(tables: Tables, point: Mapping[str, float]) -> CylinderGrid:
    """Return the grid at a point of the axes."""
    return CylinderGrid(**(tables["grid"] | {key: point[key] for key in point if AXES[key][0] == "grid"}))


def file_digest(path: str) -> str:
    """Return the SHA-256 of a file. Raises `InputError` if it cannot be read."""
    try:
        with open(path, "rb") as file:
            return hashlib.file_digest(file, "sha256").hexdigest()
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise InputError("path", path, "a file that can be read", f"check the path ({reason})") from error


def _axes(given: Any) -> dict[str, dict[str, Any]]:
    if given is None or (isinstance(given, Mapping) and not given):
        raise InputError(
            "axes", given, "a table with at least one axis", "add [axes] with a parameter to sweep"
        )
    if not isinstance(given, Mapping):
        raise InputError("axes", given, "a table", "write [axes] on a line of its own")
    out = {}
    for name, table in given.items():
        if name not in AXES:
            rule = "one of " + ", ".join(AXES)
            raise InputError("axes key", name, rule, closest(name, AXES))
        out[name] = axes.checked(AXES[name][1], table)
    return out


def _refuse_other_places(given: Mapping[str, Any], swept: Mapping[str, Any]) -> None:
    """Refuse what a run would have, but a sweep has elsewhere or not at all."""
    start = given.get("initial")
    if isinstance(start, Mapping) and "seed" in start:
        raise InputError(
            "seed", start["seed"], "left out in a sweep", "write seeds and first_seed in [ensemble]"
        )
    for name in swept:
        table = given.get(AXES[name][0])
        if isinstance(table, Mapping) and name in table:
            rule = f"either in [{AXES[name][0]}] or in [axes]"
            raise InputError(name, table[name], rule, "remove one of the two")
    run = given.get("run")
    if isinstance(run, Mapping):
        for item in RUN:
            if item.name in run and item.name not in {own.name for own in TABLES["run"]}:
                rule = "left out in a sweep, which follows every member with adaptive steps to its end"
                raise InputError(item.name, run[item.name], rule, "remove it")


def _grid(tables: Tables, swept: Mapping[str, Any]) -> CylinderGrid:
    given = dict(tables["grid"])
    if "length" in swept:
        given["length"] = axes.ends(swept["length"])[0]
    return CylinderGrid(**given)


def _parameters(tables: Tables, swept: Mapping[str, Any], grid: CylinderGrid) -> dict[str, Any]:
    params = Parameters(**tables["parameters"])
    if params.shape not in (None, grid.shape):
        rule = f"that of the grid, {grid.shape}"
        raise InputError("shape of the parameter fields", params.shape, rule, "give the fields on the grid")
    return {
        name: value.tolist() if isinstance(value, np.ndarray) else value
        for name, value in params.items()
        if name not in swept
    }


def _initial(tables: Tables, swept: Mapping[str, Any]) -> dict[str, Any]:
    given = {key: value for key, value in tables["initial"].items() if value is not None}
    here = {key: axes.ends(swept[key])[0] for key in swept if AXES[key][0] == "initial"}
    kind = given.get("kind", definition("initial", "kind").default)
    if "sha256" in given and kind != "file":
        rule = "given only where initial kind is file"
        raise InputError("sha256", given["sha256"], rule, f"remove it, or change kind = {kind}")
    config.check_initial({key: value for key, value in (given | here).items() if key != "sha256"})
    out = {"kind": kind}
    for key in config.USED_BY[kind]:
        usual = None if key == "seed" else definition("initial", key).default
        if key == "filaments_per_square" and kind != "disordered":
            usual = None  # without it an ordered state has no noise
        if key not in swept and given.get(key, usual) is not None:
            out[key] = given.get(key, usual)
    if "noise_grid" in out:
        out["noise_grid"] = list(out["noise_grid"])
    return out | ({"sha256": given["sha256"]} if "sha256" in given else {})


def _filled(table: str, tables: Tables) -> dict[str, Any]:
    return {item.name: tables[table].get(item.name, item.default) for item in TABLES[table]}


def _run(tables: Tables, protocol: bool) -> dict[str, Any]:
    from ..ensemble.members import UNCERTIFIED, EnsembleSettings

    out = _filled("run", tables)
    if protocol:
        out["finish"] = tables["run"].get("finish", "t_end")
        if out["finish"] == "certified":
            raise InputError("finish", out["finish"], "t_end where there is a protocol", UNCERTIFIED)
    out["terms"] = list(out["terms"])
    _refuse_repeats("terms", out["terms"])
    EnsembleSettings(**(out | {"terms": tuple(out["terms"])}))
    return out


def _record(tables: Tables) -> dict[str, Any]:
    out = _filled("record", tables)
    if out["quantities"] is not None:
        out["quantities"] = list(out["quantities"])
        _refuse_repeats("quantities", out["quantities"])
        variables.further(out["quantities"])
    return out


def _refuse_repeats(name: str, listed: list[str]) -> None:
    for item in listed:
        if listed.count(item) > 1:
            raise InputError(name, item, "a list without repeats", "name each once")


def _read_file(given: dict[str, Any], grid: CylinderGrid) -> float:
    """Fill in where the file of the initial state is and its checksum; return the largest |P| in it."""
    given["path"] = os.path.abspath(given["path"])
    found = file_digest(given["path"])
    if given.setdefault("sha256", found) != found:
        rule = f"that of {given['path']}, {found}"
        raise InputError("sha256", given["sha256"], rule, "restore that file, or leave sha256 out")
    return _largest(initial.from_file(given["path"], grid, given["frame"]))


def _refuse_impossible_steps(tables: Tables, protocol: Protocol) -> None:
    """Refuse steps that no member reaches, and regions that do not fit the cell at either end of an axis."""
    end = tables["run"]["t_end"]
    for step in protocol:
        if step.at > end:
            rule = f"at most t_end = {end:g} in a sweep"
            raise InputError(f"at of {step.action}", step.at, rule, "raise t_end, or leave the step out")
    given = tables["grid"]
    lengths = axes.ends(tables["axes"]["length"]) if "length" in tables["axes"] else (given["length"],)
    for length in lengths:
        Schedule(Parameters(), CylinderGrid(**(given | {"length": length})), protocol)


def _refuse_pointless_seeds(tables: Tables, random: bool) -> None:
    seeds = tables["ensemble"]["seeds"]
    if seeds > 1 and not _noisy(tables) and not random:
        kind = tables["initial"]["kind"]
        rule = f"1 where the initial state has no noise, as with kind = {kind} alone"
        raise InputError(
            "seeds", seeds, rule, "add filaments_per_square to [initial], or noise to the protocol"
        )


def _refuse_crowds(tables: Tables) -> None:
    sizes = {name: axes.size(table) for name, table in tables["axes"].items()}
    sizes["seeds"] = tables["ensemble"]["seeds"]
    members = math.prod(sizes.values())
    if members > MAX_MEMBERS:
        rule = f"at most {MAX_MEMBERS:,} in one sweep"
        remedy = "split it, or shorten " + " x ".join(f"{name} ({size})" for name, size in sizes.items())
        raise InputError("number of members", members, rule, remedy)


def _block(tables: Tables, grid: CylinderGrid) -> int:
    """Return the members of a block: as asked, or whole points of the axes, or slices of a point."""
    each = 2 * grid.n_theta * grid.n_z * 8
    asked, seeds = tables["ensemble"]["block"], tables["ensemble"]["seeds"]
    if asked is None:
        most = max(1, min(USUAL_BLOCK, USUAL_BYTES // each))
        asked = most // seeds * seeds if seeds <= most else _slice(seeds, most)
    largest = MOST_BYTES // each
    if tables["record"]["fields"] and asked > largest:
        rule = f"at most {largest} with fields on this grid, for a file can hold no more"
        raise InputError("block", asked, rule, "lower it, or store no fields")
    return int(asked)


def _slice(seeds: int, most: int) -> int:
    """Return the members of a slice of a point: even slices if that takes no more than twice as many."""
    fewest = math.ceil(seeds / most)
    even = (slices for slices in range(fewest, 2 * fewest + 1) if seeds % slices == 0)
    return math.ceil(seeds / next(even, fewest))


def _refuse_impossible_states(tables: Tables, grid: CylinderGrid, magnitude: float) -> None:
    """Refuse noise that would make |P| > 1 somewhere: P is a mean of unit vectors.

    With |P| = M before noise of variance 1/(2N) a component, a point exceeds 1 with a probability of at most
    exp(-N (1 - M)²), which is exact for M = 0.
    """
    if not _noisy(tables):
        return
    N = _ends(tables, "filaments_per_square")[0]
    points = tables["ensemble"]["seeds"] * grid.n_theta * grid.n_z
    room = max(1.0 - magnitude, 0.0) ** 2 * _share_kept(tables, grid)
    if points * math.exp(-N * room) > ALMOST_NEVER:
        needed = math.log(points / ALMOST_NEVER) / room if room > 0 else math.inf
        remedy = f"raise it to {_up(needed):g}" if needed < 1e15 else "lower the magnitude of the state"
        rule = f"large enough for |P| <= 1 at all points of all {tables['ensemble']['seeds']} initial states"
        raise InputError("filaments_per_square", N, rule, remedy)


def _magnitude(tables: Tables, grid: CylinderGrid) -> float:
    """Return the largest |P| of the initial states without noise, having checked that they can be made."""
    start = tables["initial"]
    if start["kind"] == "disordered":
        return 0.0
    magnitude = _ends(tables, "magnitude")[1]
    if start["kind"] == "stripes":
        initial.stripes(grid.resized(grid.n_theta, 8), start["stripes"], magnitude)
    return magnitude


def _largest(state: Array) -> float:
    return float(np.sqrt(np.max(np.sum(state**2, axis=0))))


def _share_kept(tables: Tables, grid: CylinderGrid) -> float:
    """Return by what the noise's inverse variance grows where the grid resolves less than the noise's own."""
    drawn = tables["initial"].get("noise_grid")
    if drawn is None or tuple(drawn) == grid.shape:
        return 1.0
    kept = math.prod(2 * ((min(a, b) - 1) // 2) + 1 for a, b in zip(drawn, grid.shape, strict=True))
    return math.prod(drawn) / kept


def _noisy(tables: Tables) -> bool:
    name = "filaments_per_square"
    return name in tables["axes"] or name in tables["initial"]


def _ends(tables: Tables, name: str) -> tuple[float, float]:
    """Return the least and the greatest value that a setting of the initial state takes."""
    if name in tables["axes"]:
        return axes.ends(tables["axes"][name])
    return tables["initial"][name], tables["initial"][name]


def _up(value: float) -> float:
    """Return a number rounded up to two digits."""
    digit = 10.0 ** (math.floor(math.log10(value)) - 1)
    return math.ceil(value / digit) * digit


def _plain(grid: CylinderGrid) -> dict[str, Any]:
    return {"n_theta": grid.n_theta, "n_z": grid.n_z, "length": grid.length}


def differences(there: Mapping[str, Any], here: Mapping[str, Any]) -> list[str]:
    """Return in words where two complete configurations differ, in the order of their keys."""
    out = []
    for table in dict.fromkeys([*there, *here]):
        one, other = _keyed(there.get(table, {})), _keyed(here.get(table, {}))
        for key in dict.fromkeys([*one, *other]):
            a, b = one.get(key, "-"), other.get(key, "-")
            if a != b and key != "path":
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
