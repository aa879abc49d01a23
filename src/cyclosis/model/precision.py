"""Double precision, and the host where it serves best, whatever the caller's JAX settings are."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import AbstractContextManager, contextmanager
from functools import cache
from typing import Any

import jax
import jax.numpy as jnp

from .errors import InputError


def double() -> AbstractContextManager[None]:
    """Return a context in which JAX computes in the precision of the arrays it is given."""
    context: AbstractContextManager[None] = jax.enable_x64(True)
    return context


@contextmanager
def on_host() -> Iterator[None]:
    """Compute in double precision on the host's processor, also where JAX has an accelerator.

    Problems of one dimension are too small for one: starting its programs would take all their time.
    """
    with double(), jax.default_device(_processor()):
        yield


@cache
def _processor() -> Any:
    """Return the host's processor as a device, or None (JAX's default) where JAX must not use it."""
    try:
        return jax.devices("cpu")[0]
    except RuntimeError:
        return None


def require_double(precision: str) -> None:
    """Raise `InputError` if a function that is being traced cannot have the precision asked for."""
    if precision == "float64" and jnp.result_type(float) != jnp.float64:
        raise InputError(
            "precision",
            precision,
            "float32 while JAX's x64 mode is off",
            "call jax.config.update('jax_enable_x64', True) first",
        )
