"""The whole cell as a vector equation: the right-hand side of a simulation, and its derivative, matrix-free.

A state is a real vector: the real and imaginary parts of its modes, scaled such that the Euclidean norm is
<|P|²>^½. The right-hand side is that of a simulation; its derivative is taken by automatic differentiation of
the sum of terms, so that a steady state found here is also steady in a simulation on the same grid, to
rounding. What cells of different geometry do not share is in `plane` and `closed_surface`.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import numpy.typing as npt

from ...dynamics.advance import Control, advance, start
from ...dynamics.steppers import phi
from ...model.grid import Array
from ...model.precision import double
from ...model.system import System
from ...models import polar

VARIES = 1e-7
"""Root mean square slope, relative to the state, below which it counts as uniform along a direction."""
MOST_STEPS = 1_000_000


@dataclass(frozen=True)
class WholeCell(ABC):
    """The filament equation of a cell for vectors (size,), dimensionless.

    `free` says of every motion of the surface into itself whether it leaves the equation unchanged, so that
    it moves one solution to another: shifts on a cylinder, rotations of a closed surface.
    """

    system: System
    free: tuple[bool, ...]

    @property
    @abstractmethod
    def size(self) -> int:
        """The length of a vector."""

    @abstractmethod
    def packed(self, vector: Array) -> Any:
        """Return the modes of a vector."""

    @abstractmethod
    def flat(self, packed: Any) -> Array:
        """Return the vector of modes."""

    @abstractmethod
    def slopes(self, vector: Array) -> Array:
        """Return the derivatives of a state along every motion, (motions, size)."""

    @abstractmethod
    def alike(self, one: Array, other: Array) -> float:
        """Return the scalar product of two vectors, maximised over free motions."""

    @abstractmethod
    def tail(self, vector: Array) -> float:
        """Return the amplitude beyond two thirds of the resolved wavenumbers over that of all."""

    @abstractmethod
    def variation(self, vector: Array) -> dict[str, float]:
        """Return the relative variation of a state along each axis by name."""

    @abstractmethod
    def moving(self, drift: Array) -> Any:
        """Return the part of c·∇, with c the drift, that is diagonal in the modes; 0 for none."""

    def carried(self, drift: Array) -> Any:
        """Return the rest of c·∇ as a function of modes that JAX may trace, or None for none."""
        return None

    @property
    def local(self) -> float:
        """A typical rate at which perturbations unaffected by diffusion decay."""
        return float(np.mean(self.system.values.alpha_p) + np.mean(self.system.values.alpha_u))

    def vector(self, state: npt.ArrayLike) -> Array:
        """Return the vector of a state (2, ...)."""
        return self.flat(self.system.spectrum(state))

    def state(self, vector: Array) -> Array:
        """Return the state (2, ...) of a vector."""
        return self.system.state(self.packed(vector))

    def rate(self, vector: Array) -> Array:
        """Return dP/dt."""
        with double():
            return self.flat(_rate(self.system, self.packed(vector)))

    def directions(self, vector: Array) -> Array:
        """Return orthonormal directions (count, motions) along which a free motion has an effect.

        On a cylinder none for a uniform state, one for straight or tilted stripes, else two.
        """
        slopes = self.slopes(vector) * np.array(self.free)[:, None]
        lengths, axes = np.linalg.eigh(slopes @ slopes.T)
        felt = lengths > (VARIES * max(float(np.linalg.norm(vector)), 1e-12)) ** 2
        return np.asarray(axes.T[felt][::-1], dtype=np.float64)

    def noise(self, count: int) -> Array:
        """Return random vectors (count, size), the same each time, whose modes fall with wavenumber."""
        space = self.system.space
        drawn = np.random.default_rng(0).normal(size=(count, *space.keep.shape, 2))
        weight = np.asarray(space.keep) / (1.0 + np.asarray(space.k2))
        weighted = np.ascontiguousarray(drawn * weight[..., None]).view(np.complex128)[..., 0]
        return np.stack([self.flat(packed) for packed in weighted])

    def linearised(self, vector: Array, drift: Array) -> Linearised:
        """Return the derivative of dP/dt + c·∇P at a state, c the drift (motions,)."""
        with double():
            tangent = _tangent(self.system, self.carried(drift), self.packed(vector))
            linear = np.asarray(self.system.linear())
            return Linearised(self, tangent, linear, jax.device_put(linear + self.moving(drift)))

    def relaxed(self, vector: Array, duration: float) -> Array:
        """Return a state after a simulation over `duration` with default tolerances."""
        with double():
            control = Control.of(rtol=1e-4, atol=1e-10, bound=polar.bound)
            began = start(self.system, self.packed(vector), np.float64(0.0))
            end = advance(self.system, control, began, np.float64(duration), np.int64(MOST_STEPS))
            return self.flat(end.spectrum)


@dataclass(frozen=True)
class Linearised:
    """The derivative J of dP/dt + c·∇P at a state; `symbol` is its part that is diagonal in the modes."""

    cell: WholeCell
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
            return self.cell.flat(_apply(self.tangent, self.symbol, self.cell.packed(vectors)))

    @property
    def diagonal(self) -> Array:
        """The symbol of diffusion and rotational diffusion, (size,)."""
        return self.cell.flat(self.linear * (1 + 1j)) / self.cell.flat(np.ones_like(self.linear) * (1 + 1j))

    def fastest(self, vector: Array) -> float:
        """Return an estimate of the largest rate in J without its diagonal part, from any vector."""
        with double():
            return float(_fastest(self.tangent, self.cell.packed(vector)))

    def evolved(self, vectors: Array, step: float, steps: int) -> Array:
        """Return v (rows, size) after some time steps of dv/dt = J v, to the accuracy of ETD2RK."""
        with double():
            begun = [self.cell.packed(vector) for vector in vectors]
            found = [_evolved(self.tangent, self.symbol, packed, step, steps) for packed in begun]
        return np.stack([self.cell.flat(packed) for packed in found])


@jax.jit
def _rate(system: System, packed: Any) -> Any:
    return system.space.keep * system.rate(system.at(packed))


@jax.jit
def _tangent(system: System, carried: Any, packed: Any) -> Any:
    """Return the derivative of the nonlinear terms and of `carried`, a function linear over the reals."""

    def nonlinear(moved: Any) -> Any:
        rate = system.space.keep * system.nonlinear(system.at(moved))
        return rate if carried is None else rate + carried(moved)

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
