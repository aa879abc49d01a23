"""Tracks of spots: TrackMate (spots as CSV, tracks as XML) and trackpy."""

from __future__ import annotations

import csv
import io
import re
from pathlib import Path
from typing import Any

import numpy as np

from ..units import TIMES, is_length
from .content import TRACKS, Array, Content, unreadable
from .text import Text

_NAMES = {
    "track": ("TRACK_ID", "Track ID"),
    "x": ("POSITION_X", "X"),
    "y": ("POSITION_Y", "Y"),
    "t": ("POSITION_T", "T"),
    "frame": ("FRAME", "Frame"),
}
"""Columns of a spots table, by their names in the first and in the second row of its header."""
MOST_HEADER = 5
_NOTES = ["y is positive downwards", "spots without a track are left out"]


def is_spots(text: str) -> bool:
    """Return whether a text is TrackMate's table of spots, by its first line."""
    words = set(_split(text.lstrip("\ufeff").partition("\n")[0]))
    return any(
        all(names[k] in words for key, names in _NAMES.items() if key not in ("t", "frame")) for k in (0, 1)
    )


def spots(path: Path, text: str) -> Content:
    """Return the spots of a TrackMate table with 1 to 4 header rows. Raises `InputError` for damaged ones."""
    lines = [line for line in text.lstrip("\ufeff").splitlines() if line.strip()]
    mark = _mark(lines[0])
    names = _split(lines[0])
    places = {key: next((names.index(n) for n in known if n in names), -1) for key, known in _NAMES.items()}
    for key in ("track", "x", "y", "frame"):
        if places[key] < 0 or names.count(names[places[key]]) != 1:
            rule = f"a table of spots with one column {_NAMES[key][0]}"
            raise unreadable(path, rule, "export all spots again")
    first = next(
        (k for k in range(1, min(len(lines), MOST_HEADER + 1)) if _numeric(lines[k], mark, places["x"])), 0
    )
    if not first:
        raise unreadable(
            path, "a table of spots with numbers after at most four rows of names", "export it again"
        )
    length, clock = _units([_split(line) for line in lines[1:first]], places, path)
    table = _columns(path, lines[first:], mark, names, places, first)
    notes = list(_NOTES)
    return Content(
        "trackmate",
        TRACKS,
        [{k: table[k] for k in ("x", "y", "frame", "track")}],
        length,
        None,
        "down",
        None,
        _interval(table, clock),
        notes=notes,
    )


def _split(line: str) -> list[str]:
    return [word.strip().strip('"') for word in line.strip("\r\n").split(_mark(line))]


def _mark(line: str) -> str:
    return max(",;\t", key=line.count)


def _numeric(line: str, mark: str, place: int) -> bool:
    fields = line.split(mark)
    return len(fields) > place and re.fullmatch(r'\s*"?[-+]?\d[\d.,eE+-]*"?\s*', fields[place]) is not None


def _units(rows: list[list[str]], places: dict[str, int], path: Path) -> tuple[str | None, str | None]:
    """Return the units of length and time in the row that has them."""
    for row in rows:
        if len(row) <= max(places["x"], places["y"]):
            continue
        units = [row[places[key]] for key in ("x", "y")]
        if all(unit.startswith("(") and unit.endswith(")") for unit in units):
            plain = units[0].strip("()")
            if units[0] != units[1] or not is_length(plain):
                raise unreadable(
                    path, f"one whose x and y have a known unit; they have {units}", "export it again"
                )
            clock = row[places["t"]].strip("()") if 0 <= places["t"] < len(row) else None
            return plain, clock
    return None, None


def _columns(
    path: Path, lines: list[str], mark: str, names: list[str], places: dict[str, int], before: int
) -> dict[str, Array]:
    """Return the columns that are needed. A label that contains the delimiter takes the surplus fields."""
    expected = len(names) - 1
    if any('"' in line for line in lines[:1000]):
        rows = list(csv.reader(lines, delimiter=mark))
        lines = [mark.join(field.replace(mark, " ") for field in row) for row in rows]
    for k, line in enumerate(lines):
        count = line.count(mark)
        if count == expected:
            continue
        fields = line.split(mark)
        if count < expected or names[0].upper() != "LABEL":
            rule = f"a table with {expected + 1} fields on every line; line {before + k + 1} has {count + 1}"
            raise unreadable(path, rule, "export it again if it was cut off")
        lines[k] = mark.join([" ".join(fields[: count - expected + 1]), *fields[count - expected + 1 :]])
    tidy = "\n".join(lines)
    if mark == ";":
        tidy = tidy.replace(",", ".")
    for _ in range(2):
        tidy = tidy.replace(mark * 2, f"{mark}nan{mark}")
    used = {key: place for key, place in places.items() if place >= 0}
    try:
        values = np.loadtxt(
            io.StringIO(tidy),
            delimiter=mark,
            comments=None,
            usecols=list(used.values()),
            ndmin=2,
            converters=None,
            dtype=np.float64,
        )
    except (ValueError, IndexError, OverflowError, MemoryError) as error:
        rule = f"one whose positions, frames and tracks are numbers ({' '.join(str(error).split())[:80]})"
        raise unreadable(path, rule, "export it again") from error
    return dict(zip(used, values.T, strict=True))


