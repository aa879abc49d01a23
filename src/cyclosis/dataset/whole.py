"""Writing files and folders completely or not at all, and removing what killed writers leave."""

from __future__ import annotations

import contextlib
import errno
import os
import re
import secrets
import shutil
import socket
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from ..model.errors import InputError

FULL = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG)
"""Errors of a full disk."""
STALE_SECONDS = 3600.0
"""Age above which a temporary file counts as left by a killed writer."""

_TEMPORARY = re.compile(r"\..+\.(?P<host>[^.]+)\.(?P<process>\d+)\.[0-9a-f]+\.new")


def temporary(target: Path) -> Path:
    """Return a new name beside `target` that names this process and is not too long for a file system."""
    name = target.name.encode()[:120].decode(errors="ignore")
    return target.with_name(f".{name}.{host()}.{os.getpid()}.{secrets.token_hex(4)}.new")


@contextmanager
def whole(target: Path, force: bool = True) -> Iterator[Path]:
    """Provide a temporary name beside `target`; what is written there is renamed to `target` on success.

    Raises `FileExistsError` if `target` exists by then, unless `force`. After any error the temporary file is
    removed.
    """
    new = temporary(target)
    try:
        yield new
        _put(new, target, force)
        sync_folder(target.parent)
    finally:
        with contextlib.suppress(OSError):
            new.unlink(missing_ok=True)


def _put(new: Path, target: Path, force: bool) -> None:
    if not force:
        try:
            os.link(new, target)  # unlike a rename, this never replaces a file
            return
        except FileExistsError:
            raise
        except (OSError, AttributeError, NotImplementedError):  # no hard links here
            if os.path.lexists(target):
                raise FileExistsError(errno.EEXIST, os.strerror(errno.EEXIST), str(target)) from None
    os.replace(new, target)


def swap_folder(new: Path, target: Path) -> list[Path]:
    """Move a folder to `target`, and return the new paths of what was there before.

    A folder cannot be replaced in one step: if two processes do this at once, one does it after the other.
    """
    aside = []
    for _ in range(100):
        old = temporary(target).with_suffix(".old")
        with contextlib.suppress(FileNotFoundError):
            os.replace(target, old)
            aside.append(old)
        try:
            os.replace(new, target)
            return aside
        except OSError:
            if not target.is_dir():
                if aside:
                    os.replace(aside[-1], target)
                raise
            time.sleep(0.01)
    raise FileExistsError(errno.EEXIST, os.strerror(errno.EEXIST), str(target))


def remove(path: Path) -> None:
    """Remove a file, or a folder with its content, even if others still write into it for some seconds."""
    if not path.is_dir():
        with contextlib.suppress(NotADirectoryError):
            path.unlink(missing_ok=True)
    for _ in range(100):
        if not path.is_dir():
            return
        shutil.rmtree(path, ignore_errors=True)
        time.sleep(0.1)


def sync_folder(folder: Path) -> None:
    """Make a rename in a folder durable, if the system supports it."""
    if hasattr(os, "O_DIRECTORY"):
        handle = os.open(folder, os.O_RDONLY | os.O_DIRECTORY)
        try:
            os.fsync(handle)
        finally:
            os.close(handle)


def unwritable(target: Path, error: OSError) -> InputError:
    """Return the error for a file that could not be written."""
    full = error.errno in FULL
    remedy = (
        "free some disk space and resume" if full else f"choose another place ({error.strerror or error})"
    )
    rule = "a file that can be written whole"
    return InputError("out", str(target), rule, f"{remedy}; what was saved before is kept")


def is_stale(path: Path) -> bool:
    """Return whether a temporary file belongs to a writer that no longer runs."""
    named = _TEMPORARY.fullmatch(path.name)
    if named and named["host"] == host() and not _alive(int(named["process"])):
        return True
    try:
        return time.time() - path.stat().st_mtime > STALE_SECONDS
    except OSError:
        return False


def _alive(process: int) -> bool:
    import psutil  # rarely needed

    return bool(psutil.pid_exists(process))


def host() -> str:
    """Return the name of this machine as used in the names of temporary files."""
    return re.sub(r"[^A-Za-z0-9-]", "-", socket.gethostname())[:40] or "-"
