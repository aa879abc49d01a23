"""The few functions that JAX may trace (jit, grad, vmap).

They take and return JAX arrays, and refuse float64 while JAX's x64 mode is off. Everything else in
the package takes and returns NumPy arrays, manages precision itself, and refuses traced values.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import jax
import jax.numpy as jnp

from .model.carried import traced
from .model.definitions import definition
from .model.doors import traced_door
from .model.errors import InputError, number
from .model.filaments import TermLike
from .model.grid import CylinderGrid
from .model.parameters import Parameters
from .model.precision import require_double
from .model.spectral import pack, unpack
from .model.system import System
from .model.system import system as system_of


@traced_door
def flow(
    params: Parameters, grid: CylinderGrid, P: Any, *, precision: str = "float64", **values: Any
) -> jax.Array:
    """Return the flow u of a state P, both (2, n_theta, n_z), dimensionless.

    `values` override parameters by values that JAX traces, for example `alpha_u=x` inside `jax.grad`: one
    number each, or a field (n_theta, n_z) where `Parameters` takes one. Raises `InputError` in float64 with
    x64 off, for unknown parameters, and for values that do not match the grid.

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
    system, spectrum = _prepared(params, grid, P, None, precision, values)
    return unpack(jnp.fft.ifft2(system.at(spectrum).flow_spectrum))


@traced_door
def rate_of_change(
    params: Parameters,
    grid: CylinderGrid,
    P: Any,
    time: Any = 0.0,
    *,
    terms: Iterable[TermLike] | None = None,
    precision: str = "float64",
    closure: str = "paper",
    **values: Any,
) -> jax.Array:
    """Return dP/dt of a state P, both (2, n_theta, n_z), dimensionless; `values` and errors as in `flow`.

    `closure` is that of `cyclosis.models.polar_model`.

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
    now = time if traced(time) else number("time", time, -1e12, 1e12, "the default is 0")
    system, spectrum = _prepared(params, grid, P, terms, precision, values, closure)
    return unpack(jnp.fft.ifft2(system.rate(system.at(spectrum, now))))


def _prepared(
    params: Parameters,
    grid: CylinderGrid,
    P: Any,
    terms: Iterable[TermLike] | None,
    precision: str,
    values: dict[str, Any],
    closure: str = "paper",
) -> tuple[System, jax.Array]:
    require_double(precision)
    free = [name for name, value in params.items() if not isinstance(value, bool)]
    for name in values:
        if name not in free:
            raise InputError("parameter", name, "one of " + ", ".join(free), "check the spelling")
    overridden = {
        name: _traced_parameter(name, value, grid) for name, value in values.items() if traced(value)
    }
    params = params.replace(**{name: value for name, value in values.items() if name not in overridden})
    system = system_of(params, grid, terms, precision=precision, traced=overridden, closure=closure)
    p = pack(_state(P, grid) if traced(P) else grid.check_state(P, "P"))
    return system, jnp.fft.fft2(p).astype(system.space.packed) * system.space.keep


def _traced_parameter(name: str, value: Any, grid: CylinderGrid) -> jax.Array:
    """Return a traced parameter as one array, or raise `InputError` for a shape that no parameter has."""
    array = _stacked(name, value)
    field = definition("parameters", name).field
    if array.shape != () and not (field and array.shape == grid.shape):
        rule = f"one number, or a field of shape {grid.shape}" if field else "one number"
        raise InputError(name, array.shape, f"of the shape of {rule}", "map over several by jax.vmap")
    return array


def _state(P: Any, grid: CylinderGrid) -> jax.Array:
    array = _stacked("P", P)
    if array.shape != (2, *grid.shape):
        raise InputError("P", array.shape, f"of shape {(2, *grid.shape)}", "make state and grid match")
    return array


def _stacked(name: str, value: Any) -> jax.Array:
    """Return a traced value, or a list that contains traced values, as one array of real numbers."""
    try:
        array = jnp.asarray(value)
    except (TypeError, ValueError) as error:
        raise InputError(name, value, "one array of real numbers", "stack its parts") from error
    if not jnp.issubdtype(array.dtype, jnp.floating) and not jnp.issubdtype(array.dtype, jnp.integer):
        raise InputError(name, str(array.dtype), "of real numbers", "take its real part")
    return array
