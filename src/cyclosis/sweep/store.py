"""A store: the folder in which the blocks of a sweep stand, each in a file of its own, whole or not at all.

    STORE/sweep.json                     the configuration, its digest, versions, when it was begun
    STORE/blocks/000012/000012345.nc     block 12345: a classic NetCDF file with a checksum of itself
    STORE/failed/000012345.json          why block 12345 could not be computed

That a block's file stands is the record that it is done: there is no lock, no database and nothing is ever
appended to, so that any number of processes on any number of machines may write to one store and any of
them may die at any moment. Files are written under a temporary name, synced and renamed.
"""

from __future__ import annotations

import hashlib
import json
import os
import platform
import re
import secrets
import socket
import time
from collections.abc import Callable, Collection, Iterator, Mapping
from contextlib import suppress
from datetime import UTC, datetime
from functools import cached_property
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

import numpy.typing as npt

from ..dataset.netcdf import sync_folder, unwritable
from ..model.errors import InputError
from ..version import __version__
from .configuration import differences
from .packed import SCHEMA, Arrays, Damaged, pack, unpack
from .plan import Sweep

BLOCKS, FAILED, SWEEP = "blocks", "failed", "sweep.json"
MISSING = "missing"
"""What `Store.fault` says of a block that does not stand."""
STALE_SECONDS = 3600.0
"""Age at which a temporary file is certainly that of a writer that was killed."""

_NAME = re.compile(r"(\d{9})\.(?:nc|json)")
_TEMPORARY = re.compile(r"\..+\.(?P<host>[^.]+)\.(?P<process>\d+)\.[0-9a-f]+\.new")


