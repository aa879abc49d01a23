"""The few functions that are meant to be traced by JAX (jit, grad, vmap).

They take and return JAX arrays, and refuse float64 while JAX's x64 mode is off. Everything else in
the package takes and returns NumPy arrays and manages precision itself.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import jax
import jax.numpy as jnp

from .model.errors import InputError
from .model.filaments import TermLike
from .model.grid import CylinderGrid
from .model.parameters import Parameters
from .model.precision import require_double
from .model.spectral import unpack
from .model.system import System, system


def flow(
    params: Parameters, grid: CylinderGrid, P: Any, *, precision: str = "float64", **values: Any
) -> jax.Array:
    """Return the flow u of a state P, both (2, n_theta, n_z), dimensionless.

    `values` override parameters by numbers that JAX traces, for example `alpha_u=x` inside `jax.grad`.
    Raises `InputError` in float64 with x64 off, and for unknown parameters.

    Example:
        >>> import jax
        >>> import cyclosis as cy
        >>> params, grid = cy.Parameters(), cy.CylinderGrid(16, 16)
        >>> P = cy.initial.stripes(grid)
        >>> def power(mu):
        ...     return (cy.traced.flow(params, grid, P, precision="float32", mu=mu) ** 2).mean()
        >>> bool(jax.grad(power)(0.05) < 0)  # the more viscous, the slower
        True
    """
    cell, spectrum = _prepared(params, grid, P, None, precision, values)
    return unpack(jnp.fft.ifft2(cell.at(spectrum).flow_spectrum))


def rate_of_change(
    params: Parameters,
    grid: CylinderGrid,
    P: Any,
    time: Any = 0.0,
    *,
    terms: Iterable[TermLike] | None = None,
    precision: str = "float64",
    **values: Any,
) -> jax.Array:
    """Return dP/dt of a state P, both (2, n_theta, n_z), dimensionless; `values` and errors as in `flow`.

    Example:
        >>> import jax
        >>> import cyclosis as cy
        >>> params, grid = cy.Parameters(), cy.CylinderGrid(16, 16)
        >>> P = cy.initial.unidirectional(grid, 0.1)
        >>> def rate(x):  # of P_z = 0.1: α_p adds α_p (1 - P_z²) P_z
        ...     return cy.traced.rate_of_change(params, grid, P, precision="float32", alpha_p=x)[1].mean()
        >>> round(float(jax.grad(rate)(1.0)), 4)
        0.099
    """
    cell, spectrum = _prepared(params, grid, P, terms, precision, values)
    return unpack(jnp.fft.ifft2(cell.rate(cell.at(spectrum, time))))


def _prepared(
    params: Parameters,
    grid: CylinderGrid,
    P: Any,
    terms: Iterable[TermLike] | None,
    precision: str,
    values: dict[str, Any],
) -> tuple[System, jax.Array]:
    require_double(precision)
    free = [name for name, value in params.items() if not isinstance(value, bool)]
    for name in values:
        if name not in free:
            raise InputError("parameter", name, "one of " + ", ".join(free), "check the spelling")
    if jnp.shape(P) != (2, *grid.shape):
        raise InputError("P", jnp.shape(P), f"of shape {(2, *grid.shape)}", "make state and grid match")
    cell = system(params, grid, terms, precision=precision, traced=values)
    return cell, jnp.fft.fft2(P[0] + 1j * P[1]).astype(cell.space.packed) * cell.space.keep
