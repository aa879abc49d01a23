"""Small files of a store, written completely or not at all, with checksums of their content."""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from ...dataset.whole import sync_folder, unwritable, whole
from ...model.errors import InputError


def files(folder: Path) -> Iterator[tuple[str, str]]:
    """Yield the name and path of every file in a folder and its subfolders."""
    try:
        with os.scandir(folder) as entries:
            for entry in entries:
                if entry.is_dir():
                    yield from files(Path(entry.path))
                else:
                    yield entry.name, entry.path
    except FileNotFoundError:
        return


def write(target: Path, data: bytes) -> None:
    """Write a file under a temporary name, sync it and rename it to `target`; missing folders are created.

    Raises `InputError` if that fails; then no part of a file is left.
    """
    try:
        make_folder(target.parent)
        with whole(target) as new:
            _write_synced(new, data)
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
    """Create a folder and those above it, durably."""
    if not folder.is_dir():
        make_folder(folder.parent)
        folder.mkdir(exist_ok=True)
        sync_folder(folder.parent)


def write_json(target: Path, content: Mapping[str, Any]) -> None:
    """Write a JSON file with a checksum of its content, by `write`."""
    sealed = {**content, "sha256": _seal(content)}
    write(target, (json.dumps(sealed, indent=1) + "\n").encode())


def read_json(path: Path) -> dict[str, Any]:
    """Return the content that `write_json` wrote. Raises `InputError` if the file is missing or altered."""
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
