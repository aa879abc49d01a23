"""Files and folders of exports: written beside their place, and then put there as a whole."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path

from ..model.errors import InputError
from .owner import claim
from .parts import folder_of
from .place import in_the_way, vacate
from .whole import remove, swap_folder, sync_folder, temporary, whole


def refuse_existing(target: Path, force: bool) -> None:
    """Raise `InputError` if something stands at the place of an export that it may not replace."""
    if not target.parent.is_dir():
        raise InputError("out", str(target), "in a folder that exists", f"create {target.parent} first")
    if os.path.lexists(target) and not force:
        raise in_the_way(target, "a new name")
    if target.is_dir() and not (is_named_zarr(target) and _is_zarr(target)):
        raise InputError("out", str(target), "no folder with other things", "choose another name")


def is_named_zarr(target: Path) -> bool:
    """Return whether a name is that of a Zarr store, which is a folder."""
    return target.name.lower().endswith(".zarr")


def _is_zarr(folder: Path) -> bool:
    return any((folder / name).exists() for name in (".zgroup", "zarr.json"))


@contextmanager
def put_whole(target: Path, force: bool) -> Iterator[Path]:
    """Provide a temporary name beside a target, which it replaces on success; otherwise it is removed."""
    if not is_named_zarr(target):
        with whole(target, force) as new:
            yield new
            vacate(target)
        return
    new = temporary(target)
    old: list[Path] = []
    try:
        yield new
        if os.path.lexists(target) and not force:
            raise FileExistsError
        old = swap_folder(new, target)
        sync_folder(target.parent)
    finally:
        for path in (new, *old):
            remove(path)


def fill_folder(
    target: Path, force: bool, fill: Callable[[Path], None], earlier: Callable[[Path], Iterable[Path]]
) -> None:
    """Fill a new folder beside `target`, and move its files there, those of the least suffix last.

    With `force` the files that `earlier` names, those of an earlier export, are removed; all others stay.
    Raises `InputError` if the folder is not empty (unless `force`), or cannot be written to.
    """
    new = temporary(target) if target.name else target
    try:
        used = target.exists() and (not target.is_dir() or any(target.iterdir()))
        if not target.name or (used and not force):
            raise in_the_way(target, "a new or empty folder")
        with claim(folder_of(target), target):
            new.mkdir()
            fill(new)
            target.mkdir(exist_ok=True)
            for old in list(earlier(target)):
                old.unlink(missing_ok=True)
            for written in sorted(new.iterdir(), key=lambda path: path.suffix, reverse=True):
                os.replace(written, target / written.name)
    except OSError as error:
        remedy = f"choose another ({error.strerror or error})"
        raise InputError("out", str(target), "a folder that can be written to", remedy) from error
    finally:
        if target.name:
            remove(new)
