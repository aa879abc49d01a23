"""Functions on their way to the workers of a cluster, and what they load there."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import cloudpickle
from dask.utils import SerializableLock

LOADING = SerializableLock("cyclosis loads its modules")
"""Held by a worker's thread that loads modules: two that load parts of one package at the same moment can see
each other's half-made ones. A process has one lock of this name, however many functions bring it along."""


def shipped(function: Callable[..., Any]) -> Callable[..., Any]:
    """Return the same function in a form that a scheduler can handle without having this package.

    A scheduler takes apart what it is given to pass on. An inner function goes by value, and what it holds
    are plain bytes, which a worker unpacks while it holds `LOADING`. The function may take the worker as its
    last argument, which Dask gives to what is run beside the tasks.
    """
    packed, loading = cloudpickle.dumps(function), LOADING

    def called(*arguments: Any, dask_worker: Any = None) -> Any:
        import pickle

        with loading:
            unpacked = pickle.loads(packed)
        return unpacked(*arguments) if dask_worker is None else unpacked(*arguments, dask_worker)

    return called
