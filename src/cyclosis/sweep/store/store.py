"""A store: the folder in which the blocks of a sweep are stored, one complete file per block.

    STORE/sweep.json                     the configuration, its digest, versions, when it was created
    STORE/blocks/000012/000012345.nc     block 12345: a classic NetCDF file that contains its checksum
    STORE/failed/000012345.json          why block 12345 could not be computed

A block is done if its file exists: there is no lock and no database, and no file is ever appended to. Any
number of processes on any number of machines may therefore write to one store, and any of them may die at any
time. Files are written under a temporary name, synced and renamed.
"""

from __future__ import annotations

import os
import platform
import re
import shlex
from collections.abc import Callable, Collection, Iterator, Mapping
from contextlib import suppress
from datetime import UTC, datetime
from functools import cached_property
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

import numpy.typing as npt

from ...dataset.whole import is_stale, sync_folder, unwritable
from ...display.shown import shown
from ...model.errors import InputError
from ...version import __version__
from ..plan.configuration import differences
from ..plan.sweep import Sweep
from .block_file import SCHEMA, Arrays, Damaged, pack, unpack
from .safe_files import files, make_folder, read_json, write, write_json

BLOCKS, FAILED, SWEEP = "blocks", "failed", "sweep.json"
MISSING = "missing"
"""What `Store.fault` returns for a block that is not in the store."""
_NAME = re.compile(r"(\d{9})\.(?:nc|json)")


