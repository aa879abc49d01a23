"""Ratios of modified Bessel functions: t_n(x) = I_{n+1}(x) / (x I_n(x)), smooth and even in x.

t_n(0) = 1/(2n + 2), and t_{n-1} = 1/(2n + x² t_n) (the recurrence of I_n). All terms are positive, so that
the recurrence is stable downwards. It starts from Perron's continued fraction.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]

TERMS = 30
"""Terms of Perron's fraction that leave only rounding errors at every n and x."""


def ratios(highest: int, x: npt.ArrayLike) -> Array:
    """Return t_n(x) for n = 0 to `highest`, shape (highest + 1, *x.shape), for x >= 0."""
    at = np.asarray(x, dtype=np.float64)
    out = np.empty((highest + 1, *at.shape))
    nu, rest = highest + 1.0, np.zeros_like(at)
    for k in range(TERMS, 0, -1):
        rest = (2 * nu + 2 * k - 1) * at / (2 * nu + k + 2 * at - rest)
    out[highest] = 1.0 / (at + 2 * nu - rest)
    square = at**2
    for n in range(highest, 0, -1):
        out[n - 1] = 1.0 / (2 * n + square * out[n])
    return out
