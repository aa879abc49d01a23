"""Functions of the radius in which diffusion is diagonal, regular at the axis.

A scalar c = Σ y_mqk f_mk(r) exp(i m θ + i q z) has radial functions f_mk(r) = r^|m| times a polynomial in r²,
of degree at most `degree` in r (triangular truncation: |m| + 2k <= degree), so that waves around the axis are
resolved as coarsely near it as elsewhere. Zernike polynomials span that space. Here they are combined into
the eigenfunctions of the weak form of diffusion,

    2 ∫ (f' g' + m² f g / r²) r dr + 2 Bi f(1) g(1) = λ 2 ∫ f g r dr,

with f(1) = 0 in place of the boundary term where the wall absorbs (Bi infinite). They are orthonormal in the
mean over the section, and -∇² is λ_mk + q² for each. Points are those of Gauss and Legendre in r²: none
lies on the axis or the wall, and products of three functions are integrated exactly if degree <= 4 n_r / 3.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from ..model.grid import Array


@dataclass(frozen=True, eq=False)
class RadialBasis:
    """The radial functions of |m| = 0 ... m_max at the points `r` (n_r,), in radii.

    Σ weights f is the mean over the section of a function of r alone. `value` and `slope` (m, n_r, k) are f
    and f', `rates` (m, k) the λ, `at_wall` and `wall_slope` (m, k) are f(1) and f'(1); all are 0 beyond
    `count[m]` functions. `combined` (m, zernike, k) are the coefficients of f in Zernike polynomials.
    """

    r: Array
    weights: Array
    value: Array
    slope: Array
    rates: Array
    at_wall: Array
    wall_slope: Array
    combined: Array
    count: tuple[int, ...]

    def at(self, m: int, r: Array) -> Array:
        """Return the functions of |m| at any radii from 0 to 1, shape (len(r), k)."""
        found = np.zeros((len(r), self.combined.shape[-1]))
        n = _count(m, self.combined.shape[1] * 2 - 2)
        found[:] = zernike(m, n, np.maximum(r, 1e-150))[0] @ self.combined[m, :n]
        return found


def zernike(m: int, count: int, r: Array) -> tuple[Array, Array]:
    """Return f and f', (len(r), count) each, of f_k = (m + 2k + 1)^½ r^m P_k^(0,m)(2r² - 1), for r > 0."""
    x = 2 * r**2 - 1
    k = np.arange(count)
    scale = np.sqrt(m + 2 * k + 1.0)
    from scipy.special import eval_jacobi  # slow to load

    polynomial = eval_jacobi(k, 0, m, x[:, None])
    derivative = np.zeros_like(polynomial)
    derivative[:, 1:] = 0.5 * (k[1:] + m + 1) * eval_jacobi(k[1:] - 1, 1, m + 1, x[:, None])
    power = (r**m)[:, None]
    value = scale * power * polynomial
    return value, m * value / r[:, None] + scale * power * derivative * 4 * r[:, None]


@lru_cache(maxsize=8)
def radial_basis(m_max: int, degree: int, n_r: int, biot: float = 0.0) -> RadialBasis:
    """Return the radial functions for a wall that is sealed (biot 0), exchanging, or absorbing (infinite)."""
    x, weights = np.polynomial.legendre.leggauss(n_r)
    r, weights = np.sqrt(0.5 * (x + 1)), 0.5 * weights
    most = degree // 2 + 1
    value, slope = np.zeros((2, m_max + 1, n_r, most))
    rates, at_wall, wall_slope = np.zeros((3, m_max + 1, most))
    combined = np.zeros((m_max + 1, most, most))
    count = []
    for m in range(m_max + 1):
        n = _count(m, degree)
        f, df = zernike(m, n, r)
        edge, edge_slope = (part[0] for part in zernike(m, n, np.ones(1)))
        own, vectors = _eigen(m, weights, f / r[:, None], df, edge, biot)
        k = own.size
        rates[m, :k], combined[m, :n, :k] = own, vectors
        value[m, :, :k], slope[m, :, :k] = f @ vectors, df @ vectors
        # A row of Zernike polynomials sums to the value at the wall only to rounding.
        at_wall[m, :k] = 0.0 if np.isinf(biot) else edge @ vectors
        wall_slope[m, :k] = edge_slope @ vectors
        count.append(k)
    return RadialBasis(r, weights, value, slope, rates, at_wall, wall_slope, combined, tuple(count))


def _count(m: int, degree: int) -> int:
    return (degree - m) // 2 + 1


def _eigen(
    m: int, weights: Array, over_r: Array, slope: Array, edge: Array, biot: float
) -> tuple[Array, Array]:
    """Return the rates, ascending, and the eigenfunctions as columns of polynomial coefficients."""
    stiffness = (slope.T * weights) @ slope + m**2 * ((over_r.T * weights) @ over_r)
    if np.isinf(biot):
        allowed = np.linalg.qr(edge[:, None], mode="complete")[0][:, 1:]
        rates, inner = np.linalg.eigh(allowed.T @ stiffness @ allowed)
        return rates, allowed @ inner
    if biot == 0 and m == 0:  # the constant is one of them exactly, so that the amount is kept exactly
        rates, inner = np.linalg.eigh(stiffness[1:, 1:])
        vectors = np.zeros_like(stiffness)
        vectors[0, 0], vectors[1:, 1:] = 1.0, inner
        return np.concatenate([[0.0], rates]), vectors
    rates, vectors = np.linalg.eigh(stiffness + 2 * biot * np.outer(edge, edge))
    return rates, vectors
