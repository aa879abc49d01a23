"""Closures: what stands for the second and third angular moments of filaments in the equation for P.

The density Ψ of filament angles φ at one filament per place has the moments m_n = ∫ e^{inφ} Ψ dφ, of which
m_1 = p = P_theta + i P_z. A torque that turns a filament at the rate
ω = ε w/2 + Im(H e^{-iφ}) + Im(S e^{-2iφ}) changes p by (see docs/kinetic.md)

    dp/dt = (1/2)[H - H* m_2 + S p* - S* m_3] + (i ε w/2) p.

* `paper`: <pp> = PP and <ppp> = PPP as real tensors, which changes their traces too, so that it does not have
  this form. It is the equation of `cyclosis.model.filaments`.
* `von_mises`: m_2 = (I_2/I_0) e², m_3 = (I_3/I_0) e³ with I_1(x)/I_0(x) = |P|, e = p/|p|.
* `wrapped_normal`: m_2 = |p|² p², m_3 = |p|⁶ p³.
* `weak`: m_2 = p², m_3 = p³.

The last three keep the traces of the tensors. They have no nematic order of their own: where κ > 4 d_r they
polarise even without bundling, at the rate κ/4 - d_r about isotropy, which filaments do not.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import numpy.typing as npt

from .definitions import definition
from .spectral import dot

PAPER = "paper"
DEGREE = 64
"""Degree of the polynomials that stand for ratios of Bessel functions; their errors are below 1e-12."""

Moments = tuple[jax.Array, jax.Array]


def checked(closure: Any) -> str:
    """Return the name of a closure. Raises `InputError` for any other."""
    name: str = definition("model", "closure").check(closure)
    return name


def weak(p: jax.Array) -> Moments:
    """Return m_2 and m_3 of weak order: p² and p³."""
    return p * p, p * p * p


def wrapped_normal(p: jax.Array) -> Moments:
    """Return m_2 and m_3 of a normal distribution of angles, wrapped around the circle."""
    square = dot(p, p)
    return square * p * p, square**3 * p * p * p


def von_mises(p: jax.Array) -> Moments:
    """Return m_2 and m_3 of the von Mises distribution with mean p.

    Where |p| is above 1, by an error of the discretisation, they continue as those of the wrapped normal
    distribution, whose values and slopes at |p| = 1 are the same.
    """
    square = dot(p, p)
    inside = jnp.minimum(square, 1.0)
    second, third = (_polynomial(coefficients, 2.0 * inside - 1.0) for coefficients in _bessel_ratios())
    whole = square < 1.0
    second = jnp.where(whole, second, square)
    third = jnp.where(whole, third, square**3)
    return second * p * p, third * p * p * p


MOMENTS: dict[str, Callable[[jax.Array], Moments]] = {
    "von_mises": von_mises,
    "wrapped_normal": wrapped_normal,
    "weak": weak,
}
"""m_2 and m_3 as functions of packed P, of every closure but the paper's."""


def turned(closure: str, p: jax.Array, H: Any, S: Any, spin: Any) -> jax.Array:
    """Return dp/dt by torques with polar part H, nematic part S and spin ε w/2, packed."""
    second, third = MOMENTS[closure](p)
    turning = H - jnp.conj(H) * second + S * jnp.conj(p) - jnp.conj(S) * third
    return 0.5 * turning + 1j * spin * p


def _polynomial(coefficients: tuple[float, ...], x: jax.Array) -> jax.Array:
    """Return a Chebyshev series at points from -1 to 1, by Clenshaw's recurrence."""
    last = before = jnp.zeros_like(x)
    for coefficient in coefficients[:0:-1]:
        last, before = 2.0 * x * last - before + coefficient, last
    return x * last - before + coefficients[0]


@cache
def _bessel_ratios() -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Return the Chebyshev coefficients of (I_2/I_0)/|P|² and (I_3/I_0)/|P|³ over 2 |P|² - 1.

    Both are smooth functions of |P|² from 0 to 1, from 1/2 to 1 and from 1/6 to 1.
    """
    from scipy.special import ive  # loaded only here: the other closures need none of it

    nodes = np.cos(np.pi * (np.arange(DEGREE + 1) + 0.5) / (DEGREE + 1))
    square = 0.5 * (1.0 + nodes)
    x = concentration(np.sqrt(square))
    zeroth = ive(0, x)
    ratios = (ive(2, x) / zeroth / square, ive(3, x) / zeroth / square**1.5)
    series = (np.polynomial.chebyshev.chebfit(nodes, ratio, DEGREE) for ratio in ratios)
    second, third = (tuple(float(item) for item in found) for found in series)
    return second, third


def concentration(magnitude: npt.NDArray[Any]) -> npt.NDArray[Any]:
    """Return x with I_1(x)/I_0(x) = |P| for magnitudes between 0 and 1, by Newton's method."""
    from scipy.special import ive

    x = magnitude * (2.0 - magnitude**2) / (1.0 - magnitude**2)  # within 7 %
    for _ in range(8):
        ratio = ive(1, x) / ive(0, x)
        x = x - (ratio - magnitude) / (1.0 - ratio / x - ratio**2)
    return np.asarray(x)
