"""Text files of numbers: their encoding, delimiter, decimal mark and header, whatever those are."""

from __future__ import annotations

import codecs
import io
import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from .content import Array, unreadable

MOST_HEADER = 60
"""Lines of a header, at most."""
_NUMBER = re.compile(r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eEdD][+-]?\d+)?|[+-]?(?:nan|inf(?:inity)?)", re.IGNORECASE)
_DECIMAL_COMMA = re.compile(r"[+-]?(?:\d+,\d*|,\d+)(?:[eE][+-]?\d+)?")
_BOMS = (
    (codecs.BOM_UTF8, "utf-8-sig"),
    (codecs.BOM_UTF16_LE, "utf-16"),
    (codecs.BOM_UTF16_BE, "utf-16"),
)


@dataclass
class Text:
    """A text file in parts: the lines before the numbers, and the numbers (rows, columns)."""

    path: Path
    header: list[str]
    delimiter: str
    values: Array
    decimal_comma: bool = False

    @property
    def names(self) -> list[str]:
        """The names of the columns, in the last line of the header; empty if it has none."""
        if not self.header:
            return []
        line = self.header[-1].strip().lstrip("#%").strip()
        parts = (
            line.split(self.delimiter) if self.delimiter.strip() or self.delimiter == "\t" else line.split()
        )
        if len(parts) == 1:
            parts = re.split(r"[\t,;]", line) if re.search(r"[\t,;]", line) else line.split()
        return [part.strip().strip('"') for part in parts]


def decoded(path: Path, raw: bytes) -> str:
    """Return the text of a file with line ends as they are. Raises `InputError` for what is no text."""
    for mark, encoding in _BOMS:
        if raw.startswith(mark):
            try:
                return raw.decode(encoding)
            except UnicodeDecodeError:
                raise unreadable(path, "text that is whole", "write it again, it is damaged") from None
    if b"\0" in raw:
        rule = "a file of a known format, or text without zero bytes"
        raise unreadable(path, rule, "write it again if it is damaged, or export it as text")
    try:
        return raw.decode("utf-8")
    except UnicodeDecodeError:
        return raw.decode("latin-1")


def numbers_in(path: Path, text: str, skip: int = 0) -> Text:
    """Return the header and the numbers of a text. Raises `InputError` if there are none, or rows differ."""
    lines = text.splitlines()
    while lines and not lines[-1].strip():
        lines.pop()
    for at, line in enumerate(lines[: MOST_HEADER + 1]):
        form = (
            _form(line) if at >= skip and line.strip() and not line.lstrip().startswith(("#", "%")) else None
        )
        if form is not None:
            delimiter, comma = form
            header = [each for each in lines[:at] if each.strip()]
            values = _values(path, lines[at:], at, delimiter, comma)
            return Text(path, header, delimiter, values, comma)
    if not lines:
        raise unreadable(path, "a file with something in it", "check the path, it is empty")
    first = lines[0].strip()
    rule = f"a file whose columns are known; it begins with {first[:60]!r}"
    raise unreadable(path, rule, 'name them, as columns={"x": 0, "y": 1, "u": 2, "v": 3}')


def _form(line: str) -> tuple[str, bool] | None:
    """Return the delimiter of a line of numbers and whether decimals have a comma; None if it is not one."""
    for delimiter in ("\t", ";"):
        if delimiter in line.strip():
            return _checked(_fields(line, delimiter), delimiter)
    words = line.split()
    if "," in line:
        if len(words) >= 2 and all(_DECIMAL_COMMA.fullmatch(w) or _NUMBER.fullmatch(w) for w in words):
            return " ", True
        return _checked(_fields(line, ","), ",", False)
    return _checked(words, " ")


def _checked(fields: list[str], delimiter: str, may_comma: bool = True) -> tuple[str, bool] | None:
    plain = [_NUMBER.fullmatch(f) is not None or f == "" for f in fields]
    comma = [_DECIMAL_COMMA.fullmatch(f) is not None for f in fields]
    if len(fields) < 2 or not any(fields):
        return None
    if all(plain):
        return delimiter, False
    if may_comma and all(p or c for p, c in zip(plain, comma, strict=True)):
        return delimiter, True
    return None


def _fields(line: str, delimiter: str) -> list[str]:
    fields = [part.strip() for part in line.strip("\r\n ").split(delimiter)]
    return fields[:-1] if len(fields) > 2 and fields[-1] == "" else fields


def _values(path: Path, lines: list[str], first: int, delimiter: str, comma: bool) -> Array:
    """Return lines of numbers as an array. Raises `InputError` with the number of the line that does not fit."""
    if comma:
        lines = [line.replace(",", ".") for line in lines]
    given = None if delimiter == " " else delimiter
    empty = delimiter * 2
    tidy = "\n".join(lines)
    if given is not None and empty in tidy:
        tidy = tidy.replace(empty, f"{delimiter}nan{delimiter}").replace(empty, f"{delimiter}nan{delimiter}")
    try:
        values = np.loadtxt(io.StringIO(tidy), delimiter=given, comments=None, ndmin=2, dtype=np.float64)
        return np.asarray(values)
    except (ValueError, MemoryError, OverflowError):
        return _slowly(path, lines, first, given)


def _slowly(path: Path, lines: list[str], first: int, delimiter: str | None) -> Array:
    """Return lines of numbers with comments, empty lines and empty fields between them."""
    rows: list[list[float]] = []
    for at, line in enumerate(lines, first + 1):
        if not line.strip() or line.lstrip().startswith(("#", "%")):
            continue
        fields = line.split() if delimiter is None else _fields(line, delimiter)
        if (
            rows
            and delimiter is not None
            and len(fields) == len(rows[0]) - 1
            and line.rstrip(" \r\n")[-1:] == delimiter
        ):
            fields.append("")
        row = [_float(field) for field in fields]
        if None in row or (rows and len(row) != len(rows[0])):
            expected = f"{len(rows[0])} numbers" if rows else "numbers"
            rule = f"{expected} on every line; line {at} is {line.strip()[:60]!r}"
            raise unreadable(path, rule, "write it again if it was cut off, or remove that line")
        rows.append([value for value in row if value is not None])
    return np.array(rows, dtype=np.float64)


def _float(field: str) -> float | None:
    if field == "":
        return float("nan")
    return (
        float(field.replace("D", "e").replace("d", "e"))
        if _NUMBER.fullmatch(field) and not field.lower().startswith(("n", "i", "+n", "-n", "+i", "-i"))
        else (float(field) if _NUMBER.fullmatch(field) else None)
    )
