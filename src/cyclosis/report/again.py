"""How a run began, and the command or the configuration that makes it again."""

from __future__ import annotations

import json
import shlex
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..dynamics.protocol import Protocol
from ..model.definitions import ADAPTIVE, STEPPERS, TABLES, TERM_NAMES, definition, option
from ..model.errors import InputError
from ..model.units import NAMES, stored

if TYPE_CHECKING:
    import xarray

IDLE = {True: ("dt",), False: ("rtol", "atol")}
"""Settings of [run] that are not used by the adaptive steppers, and by the others."""


def start_of(asked: Mapping[str, Any]) -> dict[str, Any]:
    """Return the initial state of a configuration with its seed; {} if it was given as an array."""
    given = dict(asked.get("initial", {}))
    if given.get("kind") == "disordered" or "filaments_per_square" in given:
        given.setdefault("seed", 0)
    return given


def hindrance(asked: Mapping[str, Any]) -> str:
    """Return in words why a configuration alone does not make the run again, or "" if it does."""
    if "field" in asked["parameters"].values():
        return "a parameter is a field that was given in Python"
    if not set(asked["run"]["terms"]) <= set(TERM_NAMES):
        return "it has terms of its own, given in Python"
    if "initial" not in asked:
        return "its initial state was given in Python"
    return ""


def tables_of(asked: Mapping[str, Any], scales: Mapping[str, float] | None = None) -> dict[str, Any]:
    """Return the tables of a configuration file that makes the run again, without defaults."""
    out: dict[str, Any] = {}
    for name in TABLES:
        table = dict(asked.get(name, {}))
        if name == "run":
            for idle in IDLE[table.get("stepper", STEPPERS[0]) in ADAPTIVE]:
                table.pop(idle, None)
            if "save_at" in table:
                table.pop("save_every", None)
            if list(table["terms"]) == list(TERM_NAMES):
                table.pop("terms")
        if name == "initial":
            table = start_of(asked)
        kept = {key: value for key, value in table.items() if _told(name, key, value)}
        if kept:
            out[name] = kept
    if scales:
        out["scales"] = {name: scales[name] for name in NAMES}
    if "protocol" in asked:
        out["protocol"] = asked["protocol"]
        if Protocol.from_tables(asked["protocol"]).random:
            out["initial"].setdefault("seed", asked["protocol_seed"])
    return out


def _told(table: str, key: str, value: Any) -> bool:
    """Return whether a value has to be given: the kind and the seed of a start are always worth it."""
    if value is None:
        return False
    return (table, key) in (("initial", "kind"), ("initial", "seed")) or value != definition(
        table, key
    ).default


def command_of(
    asked: Mapping[str, Any], file: Path, scales: Mapping[str, float] | None = None
) -> tuple[str | None, str]:
    """Return the command that makes the run in a file again, or None, and a remark."""
    reason = hindrance(asked)
    if reason:
        return None, f"not from the command line: {reason}"
    name = shlex.quote(str(file))
    tables = tables_of(asked, scales)
    if "protocol" in tables:
        return f"cyclosis info {name} --toml | cyclosis run --config - --out again.nc", ""
    words = ["cyclosis", "run"]
    for table, values in tables.items():
        for key, value in values.items():
            item = definition(table, key)
            flag = option(table, item)
            if item.kind == "flag":
                words.append(flag if value else f"--no-{flag[2:]}")
            else:
                words += [flag, _spelt(value)]
    return shlex.join([*words, "--out", "again.nc"]), ""


def _spelt(value: Any) -> str:
    return ",".join(map(str, value)) if isinstance(value, list | tuple) else str(value)


def configured(dataset: xarray.Dataset, file: Path) -> str:
    """Return the configuration file that makes a run again. Raises `InputError` if there is none."""
    import tomli_w

    asked = json.loads(dataset.attrs["configuration"])
    reason = hindrance(asked)
    if reason:
        rule = f"a run that a configuration makes, but {reason}"
        raise InputError("file", str(file), rule, "make it again in Python")
    return tomli_w.dumps(tables_of(asked, stored(dataset)))
