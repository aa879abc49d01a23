"""The whole cell as a vector equation: the right-hand side of a simulation, and its derivative, matrix-free.

A state is a real vector of 2 n_theta n_z numbers, the real and imaginary parts of its packed spectrum without
Nyquist modes, scaled such that the Euclidean norm is <|P|²>^½. The right-hand side is that of
`cyclosis.model.system`; its derivative is taken by automatic differentiation of the sum of terms, so that
what is steady here stands still in a simulation on the same grid, to rounding.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import numpy.typing as npt

from ..analysis.diagnostics import tail
from ..dynamics.advance import Control, advance, start
from ..dynamics.steppers import phi
from ..model.errors import InputError
from ..model.filaments import TermLike, select_terms
from ..model.grid import Array, CylinderGrid
from ..model.parameters import Parameters
from ..model.precision import double
from ..model.system import System, system

VARIES = 1e-7
"""Root mean square slope, relative to the state, below which it counts as uniform along a direction."""
MOST_STEPS = 1_000_000


@dataclass(frozen=True)
class Plane:
    """The filament equation of a cell for vectors (size,), dimensionless.

    `free` says along which axes (theta, z) the couplings are uniform, so that states may be shifted.
    """

    cell: System
    free: tuple[bool, bool]

    @property
    def shape(self) -> tuple[int, int]:
        """(n_theta, n_z)."""
        return self.cell.space.shape

    @property
    def local(self) -> float:
        """A typical rate at which perturbations that diffusion does not reach decay."""
        return float(np.mean(self.cell.values.alpha_p) + np.mean(self.cell.values.alpha_u))

    @property
    def size(self) -> int:
        """The length of a vector."""
        return 2 * self.shape[0] * self.shape[1]

    def vector(self, state: npt.ArrayLike) -> Array:
        """Return the vector of a state (2, n_theta, n_z)."""
        return self._flat(self.cell.spectrum(state))

    def state(self, vector: Array) -> Array:
        """Return the state (2, n_theta, n_z) of a vector."""
        return self.cell.state(self._spectrum(vector))

    def rate(self, vector: Array) -> Array:
        """Return dP/dt."""
        with double():
            return self._flat(_rate(self.cell, self._spectrum(vector)))

    def slopes(self, vector: Array) -> Array:
        """Return the derivatives along theta and z, (2, size)."""
        spectrum = self._spectrum(vector)
        return np.stack([self._flat(1j * k * spectrum) for k in (self.cell.space.m, self.cell.space.q)])

    def directions(self, vector: Array) -> Array:
        """Return orthonormal directions (count, 2) of the (theta, z) plane along which a shift is felt.

        None for a uniform state or none that is free, one for stripes straight or tilted, else two.
        """
        slopes = self.slopes(vector) * np.array(self.free)[:, None]
        lengths, axes = np.linalg.eigh(slopes @ slopes.T)
        felt = lengths > (VARIES * max(float(np.linalg.norm(vector)), 1e-12)) ** 2
        return np.asarray(axes.T[felt][::-1], dtype=np.float64)

    def tail(self, vector: Array) -> float:
        """Return the amplitude beyond two thirds of the resolved wavenumbers over that of all."""
        with double():
            return float(tail(self.cell, np.abs(self._spectrum(vector)) ** 2))

    def noise(self, count: int) -> Array:
        """Return random vectors (count, size), always the same, whose spectrum falls with the wavenumber."""
        space = self.cell.space
        drawn = np.random.default_rng(0).normal(size=(count, *self.shape, 2))
        weight = np.asarray(space.keep) / (1.0 + np.asarray(space.k2))
        return (drawn * weight[..., None]).reshape(count, -1)

    def alike(self, one: Array, other: Array) -> float:
        """Return the scalar product of two vectors, the largest of all shifts that are free."""
        product = np.fft.ifft2(self._spectrum(one) * np.conj(self._spectrum(other))).real / (0.5 * self.size)
        shifts = tuple(slice(None) if free else slice(1) for free in self.free)
        return float(product[shifts].max())

    def linearised(self, vector: Array, drift: Array) -> Linearised:
        """Return the derivative of dP/dt + c·∇P at a state, c the drift (2,)."""
        with double():
            tangent = _tangent(self.cell, self._spectrum(vector))
            linear = np.asarray(self.cell.linear())
            shift = drift[0] * self.cell.space.m + drift[1] * self.cell.space.q
            return Linearised(self.shape, tangent, linear, jax.device_put(linear + 1j * shift))

    def relaxed(self, vector: Array, duration: float) -> Array:
        """Return the state into which a simulation with default tolerances takes a state."""
        with double():
            control = Control(*(np.float64(x) for x in (1e-4, 1e-10, 0.1, -1.0)))
            began = start(self.cell, self._spectrum(vector), np.float64(0.0))
            end = advance(self.cell, control, began, np.float64(duration), np.int64(MOST_STEPS))
            return self._flat(end.spectrum)

    def _spectrum(self, vector: Array) -> Any:
        return vector.view(np.complex128).reshape(self.shape) * (0.5 * self.size)

    def _flat(self, spectrum: Any) -> Array:
        return (np.asarray(spectrum) / (0.5 * self.size)).ravel().view(np.float64)


def plane(
    params: Parameters,
    grid: CylinderGrid,
    terms: Iterable[TermLike] | None = None,
    dealias: str = "none",
) -> Plane:
    """Return the `Plane` of a cell in double precision.

    Raises `InputError` for terms of the user's own, which need not be autonomous.
    """
    chosen = select_terms(terms)
    for term in chosen:
        if term.kind == "custom":
            raise InputError("terms", term.name, "terms of the model, which do not depend on time", "omit it")
    fields = [value for _, value in params.items() if isinstance(value, np.ndarray)]
    free = tuple(all(np.ptp(field, axis=axis).max() == 0 for field in fields) for axis in (0, 1))
    return Plane(system(params, grid, chosen, dealias), (free[0], free[1]))


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
            return self._flat(_apply(self.tangent, self.symbol, self._spectrum(vectors)))

    @property
    def diagonal(self) -> Array:
        """The symbol of diffusion and rotational diffusion, (size,)."""
        return np.repeat(self.linear.ravel(), 2)

    def fastest(self, vector: Array) -> float:
        """Return an estimate of the largest rate in J beside its diagonal part, from any vector."""
        with double():
            return float(_fastest(self.tangent, self._spectrum(vector)))

    def evolved(self, vectors: Array, step: float, steps: int) -> Array:
        """Return v (rows, size) after some steps in time of dv/dt = J v, to the accuracy of ETD2RK."""
        with double():
            begun = [self._spectrum(vector) for vector in vectors]
            found = [_evolved(self.tangent, self.symbol, spectrum, step, steps) for spectrum in begun]
        return np.stack([self._flat(spectrum) for spectrum in found])

    def _spectrum(self, vector: Array) -> Any:
        return np.ascontiguousarray(vector).view(np.complex128).reshape(self.shape)

    def _flat(self, spectrum: Any) -> Array:
        return np.array(spectrum).ravel().view(np.float64)


@jax.jit
def _rate(cell: System, spectrum: Any) -> Any:
    return cell.space.keep * cell.rate(cell.at(spectrum))


@jax.jit
def _tangent(cell: System, spectrum: Any) -> Any:
    """Return the derivative of the nonlinear terms as a function that is linear over the reals."""

    def nonlinear(moved: Any) -> Any:
        return cell.space.keep * cell.nonlinear(cell.at(moved))

    return jax.linearize(nonlinear, spectrum)[1]


@jax.jit
def _apply(tangent: Any, symbol: Any, spectrum: Any) -> Any:
    return symbol * spectrum + tangent(spectrum)


@jax.jit
def _fastest(tangent: Any, spectrum: Any) -> Any:
    """Return an estimate of the largest rate of the nonlinear terms: their growth under iteration."""

    def again(_: Any, carry: Any) -> Any:
        spectrum = tangent(carry[0])
        size = jnp.sqrt(jnp.sum(jnp.abs(spectrum) ** 2))
        return spectrum / size, size

    return jax.lax.fori_loop(0, 12, again, (spectrum, jnp.zeros(())))[1]


@jax.jit
def _evolved(tangent: Any, symbol: Any, spectrum: Any, h: Any, steps: Any) -> Any:
    """Step dv/dt = L v + N v by ETD2RK: a = e^{hL} v + h φ₁ N v, then v = a + h φ₂ N (a - v)."""
    z = h * symbol
    first, second, _ = phi(z)
    decay, first, second = jnp.exp(z), h * first, h * second

    def one(_: Any, v: Any) -> Any:
        rate = tangent(v)
        a = decay * v + first * rate
        return a + second * (tangent(a) - rate)

    return jax.lax.fori_loop(0, steps, one, spectrum)
