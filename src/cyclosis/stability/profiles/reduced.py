"""States that do not vary along one axis of the cell: the same equation in one dimension.

The right-hand side is that of `cyclosis.model.system` itself, on the wavenumbers that remain, so that a
steady state found here is one of the two-dimensional equations on the same grid, to rounding. A state
is a real vector y = (P_theta, P_z) of 2n values on the n points of the remaining direction; the
linearisation is taken by automatic differentiation of the sum of terms.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property, partial
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from ...contract.model import Problem
from ...model.grid import Array, CylinderGrid
from ...model.parameters import Parameters
from ...model.precision import on_host
from ...model.system import System, system
from ...models import polar

_ALTERNATE = np.array([1.0, 0.0, -1.0, 0.0])


@dataclass(frozen=True)
class Reduced:
    """The filament equation of states that do not vary along `axis` (0: theta, 1: z), dimensionless.

    `k` (n,) are the wavenumbers of the direction that is left, in transform order, `turn` its period (2π or
    the length). `system` holds the whole equation, `line` what is left of it.
    """

    system: System
    line: System
    axis: int
    k: Array
    turn: float

    @property
    def n(self) -> int:
        """Number of points left."""
        return self.k.size

    def rate(self, y: Array) -> Array:
        """Return dy/dt (2n,)."""
        with on_host():
            return np.asarray(_rate(self.line, y))

    def jacobian(self, y: Array) -> Array:
        """Return the derivative of `rate`, (2n, 2n)."""
        with on_host():
            return np.asarray(_jacobian(self.line, y))

    def waves(self, y: Array, j: int) -> np.ndarray[Any, np.dtype[np.complex128]]:
        """Return the linearisation (2n, 2n) about y on perturbations v e^{iqx}.

        q is the j-th wavenumber of the axis along which y does not vary, x the position along it.
        """
        with on_host():
            return np.asarray(_waves(_restricted(self.system, self.axis, (0, j, None, -j)), self.axis, y))

    def slope(self, y: Array) -> Array:
        """Return the derivative of y along the remaining direction."""
        nyquist = (np.arange(self.n) == self.n // 2) & (self.n % 2 == 0)
        return self._filtered(y, 1j * np.where(nyquist, 0.0, self.k))

    @cached_property
    def derivative(self) -> Array:
        """The matrix (2n, 2n) of `slope`."""
        return np.stack([self.slope(unit) for unit in np.eye(2 * self.n)], axis=1)

    @property
    def wavenumber(self) -> float:
        """The smallest wavenumber of the axis along which states do not vary."""
        space = self.system.space
        return float(np.ravel(space.q if self.axis == 1 else space.m)[1])

    def shifted(self, y: Array, distance: float) -> Array:
        """Return y moved by a distance along the remaining direction."""
        return self._filtered(y, np.exp(-1j * self.k * distance))

    def packed(self, y: Array) -> np.ndarray[Any, np.dtype[np.complex128]]:
        """Return the packed Fourier coefficients (n,) of y."""
        return np.fft.fft(y[: self.n] + 1j * y[self.n :])

    def from_packed(self, packed: Any) -> Array:
        """Return y from its packed Fourier coefficients (n,)."""
        p = np.fft.ifft(packed)
        return np.concatenate([p.real, p.imag])

    def state(self, y: Array, grid: CylinderGrid) -> Array:
        """Return the state (2, n_theta, n_z) that y represents."""
        both = y.reshape(2, self.n)
        return np.broadcast_to(np.expand_dims(both, 1 + self.axis), (2, *grid.shape)).copy()

    def _filtered(self, y: Array, multiplier: Any) -> Array:
        return self.from_packed(self.packed(y) * multiplier)


def reduced(params: Parameters, grid: CylinderGrid, axis: int = 1) -> Reduced:
    """Return the `Reduced` equation of a cell whose couplings are numbers, with all terms."""
    return reduced_of(polar.problem(params, grid), axis)


def reduced_of(problem: Problem, axis: int = 1) -> Reduced:
    """Return the `Reduced` equation of a problem, always in double precision.

    Its model is the polar one, or the same with the drag of the vacuole.
    """
    grid = problem.grid
    drag = float(problem.model.options.get("vacuole_drag", 0.0))
    whole = system(problem.params, grid, problem.terms, problem.dealias, vacuole_drag=drag)
    k, turn = (grid.m, 2 * np.pi) if axis == 1 else (grid.q, grid.length)
    with on_host():
        line = jax.device_put(_restricted(whole, axis, (0,)))
    return Reduced(whole, line, axis, k, turn)


def _restricted(system: System, axis: int, modes: tuple[int | None, ...]) -> System:
    """Return the System of states with only some wavenumbers along an axis; None is left empty."""
    chosen = [0 if mode is None else mode for mode in modes]
    kept = np.array([mode is not None for mode in modes], dtype=float)
    along = np.expand_dims(kept, 1 - axis)

    def pick(values: Any) -> Any:
        return np.take(np.asarray(values), chosen, axis)

    space, operator = system.space, system.operator
    shape, fine = (_resized(old, axis, len(modes)) for old in (space.shape, space.fine))
    numbers = (
        {"q": pick(space.q) * along, "keep_q": pick(space.keep_q) * along}
        if axis == 1
        else {"m": pick(space.m) * along, "keep_m": pick(space.keep_m) * along}
    )
    smaller = replace(space, k2=pick(space.k2), shape=shape, fine=fine, **numbers)
    return replace(
        system,
        space=smaller,
        operator=type(operator)(pick(operator.direct) * along, pick(operator.mirror) * along),
    )


def _resized(shape: tuple[int, int], axis: int, size: int) -> tuple[int, int]:
    return (shape[0], size) if axis == 1 else (size, shape[1])


def _real_rate(line: System, y: Any) -> Any:
    n = y.size // 2
    p = jax.lax.complex(y[:n], y[n:]).reshape(line.space.shape)
    rate = jnp.fft.ifft2(line.rate(line.at(jnp.fft.fft2(p)))).reshape(n)
    return jnp.concatenate([rate.real, rate.imag])


_rate = jax.jit(_real_rate)
_jacobian = jax.jit(jax.jacfwd(_real_rate, argnums=1))


@partial(jax.jit, static_argnums=1)
def _waves(system: System, axis: int, y: Any) -> Any:
    """Perturb by v cos(qx) on four points a wave: A v is the result's cosine part less i its sine part."""
    n = y.size // 2
    base = jnp.broadcast_to(jnp.expand_dims(jax.lax.complex(y[:n], y[n:]), axis), system.space.shape)

    def physical(p: Any) -> Any:
        now = system.at(jnp.fft.fft2(p))
        # A wave gets no Nyquist modes along the remaining direction, just as a state of the cell has none.
        return jnp.fft.ifft2(system.linear() * now.spectrum + system.space.keep * system.nonlinear(now))

    def column(unit: Any) -> Any:
        wave = jnp.expand_dims(jax.lax.complex(unit[:n], unit[n:]), axis) * jnp.expand_dims(
            _ALTERNATE, 1 - axis
        )
        answer = jnp.moveaxis(jax.jvp(physical, (base,), (wave,))[1], axis, 0)
        cosine, sine = answer[0], answer[1]
        return jax.lax.complex(
            jnp.concatenate([cosine.real, cosine.imag]), -jnp.concatenate([sine.real, sine.imag])
        )

    return jax.vmap(column)(jnp.eye(2 * n)).T
