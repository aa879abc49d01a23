"""One axis of a sweep: its table in the configuration, and its values."""

from __future__ import annotations

import math
from collections.abc import Mapping
from itertools import pairwise
from typing import Any

from ...model.definitions import Definition
from ...model.errors import InputError, closest
from ...model.wording import beside
from .definitions import AXIS

_KEYS = {item.name: item for item in AXIS}
_SHAPE = "write { start = ..., stop = ..., count = ... } or { values = [...] }"


def checked(item: Definition, table: Any) -> dict[str, Any]:
    """Return the table of an axis along a setting, with every value checked and defaults filled in.

    Raises `InputError` for unknown keys, wrong types, an axis described twice or not at all, values
    that the setting's definition refuses, and values that do not increase.
    """
    name = f"axis {item.name}"
    if not isinstance(table, Mapping):
        raise InputError(name, table, "a table", _SHAPE)
    given = {}
    for key, value in table.items():
        if key not in _KEYS:
            raise InputError(f"{name} key", key, "one of " + ", ".join(_KEYS), closest(key, _KEYS))
        given[key] = _KEYS[key].check(value)
    spaced = ("start", "stop", "count")
    if given.get("values") is not None:
        for key in (*spaced, "spacing"):
            if key in given:
                raise InputError(
                    f"{key} of {name}", given[key], "left out beside values", "remove one of the two"
                )
        return {"values": [item.check(value) for value in given["values"]]}
    for key in spaced:
        if given.get(key) is None:
            raise InputError(f"{key} of {name}", None, "given where values are not", _SHAPE)
    out = {key: item.check(given[key]) for key in spaced[:2]} | {"count": given["count"]}
    out["spacing"] = given.get("spacing", _KEYS["spacing"].default)
    _refuse_empty(name, out)
    return out


def values(table: Mapping[str, Any]) -> tuple[float, ...]:
    """Return the values of an axis, given its checked table.

    Evenly spaced values x_i = start + (stop - start) i / (count - 1), or the same for their logarithms;
    all but the ends are rounded to 12 digits, so that they are the same on every machine.
    """
    if "values" in table:
        return tuple(table["values"])
    start, stop, last = table["start"], table["stop"], table["count"] - 1
    if table["spacing"] == "log":
        low, high = math.log(start), math.log(stop)
        inner = [math.exp(low + (high - low) * i / last) for i in range(1, last)]
    else:
        inner = [start + (stop - start) * i / last for i in range(1, last)]
    return (start, *(float(f"{value:.12g}") for value in inner), stop)


def size(table: Mapping[str, Any]) -> int:
    """Return the number of values of an axis, given its checked table."""
    return len(table["values"]) if "values" in table else int(table["count"])


def ends(table: Mapping[str, Any]) -> tuple[float, float]:
    """Return the first and the last value of an axis, given its checked table."""
    if "values" in table:
        return table["values"][0], table["values"][-1]
    return table["start"], table["stop"]


def _refuse_empty(name: str, table: Mapping[str, Any]) -> None:
    start, stop = table["start"], table["stop"]
    if stop <= start:
        raise InputError(
            f"stop of {name}", stop, f"greater than start = {beside(start, stop)}", "exchange or change them"
        )
    if table["spacing"] == "log" and start <= 0:
        raise InputError(
            f"start of {name}", start, "positive where spacing is log", "raise it, or space linearly"
        )
    if any(b <= a for a, b in pairwise(values(table))):
        rule = "such that the values differ in their first 12 digits"
        raise InputError(f"count of {name}", table["count"], rule, "lower it, or widen the range")
