"""PIVlab: text (0 to 3 header lines, y fastest) and .mat (v7 and v7.3)."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np

from .content import VELOCITY, Array, Columns, Content, good_of, unreadable
from .text import Text

KNOWN = (0, 1, 2, 3)
"""Codes of vectors: 0 masked, 1 measured, 2 filtered or interpolated, 3 of another origin."""
_NOTES = [
    "types 0 (masked), 2 (filtered, interpolated) and 3 are not taken as measured",
    "PIVlab lets its user choose the direction of y, and does not write it down",
]
_FACTORS = re.compile(r"conversion factor (xy|uv)[^:]*:\s*([-+0-9.eE]+)")


def recognises(text: Text) -> bool:
    """Return whether a text is one of PIVlab's."""
    joined = " ".join(text.header).lower()
    return "pivlab" in joined or "vector type" in joined


def read(text: Text) -> Content:
    """Return the vectors of a PIVlab text file. Raises `InputError` if its columns are not x, y, u, v, type."""
    names, values = text.names, text.values
    speed, length, found = None, None, {}
    lowered = [name.lower() for name in names]
    if lowered and lowered[0].startswith("x"):
        if len(names) != values.shape[1]:
            rule = f"one with as many columns as names; {len(names)} names and {values.shape[1]} columns"
            raise unreadable(text.path, rule, "export it again")
        for key, start in (("x", "x ["), ("y", "y ["), ("u", "u ["), ("v", "v ["), ("type", "vector type")):
            hits = [k for k, name in enumerate(lowered) if name.startswith(start)]
            if len(hits) != 1:
                rule = f"one with a column {start.strip(' [')}; it has {', '.join(names)[:80]}"
                raise unreadable(text.path, rule, "export it again, or name the columns with columns=")
            found[key] = hits[0]
        length, speed = (_unit(names[found[key]]) for key in ("x", "u"))
        others = (_unit(names[found["y"]]), _unit(names[found["v"]]))
        if others != (length, speed):
            rule = "one whose x and y, and u and v, have the same units"
            raise unreadable(text.path, rule, "export it again")
    elif values.shape[1] >= 5:
        found = {"x": 0, "y": 1, "u": 2, "v": 3, "type": 4}
    else:
        raise unreadable(text.path, "one with at least five columns", "export it again")
    columns = _columns(text.path, *(values[:, found[key]] for key in ("x", "y", "u", "v", "type")))
    pixel_um, frame_s, notes = _calibration(text.header, length)
    said = [f"its header says {speed}; after a calibrated export without derivatives that may be wrong"]
    return Content(
        "pivlab",
        VELOCITY,
        [columns],
        length,
        speed,
        None,
        pixel_um,
        frame_s,
        complete=True,
        notes=[*_NOTES, *notes, *(said if speed == "m/s" else [])],
    )


def _unit(name: str) -> str | None:
    unit = re.search(r"\[([^\]]+)\]", name)
    return unit[1] if unit and unit[1] != "-" else None


def _calibration(header: list[str], length: str | None) -> tuple[float | None, float | None, list[str]]:
    """Return the size of a pixel in µm and the time of a frame in s, if the second line of a header has them."""
    factors = {}
    for line in header:
        for name, number in _FACTORS.findall(line):
            try:
                factors[name] = abs(float(number))
            except ValueError:
                continue
    xy, uv = factors.get("xy"), factors.get("uv")
    if length != "m" or not xy or not uv or not (np.isfinite(xy) and np.isfinite(uv)):
        return None, None, []
    dt = xy / uv
    note = f"its factors make a pixel {xy * 1e6:g} um and the time between two images {dt:.6g} s"
    return xy * 1e6, dt, [note]


def _columns(path: Path, x: Array, y: Array, u: Array, v: Array, kind: Array) -> Columns:
    odd = kind[~np.isin(kind, KNOWN) & np.isfinite(kind)]
    if odd.size:
        rule = f"one whose vector types are 0, 1, 2 or 3; {odd[0]:g} occurs"
        raise unreadable(path, rule, "export it again, or name the columns with columns=")
    good = good_of(x, y, u, v) & (kind == 1)
    return {"x": x, "y": y, "u": u, "v": v, "good": good.astype(float)}


def in_mat(variables: dict[str, Any]) -> bool:
    """Return whether the variables of a .mat file are those of PIVlab."""
    names = set(variables)
    return {"x", "y", "u_original", "v_original"} <= names or {"x_0", "y_0", "u_0", "v_0"} <= names


def read_mat(path: Path, variables: dict[str, Any]) -> Content:
    """Return the vectors of a PIVlab .mat file: the filtered ones where they are, otherwise the original.

    `variables` has lists of arrays by name, one for each frame.
    """
    numbered = "u_0" in variables
    frames = []
    if numbered:
        count = 0
        while f"u_{count}" in variables:
            names = [f"{key}_{count}" for key in ("x", "y", "u", "v", "typevector")]
            frames.append(_frame(path, [variables.get(name, [None])[0] for name in names]))
            count += 1
    else:
        for k in range(len(variables["x"])):
            frames.append(_frame(path, _chosen(variables, k)))
    units = str(variables.get("units", ""))
    length = speed = None
    pair = re.findall(r"\[([^\]]+)\]", units)
    if len(pair) == 2:
        length, speed = pair
    pixel_um = None
    calxy = _scalar(variables.get("calxy"))
    if length == "m" and calxy:
        pixel_um = calxy * 1e6
    calu = _scalar(variables.get("calu"))
    frame_s = calxy / abs(calu) if length == "m" and calxy and calu else None
    return Content(
        "pivlab .mat",
        VELOCITY,
        frames,
        length,
        speed,
        None,
        pixel_um,
        frame_s,
        complete=True,
        notes=list(_NOTES),
    )


def _chosen(variables: dict[str, Any], k: int) -> list[Any]:
    """Return x, y, u, v and types of a frame. Filtered vectors replace only those that were not measured."""
    x, y = (_cell(variables, name, k) for name in ("x", "y"))
    for kind in ("filtered", "original"):
        u, v, types = (_cell(variables, f"{name}_{kind}", k) for name in ("u", "v", "typevector"))
        if u is not None and v is not None:
            return [x, y, u, v, types]
    return [x, y, None, None, None]


def _cell(variables: dict[str, Any], name: str, k: int) -> Any:
    cells = variables.get(name, [])
    found = cells[k] if k < len(cells) else None
    return None if found is None or not np.size(found) else found


def _frame(path: Path, found: list[Any]) -> Columns:
    shapes = {np.shape(each) for each in found if each is not None}
    if any(each is None for each in found[:4]) or len(shapes) != 1:
        rule = "one with x, y, u and v of one shape for every frame"
        raise unreadable(path, rule, "save the session's results again")
    try:
        arrays = [np.asarray(each, dtype=np.float64).ravel() for each in found[:4]]
        kind = np.ones_like(arrays[0]) if found[4] is None else np.asarray(found[4], dtype=np.float64).ravel()
    except (TypeError, ValueError):
        raise unreadable(path, "one whose x, y, u and v are numbers", "save the results again") from None
    return _columns(path, *arrays, kind)


def _scalar(value: Any) -> float | None:
    try:
        found = float(np.asarray(value[0] if isinstance(value, list) else value).ravel()[0])
    except (TypeError, ValueError, IndexError):
        return None
    return found if np.isfinite(found) and found > 0 else None
