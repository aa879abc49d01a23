"""The filament equation and the flow on a closed surface, prepared for computing.

    dP/dt + ε ∇_u P = d⁽ˢ⁾ Lap_B P - d⁽ʳ⁾ P + (I - PP)·[ε ∇_P u + α_p P + α_u u - κ M P]
    -2 μ div D(u) + u + ∇Π = |P|ⁿ P,   ∇·u = 0

in covariant derivatives. Terms, torques and custom terms are those of the polar model; only what they are
evaluated on differs. Lap_B is the Bochner Laplacian: filaments wander with parallel transport of their
directions, and |P| <= 1 stays so. A rigid rotation costs no viscosity. M stands for (P·d) d: see
`REPULSIONS`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import cached_property
from typing import Any, ClassVar

import jax
import jax.numpy as jnp
import numpy as np
import numpy.typing as npt

from ..model import filaments, spectral
from ..model.definitions import definition
from ..model.errors import InputError, choice
from ..model.filaments import Term, TermLike
from ..model.moment import Moment, Values
from ..model.parameters import Parameters
from ..model.precision import double, dtypes
from ..model.system import System
from .grid import Array, ClosedGrid
from .space import ClosedSpace, closed_space

PRINCIPAL = "principal"


def _principal(k_theta: Array, k_s: Array) -> tuple[Array, Array]:
    """Return M_θθ and M_ss of M = (k_1² - k_2²) d d, with d the direction of the larger curvature k_1."""
    excess = k_theta**2 - k_s**2
    return np.maximum(excess, 0.0), np.maximum(-excess, 0.0)


def _polynomial(k_theta: Array, k_s: Array) -> tuple[Array, Array]:
    """Return those of M = B² - K I, a polynomial in the shape operator B."""
    apart = k_theta - k_s
    return k_theta * apart, -k_s * apart


def _bounded(k_theta: Array, k_s: Array) -> tuple[Array, Array]:
    """Return those of M = d d (k_1² - k_2²)/(k_1² + k_2²), which is at most 1."""
    share: Array = (k_theta**2 - k_s**2) / (k_theta**2 + k_s**2)
    return np.maximum(share, 0.0), np.maximum(-share, 0.0)


REPULSIONS: dict[str, Callable[[Array, Array], tuple[Array, Array]]] = {
    PRINCIPAL: _principal,
    "polynomial": _polynomial,
    "bounded": _bounded,
}
"""How M follows from the curvatures, in units of 1/R. Each is d d on a cylinder of radius R and 0 where both
curvatures are equal, as at the poles: there no direction is more curved than another."""


class ClosedMoment(Moment):
    """The fields of one instant on a closed surface; `flow_spectrum` holds amplitudes of the flow modes."""

    fuses = False
    space: Any

    @cached_property
    def latitudes(self) -> jax.Array:
        """P of every m as a function of the latitude."""
        return self.space.to_latitudes(self.spectrum)

    @cached_property
    def flow_latitudes(self) -> jax.Array:
        """The flow of every m as a function of the latitude."""
        return self.space.flow_to_latitudes(self.flow_spectrum)

    @cached_property
    def p(self) -> jax.Array:
        """P_theta + i P_s."""
        return self.space.to_points(self.latitudes)

    @cached_property
    def force_spectrum(self) -> jax.Array:
        """The force on every flow mode, ∫ v·F."""
        return self.space.flow_amplitudes(self.force)

    @cached_property
    def flow_spectrum(self) -> jax.Array:
        """The amplitudes of the flow modes."""
        operator: jax.Array = self.operator  # type: ignore[assignment]
        return operator * self.force_spectrum

    @cached_property
    def u(self) -> jax.Array:
        """u_theta + i u_s."""
        return self.space.to_points(self.flow_latitudes)

    @cached_property
    def p_gradient(self) -> tuple[jax.Array, jax.Array]:
        """The covariant derivatives of P in the directions theta and s."""
        return self.space.derivatives(self.latitudes)

    @cached_property
    def u_gradient(self) -> tuple[jax.Array, jax.Array]:
        """The covariant derivatives of u in the directions theta and s."""
        return self.space.derivatives(self.flow_latitudes)


@dataclass(frozen=True)
class ClosedSystem(System):
    """The right-hand side on a closed surface, in modes of shape (2, M + 1, J) as in `space`.

    `space` is a `ClosedSpace`, and `operator` (M + 1, K) is 1/(1 + μ β) of the flow modes.
    """

    space: Any
    operator: Any
    moment: ClassVar[type[Moment]] = ClosedMoment

    def operator_of(self, values: Values) -> Any:
        """Return 1/(1 + μ β) of the flow modes."""
        return 1.0 / (1.0 + values.mu * self.space.viscous)

    def size(self, spectrum: jax.Array) -> jax.Array:
        """Return <|P|²>^½ of modes, or the same of a rate or an error: the harmonics are orthonormal."""
        square = jnp.sum(jnp.abs(spectrum) ** 2, dtype=jnp.float64)
        return jnp.sqrt(2 * np.pi / self.space.area * square)

    def spectrum(self, state: npt.ArrayLike) -> npt.NDArray[np.complexfloating[Any, Any]]:
        """Return the modes of a state (2, n_theta, n_s): its projection on the harmonics."""
        field = spectral.pack(np.asarray(state, dtype=np.float64))
        with double():
            return np.asarray(_projected(self.space, field)).astype(self.space.packed)

    def reported(self, spectrum: Any) -> Any:
        """Return the modes: none is left out."""
        return spectrum

    def state(self, spectrum: npt.ArrayLike) -> Array:
        """Return the state (2, n_theta, n_s) of modes."""
        return vector(self.space, spectrum)


jax.tree_util.register_dataclass(
    ClosedSystem,
    data_fields=["space", "values", "operator", "ramp", "drag"],
    meta_fields=["terms", "cubic", "grid", "split", "closure", "together"],
)

_projected = jax.jit(ClosedSpace.to_spectrum)
_physical = jax.jit(ClosedSpace.to_physical)
_flowing = jax.jit(lambda space, flow: space.to_points(space.flow_to_latitudes(flow)))


def vector(space: ClosedSpace, modes: npt.ArrayLike) -> Array:
    """Return the vector field (2, n_theta, n_s) of a state's modes."""
    with double():
        field = np.asarray(_physical(space, np.asarray(modes)), dtype=np.complex128)
    return np.stack([field.real, field.imag])


