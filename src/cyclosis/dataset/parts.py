"""Runs that are still going, or were cut off: parts in a folder, joined into one file at the end.

While a run goes towards `run.nc`, its checkpoints stand in `run.nc.unfinished/` as numbered NetCDF
files, each with the frames since the one before and the stepper's state, each written whole or not at
all. A checkpoint therefore costs the same however long the run already is, and whatever kills the
process, the parts that stand can be opened and resumed. At the end the parts are joined into `run.nc` and
the folder goes. When a finished file is resumed it stays as the first part until the join replaces it.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import h5py

from .netcdf import DAMAGED, attributes_of, damaged

MARKS = ("follows", "continues")
"""Attributes of a part: the digest of the file at its run's place when the run began, and whether the run
continues that file."""


def folder_of(target: Path) -> Path:
    """Return the folder of the parts of an unfinished run."""
    return target.with_name(target.name + ".unfinished")


def parts(target: Path) -> list[Path]:
    """Return the files that make up a run: the one at its place, or what an unfinished run has left."""
    if not target.name:
        return [target]  # a folder: reading it says so
    stored = sorted(folder_of(target).glob("[0-9]*.nc"))
    if not stored:
        return [target]
    marks = marks_of(stored[-1])
    if marks["follows"] != digest_at(target):
        return [target]  # the run has been joined since: the folder was only not yet removed
    return [target, *stored] if marks["continues"] else stored


def is_unfinished(target: Path) -> bool:
    """Return whether parts of an unfinished run stand beside `target`."""
    return parts(target) != [target]


def digest_at(path: Path) -> str:
    """Return the digest that a file states of itself, or nothing where there is no such file."""
    try:
        with h5py.File(path, "r") as file:
            return str(file.attrs["digest"])
    except DAMAGED:
        return ""


def marks_of(path: Path) -> dict[str, Any]:
    """Return the marks of a part."""
    try:
        with h5py.File(path, "r") as file:
            found = attributes_of(file)
            return {mark: found[mark] for mark in MARKS}
    except DAMAGED as error:
        raise damaged(path, error) from error
