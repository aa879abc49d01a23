"""Text of DaVis 8, TSI Insight and the PIV plugin of Fiji."""

from __future__ import annotations

import re

import numpy as np

from .content import VELOCITY, Content, good_of, unreadable
from .text import Text
from ..units import is_length, is_speed


def is_davis(text: Text) -> bool:
    """Return whether a text is one of DaVis 8: one comment with sizes and units, then four columns."""
    return bool(text.header) and text.header[0].lstrip().startswith("#DaVis")


def davis(text: Text) -> Content:
    """Return the vectors of a DaVis text file. Raises `InputError` if its header is not that of one."""
    quoted = re.findall(r'"([^"]*)"', text.header[0])
    sizes = re.findall(r"\b(\d+)\b", text.header[0].partition('"')[0])
    if len(quoted) != 6 or quoted[::2] != ["position", "position", "velocity"] or len(sizes) < 2:
        rule = 'one whose first line has two sizes, then "position" twice and "velocity" with their units'
        raise unreadable(text.path, rule, "export it again as text, or name the columns with columns=")
    if text.values.shape[1] != 4 or text.values.shape[0] != int(sizes[-1]) * int(sizes[-2]):
        rule = f"one with {int(sizes[-1]) * int(sizes[-2])} rows of 4 numbers, as its first line says"
        raise unreadable(text.path, rule, "export it again if it was cut off")
    length, across, speed = quoted[1::2]
    if length != across or not is_length(length) or not is_speed(speed):
        rule = "one whose units are known; it has " + ", ".join(quoted[1::2])
        raise unreadable(text.path, rule, "name the columns with columns=")
    x, y, u, v = text.values.T
    good = good_of(x, y, u, v) & ((u != 0) | (v != 0))
    notes = ["DaVis writes exact zeros where there is no vector; they are not taken as measured"]
    return Content(
        "davis",
        VELOCITY,
        [{"x": x, "y": y, "u": u, "v": v, "good": good.astype(float)}],
        length,
        speed,
        complete=True,
        notes=notes,
    )


def is_insight(text: Text) -> bool:
    """Return whether a text is a .vec file of TSI Insight."""
    joined = " ".join(text.header)
    return "VARIABLES" in joined and "CHC" in joined and "ZONE" in joined


def insight(text: Text) -> Content:
    """Return the vectors of an Insight file. Raises `InputError` if its header is not that of one."""
    header = " ".join(text.header)
    listed = re.findall(r'"([^"]*)"', header.partition("VARIABLES")[2].partition("DATASETAUXDATA")[0])
    zone = re.search(r"ZONE\s+I=(\d+),\s*J=(\d+)", header)
    names = [each.split()[0] if each.split() else "" for each in listed]
    if names[:5] != ["X", "Y", "U", "V", "CHC"] or zone is None or text.values.shape[1] != len(names):
        rule = 'one with VARIABLES "X", "Y", "U", "V", "CHC" and a ZONE'
        raise unreadable(text.path, rule, "export it again, or name the columns with columns=")
    if text.values.shape[0] != int(zone[1]) * int(zone[2]):
        rule = f"one with {int(zone[1]) * int(zone[2])} rows, as its first line says"
        raise unreadable(text.path, rule, "export it again if it was cut off")
    units = [each.split()[1] if len(each.split()) > 1 else "" for each in listed[:4]]
    pixels = units == ["pixel"] * 4
    length, speed = ("px", "px/frame") if pixels else (units[0], units[2])
    if units[0] != units[1] or units[2] != units[3] or not is_length(length) or not is_speed(speed):
        rule = "one whose units are known; it has " + ", ".join(units)
        raise unreadable(text.path, rule, "name the columns with columns=")
    x, y, u, v, code = text.values.T[:5]
    said = {
        key: float(value) for key, value in re.findall(r'(\w+)="([-+0-9.eE]+)"', header) if _is_number(value)
    }
    origin, dt = (said.get("OriginInImageX"), said.get("OriginInImageY")), said.get("MicrosecondsPerDeltaT")
    notes = ["CHC other than 1 is not taken as measured; y and v are positive upwards, as Insight's axes are"]
    return Content(
        "insight",
        VELOCITY,
        [{"x": x, "y": y, "u": u, "v": v, "good": (good_of(x, y, u, v) & (code == 1)).astype(float)}],
        length,
        speed,
        "up",
        said.get("MicrometersPerPixelX"),
        None if not dt else 1e-6 * dt,
        None if None in origin else (float(origin[0] or 0.0), float(origin[1] or 0.0)),
        complete=True,
        notes=notes,
    )


def _is_number(text: str) -> bool:
    try:
        return bool(np.isfinite(float(text)))
    except ValueError:
        return False


FIJI_COLUMNS = 16


def is_fiji(text: Text) -> bool:
    """Return whether a text has the 16 columns of Fiji's PIV plugin and no header."""
    return not text.header and text.values.shape[1] == FIJI_COLUMNS


def fiji(text: Text) -> Content:
    """Return the vectors of a file of Fiji's PIV plugin (x, y, ux1, uy1, mag1, ang1, p1, ..., flag)."""
    x, y, u, v, size = text.values.T[:5]
    flag = text.values[:, 15]
    good = good_of(x, y, u, v) & (flag == 0)
    if not np.allclose(np.hypot(u, v)[good], size[good], rtol=0.05, atol=0.02):
        rule = "one whose fifth column is the length of the vector (ux1, uy1)"
        raise unreadable(text.path, rule, "name its columns with columns=")
    notes = ["the first peak (ux1, uy1) is taken where the last column is 0; y and v are positive downwards"]
    return Content(
        "fiji",
        VELOCITY,
        [{"x": x, "y": y, "u": u, "v": v, "good": good.astype(float)}],
        "px",
        "px/frame",
        "down",
        complete=True,
        notes=notes,
    )
