"""The flow at single points: the sum over all waves."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from ..model.arrays import numbers
from ..model.errors import InputError
from ..model.grid import Array
from .modes import radial

BLOCK = 2**17
"""Products of points and waves that are summed at once: more do not fit the processor's cache."""
OUTSIDE = 1e-12
"""How far beyond r = 1 a point may lie by rounding."""


def checked_points(points: npt.ArrayLike) -> Array:
    """Return points (n, 3) of (r, θ, z), with r <= 1. Raises `InputError` for anything else."""
    rule = "an array of real numbers of shape (n, 3), each row (r, theta, z)"
    found = numbers("points", points, rule, "give one row for each point")
    if found.ndim != 2 or found.shape[1] != 3:
        raise InputError("points", found, rule, "give one row for each point")
    if not np.all(np.isfinite(found)):
        raise InputError("points", found, "finite everywhere", "remove its NaN or infinite entries")
    found[:, 0] = checked_radii(found[:, 0], "r of points")
    return found


def checked_radii(radii: npt.ArrayLike, name: str = "radii") -> Array:
    """Return radii (n,) from 0 to 1. Raises `InputError` for anything else."""
    rule, remedy = "a row of numbers from 0 to 1, in units of R", "the vacuole is inside r = 1"
    found = np.atleast_1d(numbers(name, radii, rule, remedy))
    if found.ndim != 1 or found.size == 0:
        raise InputError(name, found, rule, remedy)
    wrong = found[~((found >= 0) & (found <= 1 + OUTSIDE))]
    if wrong.size:
        raise InputError(name, float(wrong[0]), "from 0 to 1, in units of R", remedy)
    return np.minimum(found, 1.0)


def summed(q: Array, modes: npt.NDArray[np.complex128], points: Array, pressure: bool = False) -> Array:
    """Return the velocity (n, 3) at points (n, 3), components (r, θ, z), or the pressure (n, 1).

    `modes` (2, 2 m_max + 1, n_q) are the waves of the wall's velocity. The pressure is its periodic part.
    """
    highest, count = modes.shape[1] // 2, modes.shape[2]
    out = np.empty((len(points), 1 if pressure else 3))
    # m and -m have the same radial functions, but for a sign: their sums are formed once.
    negative = np.zeros((2, highest + 1, count), np.complex128)
    negative[:, 1:] = modes[:, :highest:-1]
    positive = modes[:, : highest + 1]
    weight = np.where(q > 0, 2.0, 1.0)
    step = max(1, BLOCK // ((highest + 1) * count))
    for start in range(0, len(points), step):
        r, theta, z = points[start : start + step].T
        turn = np.exp(1j * np.outer(theta, np.arange(highest + 1)))[:, :, None]
        along = weight * np.exp(1j * np.outer(z, q))
        ahead, back = turn * along[:, None, :], turn.conj() * along[:, None, :]
        f = radial(highest, q, r)
        # Only real parts count: those of e^{...}, and of i e^{...} where the radial function has an i.
        a_even, a_odd = _both(ahead, back, positive[0], negative[0])
        b_even, b_odd = _both(ahead, back, positive[1], negative[1])
        if pressure:
            parts = [_sum(f.p_a, -a_odd.imag) + _sum(f.p_b, -b_even.imag)]
        else:
            parts = [
                _sum(f.r_a, -a_odd.imag) + _sum(f.r_b, -b_even.imag),
                _sum(f.theta_a, a_even.real) + _sum(f.theta_b, b_odd.real),
                _sum(f.z_a, a_odd.real) + _sum(f.z_b, b_even.real),
            ]
        out[start : start + step] = np.stack(parts, axis=1)
    return out


def _both(ahead: Any, back: Any, positive: Any, negative: Any) -> tuple[Any, Any]:
    """Return the sum and the difference of the waves m and -m at points."""
    one, other = ahead * positive, back * negative
    return one + other, one - other


def _sum(radial_function: Array, wave: Array) -> Array:
    return np.einsum("pmq,pmq->p", radial_function, wave)
