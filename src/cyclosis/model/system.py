"""Parameters, grid and terms prepared for computing, and the functions of a state.

`System` is a traceable value: its numbers are arrays, so that changing one never recompiles; what is
compiled in is only the shape, the dealiasing, the selection of terms, the closure and whether the force is
cubic.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from typing import Any, ClassVar, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
import numpy.typing as npt

from . import closures, filaments, hydrodynamics, interior, relaxation, spectral
from .closures import PAPER
from .definitions import definition
from .doors import door
from .errors import number
from .filaments import Term, TermLike
from .grid import Array, CylinderGrid, interpolate
from .hydrodynamics import FlowOperator
from .moment import Moment, Values
from .parameters import Parameters
from .precision import double, dtypes
from .real_arithmetic import in_real_arithmetic
from .spectral import Space, dot
from .transforms_together import transforms_together

SMALL = 32 * 32
"""Points up to which complex arithmetic stays: compiling pairs of real arrays takes longer than they save."""


class Ramp(NamedTuple):
    """Values that change linearly in time, by name: those of the system at `begin`, `target` at `end`."""

    begin: dict[str, Any]
    end: dict[str, Any]
    target: dict[str, Any]


@dataclass(frozen=True)
class System:
    """The right-hand side of one cell: dP/dt = linear P + nonlinear(P) in packed Fourier space.

    `split` says that the linear terms are kept separate, for steppers that treat them exactly. With a `ramp`
    some of the values depend on time; the linear part then has the stronger diffusion of the two ends, and
    the excess is subtracted in the nonlinear part, so that a stepper keeps its order. `drag` (n_theta, n_z)
    is the resistance of the vacuole to each wave of the flow, or None without it. `together` says that
    transforms run in batches, which takes less time on few points: see `transforms_together`.
    """

    space: Space
    values: Values
    operator: FlowOperator
    terms: tuple[Term, ...]
    cubic: bool
    grid: CylinderGrid | None
    split: bool = True
    ramp: Ramp | None = None
    closure: str = PAPER
    drag: Any = None
    together: bool = False
    moment: ClassVar[type[Moment]] = Moment

    def at(self, spectrum: jax.Array, time: Any = 0.0) -> Moment:
        """Return the `Moment` of a packed spectrum."""
        values, operator = self.couplings(time)
        space, closure = self.space, self.closure
        return self.moment(time, spectrum, values, space, operator, self.cubic, self.grid, closure)

    def couplings(self, time: Any) -> tuple[Values, FlowOperator]:
        """Return the values of the couplings at a time, and the flow operator."""
        values, operator = self.values, self.operator
        if self.ramp is not None:
            values = _at_time(values, self.ramp, time)
            if "mu" in self.ramp.target:
                operator = self.operator_of(values)
        return values, operator

    def operator_of(self, values: Values) -> Any:
        """Return the operator that gives the flow of a force, for values of the couplings."""
        return hydrodynamics.flow_operator(self.space, values.mu, values.zero_theta_flux, self.drag)

    def strongest(self) -> Values:
        """Return the values with the larger of the diffusion constants at either end of a ramp."""
        return self.values if self.ramp is None else _strongest(self.values, self.ramp)

    def with_values(self, values: Values) -> System:
        """Return the same system with other values of the couplings.

        Those that are built into its operators (μ and the flux condition) must be the same.
        """
        return replace(self, values=values)

    @property
    def varying(self) -> tuple[Values, Ramp | None]:
        """What differs between cells of one shape and one flow operator: values, and their ramps."""
        return self.values, self.ramp

    def with_varying(self, varying: tuple[Values, Ramp | None]) -> System:
        """Return the same system with the values of another cell."""
        return replace(self, values=varying[0], ramp=varying[1])

    def in_batches(self) -> System:
        """Return the same system with transforms in batches."""
        return replace(self, together=True)

    def linear(self) -> jax.Array:
        """Return the real symbol of the linear part, shape (n_theta, n_z); zero if not `split`."""
        now = Moment(0.0, self.space.k2, self.strongest(), self.space, self.operator, self.cubic, self.grid)
        symbol = filaments.linear_symbol(now, self.terms)
        return symbol if self.split else jnp.zeros_like(symbol)

    def nonlinear(self, now: Moment) -> jax.Array:
        """Return the spectrum of the rest of dP/dt."""
        rest = self._rest(now)
        if not self.split:
            return rest + filaments.linear_symbol(now, self.terms) * now.spectrum
        if self.ramp is None or not _LINEAR & self.ramp.target.keys():
            return rest
        return rest + (filaments.linear_symbol(now, self.terms) - self.linear()) * now.spectrum

    def _rest(self, now: Moment) -> jax.Array:
        # Models that add to a moment share its fields with their own terms. A custom term stays as written.
        own = type(now) is Moment and all(term.kind != "custom" for term in self.terms)
        if not own or (now.spectrum.size <= SMALL and not self.together):
            return filaments.nonlinear(now, self.terms)

        def rest(spectrum: jax.Array) -> jax.Array:
            return filaments.nonlinear(now.of(spectrum), self.terms)

        rewritten = in_real_arithmetic(transforms_together(rest) if self.together else rest)
        result: jax.Array = rewritten(now.spectrum)
        return result

    def size(self, spectrum: jax.Array) -> jax.Array:
        """Return <|P|²>^½ of a packed spectrum (Parseval), or the same of a rate or an error."""
        return jnp.sqrt(jnp.sum(jnp.abs(spectrum) ** 2, dtype=jnp.float64)) / spectrum.size

    def peak(self, now: Moment) -> jax.Array:
        """Return max |P|²."""
        return jnp.max(dot(now.p, now.p))

    def local(self, now: Moment) -> jax.Array:
        """Return the decaying part of the local Jacobian of the torques, see `relaxation`."""
        return relaxation.decaying(*relaxation.jacobian(now, self.terms))

    def relaxed(self, spectrum: jax.Array, local: jax.Array, tau: Any) -> jax.Array:
        """Return (1 - τ L)⁻¹ (1 - τ D)⁻¹ of a packed spectrum, with the D that `local` returned."""
        return relaxation.relaxed(self.space, self.linear(), local, spectrum, tau)

    def rate(self, now: Moment) -> jax.Array:
        """Return the spectrum of dP/dt."""
        return self.linear() * now.spectrum + self.nonlinear(now)

    def spectrum(self, state: npt.ArrayLike) -> npt.NDArray[np.complexfloating[Any, Any]]:
        """Return the packed spectrum of a state (2, n_theta, n_z) without its Nyquist modes."""
        packed = np.fft.fft2(spectral.pack(np.asarray(state, dtype=np.float64)))
        return (packed * np.asarray(self.space.keep)).astype(self.space.packed)

    def reported(self, spectrum: Any) -> Any:
        """Return the part of a packed spectrum that is reported: without its Nyquist modes.

        In a run only an intervention leaves some, and they diffuse away.
        """
        return spectrum * self.space.keep

    def state(self, spectrum: npt.ArrayLike) -> Array:
        """Return the state (2, n_theta, n_z) of a packed spectrum."""
        return state_of(spectrum)


def state_of(spectrum: npt.ArrayLike) -> Array:
    """Return the vector field (2, n_theta, n_z) of a packed spectrum."""
    field = np.fft.ifft2(np.asarray(spectrum, dtype=np.complex128))
    return np.stack([field.real, field.imag])


jax.tree_util.register_dataclass(
    System,
    data_fields=["space", "values", "operator", "ramp", "drag"],
    meta_fields=["terms", "cubic", "grid", "split", "closure", "together"],
)

_LINEAR = {"d_s", "d_r"}
"""The parameters of the linear terms."""


def _at_time(values: Values, ramp: Ramp, time: Any) -> Values:
    """Return the values at a time during a ramp."""

    def between(name: str) -> Any:
        first = getattr(values, name)
        share = (time - ramp.begin[name]) / (ramp.end[name] - ramp.begin[name])
        return first + jnp.asarray(share, first.real.dtype) * (ramp.target[name] - first)

    now = values._replace(**{name: between(name) for name in ramp.target})
    if "repulsion_angle" not in ramp.target:
        return now
    mirror = now.kappa * jnp.exp(2j * now.repulsion_angle)
    return now._replace(kappa_mirror=mirror.astype(values.kappa_mirror.dtype))


def _strongest(values: Values, ramp: Ramp) -> Values:
    """Return the values with the larger of the diffusion constants at either end of a ramp."""
    larger = {n: jnp.maximum(getattr(values, n), ramp.target[n]) for n in _LINEAR & ramp.target.keys()}
    return values._replace(**larger)


def ramped(first: System, last: System, times: Mapping[str, tuple[float, float]]) -> System:
    """Return the system with values that change linearly from those of `first` to those of `last`.

    `times` gives the beginning and the end of each ramp, by name. Everything else must be the same in both;
    a named value that does not change only costs time.
    """
    chosen = dict(times)
    if "kappa" in chosen and "repulsion_angle" not in chosen:
        chosen["kappa_mirror"] = chosen["kappa"]  # linear in kappa
    names = sorted(chosen)
    begin, end = ({name: np.float64(chosen[name][k]) for name in names} for k in (0, 1))
    return replace(first, ramp=Ramp(begin, end, {name: getattr(last.values, name) for name in names}))


def system(
    params: Parameters,
    grid: CylinderGrid,
    terms: Iterable[TermLike] | None = None,
    dealias: str = "none",
    precision: str = "float64",
    split: bool = True,
    traced: dict[str, Any] | None = None,
    cubic: bool | None = None,
    closure: str = PAPER,
    vacuole_drag: float = 0.0,
) -> System:
    """Return the `System` of a cell.

    `traced` overrides parameters with values that JAX traces (without dealiasing). `cubic` says whether the
    force is always cubic (default: if it is by its parameters). `vacuole_drag` is the coefficient β of the
    drag of the vacuole. Raises `InputError` when field-valued parameters do not match the grid, and for an
    unknown closure.
    """
    params.require_grid(grid)
    dealias = definition("run", "dealias").check(dealias)
    precision = definition("run", "precision").check(precision)
    chosen = filaments.select_terms(terms)
    space = spectral.space(grid, dealias, precision)
    given = dict(params.items()) | (traced or {})
    values = _values(given, space, precision, jnp if traced else np)
    drag = (vacuole_drag * interior.drag(space.m, space.q)).astype(space.k2.dtype) if vacuole_drag else None
    operator = hydrodynamics.flow_operator(space, values.mu, values.zero_theta_flux, drag)
    custom = any(term.kind == "custom" for term in chosen)
    return System(
        space,
        values,
        operator,
        chosen,
        cubic=not (traced and "force_exponent" in traced) and params.force_exponent == 2
        if cubic is None
        else cubic,
        grid=grid.resized(*space.fine) if custom else None,
        split=split,
        closure=closures.checked(closure),
        drag=drag,
    )


def _values(given: dict[str, Any], space: Space, precision: str, xp: Any) -> Values:
    real, packed = dtypes(precision)
    mirror = given["kappa"] * xp.exp(2j * given["repulsion_angle"])

    def placed(value: Any) -> Any:
        if np.ndim(value) == 0 or xp is jnp:  # what JAX traces is on the grid itself
            return xp.asarray(value, packed if xp.iscomplexobj(value) else real)
        if xp.iscomplexobj(value):
            fine = interpolate(np.stack([value.real, value.imag]), space.fine)
            return spectral.pack(fine).astype(packed)
        return interpolate(value, space.fine).astype(real)

    return Values(**{name: placed(value) for name, value in given.items()}, kappa_mirror=placed(mirror))


@jax.jit
def rate_spectrum(system: System, spectrum: Any, time: Any = 0.0) -> Any:
    """Return the spectrum of dP/dt of a state at a time (traceable)."""
    return system.rate(system.at(spectrum, time))


@jax.jit
def flow_spectrum(system: System, spectrum: Any, time: Any = 0.0) -> Any:
    """Return the packed spectrum of the flow that a state drives at a time (traceable)."""
    return system.at(spectrum, time).flow_spectrum


@door
def flow(params: Parameters, grid: CylinderGrid, state: npt.ArrayLike, dealias: str = "none") -> Array:
    """Return the flow u that a state drives, shape (2, n_theta, n_z), dimensionless (units of U).

        -μ ∇²u + u + Π₀ e_z + ∇Π' = |P|ⁿ P,   ∇·u = 0,   <u_z> = 0

    On a `cyclosis.ClosedGrid` it is the flow on that surface, (2, n_theta, n_s).
    Raises `InputError` if state or parameter fields do not match the grid. Source: Woodhouse &
    Goldstein 2013.

    Example:
        >>> import numpy as np
        >>> import cyclosis as cy
        >>> grid = cy.CylinderGrid(16, 16)
        >>> P = cy.initial.stripes(grid, magnitude=1.0)  # F_z = sin³θ = (3 sin θ - sin 3θ)/4
        >>> expected = 0.75 * np.sin(grid.theta) / 1.05 - 0.25 * np.sin(3 * grid.theta) / 1.45
        >>> u = cy.flow(cy.Parameters(mu=0.05), grid, P)
        >>> bool(np.allclose(u[1], expected[:, None])), bool(np.allclose(u[0], 0.0))
        (True, True)
    """
    P = grid.check_state(state)
    equation = system(params, grid, dealias=dealias)
    with double():
        return equation.state(flow_spectrum(equation, equation.spectrum(P)))


@door
def rate_of_change(
    params: Parameters,
    grid: CylinderGrid,
    state: npt.ArrayLike,
    time: float = 0.0,
    terms: Iterable[TermLike] | None = None,
    dealias: str = "none",
    closure: str = PAPER,
) -> Array:
    """Return dP/dt of a state, shape (2, n_theta, n_z), dimensionless (per R/U).

    The same right-hand side that `simulate` integrates; `terms` selects from it (see `Term`), `closure` is
    that of `cyclosis.models.polar_model`. Raises `InputError` if state or parameter fields do not match the
    grid.

    Example:
        >>> import cyclosis as cy
        >>> params, grid = cy.Parameters(alpha_p=1.0, d_r=0.025), cy.CylinderGrid(16, 16)
        >>> weak = cy.initial.unidirectional(grid, 1e-6)
        >>> rate = cy.rate_of_change(params, grid, weak)
        >>> round(float(rate[1, 0, 0] / 1e-6), 6)  # α_p - d_r, how fast order grows out of disorder
        0.975
        >>> only = cy.rate_of_change(params, grid, weak, terms=["bundling"])
        >>> round(float(only[1, 0, 0] / 1e-6), 6)
        1.0
    """
    P = grid.check_state(state)
    equation = system(params, grid, terms, dealias, closure=closure)
    now = number("time", time, -1e12, 1e12, "the default is 0")
    with double():
        return equation.state(rate_spectrum(equation, equation.spectrum(P), now))
