"""The task of a worker: compute one block from the store's configuration, and write it to the store."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import lru_cache
from typing import Any

import numpy as np

from ...model.errors import InputError
from ...version import __version__
from ..plan.sweep import Sweep
from ..store.block_file import Arrays
from ..store.store import Store
from .pickling import LOADING

Compute = Callable[[Sweep, int], Arrays]


@dataclass(frozen=True)
class Report:
    """What a worker reports about a block; the block itself is in the store.

    `regimes` and `statuses` count members by name, `seconds` is the wall time of the block. `failure` says
    why it could not be computed, `obstacle` why nothing can be stored; both are empty on success.
    """

    index: int
    regimes: dict[str, int] = field(default_factory=dict)
    statuses: dict[str, int] = field(default_factory=dict)
    seconds: float = 0.0
    failure: str = ""
    obstacle: str = ""


@dataclass(frozen=True)
class BlockTask:
    """Computes blocks of the sweep in a store, one per call, and writes them there.

    `digest` is that of the sweep and `version` that of this package, so that a worker does not write to
    another store under the same path, or compute with another version. `compute` replaces the usual function.
    """

    folder: str
    digest: str
    compute: Compute | None = None
    version: str = __version__

    def __call__(self, index: int) -> Report:
        """Compute a block unless it is in the store, and return a report."""
        began = time.perf_counter()
        try:
            store, sweep = _opened(self.folder, self.digest, self.version)
        except InputError as error:
            return Report(index, obstacle=str(error))
        if store.has(index):
            return Report(index)
        arrays = None
        try:
            arrays = (self.compute or _usual())(sweep, index)
            store.write(index, arrays)
        except Exception as error:
            if arrays is not None and isinstance(error, InputError):  # the store cannot be written
                return Report(index, obstacle=str(error))
            return Report(index, seconds=time.perf_counter() - began, failure=described(error))
        regimes, statuses = (counted(sweep, arrays, name) for name in ("regime", "status"))
        return Report(index, regimes, statuses, time.perf_counter() - began)


def described(error: BaseException) -> str:
    """Return a description of an exception in one line."""
    if isinstance(error, InputError):
        return str(error)
    return " ".join(f"{type(error).__name__}: {error}".split())[:500]


def counted(sweep: Sweep, arrays: Mapping[str, Any], name: str) -> dict[str, int]:
    """Return how many members have each value of a coded variable, `regime` or `status`."""
    names = next(item.codes for item in sweep.variables if item.name == name)
    codes, counts = np.unique(arrays[name], return_counts=True)
    return {names[code]: int(count) for code, count in zip(codes, counts, strict=True) if code >= 0}


def _usual() -> Compute:
    with LOADING:
        from ..store.block import compute  # loads JAX, which a client does not need

    return compute


@lru_cache(maxsize=4)
def _opened(folder: str, digest: str, version: str) -> tuple[Store, Sweep]:
    if version != __version__:
        raise InputError(
            "version of cyclosis on a worker", __version__, version, "install the same everywhere"
        )
    store = Store(folder)
    if store.digest != digest:
        raise InputError("store", folder, "the one that the client sees", "let all of them reach one folder")
    return store, store.sweep
