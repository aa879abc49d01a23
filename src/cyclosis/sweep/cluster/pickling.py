"""Serialising functions for the workers of a cluster, and loading modules there under a lock."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import cloudpickle
from dask.utils import SerializableLock

LOADING = SerializableLock("cyclosis loads its modules")
"""Held by a worker's thread that loads modules: two threads that load parts of one package at the same time
can see each other's incomplete modules. A process has one lock of this name, shared by all functions."""


def shipped(function: Callable[..., Any]) -> Callable[..., Any]:
    """Return the same function in a form that a scheduler can handle without having this package installed.

    A scheduler deserialises part of what it passes on. An inner function is pickled by value, and contains
    only plain bytes, which a worker unpickles while it holds `LOADING`. The function may take the worker as
    its last argument, which Dask passes to functions that run outside tasks.
    """
    packed, loading = cloudpickle.dumps(function), LOADING

    def called(*arguments: Any, dask_worker: Any = None) -> Any:
        import pickle

        with loading:
            unpacked = pickle.loads(packed)
        return unpacked(*arguments) if dask_worker is None else unpacked(*arguments, dask_worker)

    return called