class Store:
    """The store in an existing folder.

    Its files are checked whenever they are read. Raises `InputError` if there is no store at `path`, or
    its description was altered.
    """

    def __init__(self, path: str | os.PathLike[str]) -> None:
        self.path = Path(os.path.abspath(path))
        self.about = _read_json(self.path / SWEEP)
        if self.about.get("schema") != SCHEMA:
            rule = f"{SCHEMA}, the layout that this version reads"
            remedy = "use the version that wrote it"
            raise InputError(f"schema of {self.path}", self.about.get("schema"), rule, remedy)

    @classmethod
    def create(cls, path: str | os.PathLike[str], sweep: Sweep) -> Store:
        """Return the store of a sweep at `path`: a new one, or the one of the same sweep that stands there.

        Raises `InputError` if it is that of another sweep (with the difference), if anything else
        stands there, or if it cannot be written.
        """
        folder = Path(os.path.abspath(path))
        if not (folder / SWEEP).exists():
            _refuse_others(folder, sweep)
            try:
                folder.mkdir(parents=True, exist_ok=True)
            except OSError as error:
                raise unwritable(folder, error) from error
            _write_json(folder / SWEEP, _description(sweep))
        store = cls(folder)
        store.require(sweep)
        return store

    @cached_property
    def sweep(self) -> Sweep:
        """The sweep that is stored here. Raises `InputError` if its configuration means another by now."""
        sweep = Sweep.from_tables(self.about["configuration"], files=False)
        if sweep.digest != self.digest:
            rule = f"that of its configuration, {sweep.digest[:12]}..."
            remedy = f"use the version that wrote it, {self.about['versions'].get('cyclosis')}"
            raise InputError(f"digest of {self.path}", self.digest[:12] + "...", rule, remedy)
        return sweep

    @property
    def digest(self) -> str:
        """The digest of the sweep."""
        return str(self.about["digest"])

    def require(self, sweep: Sweep) -> None:
        """Raise `InputError`, saying where they differ, unless `sweep` is the one that is stored here."""
        if sweep.digest != self.digest:
            found = differences(self.about["configuration"], sweep.tables) or ["the meaning of a key differs"]
            more = f" and {len(found) - 6} more" if len(found) > 6 else ""
            rule = f"that of the store {self.path}: " + ", ".join(found[:6]) + more
            raise InputError("configuration", f"digest {sweep.digest[:12]}", rule, "choose another store")

    def path_of(self, index: int) -> Path:
        """Return where a block stands, or would."""
        return self.path / BLOCKS / f"{index // 1000:06d}" / f"{index:09d}.nc"

    def write(self, index: int, arrays: Mapping[str, npt.ArrayLike]) -> Path:
        """Write a block: an array (members, ...) for each of the sweep's variables. Return its file.

        The file appears whole or not at all, and replaces one that stood there. A reason why the block had
        been set aside goes. Raises `InputError` if it cannot be written; all that stood before stands.
        """
        data = pack(self.sweep, index, arrays)
        target = self.path_of(index)
        _write(target, data)
        with suppress(OSError):  # where the block stands, what is said of its failure counts no more
            self._failed(index).unlink(missing_ok=True)
        return target

    def read(self, index: int, names: Collection[str] | None = None) -> Arrays:
        """Return the variables of a block, or those named, after checking every byte of its file.

        Raises `InputError` if the block is missing or damaged.
        """
        try:
            return self._load(index, names)
        except Damaged as error:
            remedy = (
                f"find all such blocks with `cyclosis sweep verify {self.path}` and mend them with repair"
            )
            rule = f"a whole block of this sweep, but it is {error}"
            raise InputError(f"block {index}", str(self.path_of(index)), rule, remedy) from error

    def fault(self, index: int) -> str:
        """Return what is wrong with a block in a few words: nothing, `MISSING`, or how it is damaged."""
        try:
            self._load(index, ())
        except Damaged as error:
            return str(error)
        return ""

    def has(self, index: int) -> bool:
        """Return whether a block stands, damaged or not."""
        return self.path_of(index).exists()

    def present(self) -> set[int]:
        """Return the indices of the blocks that stand, damaged or not."""
        return self._indices(self.path / BLOCKS, ".nc")

    def missing(self) -> list[int]:
        """Return the indices of the blocks that do not stand, sorted."""
        standing = self.present()
        return [index for index in range(self.sweep.blocks) if index not in standing]

    def verify(self, progress: Callable[[int], None] | None = None) -> list[tuple[int, str]]:
        """Return every block that is missing or damaged, with what is wrong with it, sorted.

        Every byte of every block is read. `progress` is called with the number of blocks looked at.
        """
        standing, out = self.present(), []
        for index in range(self.sweep.blocks):
            wrong = self.fault(index) if index in standing else MISSING
            if wrong:
                out.append((index, wrong))
            if progress is not None:
                progress(index + 1)
        return out

    def discard(self, index: int) -> None:
        """Remove a block, and the reason why it was set aside. Raises `InputError` if that fails."""
        try:
            for path in (self.path_of(index), self._failed(index)):
                if path.exists():
                    path.unlink(missing_ok=True)
                    sync_folder(path.parent)
        except OSError as error:
            raise unwritable(self.path_of(index), error) from error

    def set_aside(self, index: int, reason: str) -> None:
        """Write down that a block could not be computed, and why. Raises `InputError` if that fails."""
        _write_json(self._failed(index), {"block": index, "reason": reason})

    def failed(self) -> dict[int, str]:
        """Return the blocks that were set aside and do not stand, with the reasons."""
        out = {}
        for index in sorted(self._indices(self.path / FAILED, ".json") - self.present()):
            try:
                out[index] = str(_read_json(self._failed(index)).get("reason"))
            except InputError:
                out[index] = "the reason cannot be read"
        return out

    def clean(self) -> int:
        """Remove what killed writers left half written, and return the number of files.

        That is temporary files of processes of this machine that are no more, and any that are an hour old;
        those of living writers stay.
        """
        stale = [path for path in self._temporaries() if _is_stale(path)]
        for path in stale:
            path.unlink(missing_ok=True)
        return len(stale)

    def _load(self, index: int, names: Collection[str] | None) -> Arrays:
        self.sweep.block(index)
        try:
            data = self.path_of(index).read_bytes()
        except FileNotFoundError as error:
            raise Damaged(MISSING) from error
        except OSError as error:
            raise Damaged(f"unreadable ({error.strerror or error})") from error
        return unpack(data, self.sweep, index, names)

    def _failed(self, index: int) -> Path:
        return self.path / FAILED / f"{index:09d}.json"

    def _indices(self, folder: Path, suffix: str) -> set[int]:
        found = (_NAME.fullmatch(name) for name, _ in _files(folder) if name.endswith(suffix))
        return {index for match in found if match and (index := int(match[1])) < self.sweep.blocks}

    def _temporaries(self) -> Iterator[Path]:
        for folder in (self.path / BLOCKS, self.path / FAILED):
            for name, place in _files(folder):
                if name.endswith(".new"):
                    yield Path(place)
        yield from self.path.glob(".*.new")