def flow_vector(space: ClosedSpace, amplitudes: npt.ArrayLike) -> Array:
    """Return the flow (2, n_theta, n_s) of amplitudes of the flow modes."""
    with double():
        field = np.asarray(_flowing(space, np.asarray(amplitudes)), dtype=np.complex128)
    return np.stack([field.real, field.imag])


def closed_system(
    params: Parameters,
    grid: ClosedGrid,
    terms: Iterable[TermLike] | None = None,
    precision: str = "float64",
    split: bool = True,
    cubic: bool | None = None,
    repulsion: str = PRINCIPAL,
) -> ClosedSystem:
    """Return the `ClosedSystem` of a cell; `repulsion` names one of `REPULSIONS`.

    Raises `InputError` for parameters that have no meaning on a closed surface, and for fields of another
    grid.
    """
    refuse(params, grid)
    choice("repulsion", repulsion, tuple(REPULSIONS))
    precision = definition("run", "precision").check(precision)
    chosen: tuple[Term, ...] = filaments.select_terms(terms)
    space = closed_space(grid, precision)
    values = _values(params, grid, precision, repulsion)
    return ClosedSystem(
        space,
        values,
        1.0 / (1.0 + values.mu * space.viscous),
        chosen,
        cubic=params.force_exponent == 2 if cubic is None else cubic,
        grid=grid if any(term.kind == "custom" for term in chosen) else None,  # type: ignore[arg-type]
        split=split,
    )


def refuse(params: Parameters, grid: ClosedGrid) -> None:
    """Raise `InputError` for parameters that a closed surface cannot have, or fields of another grid."""
    if np.any(np.asarray(params.repulsion_angle) != 0):
        rule = "0 on a closed surface: the repulsive direction is that of the larger curvature"
        raise InputError("repulsion_angle", params.repulsion_angle, rule, "leave it out")
    if params.zero_theta_flux:
        rule = "false on a closed surface, where the torque on the cell is balanced instead"
        raise InputError("zero_theta_flux", True, rule, "leave it out")
    for name, value in params.items():
        if np.ndim(value) and np.shape(value) != grid.shape:
            rule = f"one number, or an array of shape {grid.shape} (theta, s)"
            raise InputError(name, value, rule, "give a field on the grid of the run")


def _values(params: Parameters, grid: ClosedGrid, precision: str, repulsion: str) -> Values:
    """Return the couplings, with -κ M P packed as -(κ₁ p + κ₂ p*)/2 in `kappa` and `kappa_mirror`."""
    real, packed = dtypes(precision)
    at = grid.meridian
    around, along = REPULSIONS[repulsion](at.k_theta, at.k_s)
    given = dict(params.items())
    kappa = np.asarray(given["kappa"])
    given["kappa"], mirror = kappa * (around + along), kappa * (around - along)
    values = {name: np.asarray(value, real) for name, value in given.items()}
    return Values(**values, kappa_mirror=np.asarray(mirror, packed))
