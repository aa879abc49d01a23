"""Times that mean the same are the same number: the one rule for every time of a run.

0.1 * 3, 0.1 + 0.2, `np.arange(0, 1, 0.1)[3]` and 0.3 all mean three tenths, but as floating-point numbers
they differ in the last place. Every time that a user gives or that is computed from an interval passes
through `instant`, so that a step, a frame and the end of a run that are meant to coincide do so exactly.
"""

from __future__ import annotations

from typing import Any, overload

import numpy as np
import numpy.typing as npt

DIGITS = 12
"""Significant digits of a time. Rounding errors of long sums are below the last one, and intervals between
frames are well above it: a run has at most a million of them."""
_POWERS = np.array([float(f"1e{k}") for k in range(23)])
"""The powers of ten that are floating-point numbers, so that dividing by one of them rounds only once."""


@overload
def instant(t: float) -> float: ...
@overload
def instant(t: npt.NDArray[np.floating[Any]]) -> npt.NDArray[np.float64]: ...
def instant(t: Any) -> Any:
    """Return a time, or an array of times of any shape, rounded to 12 significant digits.

    Times are dimensionless (R/U). The result is the floating-point number nearest to that decimal, so that
    a second `instant` changes nothing. Order is kept: of two times the later one never becomes the earlier.
    Values that are not finite are unchanged.

    Example:
        >>> from cyclosis.model.instants import instant
        >>> instant(0.1 * 3) == instant(0.1 + 0.2) == 0.3
        True
        >>> instant(1e6 + 0.1 * 3), instant(1e-7)
        (1000000.3, 1e-07)
    """
    times = np.asarray(t, dtype=np.float64)
    usable = np.isfinite(times) & (times != 0)
    size = np.floor(np.log10(np.abs(np.where(usable, times, 1.0))))
    scale = _POWERS[np.clip(DIGITS - 1 - size, 0, _POWERS.size - 1).astype(int)]
    rounded = np.where(usable, np.rint(np.where(usable, times, 1.0) * scale) / scale, times)
    return rounded if times.ndim else float(rounded)
