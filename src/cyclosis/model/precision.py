"""Double precision, and computing on the host where that is best, whatever the caller's JAX settings are."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import AbstractContextManager, contextmanager
from functools import cache
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from .devices import require_devices
from .errors import InputError
from .forks import refuse_fork
from .programs import keep_programs


def double() -> AbstractContextManager[None]:
    """Return a context in which JAX computes in the precision of the arrays it is given.

    Every computation runs in it. Raises `ForkedError` in a forked process. Raises `InputError` inside
    `jax.jit`, where results would be traced, and if JAX has no device of the platform it must use.
    """
    refuse_fork()
    keep_programs()
    config: Any = jax.config
    if config.jax_default_device is None:  # on the host no other device is needed
        require_devices()
    if isinstance(_zero(), jax.core.Tracer):
        raise InputError(
            "the place of this call",
            "inside jax.jit",
            "outside, because the result would be a traced value",
            "call it first and pass on its result, or use the functions of cyclosis.traced",
        )
    context: AbstractContextManager[None] = jax.enable_x64(True)
    return context


@jax.jit
def _zero() -> Any:
    """Return a number that is traced where everything is. Compiled, it takes a quarter of the time."""
    return 0.0


@contextmanager
def on_host() -> Iterator[None]:
    """Compute in double precision on the host's processor, also where JAX has an accelerator.

    One-dimensional problems are too small for one: most of the time would go into starting its programs.
    """
    with jax.default_device(_processor()), double():
        yield


@cache
def _processor() -> Any:
    """Return the host's processor as a device, or None (JAX's default) where JAX must not use it."""
    try:
        return jax.devices("cpu")[0]
    except RuntimeError:
        return None


def dtypes(precision: str) -> tuple[type[np.floating[Any]], type[np.complexfloating[Any, Any]]]:
    """Return the real and the complex type of a precision."""
    return (np.float64, np.complex128) if precision == "float64" else (np.float32, np.complex64)


def require_double(precision: str) -> None:
    """Raise `InputError` if a function that is being traced cannot have the requested precision."""
    refuse_fork()
    if precision == "float64" and jnp.result_type(float) != jnp.float64:
        raise InputError(
            "precision",
            precision,
            "float32 while JAX's x64 mode is off",
            "call jax.config.update('jax_enable_x64', True) first",
        )
