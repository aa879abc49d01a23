"""The kinetic equation of states that do not vary along the cell, on their wavenumbers around it.

The right-hand side is that of `cyclosis.models.kinetic.system` itself, as a run on the same points evaluates
it, so that a steady state found here is one of the whole cell, to rounding. The concentration is 1. A state
is a complex array a (N, p): the moment m_n(θ) = Σ_k a_nk e^{ikθ}, n = 1, ..., N, k = -K, ..., K, p = 2K + 1.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import numpy.typing as npt

from ...dynamics.advance import Control, advance, start
from ...model.errors import InputError
from ...model.grid import Array, CylinderGrid
from ...model.parameters import Parameters
from ...model.precision import on_host
from ...models import polar
from ...models.kinetic.system import KineticSystem, kinetic_system
from ..profiles.reduced import reduced
from ..profiles.travelling import LENGTH

Complex = npt.NDArray[np.complex128]

RTOL, ATOL = 1e-4, 1e-10
MOST_STEPS = 1_000_000


@dataclass(frozen=True, eq=False)
class Line:
    """The equation on `n` points around with moments up to N = `modes`, dimensionless.

    `params` holds a_p and a_u in place of α_p and α_u.
    """

    params: Parameters
    n: int
    modes: int

    @cached_property
    def system(self) -> KineticSystem:
        """The right-hand side, on the points around alone."""
        whole = reduced(self.params, CylinderGrid(self.n, 8, LENGTH))
        with on_host():
            return jax.device_put(kinetic_system(whole.line, self.modes))

    @cached_property
    def k(self) -> Array:
        """The wavenumbers (p,): all but the Nyquist one."""
        most = (self.n - 1) // 2
        return np.arange(-most, most + 1.0)

    @cached_property
    def theta(self) -> Array:
        """The points (n,)."""
        return CylinderGrid(self.n, 8).theta

    @cached_property
    def waves(self) -> Complex:
        """e^{ikθ} (n, p): values at the points are `waves @ amplitudes`."""
        return np.exp(1j * np.outer(self.theta, self.k))

    def at(self, params: Parameters) -> Line:
        """Return the equation with other parameters."""
        return replace(self, params=params)

    def moments(self, a: Complex) -> Complex:
        """Return m_0, ..., m_N (N + 1, n) at the points."""
        return np.concatenate([np.ones((1, self.n)), a @ self.waves.T])

    def state(self, moments: Any) -> Complex:
        """Return a (N, p) of moments (any number, n) at the points; those that are lacking are 0."""
        found = np.zeros((self.modes, self.k.size), dtype=np.complex128)
        given = np.asarray(moments)[1 : self.modes + 1]
        found[: len(given)] = given @ self.waves.conj() / self.n
        return found

    def resampled(self, other: Line, a: Complex) -> Complex:
        """Return a state of this equation as one of another with other points or moments."""
        found = np.zeros((other.modes, other.k.size), dtype=np.complex128)
        common, modes = min(self.k.size, other.k.size) // 2, min(self.modes, other.modes)
        mine, its = (
            slice(line.k.size // 2 - common, line.k.size // 2 + common + 1) for line in (self, other)
        )
        found[:modes, its] = a[:modes, mine]
        return found

    def slope(self, a: Complex) -> Complex:
        """Return the derivative of a state along theta."""
        return 1j * self.k * a

    def rate(self, a: Complex) -> Complex:
        """Return da/dt (N, p)."""
        with on_host():
            return self._picked(np.asarray(_rate(self.system, self._spectrum(a))))

    def flow(self, a: Complex) -> Array:
        """Return the flow (2, n) at the points."""
        with on_host():
            u = np.asarray(_flow(self.system, self._spectrum(a))).ravel()
        return np.stack([u.real, u.imag])

    def relaxed(self, a: Complex, duration: float) -> Complex:
        """Return a state after a time, with the default tolerances of `simulate`."""
        control = Control.of(RTOL, ATOL, polar.bound)
        with on_host():
            began = start(self.system, self._spectrum(a), np.float64(0.0))
            end = advance(self.system, control, began, np.float64(duration), np.int64(MOST_STEPS))
        if bool(end.failed):
            raise InputError("modes", self.modes, "enough for a run from these stripes", "raise it")
        return self._picked(np.asarray(end.spectrum))

    def _spectrum(self, a: Complex) -> Complex:
        found = np.zeros((self.modes + 1, self.n, 1), dtype=np.complex128)
        found[0, 0, 0] = self.n
        found[1:, self.k.astype(int), 0] = self.n * a
        return found

    def _picked(self, spectrum: Any) -> Complex:
        return np.asarray(spectrum[1:, self.k.astype(int), 0] / self.n, dtype=np.complex128)


@jax.jit
def _rate(system: KineticSystem, spectrum: Any) -> Any:
    return system.rate(system.at(spectrum))


@jax.jit
def _flow(system: KineticSystem, spectrum: Any) -> Any:
    return jnp.fft.ifft2(system.at(spectrum).flow_spectrum)


def mirrored(a: Complex) -> Complex:
    """Return the amplitudes of the conjugate field, conj(a_{-k}), of amplitudes (..., p)."""
    return np.conj(a[..., ::-1])