def _interval(table: dict[str, Array], clock: str | None) -> float | None:
    """Return the seconds between frames, where times and frames agree on one."""
    seconds = TIMES.get(clock or "")
    if seconds is None or "t" not in table:
        return None
    later = np.isfinite(table["t"]) & (table["frame"] > 0)
    if not later.any():
        return None
    each = table["t"][later] / table["frame"][later]
    step = float(np.median(each))
    return step * seconds if step > 0 and np.allclose(each, step, rtol=1e-3) else None


def is_xml(text: str) -> bool:
    """Return whether a text is XML."""
    return text.lstrip("\ufeff \r\n\t").startswith("<")


def xml(path: Path, text: str) -> Content:
    """Return the tracks of TrackMate's "tracks to XML". Raises `InputError` for other XML and damaged files."""
    from xml.etree import ElementTree

    if "<!DOCTYPE" in text or "<!ENTITY" in text:
        raise unreadable(path, "XML without declarations of its own", "export the tracks again")
    try:
        root = ElementTree.fromstring(text.lstrip("\ufeff \r\n\t"))
    except (ElementTree.ParseError, ValueError) as error:
        raise unreadable(path, f"XML that is whole ({error})", "export the tracks again") from error
    if root.tag != "Tracks":
        rule = f"the tracks of TrackMate as XML, <Tracks>; it is <{root.tag[:40]}>"
        raise unreadable(path, rule, 'choose "Export tracks to XML file" in TrackMate')
    rows = []
    try:
        for track, particle in enumerate(root.findall("particle")):
            for spot in particle.findall("detection"):
                rows.append((track, *(float(spot.attrib[key]) for key in ("t", "x", "y"))))
    except (KeyError, ValueError) as error:
        raise unreadable(
            path, f"one whose spots have numbers t, x and y ({error})", "export it again"
        ) from error
    said = root.attrib.get("nTracks", "")
    found = len(root.findall("particle"))
    if not rows or (said.isdigit() and int(said) != found):
        rule = f"one with the {said or 'any'} tracks that it announces; it has {found}"
        raise unreadable(path, rule, "export the tracks again")
    track, frame, x, y = np.array(rows, dtype=np.float64).T
    unit = root.attrib.get("spaceUnits")
    return Content(
        "trackmate",
        TRACKS,
        [{"x": x, "y": y, "frame": frame, "track": track}],
        unit if is_length(unit) else None,
        None,
        "down",
        None,
        _seconds(root.attrib),
        notes=[*_NOTES, "t counts frames"],
    )


def _seconds(attributes: Any) -> float | None:
    unit = TIMES.get(attributes.get("timeUnits", ""))
    try:
        step = float(attributes.get("frameInterval", "nan"))
    except ValueError:
        return None
    return step * unit if unit is not None and np.isfinite(step) and step > 0 else None


def is_trackpy(text: Text) -> bool:
    """Return whether a table is one of trackpy, by the names of its columns."""
    return {"x", "y", "frame", "particle"} <= set(text.names)


def trackpy(text: Text) -> Content:
    """Return the tracks of a trackpy table, whose y comes before x."""
    names = text.names
    if len(names) != text.values.shape[1] or any(
        names.count(n) != 1 for n in ("x", "y", "frame", "particle")
    ):
        rule = f"one with as many columns as names ({len(names)}), and one each of x, y, frame and particle"
        raise unreadable(text.path, rule, "write it again with DataFrame.to_csv")
    part = {key: text.values[:, names.index(name)] for key, name in _TRACKPY.items()}
    return Content("trackpy", TRACKS, [part], "px", None, "down", notes=list(_NOTES))


_TRACKPY = {"x": "x", "y": "y", "frame": "frame", "track": "particle"}
