"""Checking whether a file can be written to a path, and removing what it replaces."""

from __future__ import annotations

import os
from pathlib import Path

from ..model.errors import InputError
from .owner import claim, refuse_living
from .parts import clear, folder_of, is_unfinished, stored
from .whole import unwritable


def check_writable(target: Path, force: bool) -> None:
    """Raise `InputError` if there is a file, an unfinished or a running run, or if the folder is missing.

    With `force` files and unfinished runs may be replaced, but never a run that is being written.

    Example:
        >>> from pathlib import Path
        >>> from cyclosis.dataset import check_writable
        >>> check_writable(Path("new.nc"), force=False)
        >>> check_writable(Path("nowhere/new.nc"), force=False)
        Traceback (most recent call last):
            ...
        cyclosis.model.errors.InputError: out = 'nowhere/new.nc' cannot be used: ...
    """
    try:
        folder, there, room = target.is_dir(), os.path.lexists(target), target.parent.is_dir()
    except OSError as error:
        remedy = f"choose another ({error.strerror})"
        raise InputError("out", str(target), "a place that can be written to", remedy) from error
    if folder:
        raise InputError("out", str(target), "a file name, not a folder", "add a file name")
    if is_stream(target):
        rule = "a regular file, since the file is not written from front to back and cannot be streamed"
        raise InputError("out", str(target), rule, "write to a file, then copy that")
    if there and not force:
        raise in_the_way(target)
    if not room:
        raise InputError("out", str(target), "in a folder that exists", f"create {target.parent} first")
    if folder_of(target).is_dir():
        _check_unfinished(target, force)


def is_stream(target: Path) -> bool:
    """Return whether a path is a device, a pipe or an open file, such as /dev/stdout.

    Example:
        >>> from pathlib import Path
        >>> from cyclosis.dataset.place import is_stream
        >>> is_stream(Path("run.nc"))
        False
    """
    folder = Path(os.path.realpath(target.parent))
    inside = folder == Path("/dev") or Path("/proc") in (folder, *folder.parents)
    return inside or (os.path.exists(target) and not os.path.isfile(target) and not os.path.isdir(target))


def _check_unfinished(target: Path, force: bool) -> None:
    try:
        refuse_living(folder_of(target), target)
    except OSError as error:
        raise unwritable(target, error) from error
    if force or not stored(target):
        return
    if is_unfinished(target):
        rule = "free of an unfinished run"
        remedy, command = (
            f"continue it with {how}, or overwrite it with {force}"
            for how, force in (
                (f"cyclosis.resume_file({str(target)!r})", "force=True"),
                (f"`cyclosis resume {target}`", "--force"),
            )
        )
        raise InputError("out", str(target), rule, remedy, command)
    rule = f"free of an unfinished run, and {folder_of(target)} holds one whose beginning is missing"
    remedy = "restore the file that it continues, or overwrite it with "
    raise InputError("out", str(target), rule, remedy + "force=True", remedy + "--force")


def in_the_way(target: Path, rule: str = "a new file") -> InputError:
    """Return the error for a path that exists already."""
    remedy = "choose another name, or overwrite it with "
    return InputError("out", str(target), rule, remedy + "force=True", remedy + "--force")


def vacate(target: Path) -> None:
    """Remove the parts of an unfinished run beside a file that is about to replace it.

    Raises `InputError` if that run is being written.
    """
    if folder_of(target).is_dir():
        with claim(folder_of(target), target):
            clear(target)
