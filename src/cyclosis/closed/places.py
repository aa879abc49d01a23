"""Values at any points of a closed surface, by the polynomials that the latitudes of a grid define."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from ..model.arrays import numbers
from ..model.errors import InputError
from ..model.wording import beside
from .grid import Array, ClosedGrid
from .harmonics import Weighted
from .shapes import Shape

OFF_SURFACE = 1e-3
"""Distance from the surface, in radii, beyond which a point is refused."""


def latitudes(surface: Shape, points: npt.ArrayLike) -> tuple[Array, Array]:
    """Return θ (n,) and τ (n,), radians, of points (n, 3) = (x, y, z) on a surface, in radii.

    τ is that of the nearest point of the surface. Raises `InputError` for points further than 1e-3 from it.
    """
    rule = "an array (n, 3) of positions (x, y, z) on the surface, in radii"
    remedy = "take them from grid.xyz, for example"
    at = numbers("points", points, rule, remedy)
    if at.ndim != 2 or at.shape[1] != 3 or not np.all(np.isfinite(at)):
        raise InputError("points", at, rule, remedy)
    r, z = np.hypot(at[:, 0], at[:, 1]), at[:, 2]
    table = np.linspace(0, np.pi, 513)
    known = surface.meridian(table)
    tau = table[np.argmin(np.hypot(r[:, None] - known.r, z[:, None] - known.z), axis=1)]
    for _ in range(8):  # Newton's method for the nearest point: the rest is along the normal
        here = surface.meridian(tau)
        ahead = (r - here.r) * here.slope + (z - here.z) * here.rise
        away = (r - here.r) * here.rise - (z - here.z) * here.slope
        tau = np.clip(tau + ahead / (here.speed * (1 + here.k_s * away)), 0.0, np.pi)
    here = surface.meridian(tau)
    distance = np.hypot(r - here.r, z - here.z).max(initial=0.0)
    if distance > OFF_SURFACE:
        raise InputError("points", f"up to {distance:.3g} radii off the surface", rule, remedy)
    return np.arctan2(at[:, 1], at[:, 0]), tau


def latitude_of(surface: Shape, s: float) -> float:
    """Return τ, radians, at an arc length s from the south pole, in radii.

    Raises `InputError` for an s beyond the poles.
    """
    from scipy.optimize import brentq

    length = float(surface.meridian_length)
    if not 0 <= s <= length * (1 + 1e-9):
        rule = f"from 0 to the length of the meridian {beside(length, s)}"
        raise InputError("s", s, rule, "measure it from the south pole")
    if s in (0.0, length) or s > length:
        return 0.0 if s == 0 else np.pi
    return float(brentq(lambda tau: float(surface.meridian(tau).s) - s, 0.0, np.pi, xtol=1e-14))


def frames(surface: Shape, theta: Array, tau: Array) -> tuple[Array, Array]:
    """Return the unit vectors e_theta and e_s (n, 3) at angles θ (n,) and latitudes τ (n,)."""
    here = surface.meridian(tau)
    cos, sin = np.cos(theta), np.sin(theta)
    around = np.stack([-sin, cos, np.zeros_like(cos)], -1)
    return around, np.stack([here.slope * cos, here.slope * sin, here.rise], -1)


def packed_at(grid: ClosedGrid, field: npt.NDArray[np.complex128], theta: Array, tau: Array) -> Array:
    """Return a packed vector field (n_theta, n_s) at angles θ (n,) and latitudes τ (n,), complex (n,).

    Fourier sums around the cell; along it the polynomial in cos τ, times sin τ for even m.
    """
    spectrum = np.fft.fft(field, axis=0, norm="forward")
    m = np.fft.fftfreq(grid.n_theta, 1 / grid.n_theta)
    held = np.abs(m) <= len(grid.tables.modes) - 1
    spectrum, m = spectrum[held], m[held]
    x = grid.points.x
    sin, at_sin = np.sqrt((1 - x) * (1 + x)), np.sin(tau)
    found = np.zeros(len(theta), complex)
    onto = interpolation(grid.points, np.cos(tau))
    for odd in (0, 1):
        rows = np.abs(m) % 2 == odd
        values = spectrum[rows] if odd else spectrum[rows] / sin
        waves = np.exp(1j * np.outer(theta, m[rows]))
        parts = np.sum(waves * (onto @ values.T), axis=1)
        found += parts if odd else at_sin * parts
    return found


def interpolation(points: Weighted, at: Array) -> Array:
    """Return the matrix (n, k) that interpolates polynomials in x from points (k,) to `at` (n,)."""
    apart = at[:, None] - points.x
    exact = apart == 0
    parts = points.barycentric / np.where(exact, 1.0, apart)
    parts = np.where(exact.any(axis=1, keepdims=True), exact, parts)
    matrix: Array = parts / parts.sum(axis=1, keepdims=True)
    return matrix
