"""Equal stripes and the growth of each family of their perturbations, as functions of α_u.

The equation is that of the simulation for states P_z(θ) (see `reduced`), restricted to the symmetry
families of `families`. In the state's own family it has neither the neutral rotation nor the growth of
unequal widths, so that Newton's method is well conditioned however weakly the stripes interact.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from ...model.errors import InputError
from ...model.grid import Array, CylinderGrid
from ...model.parameters import Parameters
from ...model.precision import on_host
from ..profiles.profile import stripes
from ..profiles.reduced import reduced

OWN, WIDTHS, ROTATION, SHAPES = FAMILIES = ("own", "widths", "rotation", "shapes")


def bases(n: int, count: int = 2) -> dict[str, Array]:
    """Return an orthonormal basis (n, size) of each family on n points, without the Nyquist mode."""
    theta = 2 * np.pi / n * np.arange(n)
    per_stripe = np.arange(0, (n + 1) // 2, count // 2)
    even, odd = per_stripe[::2], per_stripe[1::2]
    waves = {
        OWN: np.sin(np.outer(theta, odd)),
        WIDTHS: np.cos(np.outer(theta, even)),
        ROTATION: np.cos(np.outer(theta, odd)),
        SHAPES: np.sin(np.outer(theta, even[1:])),
    }
    return {name: wave / np.linalg.norm(wave, axis=0) for name, wave in waves.items()}


STEPS, FEW = 40, 10
CLOSE = 1e-7
"""Largest change in a step of Newton's method after which only rounding error remains."""
LONGEST = 0.5


class Equal(NamedTuple):
    """A state of equal stripes P (n,) at some α_u, and dα_u/d(amplitude) (NaN if not computed).

    The amplitude is twice the sine coefficient of P on the first wavenumber.
    """

    P: Array
    alpha_u: float
    slope: float = np.nan


class Leading(NamedTuple):
    """The leading growth rate of a family, its error from rounding, and its derivative by α_u."""

    rate: float
    rounding: float
    slope: float = np.nan