@shown
class Store:
    """The store in an existing folder.

    Files are checked whenever they are read. Raises `InputError` if there is no store at `path`, or
    its description was altered.

    Example:
        >>> import cyclosis as cy
        >>> from cyclosis.sweep.store.block import compute
        >>> from cyclosis.sweep.store.store import Store
        >>> tables = {"axes": {"alpha_p": {"values": [0.01]}}, "ensemble": {"seeds": 2, "block": 1}}
        >>> sweep = cy.Sweep.from_tables(tables | {"grid": {"n_theta": 16, "n_z": 16}})
        >>> store = Store.create("store", sweep)
        >>> store.write(0, compute(sweep, 0)) == store.path_of(0)
        True
        >>> store.present(), store.missing(), store.has(0), store.fault(0)
        ({0}, [1], True, '')
        >>> int(store.read(0, ["regime"])["regime"][0])  # an index into cyclosis.REGIMES
        0
        >>> store.verify()
        [(1, 'missing')]
        >>> store.set_aside(1, "out of memory")
        >>> store.failed()
        {1: 'out of memory'}
        >>> store.discard(0)
        >>> store.present(), store.clean(), store.digest == sweep.digest == store.sweep.digest
        (set(), 0, True)
    """

    def __init__(self, path: str | os.PathLike[str]) -> None:
        self.path = Path(os.path.abspath(path))
        self.about = read_json(self.path / SWEEP)
        if self.about.get("schema") != SCHEMA:
            rule = f"{SCHEMA}, the layout that this version reads"
            remedy = "use the version that wrote it"
            raise InputError(f"schema of {self.path}", self.about.get("schema"), rule, remedy)

    def __repr__(self) -> str:
        return f"Store({str(self.path)!r}, {len(self.present())} of {self.sweep.blocks} blocks)"

    @classmethod
    def create(cls, path: str | os.PathLike[str], sweep: Sweep) -> Store:
        """Return the store of a sweep at `path`: a new one, or the existing one of the same sweep.

        Raises `InputError` if there is a store of another sweep (the message says where they differ) or
        anything else at `path`, or if it cannot be written.
        """
        folder = Path(os.path.abspath(path))
        if not (folder / SWEEP).exists():
            _refuse_others(folder, sweep)
            try:
                make_folder(folder)
            except OSError as error:
                raise unwritable(folder, error) from error
            write_json(folder / SWEEP, _description(sweep))
        store = cls(folder)
        store.require(sweep)
        return store

    @cached_property
    def sweep(self) -> Sweep:
        """The sweep that is stored here. Raises `InputError` if this version reads it as another sweep."""
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
        """Raise `InputError`, saying where they differ, unless `sweep` is the stored one.

        Example:
            >>> import cyclosis as cy
            >>> from cyclosis.sweep.store.store import Store
            >>> tables = {"axes": {"alpha_p": {"values": [0.01]}}, "ensemble": {"seeds": 2}}
            >>> store = Store.create("required", cy.Sweep.from_tables(tables))
            >>> store.require(cy.Sweep.from_tables(tables | {"ensemble": {"seeds": 3}}))
            Traceback (most recent call last):
                ...
            cyclosis.model.errors.InputError: configuration = 'digest ...' cannot be used: ...
        """
        if sweep.digest != self.digest:
            found = differences(self.about["configuration"], sweep.tables) or ["the meaning of a key differs"]
            more = f" and {len(found) - 6} more" if len(found) > 6 else ""
            rule = f"that of the store {self.path}: " + ", ".join(found[:6]) + more
            raise InputError("configuration", f"digest {sweep.digest[:12]}", rule, "choose another store")

    def path_of(self, index: int) -> Path:
        """Return the path of a block's file, whether it exists or not."""
        return self.path / BLOCKS / f"{index // 1000:06d}" / f"{index:09d}.nc"

    def write(self, index: int, arrays: Mapping[str, npt.ArrayLike]) -> Path:
        """Write a block, given an array (members, ...) for each of the sweep's variables. Return its path.

        The file is written completely or not at all, and replaces an older one. If the block had been set
        aside, the stored reason is removed. Raises `InputError` if the file cannot be written; an older file
        is then unchanged.
        """
        data = pack(self.sweep, index, arrays)
        target = self.path_of(index)
        write(target, data)
        with suppress(OSError):  # the reason is ignored once the block is there
            self._failed(index).unlink(missing_ok=True)
        return target

    def read(self, index: int, names: Collection[str] | None = None) -> Arrays:
        """Return the variables of a block, or only those named, after checking every byte of its file.

        Raises `InputError` if the block is missing or damaged.
        """
        try:
            return self._load(index, names)
        except Damaged as error:
            verify = shlex.join(["cyclosis", "sweep", "verify", str(self.path)])
            remedy = f"find all such blocks with `{verify}` and mend them with repair"
            rule = f"a whole block of this sweep, but it is {error}"
            raise InputError(f"block {index}", str(self.path_of(index)), rule, remedy) from error

    def fault(self, index: int) -> str:
        """Return what is wrong with a block in a few words: `MISSING`, how it is damaged, or ""."""
        try:
            self._load(index, ())
        except Damaged as error:
            return str(error)
        return ""

    def has(self, index: int) -> bool:
        """Return whether a block is in the store, damaged or not."""
        return self.path_of(index).exists()

    def present(self) -> set[int]:
        """Return the indices of the blocks in the store, damaged or not."""
        return self._indices(self.path / BLOCKS, ".nc")

    def missing(self) -> list[int]:
        """Return the sorted indices of the blocks that are not in the store."""
        present = self.present()
        return [index for index in range(self.sweep.blocks) if index not in present]

    def verify(self, progress: Callable[[int], None] | None = None) -> list[tuple[int, str]]:
        """Return every block that is missing or damaged, with what is wrong with it, sorted.

        Every byte of every block is read. `progress` is called with the number of blocks checked so far.
        """
        present, out = self.present(), []
        for index in range(self.sweep.blocks):
            wrong = self.fault(index) if index in present else MISSING
            if wrong:
                out.append((index, wrong))
            if progress is not None:
                progress(index + 1)
        return out

    def discard(self, index: int) -> None:
        """Remove a block and the reason why it was set aside. Raises `InputError` if that fails."""
        try:
            for path in (self.path_of(index), self._failed(index)):
                if path.exists():
                    path.unlink(missing_ok=True)
                    sync_folder(path.parent)
        except OSError as error:
            raise unwritable(self.path_of(index), error) from error

    def set_aside(self, index: int, reason: str) -> None:
        """Store the reason why a block could not be computed. Raises `InputError` if that fails."""
        write_json(self._failed(index), {"block": index, "reason": reason})

    def failed(self) -> dict[int, str]:
        """Return the blocks that were set aside and are not in the store, with the reasons."""
        out = {}
        for index in sorted(self._indices(self.path / FAILED, ".json") - self.present()):
            try:
                out[index] = str(read_json(self._failed(index)).get("reason"))
            except InputError:
                out[index] = "the reason cannot be read"
        return out

    def clean(self) -> int:
        """Remove incomplete files left by killed writers, and return their number.

        These are temporary files of processes of this machine that no longer run, and all that are more than
        an hour old; those of running writers are kept.
        """
        stale = [path for path in self._temporaries() if is_stale(path)]
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
        found = (_NAME.fullmatch(name) for name, _ in files(folder) if name.endswith(suffix))
        return {index for match in found if match and (index := int(match[1])) < self.sweep.blocks}

    def _temporaries(self) -> Iterator[Path]:
        for folder in (self.path / BLOCKS, self.path / FAILED):
            for name, place in files(folder):
                if name.endswith(".new"):
                    yield Path(place)
        yield from self.path.glob(".*.new")


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
    """Return the versions of the packages that compute and store, by name.

    Example:
        >>> from cyclosis.sweep.store.store import versions
        >>> sorted(versions())[:3]
        ['cyclosis', 'jax', 'jaxlib']
    """
    out = {"cyclosis": __version__, "python": platform.python_version()}
    for name in ("jax", "jaxlib", "numpy", "scipy"):
        try:
            out[name] = version(name)
        except PackageNotFoundError:
            continue
    return out


def _refuse_others(folder: Path, sweep: Sweep) -> None:
    """Raise `InputError` if a folder without description holds anything but blocks of this sweep."""
    if folder.exists() and not folder.is_dir():
        raise InputError("store", str(folder), "a folder", "choose another name")
    if not folder.is_dir():
        return
    others = {entry.name for entry in folder.iterdir()} - {BLOCKS, FAILED}
    others = {name for name in others if not name.endswith(".new")}
    if others:
        rule = f"a new or empty folder, or a store, but it holds {min(others)}"
        raise InputError("store", str(folder), rule, "choose another folder")
    for name, path in files(folder / BLOCKS):
        if match := _NAME.fullmatch(name):
            try:
                unpack(Path(path).read_bytes(), sweep, int(match[1]), ())
            except (Damaged, OSError) as error:
                rule = f"without a sweep.json only if its blocks are of this sweep, but {name} is {error}"
                raise InputError("store", str(folder), rule, "choose another folder") from error
            return
