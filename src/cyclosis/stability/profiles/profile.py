"""The steady state of straight stripes: one profile across them, found by Newton's method.

A state P(theta) e_z that does not vary along the cell is steady where

    d_s P'' - d_r P + (1 - P²)(α_p P + α_u u) = 0,    -μ u'' + u + Π₀ = F = |P|ⁿ P,    <u> = 0 .

Stripes of equal width are odd about every indifferent zone, so P is sought among odd functions: sines on
the interior points of half a circle. That excludes rotations, which would make Newton's matrix singular,
and the uniform states. Two stripes are found; 2k stripes are the same profile repeated k times.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import gcd
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from ...analysis.zones import stripe_widths, zone_angles
from ...display.shown import shown
from ...model.arrays import numbers
from ...model.doors import door
from ...model.errors import InputError, number, whole
from ...model.grid import Array
from ...model.parameters import Parameters
from .eigenmodes import Modes, profile_modes

if TYPE_CHECKING:
    import xarray

__all__ = [
    "SMALLEST",
    "UNRESOLVED",
    "Profile",
    "check",
    "cyclosis",
    "stripes",
]


def __dir__() -> list[str]:
    return sorted(__all__)


SMALLEST = 1e-5
"""A state with no larger |P| counts as disorder."""
UNRESOLVED = 1e-2
"""A profile whose interpolant has a larger |dP/dt| between its points is refused."""
_TOLERANCE = 1e-12
_ITERATIONS = 400


@shown
@dataclass(frozen=True, eq=False)
class Profile:
    """A steady state P(theta) e_z of stripes and its flow u(theta) e_z, dimensionless.

    `theta`, `P`, `u` (n_theta,) are the angles in radians, the axial polarity and the axial flow, with an
    indifferent zone at theta = 0 where P turns upward; `pressure_gradient` is Π₀; `residual` the largest
    |dP/dt| of the trigonometric interpolant on twice as many points; `count` the number of stripes.

    Example:
        >>> import cyclosis as cy
        >>> state = cy.stability.cyclosis(cy.Parameters(), n_theta=128)
        >>> state.count, state.P.shape, state.widths.round(6), state.residual < 1e-6
        (2, (128,), array([0.5, 0.5]), True)
        >>> P, u = state.at([1.0], zone=1.0)
        >>> bool(abs(P[0]) < 1e-9), sorted(state.to_dataset().data_vars)
        (True, ['P', 'u'])
    """

    theta: Array
    P: Array
    u: Array
    pressure_gradient: float
    residual: float
    params: Parameters
    count: int

    @door
    def at(self, angles: npt.ArrayLike, zone: float = 0.0) -> tuple[Array, Array]:
        """Return P and u at `angles` (...), in radians, with an upward zero crossing at the angle `zone`.

        Trigonometric interpolation, so that a resolved profile is exact between its points. Raises
        `InputError` for values that are not angles.
        """
        upward = number("zone", zone, -1e6, 1e6, "the default is 0")
        theta = numbers("angles", angles, "an array of angles", "give radians") - upward
        n = self.theta.size
        m = np.arange((n + 1) // 2)
        waves = np.fft.rfft(np.stack([self.P, self.u]), norm="forward")[:, m] * np.where(m == 0, 1.0, 2.0)
        angle = theta[..., None] * m
        found = np.cos(angle) @ waves.real.T - np.sin(angle) @ waves.imag.T
        return found[..., 0], found[..., 1]

    @property
    def widths(self) -> Array:
        """Fractions (count,) of the turn that the stripes take, beginning with the one that points up."""
        zones = zone_angles(self.P)
        # The zone at 0 may be found on either side of it.
        last = 2 * np.pi - np.pi / self.theta.size
        return stripe_widths(np.sort(np.where(zones > last, zones - 2 * np.pi, zones)))

    def spectrum(
        self, count: int = 8, axial_mode: int = 0, length: float = 5.0, components: str = "both"
    ) -> Modes:
        """Return the `count` leading `Modes`: .eigenvalues (count,), largest real part first, and .modes.

        Of perturbations v(theta) e^{iqz} with `axial_mode` waves along a cell of the given `length`
        (dimensionless), on the right-hand side of the simulation. With axial_mode 0 `components` may be
        "z", the paper's non-local Sturm-Liouville problem, or "theta". The neutral rotation is among
        them, with the eigenvalue 0. Raises `InputError` for settings out of range.

        Example:
            >>> import cyclosis as cy
            >>> state = cy.stability.cyclosis(cy.Parameters(alpha_p=0.2, alpha_u=0.5), n_theta=128)
            >>> rates = state.spectrum(2, components="z").eigenvalues.real
            >>> bool(abs(rates[0]) < 1e-6), bool(rates[1] < -1e-3)  # the neutral rotation; all others decay
            (True, True)
        """
        return profile_modes(self.params, self.P, count, axial_mode, length, components)

    def to_dataset(self) -> xarray.Dataset:
        """Return the state as an `xarray.Dataset` over `theta`."""
        import xarray

        return xarray.Dataset(
            {"P": ("theta", self.P), "u": ("theta", self.u)},
            coords={"theta": self.theta},
            attrs={
                "count": self.count,
                "pressure_gradient": self.pressure_gradient,
                "residual": self.residual,
                **{name: float(value) for name, value in self.params.items()},
            },
        )


@door
def cyclosis(params: Parameters, n_theta: int = 256) -> Profile:
    """Return the steady state of two stripes: up on one half of the cell, down on the other.

    `params` are numbers (fields are refused); the profile converges exponentially in `n_theta`. Raises
    `InputError` where no such state is found; disorder and uniform states are never returned.

    Example:
        >>> import cyclosis as cy
        >>> state = cy.stability.cyclosis(cy.Parameters(alpha_p=1.0, alpha_u=0.5))
        >>> round(float(state.P.max()), 4), round(float(state.u.max()), 4)
        (0.9916, 0.9714)
    """
    return stripes(params, 2, n_theta)


@door
def stripes(params: Parameters, count: int = 2, n_theta: int = 256) -> Profile:
    """Return the steady state of `count` stripes of equal width, alternately up and down.

    As `cyclosis`, for an even `count` of at least 2. The state is steady, not necessarily stable. Raises
    `InputError` where no such state is found.

    Example:
        >>> import cyclosis as cy
        >>> cy.stability.stripes(cy.Parameters(), count=4, n_theta=128).widths.round(6)
        array([0.25, 0.25, 0.25, 0.25])
    """
    n = whole("n_theta", n_theta, 16, 8192, "choose a number of points")
    count = whole("count", count, 2, n // 8, "choose an even number of stripes, or more points")
    if count % 2:
        raise InputError("count", count, "even, because stripes alternate", "choose an even number")
    check(params)
    turns = count // 2
    # The angle turns · θ_i of the single period is again a point of one with n / shared points.
    shared = gcd(n, turns)
    period = n // shared
    problem = _Problem(params, period, turns)
    p = _steady(problem)
    if p is None:
        point = ", ".join(f"{name} = {getattr(params, name):g}" for name in ("alpha_p", "alpha_u", "d_s"))
        rule = f"where a steady state of {count} stripes exists, and none was found: ordered stripes decay"
        raise InputError("the parameter point", point, rule, "raise alpha_p or alpha_u, or lower d_s")
    place = turns // shared * np.arange(n) % period
    P, u = _odd(p, period)[place], _odd(problem.flow(p), period)[place]
    residual = _between(params, P)
    if residual > UNRESOLVED:
        rule = f"enough to resolve the zones between stripes (|dP/dt| is {residual:.1g} between points)"
        raise InputError("n_theta", n, rule, "double it")
    theta = 2 * np.pi / n * np.arange(n, dtype=np.float64)
    return Profile(theta, P, u, float(np.mean(_force(P, params.force_exponent))), residual, params, count)


@door
def check(params: Parameters) -> None:
    """Raise `InputError` for parameters under which stripes along the axis are not a solution.

    Example:
        >>> import cyclosis as cy
        >>> from cyclosis.stability.profiles.profile import check
        >>> check(cy.Parameters(repulsion_angle=0.3))
        Traceback (most recent call last):
            ...
        cyclosis.model.errors.InputError: repulsion_angle = 0.3 cannot be used: ...
    """
    for name, value in params.items():
        if isinstance(value, np.ndarray):
            raise InputError(name, value, "one number for a profile", "simulate a cell with fields instead")
    if params.kappa > 0 and abs(np.sin(params.repulsion_angle)) > 1e-12:
        rule = "0 or π, so that repulsion does not act on stripes along the axis"
        raise InputError("repulsion_angle", params.repulsion_angle, rule, "change it or set kappa to 0")


def _sines(n: int) -> Array:
    """Return sin(m theta_j) (modes, points) on the interior points of half a circle of n points.

    Times its transpose it is n/4.
    """
    inner = np.arange(1, (n + 1) // 2)
    return np.sin(2 * np.pi / n * (np.outer(inner, inner) % n))


def _odd(p: Array, n: int) -> Array:
    """Return the odd function (n,) whose values on the interior points of half a circle are p."""
    values = np.zeros(n)
    values[1 : p.size + 1] = p
    values[n - p.size :] = -p[::-1]
    return values


def _force(p: Array, exponent: float) -> Array:
    return np.abs(p) ** exponent * p


class _Problem:
    """The equations on the interior points of half a period; the period occurs `turns` times around."""

    def __init__(self, params: Parameters, n: int, turns: int) -> None:
        sines = _sines(n)
        m2 = (turns * np.arange(1.0, (n + 1) // 2)) ** 2
        self.params = params
        self.laplacian = -(sines.T * (4.0 / n * m2)) @ sines
        self.mobility = (sines.T * (4.0 / n / (1 + params.mu * m2))) @ sines
        self.angle = 2 * np.pi / n * np.arange(1, (n + 1) // 2)

    def flow(self, p: Array) -> Array:
        """Return the flow u of a profile; oddness keeps <u> and Π₀ at zero."""
        flow: Array = self.mobility @ _force(p, self.params.force_exponent)
        return flow

    def rate(self, p: Array) -> Array:
        """Return dP/dt of a profile."""
        a = self.params
        torque = a.alpha_p * p + a.alpha_u * self.flow(p)
        rate: Array = a.d_s * (self.laplacian @ p) - a.d_r * p + (1 - p**2) * torque
        return rate

    def jacobian(self, p: Array) -> Array:
        """Return the derivative of `rate`."""
        a, n = self.params, self.params.force_exponent
        torque = a.alpha_p * p + a.alpha_u * self.flow(p)
        steep = (n + 1) * np.abs(p) ** n
        local = (1 - p**2) * a.alpha_p - 2 * p * torque - a.d_r
        jacobian: Array = a.d_s * self.laplacian + ((1 - p**2) * a.alpha_u)[:, None] * self.mobility * steep
        jacobian[np.diag_indices_from(jacobian)] += local
        return jacobian

    def guess(self) -> Array:
        """Return nearly full order, up on one half of the period and down on the other."""
        a = self.params
        zone = np.sqrt(2 * a.d_s / max(a.alpha_p + a.alpha_u, 1e-12))
        spacing = self.angle[0]
        return 0.95 * np.tanh(np.sin(self.angle) / min(max(zone, spacing), 1e3))


def _steady(problem: _Problem) -> Array | None:
    """Return the steady profile to which full order relaxes, or None if that is disorder.

    Implicit time steps lengthen as the state approaches a steady one, until they are Newton's. Far from it
    they follow the dynamics, which do not jump from stripes to disorder as Newton's method may.
    """
    p, step = problem.guess(), 0.5
    rate = problem.rate(p)
    unit = np.eye(p.size)
    for _ in range(_ITERATIONS):
        size = float(np.abs(rate).max())
        if np.abs(p).max() < SMALLEST:
            return None
        trial = p + np.linalg.solve(unit / step - problem.jacobian(p), rate)
        now = problem.rate(trial)
        after = float(np.abs(now).max())
        if np.abs(trial).max() > 1 or not after <= 2 * size or np.abs(trial - p).max() > 0.2:
            step *= 0.25
            continue
        p, rate = trial, now
        # Rounding in P'' limits the residual; once steps are Newton's, a rate that no longer falls is at it.
        if after <= _TOLERANCE or (step > 1e8 and after > 0.5 * size and after < 1e-8):
            return p if np.abs(p).max() >= SMALLEST and np.all(p > 0) else None
        step *= min(max(2.0, size / after), 1e3)
    return None


def _between(params: Parameters, P: Array) -> float:
    """Return the largest |dP/dt| of the interpolant of an odd P (n,) on twice as many points."""
    n, p = P.size, P[1 : (P.size + 1) // 2]
    waves = np.sin(np.pi / n * (np.outer(np.arange(1, n), np.arange(1, (n + 1) // 2)) % (2 * n)))
    fine = waves @ (_sines(n) @ p) * (4.0 / n)
    return float(np.abs(_Problem(params, 2 * n, 1).rate(fine)).max())
