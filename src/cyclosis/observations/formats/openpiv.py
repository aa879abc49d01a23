"""OpenPIV text (`tools.save`): six columns x, y, u, v, flags, mask, or five, with or without a header."""

from __future__ import annotations

import numpy as np

from .content import VELOCITY, Array, Columns, Content, good_of, unreadable
from .text import Text

_HEADER = "OpenPIV writes no unit and no direction of y"
_TRANSFORMED = "as after transform_coordinates, which makes y and v positive upwards"
_RAW = "as before transform_coordinates, with y and v positive downwards"


def recognises(text: Text) -> bool:
    """Return whether a text is one of OpenPIV's, by the names or the number of its columns."""
    names, count = text.names, text.values.shape[1]
    if names[:4] == ["x", "y", "u", "v"] and text.header[-1].lstrip().startswith("#"):
        return count in (5, 6) and len(names) == count
    if text.header or count not in (5, 6):
        return False
    last = text.values[:, 4:]
    return count == 5 or bool(np.isin(last, (0.0, 1.0, 2.0)).all())


def read(text: Text) -> Content:
    """Return the vectors of an OpenPIV file. Raises `InputError` for flags that OpenPIV does not write."""
    values, names = text.values, text.names
    x, y, u, v = values.T[:4]
    good = good_of(x, y, u, v)
    notes = [_HEADER]
    if values.shape[1] == 6:
        flags, mask = (
            _codes(text, "flags", values[:, 4], (0, 1, 2)),
            _codes(text, "mask", values[:, 5], (0, 1)),
        )
        good &= (flags == 0) & (mask == 0)
        notes.append("flags 1 (outlier) and 2 (replaced) and mask 1 are not taken as measured")
    else:
        good &= _fifth(text, values[:, 4], names[4] if names else "", notes)
    notes.append(_order(y))
    columns: Columns = {"x": x, "y": y, "u": u, "v": v, "good": good.astype(float)}
    return Content("openpiv", VELOCITY, [columns], complete=True, notes=notes)


def _fifth(
    text: Text, column: Array, name: str, notes: list[str]
) -> np.ndarray[tuple[int, ...], np.dtype[np.bool_]]:
    """Return which vectors are good by a fifth column, which is a mask, flags, or a ratio of peaks."""
    if name in ("mask", "flags") or np.isin(column, (0.0, 1.0, 2.0)).all():
        notes.append(
            f"the fifth column ({name or 'no name, values 0 and 1'}) marks vectors that are not good"
        )
        return np.asarray(_codes(text, name or "the fifth column", column, (0, 1, 2)) == 0)
    notes.append("the fifth column is taken as the ratio of peak to noise; vectors below 1 are not good")
    return np.asarray(~(column < 1.0))


def _order(y: Array) -> str:
    if y.size and y[0] > y[-1]:
        return f"the first row has the largest y, {_TRANSFORMED}"
    return f"the first row has the smallest y, {_RAW}"


def _codes(text: Text, name: str, column: Array, known: tuple[int, ...]) -> Array:
    if not np.isin(column, known).all():
        odd = column[~np.isin(column, known)][0]
        rule = f"one whose {name} are {', '.join(map(str, known))}; {odd:g} occurs"
        raise unreadable(text.path, rule, "write it again, or name the columns yourself with columns=")
    return column
