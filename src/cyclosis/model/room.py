"""Memory of fields that nothing needs any longer, for results of the same kind.

A C library returns the memory of a large array to the system, which clears every page that it gives out
again: at 1024 x 1024 that takes about as long for each field as a Fourier transform on two cores. JAX writes
a result into the memory of an argument that is donated, also of one that the program does not read.
"""

from __future__ import annotations

import ctypes
import sys
from functools import cache
from typing import Any

import jax
import jax.numpy as jnp


class Room:
    """Arrays to be overwritten, by shape and type. They are as many as were needed at once."""

    def __init__(self) -> None:
        self._free: dict[Any, list[jax.Array]] = {}

    def take(self, kind: Any) -> jax.Array | None:
        """Return an array of this shape and type to donate, None for a number."""
        if not kind.shape:
            return None
        free = self._free.get((kind.shape, kind.dtype))
        return free.pop() if free else jnp.zeros(kind.shape, kind.dtype)

    def add(self, array: Any) -> None:
        """Keep an array that nothing else refers to. Numbers are not kept, nor is what is no array of JAX."""
        if isinstance(array, jax.Array) and array.shape and not array.weak_type:
            self._free.setdefault((array.shape, array.dtype), []).append(array)

    def clear(self) -> None:
        """Forget all arrays, and see that their memory goes back to the system."""
        self._free.clear()
        _trim()(0)


@cache
def _trim() -> Any:
    """Return the function of the GNU C library for this; others need none."""
    library = ctypes.CDLL(None) if sys.platform == "linux" else None
    return getattr(library, "malloc_trim", lambda _: None)
