"""Stripes without alignment by flow, α_u = 0: exact in Jacobi's elliptic functions.

With a = α_p - d_r the steady state d_s P'' + a P - α_p P³ = 0 of `count` equal stripes is

    P = Pm sn(θ/ξ, k),    Pm² = 2k²/(1 + k²) a/α_p,    ξ² = d_s (1 + k²)/a,    2 K(k) ξ count = 2π,

which exists while a > d_s (count/2)². Its perturbations obey Lamé's equations, for P_z with 6k² sn² and
for P_theta with 2k² sn², whose leading solutions on the period of the state are elementary: in units of
a/(1 + k²), with r = (1 - k² + k⁴)^½,

    P_z:       2r - (1 + k²) (widths),   0 (rotation),   -3k²,   -3,   -2r - (1 + k²)
    P_theta:   1,   k²,   0,             each less κ.

The first is positive, and for two stripes the only positive one; it is driven only by the overlap of the
fronts, so that it is exponentially small where they are narrow. Own derivation; all is dimensionless.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from scipy.optimize import brentq
from scipy.special import ellipj, ellipk, ellipkm1

from ...model.arrays import numbers
from ...model.doors import door
from ...model.errors import InputError, whole
from ...model.grid import Array
from ...model.parameters import Parameters
from ...model.wording import beside

__all__ = [
    "LEAST",
    "complementary",
    "elliptic_growth",
    "elliptic_profile",
    "elliptic_rates",
    "front_threshold",
]


def __dir__() -> list[str]:
    return sorted(__all__)


LEAST = 1e-150
"""Smallest complementary parameter 1 - k² that is used: the growth rate is proportional to its square."""


@door
def elliptic_profile(params: Parameters, theta: npt.ArrayLike, count: int = 2) -> Array:
    """Return P (...) at angles `theta` (...) of `count` equal stripes at α_u = 0, in closed form.

    P turns upward at theta = 0. `params` are numbers; their α_u is ignored. Raises `InputError` where there
    is no such state.

    Example:
        >>> import numpy as np
        >>> import cyclosis as cy
        >>> params = cy.Parameters(alpha_p=0.5, alpha_u=0.0)
        >>> found = cy.stability.cyclosis(params, n_theta=128)
        >>> bool(np.allclose(cy.stability.elliptic_profile(params, found.theta), found.P, atol=1e-8))
        True
    """
    k1 = complementary(params, count)
    a, k2 = params.alpha_p - params.d_r, 1 - k1
    angles = numbers("theta", theta, "an array of angles", "give radians")
    u = angles * (count * ellipkm1(k1) / np.pi)
    return np.asarray(np.sqrt(2 * k2 / (1 + k2) * a / params.alpha_p) * _sn(u, k1), dtype=np.float64)


@door
def elliptic_growth(params: Parameters, count: int = 2) -> float:
    """Return the rate (per R/U) at which widths of stripes grow unequal at α_u = 0, the largest of P_z.

        λ = a [2 (1 - k² + k⁴)^½ - (1 + k²)]/(1 + k²)    →    96 a exp(-2π (a/2d_s)^½) for two narrow zones

    The difference is evaluated without cancellation, so that all digits are correct however small λ is. With
    more than two stripes it is the rate at which all that point up grow at the expense of all others. Raises
    `InputError` where there is no such state.

    Example:
        >>> import cyclosis as cy
        >>> params = cy.Parameters(alpha_p=0.2, alpha_u=0.0)
        >>> modes = cy.stability.cyclosis(params, n_theta=64).spectrum(1, components="z")
        >>> round(cy.stability.elliptic_growth(params), 6), round(float(modes.eigenvalues[0].real), 6)
        (0.000132, 0.000132)
    """
    k1 = complementary(params, count)
    k2 = 1 - k1
    root = np.sqrt(1 - k2 + k2**2)
    return float((params.alpha_p - params.d_r) * 3 * k1**2 / ((1 + k2) * (2 * root + 1 + k2)))


@door
def elliptic_rates(params: Parameters, count: int = 2) -> tuple[Array, Array]:
    """Return the growth rates at α_u = 0 known in closed form, of P_z (5,) and of P_theta (3,).

    In the order of the text above, largest first. d must point along theta where κ is not 0. Raises
    `InputError` where there is no such state.

    Example:
        >>> import cyclosis as cy
        >>> from cyclosis.stability.profiles.elliptic import elliptic_rates
        >>> params = cy.Parameters(alpha_p=0.2)
        >>> axial, around = elliptic_rates(params)
        >>> axial.shape, around.shape, abs(float(axial[0]) - cy.stability.elliptic_growth(params)) < 1e-12
        ((5,), (3,), True)
    """
    k2 = 1 - complementary(params, count)
    unit = (params.alpha_p - params.d_r) / (1 + k2)
    last = -2 * np.sqrt(1 - k2 + k2**2) - (1 + k2)
    axial = unit * np.array([0.0, 0.0, -3 * k2, -3.0, last])
    axial[0] = elliptic_growth(params, count)
    return axial, unit * np.array([1.0, k2, 0.0]) - params.kappa


@door
def front_threshold(params: Parameters, count: int = 2) -> float:
    """Return the α_u, estimated from the motion of fronts, above which stripes do not grow unequal together.

        α_u* = 2π λ / [3 w count P0ⁿ (1 - P0²/3)],   w = (2 d_s/a)^½,   P0² = a/α_p,   λ = `elliptic_growth`

    Zones that move by δ each, so that all stripes that point up widen, change the mean force by
    count P0ⁿ⁺¹ δ/π and, because <u> = 0, the flow everywhere by the opposite amount: it drives them back,
    against λ. Two stripes are then stable. Accurate where the zones are narrow. Raises `InputError` where
    there is no such state at α_u = 0.

    Example:
        >>> import cyclosis as cy
        >>> params = cy.Parameters(alpha_p=0.15)
        >>> round(cy.stability.front_threshold(params) / cy.stability.threshold(params), 2)
        1.0
    """
    rate = elliptic_growth(params, count)
    a = params.alpha_p - params.d_r
    order, width = np.sqrt(a / params.alpha_p), np.sqrt(2 * params.d_s / a)
    drive = 1.5 * count * width * order**params.force_exponent * (1 - order**2 / 3)
    return float(np.pi * rate / drive)


@door
def complementary(params: Parameters, count: int = 2) -> float:
    """Return 1 - k² of the elliptic state, from K(k) (1 + k²)^½ = π (a/d_s)^½ / count.

    Raises `InputError` where there is no such state, and where 1 - k² is too small for a double.

    Example:
        >>> import cyclosis as cy
        >>> from cyclosis.stability.profiles.elliptic import complementary
        >>> narrow, wide = (complementary(cy.Parameters(alpha_p=x)) for x in (1.0, 0.1))
        >>> narrow < wide
        True
    """
    count = whole("count", count, 2, 1024, "choose an even number of stripes")
    if count % 2:
        raise InputError("count", count, "even, because stripes alternate", "choose an even number")
    for name, value in params.items():
        if isinstance(value, np.ndarray):
            raise InputError(name, value, "one number for a closed form", "choose a number")
    a, least = params.alpha_p - params.d_r, params.d_s * (count / 2) ** 2
    if not a > least:
        least += params.d_r
        there = f"where {count} stripes exist at alpha_u = 0"
        rule = f"above d_r + d_s (count/2)² = {beside(float(least), float(params.alpha_p))}, {there}"
        raise InputError("alpha_p", params.alpha_p, rule, "raise it")
    narrow = a * (np.pi / count / _quarter(LEAST)) ** 2
    if params.d_s < narrow:
        least_d_s = beside(float(narrow), params.d_s, 3)
        rule = f"at least {least_d_s}, below which the interaction of zones underflows in double precision"
        raise InputError("d_s", params.d_s, rule, "raise it or lower alpha_p")
    found = brentq(_excess, np.log(LEAST), 0.0, (a, params.d_s, count), xtol=1e-14, rtol=1e-15)
    return float(np.exp(found))


def _quarter(k1: float) -> float:
    return float(ellipkm1(k1) * np.sqrt(2 - k1))


def _excess(log_k1: float, a: float, d_s: float, count: int) -> float:
    return _quarter(float(np.exp(log_k1))) - np.pi / count * np.sqrt(a / d_s)


def _sn(u: Array, k1: float) -> Array:
    """Return sn(u, k), for k near 1 as a sum of fronts, which is accurate even where k² rounds to 1.

    sn u = π/(2 k K') Σ_n (-1)ⁿ tanh[π (u - 2nK)/(2K')].
    """
    if k1 > 0.5:
        return np.asarray(ellipj(u, 1 - k1)[0], dtype=np.float64)
    K, other = float(ellipkm1(k1)), float(ellipk(k1))
    steep = 0.5 * np.pi / other
    u = np.remainder(u + 2 * K, 4 * K) - 2 * K
    total = np.tanh(steep * u)
    for n in range(1, 8):
        pair = np.tanh(steep * (u - 2 * n * K)) + np.tanh(steep * (u + 2 * n * K))
        total = total + (-1) ** n * pair
    return np.asarray(steep / np.sqrt(1 - k1) * total, dtype=np.float64)
