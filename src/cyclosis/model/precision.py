"""Double precision whatever the caller's JAX settings are."""

from __future__ import annotations

from contextlib import AbstractContextManager

import jax
import jax.numpy as jnp

from .errors import InputError


def double() -> AbstractContextManager[None]:
    """Return a context in which JAX computes in the precision of the arrays it is given."""
    context: AbstractContextManager[None] = jax.enable_x64(True)
    return context


def require_double(precision: str) -> None:
    """Raise `InputError` if a function that is being traced cannot have the precision asked for."""
    if precision == "float64" and jnp.result_type(float) != jnp.float64:
        raise InputError(
            "precision",
            precision,
            "float32 while JAX's x64 mode is off",
            "call jax.config.update('jax_enable_x64', True) first",
        )
