"""Surface harmonics: the functions in which diffusion and flow on a closed surface are diagonal.

For every azimuthal mode m, by Galerkin's method in the weighted Jacobi functions of `jacobi`:

    vectors   Lap_B p = -λ p,   Lap_B p = p'' + (r'/r) p' - ((m - r')/r)² p       (Bochner)
    scalars   Lap ψ = -λ ψ,     Lap ψ = ψ'' + (r'/r) ψ' - (m/r)² ψ

for p = P_θ + i P_s packed, ' = d/ds. A flow u = n x ∇ψ has u_m = -(ψ' + (m/r) ψ) and the strain E_m =
E_θθ + i E_θs = -i [((m - r')/r)(ψ' + (m/r) ψ) + Lap ψ/2], |D|² = 2|E|². Its viscous work is diagonal in the
flow modes v: 2 ∫ D(v_j):D(v_k) = β_k δ_jk with ∫ v_j·v_k = δ_jk. Kept are harmonics with λ <= k_max², which
is the same resolution everywhere on the surface: at a mode m only those that live where r > m/k_max.

Only m >= 0 are computed. All shapes are symmetric about their equator, and the reflection s -> S - s maps
the vectors of mode m to those of -m.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from .jacobi import weighted_jacobi
from .shapes import Meridian, Shape

Array = npt.NDArray[np.float64]

MARGIN = 24
"""Jacobi functions beyond those that a wave of wavenumber k_max and the curvature of the surface need."""
NEGLIGIBLE = 1e-8
"""Share of the largest wave of the curvature along the meridian below which others are not resolved."""


class Weighted(NamedTuple):
    """Points of a meridian with x = cos τ, and `area` (n,), the area of each ring over 2π.

    `barycentric` (n,) are the weights of interpolation between Gauss-Legendre points, (-1)^k [(1 - x²) w_k]^½
    (Wang & Xiang 2012).
    """

    x: Array
    meridian: Meridian
    area: Array
    barycentric: Array

    @classmethod
    @lru_cache(maxsize=32)
    def of(cls, shape: Shape, n: int) -> Weighted:
        """Return n Gauss-Legendre points in x, from the south pole to the north."""
        x, weight = np.polynomial.legendre.leggauss(n)
        x, weight = x[::-1], weight[::-1]
        # arccos loses digits near the poles, where sin τ is small: take the angle of (cos, sin).
        sin = np.sqrt((1 - x) * (1 + x))
        at = shape.meridian(np.arctan2(sin, x))
        barycentric = np.asarray((-1.0) ** np.arange(n) * sin * np.sqrt(weight), dtype=np.float64)
        made = cls(x, at, weight * at.r * at.speed / sin, barycentric)
        for values in (x, *at, made.area, barycentric):  # shared by all who ask for these points
            values.setflags(write=False)
        return made


@dataclass(frozen=True)
class Harmonics:
    """The vector and flow modes of one m >= 0, in coefficients of the Jacobi functions.

    `vector` (count, J) with eigenvalues `rate` λ (J,); `stream` (count, K), the stream functions of the flow
    modes, with their viscous eigenvalues `viscous` β (K,).
    """

    m: int
    vector: Array
    rate: Array
    stream: Array
    viscous: Array


def vector_powers(m: int) -> tuple[int, int]:
    """Return the powers of sin at the south and the north pole of p_m."""
    return abs(m - 1), abs(m + 1)


def functions(points: Weighted, powers: tuple[int, int], count: int) -> tuple[Array, Array]:
    """Return Jacobi functions and their derivatives along the meridian, d/ds, each (points, count)."""
    value, slope = weighted_jacobi(points.x, *powers, count)
    sin = np.sqrt((1 - points.x) * (1 + points.x))
    return value, -slope / (sin * points.meridian.speed)[:, None]


def harmonics(shape: Shape, k_max: float) -> list[Harmonics]:
    """Return the `Harmonics` of every m from 0 on that has a vector with λ <= k_max²."""
    speed = shape.meridian(np.linspace(0, np.pi, 65)).speed.max()
    margin = MARGIN + _waves(shape)
    count = int(np.ceil(1.25 * k_max * speed)) + margin
    found: list[Harmonics] = []
    # p_m vanishes near the poles as r^|m - 1|; the metric adds a few more degrees.
    points = Weighted.of(shape, count + int(k_max) + 2 * margin)
    while True:
        one = _harmonics_of(len(found), points, count, k_max)
        if not len(one.rate):
            return found
        found.append(one)


def _waves(shape: Shape) -> int:
    """Return how many waves in τ the curvature along the meridian has: many where it changes sharply."""
    at = shape.meridian(np.pi * (np.arange(1024) + 0.5) / 1024)
    from scipy.fft import dct  # slow to load, as is scipy.linalg

    waves = np.abs(dct(at.k_s * at.speed))
    return int(np.flatnonzero(waves > NEGLIGIBLE * waves.max()).max())


def _harmonics_of(m: int, points: Weighted, count: int, k_max: float) -> Harmonics:
    from scipy.linalg import eigh

    at, area = points.meridian, points.area[:, None]
    p, dp = functions(points, vector_powers(m), count)
    turn = ((m - at.slope) / at.r)[:, None] * p
    rate, vector = eigh(dp.T @ (area * dp) + turn.T @ (area * turn), p.T @ (area * p))
    kept = rate <= k_max**2
    vector = vector[:, kept] * _sign(p @ vector[:, kept])
    psi, dpsi = functions(points, (abs(m), abs(m)), count)
    over = (m / at.r)[:, None] * psi
    wave, stream = eigh(dpsi.T @ (area * dpsi) + over.T @ (area * over), psi.T @ (area * psi))
    own = (wave > 1e-6) & (wave <= k_max**2)  # the constant drives no flow
    wave, stream = wave[own], stream[:, own] / np.sqrt(wave[own])
    value, slope = psi @ stream, dpsi @ stream
    strains = [_strain(side * m, at, value, slope, wave) for side in (1, -1)]
    # Over both of ±m, and twice for 2 ∫ D:D = 4 ∫ |E|²; the flows have ∫ |u_m|² + |u_-m|² = 2.
    viscous, turned = eigh(2 * sum(strain.T @ (area * strain) for strain in strains))
    stream = stream @ turned
    stream = stream * _sign(psi @ stream if m else dpsi @ stream)
    return Harmonics(m, vector, rate[kept], stream, np.maximum(viscous, 0.0))


def _strain(m: int, at: Meridian, psi: Array, slope: Array, wave: Array) -> Array:
    """Return i E_m of stream functions (points, K) with Lap ψ = -wave ψ."""
    shifted = slope + (m / at.r)[:, None] * psi
    return ((m - at.slope) / at.r)[:, None] * shifted - 0.5 * wave * psi


def _sign(values: Array) -> Array:
    """Return the signs (K,) that make functions (points, K) positive in their first lobe from the south.

    The first lobe is the highest, or nearly so: it is found on any grid that resolves the function.
    """
    if not values.size:
        return np.ones(values.shape[1])
    large = np.abs(values) > 0.5 * np.abs(values).max(axis=0)
    first = np.argmax(large, axis=0)
    return np.sign(values[first, np.arange(values.shape[1])])
