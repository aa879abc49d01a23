"""Files that appear whole or not at all, and the temporary ones that killed writers leave."""

from __future__ import annotations

import hashlib
import json
import os
import re
import secrets
import socket
import time
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from ..dataset.netcdf import sync_folder, unwritable
from ..model.errors import InputError

STALE_SECONDS = 3600.0
"""Age at which a temporary file is certainly that of a writer that was killed."""

_TEMPORARY = re.compile(r"\..+\.(?P<host>[^.]+)\.(?P<process>\d+)\.[0-9a-f]+\.new")


def files(folder: Path) -> Iterator[tuple[str, str]]:
    """Yield name and path of every file in a folder and the folders in it."""
    try:
        with os.scandir(folder) as entries:
            for entry in entries:
                if entry.is_dir():
                    yield from files(Path(entry.path))
                else:
                    yield entry.name, entry.path
    except FileNotFoundError:
        return


def is_stale(path: Path) -> bool:
    """Return whether a temporary file is that of a writer that is no more."""
    named = _TEMPORARY.fullmatch(path.name)
    if named and named["host"] == host() and not _alive(int(named["process"])):
        return True
    try:
        return time.time() - path.stat().st_mtime > STALE_SECONDS
    except OSError:
        return False


def _alive(process: int) -> bool:
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return False
    except (OSError, OverflowError):
        return True
    return True


def host() -> str:
    """Return the name of this machine as it stands in the names of temporary files."""
    return re.sub(r"[^A-Za-z0-9-]", "-", socket.gethostname()) or "-"


def write(target: Path, data: bytes) -> None:
    """Write a file under a temporary name, sync it and rename it to `target`; folders are made if need be.

    Raises `InputError` if that fails; then no part of a file is left.
    """
    partial = target.with_name(f".{target.name}.{host()}.{os.getpid()}.{secrets.token_hex(4)}.new")
    try:
        make_folder(target.parent)
        try:
            _write_synced(partial, data)
            os.replace(partial, target)
        finally:
            partial.unlink(missing_ok=True)
        sync_folder(target.parent)
    except OSError as error:
        raise unwritable(target, error) from error


def _write_synced(path: Path, data: bytes) -> None:
    handle = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o666)
    try:
        rest = memoryview(data)
        while rest:
            rest = rest[os.write(handle, rest) :]
        os.fsync(handle)
    finally:
        os.close(handle)


def make_folder(folder: Path) -> None:
    """Make a folder and those above it, durably."""
    if not folder.is_dir():
        make_folder(folder.parent)
        folder.mkdir(exist_ok=True)
        sync_folder(folder.parent)


def write_json(target: Path, content: Mapping[str, Any]) -> None:
    """Write a JSON file with a checksum of its content, as `write` writes files."""
    sealed = {**content, "sha256": _seal(content)}
    write(target, (json.dumps(sealed, indent=1) + "\n").encode())


def read_json(path: Path) -> dict[str, Any]:
    """Return what `write_json` wrote. Raises `InputError` if there is no such file, or it was altered."""
    try:
        content = json.loads(path.read_bytes())
        seal = content.pop("sha256")
    except (OSError, ValueError, KeyError, TypeError, AttributeError, RecursionError) as error:
        if isinstance(error, FileNotFoundError | NotADirectoryError):
            rule, remedy = "the store of a sweep", f"check the path: there is no {path.name}"
            raise InputError("store", str(path.parent), rule, remedy) from error
        raise _altered(path) from error
    if seal != _seal(content):
        raise _altered(path)
    return dict(content)


def _altered(path: Path) -> InputError:
    remedy = "remove it and run the sweep again into the same store: its blocks are kept"
    return InputError("file", str(path), "as it was written, but it was altered or truncated", remedy)


def _seal(content: Mapping[str, Any]) -> str:
    text = json.dumps(content, sort_keys=True, separators=(",", ":"))
    return hashlib.sha256(text.encode()).hexdigest()
