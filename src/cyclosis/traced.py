"""The few functions that JAX may trace (jit, grad, vmap).

They take and return JAX arrays, and refuse float64 while JAX's x64 mode is off. Everything else in
the package takes and returns NumPy arrays, manages precision itself, and refuses traced values.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import numpy.typing as npt

from .dynamics.rollout import march, plan
from .model.arrays import numbers
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

__all__ = [
    "flow",
    "rate_of_change",
    "rollout",
    "system_of",
]


def __dir__() -> list[str]:
    return sorted(__all__)


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


@traced_door
def rollout(
    params: Parameters,
    grid: CylinderGrid,
    P0: Any,
    times: npt.ArrayLike,
    dt: float = 0.1,
    *,
    terms: Iterable[TermLike] | None = None,
    precision: str = "float64",
    closure: str = "paper",
    **values: Any,
) -> jax.Array:
    """Return P (n, 2, n_theta, n_z) at `times` (n,) of a run from P0 at t = 0, dimensionless (R/U).

    The steps are those of `simulate(stepper="etdrk4", dt=dt)`: an interval between two times is cut into
    equal steps no longer than dt. It can be differentiated in `values` and in P0 (2, n_theta, n_z), in
    reverse and forward mode, and mapped by `jax.vmap`; `times`, `dt` and `terms` are plain. In reverse mode
    every step is computed again, so that the memory is one spectrum per step: a gradient in any number of
    parameters and in all of P0 costs about as much as five runs. `values` and errors are those of
    `flow`, and `closure` that of `cyclosis.models.polar_model`. Raises `InputError` for times that are
    negative or do not increase. Neither |P| <= 1 nor the resolution is checked on the way.

    Example: how the speed that a cell has reached at t = 4 depends on three parameters and on its start.
        >>> import jax
        >>> import cyclosis as cy
        >>> params, grid = cy.Parameters(), cy.CylinderGrid(16, 16)
        >>> start = cy.initial.stripes(grid, magnitude=0.3)
        >>> def speed(values, P0):
        ...     P = cy.traced.rollout(params, grid, P0, [2.0, 4.0], precision="float32", **values)
        ...     u = cy.traced.flow(params, grid, P[-1], precision="float32", **values)
        ...     return (u**2).mean() ** 0.5
        >>> values = {"alpha_p": 1.0, "mu": 0.05, "kappa": 0.5}
        >>> by_values, by_start = jax.grad(speed, argnums=(0, 1))(values, jax.numpy.asarray(start))
        >>> by_start.shape, {name: round(float(slope), 3) for name, slope in by_values.items()}
        ((2, 16, 16), {'alpha_p': 0.047, 'kappa': 0.0, 'mu': -0.652})
    """
    steps = plan(_times(times), _plain("dt", dt, 1e-9, 1e3, "the default is 0.1"))
    system, spectrum = _prepared(params, grid, P0, terms, precision, values, closure)
    spectra = march(system, spectrum, steps, max(int(steps.counts.max()), 1))
    fields = jnp.fft.ifft2(spectra)
    return jnp.stack([fields.real, fields.imag], axis=1)


def _times(times: Any) -> npt.NDArray[np.float64]:
    rule, remedy = "a list of times from 0 on that increase", "sort them, and begin with 0 for P0 itself"
    if traced(times):
        raise InputError("times", times, "plain numbers, because the steps depend on them", "fix them")
    given = np.atleast_1d(numbers("times", times, rule, remedy))
    if given.ndim != 1 or not given.size or given[0] < 0 or not np.all(np.diff(given) > 0):
        raise InputError("times", given, rule, remedy)
    if not np.all(np.isfinite(given)):
        raise InputError("times", given, rule, remedy)
    return given


def _plain(name: str, value: Any, low: float, high: float, remedy: str) -> float:
    if traced(value):
        raise InputError(name, value, "a plain number, because the steps depend on it", "fix it")
    return number(name, value, low, high, remedy)


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
