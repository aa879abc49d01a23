"""Any table of numbers, its columns named by the caller or by its own header: x, y, u, v and the like."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from ...model.errors import InputError, closest
from .content import ANGLE, TRACKS, VELOCITY, Columns, Content, good_of, unreadable
from .text import Text

MEANINGS = ("x", "y", "u", "v", "angle", "frame", "track", "bad", "good")
"""What a column may be: bad is 0 where a vector is good, good is 0 where it is not."""
_SETS = {
    VELOCITY: {"x", "y", "u", "v"},
    ANGLE: {"x", "y", "angle"},
    TRACKS: {"x", "y", "frame", "track"},
}


def recognises(text: Text) -> bool:
    """Return whether a header names x, y, u and v."""
    names = [_bare(name) for name in text.names]
    return len(names) == text.values.shape[1] and all(names.count(each) == 1 for each in ("x", "y", "u", "v"))


def from_header(text: Text) -> Content:
    """Return the vectors of a table whose header names its columns."""
    names = [_bare(name) for name in text.names]
    chosen: dict[str, Any] = {each: names.index(each) for each in ("x", "y", "u", "v")}
    for name, meaning in (
        ("flags", "bad"),
        ("flag", "bad"),
        ("mask", "bad"),
        ("bad", "bad"),
        ("good", "good"),
    ):
        if names.count(name) == 1 and meaning not in chosen:
            chosen[meaning] = names.index(name)
    units = [_unit(text.names[chosen[each]]) for each in ("x", "y", "u", "v")]
    content = read(text, chosen)
    if units[0] == units[1] and units[2] == units[3]:
        content.length, content.speed = units[0], units[2]
    return content


def read(text: Text, columns: Mapping[str, Any]) -> Content:
    """Return the columns that `columns` names, by number from 0 or by name. Raises `InputError` otherwise."""
    if not isinstance(columns, Mapping):
        rule = "names of columns with their numbers, from 0, or their names in the header"
        raise InputError("columns", columns, rule, 'write {"x": 0, "y": 1, "u": 2, "v": 3}')
    found: Columns = {}
    for meaning, at in columns.items():
        if meaning not in MEANINGS:
            raise InputError("columns", meaning, "one of " + ", ".join(MEANINGS), closest(meaning, MEANINGS))
        found[meaning] = text.values[:, _place(text, at)]
    kind = next((kind for kind, needed in _SETS.items() if needed <= set(found)), None)
    if kind is None:
        rule = "x, y, u and v; or x, y and angle; or x, y, frame and track"
        raise InputError("columns", sorted(found), rule, "name those that are missing")
    finite = good_of(*(found[name] for name in _SETS[kind]))
    if "bad" in found:
        finite &= found.pop("bad") == 0
    if "good" in found:
        finite &= found["good"] != 0
    found["good"] = finite.astype(float)
    if kind == VELOCITY and "frame" in found:
        times = found.pop("frame")
        frames = [{k: c[times == t] for k, c in found.items()} for t in np.unique(times[np.isfinite(times)])]
    else:
        frames = [found]
    if not frames:
        raise unreadable(text.path, "a table with rows in it", "check it")
    return Content("table", kind, frames, notes=["its columns are those that were named"])


def _place(text: Text, at: Any) -> int:
    count = text.values.shape[1]
    if isinstance(at, int | np.integer) and not isinstance(at, bool):
        if not 0 <= at < count:
            rule = f"a number from 0 to {count - 1}, because the file has {count} columns"
            raise InputError("columns", at, rule, "count from 0")
        return int(at)
    names = text.names
    if isinstance(at, str) and names.count(at) == 1 and len(names) == count:
        return names.index(at)
    raise InputError("columns", at, "one of " + (", ".join(names) or f"0 to {count - 1}"), closest(at, names))


def _bare(name: str) -> str:
    return name.partition("[")[0].partition("(")[0].strip().lower()


def _unit(name: str) -> str | None:
    for left, right in ("[]", "()"):
        if left in name:
            return name.partition(left)[2].partition(right)[0].strip() or None
    return None
