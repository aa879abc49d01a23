"""Parameters, grid and terms made ready for computing, and the functions of a state.

`System` is a traceable value: its numbers are arrays, so that changing one never recompiles; what is
compiled in is only the shape, the dealiasing, the selection of terms and whether the force is cubic.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import numpy.typing as npt

from . import filaments, hydrodynamics, spectral
from .errors import InputError
from .filaments import Term, TermLike
from .grid import Array, CylinderGrid, interpolate
from .hydrodynamics import FlowOperator
from .moment import Moment, Values
from .parameters import Parameters
from .precision import double
from .spectral import Space


@dataclass(frozen=True)
class System:
    """The right-hand side of one cell: dP/dt = linear P + nonlinear(P) in packed Fourier space.

    `split` says that the linear terms are kept apart, for steppers that treat them exactly.
    """

    space: Space
    values: Values
    operator: FlowOperator
    terms: tuple[Term, ...]
    cubic: bool
    grid: CylinderGrid | None
    split: bool = True

    def at(self, spectrum: jax.Array, time: Any = 0.0) -> Moment:
        """Return the `Moment` of a packed spectrum."""
        return Moment(time, spectrum, self.values, self.space, self.operator, self.cubic, self.grid)

    def with_values(self, values: Values) -> System:
        """Return the same system with other values of the couplings.

        Those that are built into its operators (μ and the flux condition) must be the same.
        """
        return replace(self, values=values)

    def linear(self) -> jax.Array:
        """Return the real symbol of the linear part, shape (n_theta, n_z); zero if not `split`."""
        symbol = filaments.linear_symbol(self.at(self.space.k2), self.terms)
        return symbol if self.split else jnp.zeros_like(symbol)

    def nonlinear(self, now: Moment) -> jax.Array:
        """Return the spectrum of the rest of dP/dt."""
        rest = filaments.nonlinear(now, self.terms)
        return rest if self.split else rest + filaments.linear_symbol(now, self.terms) * now.spectrum

    def rate(self, now: Moment) -> jax.Array:
        """Return the spectrum of dP/dt."""
        return self.linear() * now.spectrum + self.nonlinear(now)

    def spectrum(self, state: npt.ArrayLike) -> npt.NDArray[np.complexfloating[Any, Any]]:
        """Return the packed spectrum of a state (2, n_theta, n_z) without its Nyquist modes."""
        packed = np.fft.fft2(spectral.pack(np.asarray(state, dtype=np.float64)))
        return (packed * np.asarray(self.space.keep)).astype(self.space.packed)

    def state(self, spectrum: npt.ArrayLike) -> Array:
        """Return the state (2, n_theta, n_z) of a packed spectrum."""
        field = np.fft.ifft2(np.asarray(spectrum, dtype=np.complex128))
        return np.stack([field.real, field.imag])


jax.tree_util.register_dataclass(
    System, data_fields=["space", "values", "operator"], meta_fields=["terms", "cubic", "grid", "split"]
)


def system(
    params: Parameters,
    grid: CylinderGrid,
    terms: Iterable[TermLike] | None = None,
    dealias: str = "none",
    precision: str = "float64",
    split: bool = True,
    traced: dict[str, Any] | None = None,
) -> System:
    """Return the `System` of a cell.

    `traced` overrides parameters with values that JAX traces (numbers only). Raises `InputError` when
    field-valued parameters do not match the grid.
    """
    if params.shape not in (None, grid.shape):
        raise InputError(
            "shape of the parameter fields",
            params.shape,
            f"that of the grid, {grid.shape}",
            "give the fields on the grid that is used",
        )
    chosen = filaments.select_terms(terms)
    space = spectral.space(grid, dealias, precision)
    given = dict(params.items()) | (traced or {})
    values = _values(given, space, precision, jnp if traced else np)
    operator = hydrodynamics.flow_operator(space, values.mu, values.zero_theta_flux)
    custom = any(term.kind == "custom" for term in chosen)
    return System(
        space,
        values,
        operator,
        chosen,
        cubic=not (traced and "force_exponent" in traced) and params.force_exponent == 2,
        grid=grid.resized(*space.fine) if custom else None,
        split=split,
    )


def _values(given: dict[str, Any], space: Space, precision: str, xp: Any) -> Values:
    real, packed = spectral.dtypes(precision)
    mirror = given["kappa"] * xp.exp(2j * given["repulsion_angle"])

    def placed(value: Any) -> Any:
        if np.ndim(value) == 0:
            return xp.asarray(value, packed if xp.iscomplexobj(value) else real)
        if xp.iscomplexobj(value):
            fine = interpolate(np.stack([value.real, value.imag]), space.fine)
            return spectral.pack(fine).astype(packed)
        return interpolate(value, space.fine).astype(real)

    return Values(**{name: placed(value) for name, value in given.items()}, kappa_mirror=placed(mirror))


@jax.jit
def _rate_of_change(system: System, spectrum: Any, time: Any) -> Any:
    return system.rate(system.at(spectrum, time))


@jax.jit
def _flow(system: System, spectrum: Any) -> Any:
    return system.at(spectrum).flow_spectrum


def flow(params: Parameters, grid: CylinderGrid, state: npt.ArrayLike, dealias: str = "none") -> Array:
    """Return the flow u that a state drives, shape (2, n_theta, n_z), dimensionless (units of U).

        -μ ∇²u + u + Π₀ e_z + ∇Π' = |P|ⁿ P,   ∇·u = 0,   <u_z> = 0

    Raises `InputError` if state or parameter fields do not match the grid. Source: Woodhouse &
    Goldstein 2013.
    """
    P = grid.check_state(state)
    cell = system(params, grid, dealias=dealias)
    with double():
        return cell.state(_flow(cell, cell.spectrum(P)))


def rate_of_change(
    params: Parameters,
    grid: CylinderGrid,
    state: npt.ArrayLike,
    time: float = 0.0,
    terms: Iterable[TermLike] | None = None,
    dealias: str = "none",
) -> Array:
    """Return dP/dt of a state, shape (2, n_theta, n_z), dimensionless (per R/U).

    The same right-hand side that `simulate` integrates; `terms` selects from it (see `Term`). Raises
    `InputError` if state or parameter fields do not match the grid.
    """
    P = grid.check_state(state)
    cell = system(params, grid, terms, dealias)
    with double():
        return cell.state(_rate_of_change(cell, cell.spectrum(P), float(time)))
