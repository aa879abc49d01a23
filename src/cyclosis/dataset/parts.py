"""Unfinished runs: parts in a folder, which are joined into one file at the end.

While a run for `run.nc` continues, its checkpoints are stored in `run.nc.unfinished/` as numbered NetCDF
files, each with the frames since the previous one and the stepper's state, each written completely or not at
all. A checkpoint therefore costs the same however long the run already is, and whatever ends the process, the
parts written so far can be opened and resumed. At the end the parts and the last frames are written to
`run.nc` and the folder is removed. When a finished file is resumed, it is kept as the first part until then.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import h5py

from .netcdf import DAMAGED, attributes_of, damaged
from .owner import NAME
from .whole import remove

MARKS = ("follows", "continues")
"""Attributes of a part: the digest of the file at the run's path when the run began, and whether the run
continues that file."""


def folder_of(target: Path) -> Path:
    """Return the folder of the parts of an unfinished run."""
    return target.with_name(target.name + ".unfinished")


def stored(target: Path) -> list[Path]:
    """Return all parts beside `target`, of any run."""
    return sorted(folder_of(target).glob("[0-9]*.nc")) if target.name else []


def parts(target: Path) -> list[Path]:
    """Return the files that make up a run: the one at its path, or the parts of an unfinished run."""
    found = stored(target)  # empty if target is a folder: reading it raises an error
    if not found:
        return [target]
    marks = marks_of(found[-1])
    if marks["follows"] != digest_at(target):
        return [target]  # the run has been joined since, or there is another file now
    return [target, *found] if marks["continues"] else found


def is_unfinished(target: Path) -> bool:
    """Return whether there are parts of an unfinished run beside `target`."""
    return parts(target) != [target]


def is_superseded(target: Path) -> bool:
    """Return whether the file at `target` is of the run whose parts are beside it, and contains all of them.

    In that case only the removal of the folder was interrupted.
    """
    try:
        whole, part = _described(target), _described(stored(target)[-1])
        same = all(whole[name] == part[name] for name in ("configuration_sha256", "initial_sha256"))
        reached, needed = (json.loads(found["outcome"])["t_final"] for found in (whole, part))
    except DAMAGED:
        return False
    return bool(same and reached >= needed)


def clear(target: Path) -> None:
    """Remove all parts beside `target`, the last first, so that the remaining ones always form a run."""
    for part in reversed(stored(target)):
        part.unlink(missing_ok=True)
    folder = folder_of(target)
    for other in folder.iterdir() if folder.is_dir() else ():
        if other.name != NAME:
            remove(other)


def digest_at(path: Path) -> str:
    """Return the digest stored in a file, or "" if there is no such file."""
    try:
        with h5py.File(path, "r") as file:
            return str(file.attrs["digest"])
    except DAMAGED:
        return ""


def marks_of(path: Path) -> dict[str, Any]:
    """Return the marks of a part."""
    try:
        found = _described(path)
        return {mark: found[mark] for mark in MARKS}
    except DAMAGED as error:
        raise damaged(path, error) from error


def outcome_of(path: Path) -> dict[str, Any]:
    """Return the outcome of the run in a file, or of the run up to a part."""
    try:
        return dict(json.loads(_described(path)["outcome"]))
    except DAMAGED as error:
        raise damaged(path, error) from error


def _described(path: Path) -> dict[str, Any]:
    with h5py.File(path, "r") as file:
        return attributes_of(file)
