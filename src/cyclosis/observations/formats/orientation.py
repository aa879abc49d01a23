"""The vector table of OrientationJ: angles of filaments, counter-clockwise with y up, at positions with y down."""

from __future__ import annotations

import numpy as np

from .content import ANGLE, Content, good_of, unreadable
from .text import Text

_NEEDED = ("X", "Y", "Orientation")


def recognises(text: Text) -> bool:
    """Return whether a table is one of OrientationJ, by the names of its columns."""
    return set(_NEEDED) <= set(text.names)


def read(text: Text) -> Content:
    """Return the angles of an OrientationJ table. Raises `InputError` if angles and directions disagree."""
    names, values = text.names, text.values
    if len(names) != values.shape[1] or any(names.count(name) != 1 for name in _NEEDED):
        rule = f"one with as many columns as names ({len(names)}), and one each of {', '.join(_NEEDED)}"
        raise unreadable(text.path, rule, "export it again")
    column = {name: values[:, names.index(name)] for name in names if name}
    angle, unit = column["Orientation"], "degrees"
    if {"DX", "DY"} <= set(column):
        unit = _unit(text, angle, column["DX"], column["DY"])
    good = good_of(column["X"], column["Y"], angle)
    notes = [
        "angles are counter-clockwise from the right as seen, positions have y downwards",
        "an angle has no polarity, and coherency is not |P|",
    ]
    for name in ("Coherency", "Energy"):
        if name in column:
            good &= column[name] > 0
            notes.append(f"samples with {name} 0 are not taken as measured")
    slices = column.get("Slice", np.zeros_like(angle))
    frames = [
        {"x": column["X"][at], "y": column["Y"][at], "angle": angle[at], "good": good[at].astype(float)}
        for at in (slices == number for number in np.unique(slices[np.isfinite(slices)]))
    ]
    return Content("orientationj", ANGLE, frames, "px", None, "down", notes=notes, extra={"angle": unit})


def _unit(text: Text, angle: np.ndarray, dx: np.ndarray, dy: np.ndarray) -> str:
    """Return the unit of the angles, which the directions (dx, dy) = ±(-cos, sin) tell."""
    for unit, factor in (("degrees", np.pi / 180), ("radians", 1.0)):
        turned = dx * np.sin(angle * factor) + dy * np.cos(angle * factor)
        used = np.isfinite(turned) & (np.hypot(dx, dy) > 0.1)
        if used.any() and np.median(np.abs(turned[used])) < 0.02:
            return unit
    rule = "one whose Orientation is the angle of (DX, DY)"
    raise unreadable(text.path, rule, "export it again, or name its columns with columns=")