class EqualStripes:
    """The one-dimensional equation of `count` equal stripes on n points; α_u is an argument throughout."""

    def __init__(self, params: Parameters, count: int, n: int) -> None:
        self.params, self.count, self.n = params, count, n
        self.line = reduced(params, CylinderGrid(n, 8)).line
        self.bases = bases(n, count)
        self.theta = 2 * np.pi / n * np.arange(n)

    def full(self, alpha_u: float) -> Equal:
        """Return the steady state to which full order relaxes; raises `InputError` if there is none."""
        state = stripes(self.params.replace(alpha_u=alpha_u), self.count, self.n)
        return Equal(state.P, alpha_u)

    def steady(self, alpha_u: float, guess: Array) -> Equal:
        """Return the steady state next to a guess (n,), or else the one to which full order relaxes."""
        return self.beside(alpha_u, guess) or self.full(alpha_u)

    def beside(self, alpha_u: float, guess: Array) -> Equal | None:
        """Return the steady state next to a guess (n,), or None where Newton's method finds no stripes."""
        P = guess
        for _ in range(STEPS):
            change = self._own(P, alpha_u, self.rate(P, alpha_u))
            if not np.all(np.isfinite(change)) or np.abs(change).max() > LONGEST:
                return None
            P = P - change
            if np.abs(change).max() < CLOSE:
                return Equal(P, alpha_u) if self.striped(P) else None
        return None

    def at_amplitude(self, amplitude: float, near: Equal) -> Equal:
        """Return the steady state of a given amplitude next to another one; α_u follows from it.

        Takes smaller steps if needed. Raises `InputError` where they fail.
        """
        begin = self.amplitude(near.P)
        for steps in (1, 2, 4, 8, 16):
            state: Equal | None = near
            for share in np.arange(1, steps + 1) / steps:
                state = state and self._amplified(begin + share * (amplitude - begin), state)
            if state:
                return state
        rule = f"where {self.count} stripes can be continued, and at amplitude {amplitude:.3g} they cannot"
        raise InputError("the parameter point", self.point, rule, "raise alpha_p, or lower d_s or mu")

    def leading(self, state: Equal, family: str) -> Leading:
        """Return the largest growth rate of a family about a state."""
        matrix = self.bases[family].T @ self.columns(state.P, state.alpha_u, family)
        rounding = float(np.finfo(float).eps * np.abs(matrix).sum(axis=1).max())
        return Leading(float(np.linalg.eigvals(matrix).real.max()), rounding)

    def rates(self, state: Equal, family: str) -> Array:
        """Return the real parts of all growth rates of a family, the largest first."""
        matrix = self.bases[family].T @ self.columns(state.P, state.alpha_u, family)
        return -np.sort(-np.linalg.eigvals(matrix).real)

    def sloping(self, state: Equal, family: str) -> Leading:
        """Return the largest growth rate of a family, a real one, and its derivative along the branch.

            dλ/dα_u = w · (∂L/∂α_u + ∂L/∂P [dP/dα_u]) v

        with the right and left eigenvectors v and w, w · v = 1. The rounding error is relative to the
        derivative itself, not to L, because λ is the only eigenvalue of L near 0 in this family.
        """
        basis = self.bases[family]
        matrix = basis.T @ self.columns(state.P, state.alpha_u, family)
        values, vectors = np.linalg.eig(matrix)
        rounding = float(np.finfo(float).eps * np.abs(matrix).sum(axis=1).max())
        found = int(np.argmax(values.real))
        duals = np.linalg.inv(vectors)
        right, left = basis @ vectors[:, found].real, basis @ duals[found].real
        right, left = right / np.abs(right).max(), left * np.abs(right).max()
        left = left / (left @ right)
        change = -self._own(state.P, state.alpha_u, self.drive(state.P, state.alpha_u))
        with on_host():
            bend = np.asarray(_bend(self.line, state.P, state.alpha_u, right, change))
        return Leading(float(values[found].real), rounding, float(left @ bend))

    def rate(self, P: Array, alpha_u: float) -> Array:
        """Return dP_z/dt (n,)."""
        with on_host():
            return np.asarray(_rate(self.line, P, alpha_u))

    def drive(self, P: Array, alpha_u: float) -> Array:
        """Return the derivative of dP_z/dt by α_u (n,)."""
        with on_host():
            return np.asarray(_drive(self.line, P, alpha_u))

    def columns(self, P: Array, alpha_u: float, family: str) -> Array:
        """Return the linearised equation applied to the basis of a family (n, size)."""
        return self.applied(P, alpha_u, self.bases[family])

    def applied(self, P: Array, alpha_u: float, basis: Array) -> Array:
        """Return the linearised equation applied to the columns of a matrix (n, size)."""
        with on_host():
            return np.asarray(_columns(self.line, P, alpha_u, basis))

    def amplitude(self, P: Array) -> float:
        """Return twice the sine coefficient of P on the first wavenumber."""
        return 2.0 / self.n * float(np.sin(self.theta * (self.count // 2)) @ P)

    def striped(self, P: Array) -> bool:
        """Return whether P is positive throughout the first stripe, and |P| below 1 everywhere."""
        inside = self.theta * self.count < 2 * np.pi * (1 - 1e-9)
        return bool(np.all(P[inside][1:] > 0) and np.abs(P).max() < 1)

    @property
    def point(self) -> str:
        """The parameter point in words."""
        return ", ".join(f"{name} = {getattr(self.params, name):g}" for name in ("alpha_p", "d_s", "d_r"))

    def _amplified(self, amplitude: float, near: Equal) -> Equal | None:
        """Return the state of an amplitude to which Newton's method leads, for P and α_u together."""
        own = self.bases[OWN]
        first = 2.0 / self.n * (own.T @ np.sin(self.theta * (self.count // 2)))
        P, alpha_u, size = near.P, near.alpha_u, first.size
        for _ in range(FEW):
            bordered = np.zeros((size + 1, size + 1))
            bordered[:size, :size] = own.T @ self.columns(P, alpha_u, OWN)
            bordered[:size, size] = own.T @ self.drive(P, alpha_u)
            bordered[size, :size] = first
            wrong = np.append(own.T @ self.rate(P, alpha_u), first @ (own.T @ P) - amplitude)
            change, along = np.linalg.solve(bordered, np.stack([wrong, np.eye(size + 1)[-1]], axis=1)).T
            step = own @ change[:size]
            if not np.abs(step).max() < LONGEST:
                return None
            P, alpha_u = P - step, alpha_u - float(change[size])
            if np.abs(step).max() < CLOSE:
                return Equal(P, alpha_u, float(along[size])) if self.striped(P) else None
        return None

    def _own(self, P: Array, alpha_u: float, right: Array) -> Array:
        """Return what the linearised equation maps to `right`, in the state's own family."""
        own = self.bases[OWN]
        try:
            return own @ np.linalg.solve(own.T @ self.columns(P, alpha_u, OWN), own.T @ right)
        except np.linalg.LinAlgError:
            return np.full(self.n, np.nan)


def _axial(line: Any, P: Any, alpha_u: Any) -> Any:
    system = line.with_values(line.values._replace(alpha_u=alpha_u))
    packed = jax.lax.complex(jnp.zeros_like(P), P).reshape(line.space.shape)
    return jnp.fft.ifft2(system.rate(system.at(jnp.fft.fft2(packed)))).imag.ravel()


_rate = jax.jit(_axial)


@jax.jit
def _drive(line: Any, P: Any, alpha_u: Any) -> Any:
    return jax.jvp(lambda value: _axial(line, P, value), (alpha_u,), (jnp.ones_like(alpha_u),))[1]


@jax.jit
def _columns(line: Any, P: Any, alpha_u: Any, basis: Any) -> Any:
    def column(v: Any) -> Any:
        return jax.jvp(lambda p: _axial(line, p, alpha_u), (P,), (v,))[1]

    return jax.vmap(column, in_axes=1, out_axes=1)(basis)


@jax.jit
def _bend(line: Any, P: Any, alpha_u: Any, v: Any, change: Any) -> Any:
    """Return the derivative of L v along the branch, on which P changes by `change` per α_u."""

    def act(p: Any, value: Any) -> Any:
        return jax.jvp(lambda state: _axial(line, state, value), (p,), (v,))[1]

    return jax.jvp(act, (P, alpha_u), (change, jnp.ones_like(alpha_u)))[1]