def _files(folder: Path) -> Iterator[tuple[str, str]]:
    """Yield name and path of every file in a folder and the folders in it."""
    try:
        with os.scandir(folder) as entries:
            for entry in entries:
                if entry.is_dir():
                    yield from _files(Path(entry.path))
                else:
                    yield entry.name, entry.path
    except FileNotFoundError:
        return


def _is_stale(path: Path) -> bool:
    named = _TEMPORARY.fullmatch(path.name)
    if named and named["host"] == _host() and not _alive(int(named["process"])):
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


def _host() -> str:
    return re.sub(r"[^A-Za-z0-9-]", "-", socket.gethostname()) or "-"


def _write(target: Path, data: bytes) -> None:
    """Write a file under a temporary name, sync it and rename it to `target`; folders are made if need be.

    Raises `InputError` if that fails; then no part of a file is left.
    """
    partial = target.with_name(f".{target.name}.{_host()}.{os.getpid()}.{secrets.token_hex(4)}.new")
    try:
        _make_folder(target.parent)
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


def _make_folder(folder: Path) -> None:
    """Make a folder of the store and those above it, durably."""
    if not folder.is_dir():
        _make_folder(folder.parent)
        folder.mkdir(exist_ok=True)
        sync_folder(folder.parent)


def _write_json(target: Path, content: Mapping[str, Any]) -> None:
    sealed = {**content, "sha256": _seal(content)}
    _write(target, (json.dumps(sealed, indent=1) + "\n").encode())


def _read_json(path: Path) -> dict[str, Any]:
    """Return what `_write_json` wrote. Raises `InputError` if there is no such file, or it was altered."""
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


def _description(sweep: Sweep) -> dict[str, Any]:
    return {
        "program": "cyclosis sweep",
        "schema": SCHEMA,
        "digest": sweep.digest,
        "configuration": sweep.tables,
        "versions": versions(),
        "created": datetime.now(UTC).isoformat(timespec="seconds"),
    }


def versions() -> dict[str, str]:
    """Return the versions of what computes and stores."""
    out = {"cyclosis": __version__, "python": platform.python_version()}
    for name in ("jax", "jaxlib", "numpy", "scipy"):
        try:
            out[name] = version(name)
        except PackageNotFoundError:
            continue
    return out


def _refuse_others(folder: Path, sweep: Sweep) -> None:
    """Raise `InputError` if a folder without description holds anything but blocks of this very sweep."""
    if folder.exists() and not folder.is_dir():
        raise InputError("store", str(folder), "a folder", "choose another name")
    if not folder.is_dir():
        return
    others = {entry.name for entry in folder.iterdir()} - {BLOCKS, FAILED}
    others = {name for name in others if not name.endswith(".new")}
    if others:
        rule = f"a new or empty folder, or a store, but it holds {min(others)}"
        raise InputError("store", str(folder), rule, "choose another folder")
    for name, path in _files(folder / BLOCKS):
        if match := _NAME.fullmatch(name):
            try:
                unpack(Path(path).read_bytes(), sweep, int(match[1]), ())
            except (Damaged, OSError) as error:
                rule = f"without a sweep.json only if its blocks are of this sweep, but {name} is {error}"
                raise InputError("store", str(folder), rule, "choose another folder") from error
            return
