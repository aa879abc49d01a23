"""Test functions: products of bumps (1 - x²)^p, their derivatives, and integrals against them.

A bump and its first p - 1 derivatives vanish at its ends. Integration by parts therefore leaves no boundary
terms, and the trapezoidal rule converges fast although the window is not periodic.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np
import numpy.typing as npt
from numpy.polynomial import Polynomial

from ..model.grid import Array

IN_TIME, IN_SPACE = 4, 7
"""The powers p of bumps in time and space: third derivatives are taken in space, first ones in time."""
FINE = 40
"""Points per frame at which bumps are integrated where frames are not even."""
HIDDEN = 1e-6
"""Height of a bump, relative to its peak, up to which points in it may be unseen."""
WHOLE = 2e-3
"""A bump is on the window if its integral by the rule is exact within this share."""


@cache
def _polynomial(power: int, derivative: int) -> Polynomial:
    return (
        (Polynomial([1.0, 0.0, -1.0]) ** power).deriv(derivative)
        if derivative
        else Polynomial([1.0, 0.0, -1.0]) ** power
    )


def bump(x: Array, power: int, derivative: int = 0) -> Array:
    """Return a derivative of (1 - x²)^p on [-1, 1], and 0 outside."""
    values: Array = np.where(np.abs(x) < 1, _polynomial(power, derivative)(x), 0.0)
    return values


def area(power: int) -> float:
    """Return the integral of (1 - x²)^p from -1 to 1."""
    whole = _polynomial(power, 0).integ()
    return float(whole(1.0) - whole(-1.0))


def weights(points: Array) -> Array:
    """Return weights of a quadrature rule at points: the integrals of their cardinal cubic splines.

    Inside a window of even spacing h they are h, the trapezoidal rule.
    """
    from scipy.interpolate import CubicSpline

    if points.size < 4:
        return np.gradient(points) if points.size > 1 else np.ones(1)
    splines = CubicSpline(points, np.eye(points.size), bc_type="natural")
    found: Array = splines.integrate(points[0], points[-1])
    return found


def slopes(points: Array) -> Array:
    """Return the matrix (n, n) that takes values at points to derivatives: polynomials of degree 4."""
    n = points.size
    width = min(5, n)
    out = np.zeros((n, n))
    for i in range(n):
        first = min(max(i - width // 2, 0), n - width)
        at = points[first : first + width] - points[i]
        scale = float(np.abs(at).max()) or 1.0
        powers = np.vander(at / scale, width, increasing=True).T
        right = np.zeros(width)
        right[min(1, width - 1)] = 1.0
        out[i, first : first + width] = np.linalg.solve(powers, right) / scale
    return out


def in_time(times: Array, centres: Array, half: float) -> tuple[Array, Array]:
    """Return the matrices (centres, frames) that integrate against bumps in time and their slopes.

    At even times the rule is the trapezoidal one, which is very exact for what vanishes at the ends.
    """
    if even(times):
        x = (times - centres[:, None]) / half
        rule = weights(times)
        return bump(x, IN_TIME) * rule, bump(x, IN_TIME, 1) / half * rule
    # The field is smoother than the bump: it is interpolated, and the bump is integrated exactly.
    from scipy.interpolate import CubicSpline

    fine = np.linspace(times[0], times[-1], FINE * times.size)
    splines = CubicSpline(times, np.eye(times.size), bc_type="natural")(fine) * (fine[1] - fine[0])
    x = (fine - centres[:, None]) / half
    return bump(x, IN_TIME) @ splines, bump(x, IN_TIME, 1) / half @ splines


def even(times: Array) -> bool:
    """Return whether frames are evenly spaced."""
    return times.size < 4 or bool(np.ptp(np.diff(times)) < 0.01 * float(np.median(np.diff(times))))


@dataclass(frozen=True, eq=False)
class InSpace:
    """Sparse matrices (bumps, points) that integrate against bumps and their derivatives.

    `value`, `theta`, `z` and `laplacian` are of φ, ∂_θ φ, ∂_z φ and ∇²φ, `theta3` and `z3` of ∂_θ ∇²φ and
    ∂_z ∇²φ.
    """

    value: Any
    theta: Any
    z: Any
    laplacian: Any
    theta3: Any
    z3: Any


def in_space(
    theta: Array,
    z: Array,
    rule: Array,
    centres: npt.NDArray[np.float64],
    half: tuple[float, float],
) -> tuple[InSpace, npt.NDArray[np.bool_]]:
    """Return the integrals against bumps at `centres` (n, 2), and which of them lie on the window.

    `theta` and `z` (points,) are where values are known and `rule` (points,) the weights of the quadrature,
    0 where nothing was seen.
    """
    from scipy.sparse import csr_array

    a, b = half
    exact = a * b * area(IN_SPACE) ** 2
    rows, columns, parts = [], [], []
    whole = np.zeros(len(centres), bool)
    for k, (c, d) in enumerate(centres):
        near = np.flatnonzero((np.abs(theta - c) < a) & (np.abs(z - d) < b))
        if near.size == 0:
            continue
        x, y = (theta[near] - c) / a, (z[near] - d) / b
        f = [bump(x, IN_SPACE, n) / a**n for n in range(4)]
        g = [bump(y, IN_SPACE, n) / b**n for n in range(4)]
        values = np.stack([
            f[0] * g[0],
            f[1] * g[0],
            f[0] * g[1],
            f[2] * g[0] + f[0] * g[2],
            f[3] * g[0] + f[1] * g[2],
            f[2] * g[1] + f[0] * g[3],
        ])  # fmt: skip
        unseen = rule[near] == 0
        values = values * rule[near]
        whole[k] = (
            not np.any(f[0][unseen] * g[0][unseen] > HIDDEN) and abs(values[0].sum() / exact - 1) < WHOLE
        )
        rows.append(np.full(near.size, k))
        columns.append(near)
        parts.append(values)
    if not rows:
        empty = csr_array((0, theta.size))
        return InSpace(*[empty] * 6), whole
    at = (np.concatenate(rows), np.concatenate(columns))
    joined = np.concatenate(parts, axis=1)
    shape = (len(centres), theta.size)
    return InSpace(*(csr_array((part, at), shape=shape)[whole] for part in joined)), whole
