"""The whole cell as a vector equation: the right-hand side of a simulation, and its derivative, matrix-free.

A state is a real vector of 2 n_theta n_z numbers, the real and imaginary parts of its packed Fourier
coefficients without Nyquist modes, scaled such that the Euclidean norm is <|P|²>^½. The right-hand side is
that of `cyclosis.model.system`; its derivative is taken by automatic differentiation of the sum of terms, so
that a steady state found here is also steady in a simulation on the same grid, to rounding.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import numpy.typing as npt

from ...analysis.diagnostics import tail
from ...contract.model import Problem
from ...dynamics.advance import Control, advance, start
from ...dynamics.steppers import phi
from ...model.errors import InputError
from ...model.grid import Array
from ...model.precision import double
from ...model.system import System, system
from ...models import polar

VARIES = 1e-7
"""Root mean square slope, relative to the state, below which it counts as uniform along a direction."""
MOST_STEPS = 1_000_000


@dataclass(frozen=True)
class Plane:
    """The filament equation of a cell for vectors (size,), dimensionless.

    `free` says along which axes (theta, z) the couplings are uniform, so that states may be shifted.
    """

    system: System
    free: tuple[bool, bool]

    @property
    def shape(self) -> tuple[int, int]:
        """(n_theta, n_z)."""
        return self.system.space.shape

    @property
    def local(self) -> float:
        """A typical rate at which perturbations unaffected by diffusion decay."""
        return float(np.mean(self.system.values.alpha_p) + np.mean(self.system.values.alpha_u))

    @property
    def size(self) -> int:
        """The length of a vector."""
        return 2 * self.shape[0] * self.shape[1]

    def vector(self, state: npt.ArrayLike) -> Array:
        """Return the vector of a state (2, n_theta, n_z)."""
        return self._flat(self.system.spectrum(state))

    def state(self, vector: Array) -> Array:
        """Return the state (2, n_theta, n_z) of a vector."""
        return self.system.state(self._packed(vector))

    def rate(self, vector: Array) -> Array:
        """Return dP/dt."""
        with double():
            return self._flat(_rate(self.system, self._packed(vector)))

    def slopes(self, vector: Array) -> Array:
        """Return the derivatives along theta and z, (2, size)."""
        packed = self._packed(vector)
        return np.stack([self._flat(1j * k * packed) for k in (self.system.space.m, self.system.space.q)])

    def directions(self, vector: Array) -> Array:
        """Return orthonormal directions (count, 2) of the (theta, z) plane along which a shift has an effect.

        Zero for a uniform state or where no axis is free, one for straight or tilted stripes, else two.
        """
        slopes = self.slopes(vector) * np.array(self.free)[:, None]
        lengths, axes = np.linalg.eigh(slopes @ slopes.T)
        felt = lengths > (VARIES * max(float(np.linalg.norm(vector)), 1e-12)) ** 2
        return np.asarray(axes.T[felt][::-1], dtype=np.float64)

    def tail(self, vector: Array) -> float:
        """Return the amplitude beyond two thirds of the resolved wavenumbers over that of all."""
        with double():
            return float(tail(self.system, np.abs(self._packed(vector)) ** 2))

    def noise(self, count: int) -> Array:
        """Return random vectors (count, size), the same each time, whose modes fall with wavenumber."""
        space = self.system.space
        drawn = np.random.default_rng(0).normal(size=(count, *self.shape, 2))
        weight = np.asarray(space.keep) / (1.0 + np.asarray(space.k2))
        return (drawn * weight[..., None]).reshape(count, -1)

    def alike(self, one: Array, other: Array) -> float:
        """Return the scalar product of two vectors, maximised over shifts along free axes."""
        product = np.fft.ifft2(self._packed(one) * np.conj(self._packed(other))).real / (0.5 * self.size)
        shifts = tuple(slice(None) if free else slice(1) for free in self.free)
        return float(product[shifts].max())

    def linearised(self, vector: Array, drift: Array) -> Linearised:
        """Return the derivative of dP/dt + c·∇P at a state, c the drift (2,)."""
        with double():
            tangent = _tangent(self.system, self._packed(vector))
            linear = np.asarray(self.system.linear())
            shift = drift[0] * self.system.space.m + drift[1] * self.system.space.q
            return Linearised(self.shape, tangent, linear, jax.device_put(linear + 1j * shift))

    def relaxed(self, vector: Array, duration: float) -> Array:
        """Return a state after a simulation over `duration` with default tolerances."""
        with double():
            control = Control.of(rtol=1e-4, atol=1e-10, bound=polar.bound)
            began = start(self.system, self._packed(vector), np.float64(0.0))
            end = advance(self.system, control, began, np.float64(duration), np.int64(MOST_STEPS))
            return self._flat(end.spectrum)

    def _packed(self, vector: Array) -> Any:
        return vector.view(np.complex128).reshape(self.shape) * (0.5 * self.size)

    def _flat(self, packed: Any) -> Array:
        return (np.asarray(packed) / (0.5 * self.size)).ravel().view(np.float64)


def plane(problem: Problem) -> Plane:
    """Return the `Plane` of a problem of the polar model, always in double precision.

    Raises `InputError` for custom terms, which need not be autonomous.
    """
    for term in problem.terms:
        if term.kind == "custom":
            raise InputError("terms", term.name, "terms of the model, which do not depend on time", "omit it")
    fields = [value for _, value in problem.params.items() if isinstance(value, np.ndarray)]
    free = tuple(all(np.ptp(field, axis=axis).max() == 0 for field in fields) for axis in (0, 1))
    whole = system(problem.params, problem.grid, problem.terms, problem.dealias)
    return Plane(whole, (free[0], free[1]))


@dataclass(frozen=True)
class Linearised:
    """The derivative J of dP/dt + c·∇P at a state; `symbol` is its part that is diagonal in Fourier space."""

    shape: tuple[int, int]
    tangent: Any
    linear: Array
    symbol: Any

    def __call__(self, vectors: Any) -> Any:
        """Return J v of a vector (size,) or of each row of (rows, size), real or complex."""
        if np.iscomplexobj(vectors):
            return self(vectors.real) + 1j * self(vectors.imag)
        if vectors.ndim == 2:
            return np.stack([self(vector) for vector in vectors])
        with double():
            return self._flat(_apply(self.tangent, self.symbol, self._packed(vectors)))

    @property
    def diagonal(self) -> Array:
        """The symbol of diffusion and rotational diffusion, (size,)."""
        return np.repeat(self.linear.ravel(), 2)

    def fastest(self, vector: Array) -> float:
        """Return an estimate of the largest rate in J without its diagonal part, from any vector."""
        with double():
            return float(_fastest(self.tangent, self._packed(vector)))

    def evolved(self, vectors: Array, step: float, steps: int) -> Array:
        """Return v (rows, size) after some time steps of dv/dt = J v, to the accuracy of ETD2RK."""
        with double():
            begun = [self._packed(vector) for vector in vectors]
            found = [_evolved(self.tangent, self.symbol, packed, step, steps) for packed in begun]
        return np.stack([self._flat(packed) for packed in found])

    def _packed(self, vector: Array) -> Any:
        return np.ascontiguousarray(vector).view(np.complex128).reshape(self.shape)

    def _flat(self, packed: Any) -> Array:
        return np.array(packed).ravel().view(np.float64)


@jax.jit
def _rate(system: System, packed: Any) -> Any:
    return system.space.keep * system.rate(system.at(packed))


@jax.jit
def _tangent(system: System, packed: Any) -> Any:
    """Return the derivative of the nonlinear terms as a function that is linear over the reals."""

    def nonlinear(moved: Any) -> Any:
        return system.space.keep * system.nonlinear(system.at(moved))

    return jax.linearize(nonlinear, packed)[1]


@jax.jit
def _apply(tangent: Any, symbol: Any, packed: Any) -> Any:
    return symbol * packed + tangent(packed)


@jax.jit
def _fastest(tangent: Any, packed: Any) -> Any:
    """Return an estimate of the largest rate of the nonlinear terms: their growth under iteration."""

    def again(_: Any, carry: Any) -> Any:
        packed = tangent(carry[0])
        size = jnp.sqrt(jnp.sum(jnp.abs(packed) ** 2))
        return packed / size, size

    return jax.lax.fori_loop(0, 12, again, (packed, jnp.zeros(())))[1]


@jax.jit
def _evolved(tangent: Any, symbol: Any, packed: Any, h: Any, steps: Any) -> Any:
    """Step dv/dt = L v + N v by ETD2RK: a = e^{hL} v + h φ₁ N v, then v = a + h φ₂ N (a - v)."""
    z = h * symbol
    first, second, _ = phi(z)
    decay, first, second = jnp.exp(z), h * first, h * second

    def one(_: Any, v: Any) -> Any:
        rate = tangent(v)
        a = decay * v + first * rate
        return a + second * (tangent(a) - rate)

    return jax.lax.fori_loop(0, steps, one, packed)
