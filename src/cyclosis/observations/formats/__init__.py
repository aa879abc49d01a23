"""One file for each family of formats. A format is recognised by what a file holds, not by its name."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path
from typing import Any

from ...model.errors import InputError
from ..films.reading import is_video
from .content import Asked, Content, unreadable

FORMATS = {
    "openpiv": "OpenPIV text, 5 or 6 columns, raw or transformed",
    "pivlab": "PIVlab text",
    "pivlab .mat": "PIVlab .mat, v7 or v7.3",
    "davis": "DaVis 8 text",
    "insight": "TSI Insight .vec",
    "fiji": "PIV plugin of Fiji, 16 columns",
    "table": "any table of numbers, with columns=",
    "trackmate": "TrackMate spots CSV, or tracks XML",
    "trackpy": "trackpy CSV",
    "orientationj": "OrientationJ vector table",
    "flow": "optical flow, .npy",
    "angles": "angles of filaments, .npy or TIFF",
    "kymograph": "kymograph, TIFF, rows are times",
    "slice": "velocity along the cell in a cross-section, TIFF",
    "pivpy": "pivpy NetCDF",
    "surface": "a file of `cyclosis measure`",
}
"""Every format that is read, by its name."""
MOST_BYTES = 2**32
"""Larger files are refused: they are films, or not what they seem."""


def content_of(path: str | os.PathLike[str], asked: Asked) -> Content:
    """Return what a file holds. Raises `InputError` for files that cannot be read or are not recognised."""
    place = Path(path)
    raw = _bytes(place)
    if is_video(raw):
        rule = "a file of vectors, tracks, angles or a picture; it is a film"
        remedy = "measure it: cyclosis.observations.film(path)"
        raise InputError("file", str(place), rule, remedy, "use `cyclosis measure` without --format")
    wanted = asked.format
    if asked.columns is not None and wanted not in (None, "table"):
        raise InputError("format", wanted, '"table" with columns=', "leave one of the two out")
    for starts, load in _BINARY:
        if starts(raw):
            content = load(place, raw, asked)
            break
    else:
        content = _text(place, raw, asked)
    if wanted is not None and content.format != wanted and not content.format.startswith(wanted):
        rule = f"a file of the format {wanted}; it is one of {content.format}"
        raise unreadable(place, rule, f'leave out format={wanted!r} or give "{content.format}"')
    return content


def _bytes(place: Path) -> bytes:
    try:
        if place.is_dir():
            raise unreadable(place, "a file", f"give the files in it, as {place}/*.txt")
        if place.stat().st_size > MOST_BYTES:
            raise unreadable(place, "at most 4 GiB", "split it")
        raw = place.read_bytes()
    except (OSError, ValueError) as error:
        if isinstance(error, InputError):
            raise
        reason = getattr(error, "strerror", None) or error
        raise unreadable(place, "a file that can be read", f"check the path ({reason})") from error
    if not raw.strip():
        raise unreadable(place, "a file with something in it", "check the path, it is empty")
    return raw


def _text(place: Path, raw: bytes, asked: Asked) -> Content:
    """Return the content of a text file."""
    from . import openpiv, orientation, pivlab, table, tracks, vendors
    from .text import decoded, numbers_in

    words = decoded(place, raw)
    if asked.columns is None:
        for starts, load in ((tracks.is_spots, tracks.spots), (tracks.is_xml, tracks.xml)):
            if starts(words):
                return load(place, words)
    text = numbers_in(place, words)
    if asked.columns is not None or asked.format == "table":
        if asked.columns is None and table.recognises(text):
            return table.from_header(text)
        return table.read(text, asked.columns or {})
    known: tuple[tuple[Callable[[Any], bool], Callable[[Any], Content]], ...] = (
        (vendors.is_davis, vendors.davis),
        (vendors.is_insight, vendors.insight),
        (pivlab.recognises, pivlab.read),
        (tracks.is_trackpy, tracks.trackpy),
        (orientation.recognises, orientation.read),
        (openpiv.recognises, openpiv.read),
        (vendors.is_fiji, vendors.fiji),
        (table.recognises, table.from_header),
    )
    for is_one, read in known:
        if is_one(text):
            return read(text)
    shown = words.lstrip("\ufeff").splitlines()[0].strip()[:60]
    rule = f"a file whose columns are known; it begins with {shown!r}"
    raise unreadable(place, rule, 'name them, as columns={"x": 0, "y": 1, "u": 2, "v": 3}')


def _tiff(place: Path, raw: bytes, asked: Asked) -> Content:
    from .images import tiff

    return tiff(place, raw, asked)


def _npy(place: Path, raw: bytes, asked: Asked) -> Content:
    from .images import npy

    return npy(place, raw, asked)


def _matlab(place: Path, raw: bytes, asked: Asked) -> Content:
    from .containers import matlab

    return matlab(place, raw, asked)


def _hdf5(place: Path, raw: bytes, asked: Asked) -> Content:
    from .containers import hdf5

    return hdf5(place, raw, asked)


def _netcdf3(place: Path, raw: bytes, asked: Asked) -> Content:
    from .containers import netcdf3

    return netcdf3(place, raw, asked)


_Starts = Callable[[bytes], bool]
_BINARY: tuple[tuple[_Starts, Callable[[Path, bytes, Asked], Content]], ...] = (
    (lambda raw: raw[:4] in (b"II*\0", b"MM\0*", b"II+\0", b"MM\0+"), _tiff),
    (lambda raw: raw.startswith(b"\x93NUMPY"), _npy),
    (lambda raw: raw.startswith(b"MATLAB 5.0"), _matlab),
    (lambda raw: b"\x89HDF\r\n\x1a\n" in (raw[:8], raw[512:520]), _hdf5),
    (lambda raw: raw.startswith((b"CDF\x01", b"CDF\x02", b"CDF\x05")), _netcdf3),
)
"""The first bytes of the binary formats."""
