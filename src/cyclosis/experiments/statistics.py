"""Statistics of experiments: named tests, and intervals."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt
import scipy.stats

from ..analysis.wilson import wilson
from ..model.grid import Array


class Circular(NamedTuple):
    """Angles on a circle: mean resultant length R, and p-values of tests that they are uniform.

    `rayleigh` is the Rayleigh test, against one preferred direction; `kuiper` Kuiper's test, against any
    departure from uniformity.
    """

    resultant: float
    rayleigh: float
    kuiper: float


def circular(angles: npt.ArrayLike) -> Circular:
    """Return the `Circular` statistics of angles (n,) in radians, n >= 2."""
    theta = np.mod(np.ravel(np.asarray(angles, dtype=np.float64)), 2 * np.pi)
    n = theta.size
    R = float(np.abs(np.mean(np.exp(1j * theta))))
    return Circular(R, _rayleigh(n, R), _kuiper(theta / (2 * np.pi)))


def _rayleigh(n: int, R: float) -> float:
    """Return the p-value of nR²: Mardia & Jupp, Directional Statistics (2000), equation 6.3.4."""
    z = n * R**2
    series = 1 + (2 * z - z**2) / (4 * n) - (24 * z - 132 * z**2 + 76 * z**3 - 9 * z**4) / (288 * n**2)
    return float(np.clip(np.exp(-z) * series, 0.0, 1.0))


def _kuiper(x: Array) -> float:
    """Return the p-value of Kuiper's V of numbers in [0, 1): Stephens' asymptotic form (1970)."""
    x, n = np.sort(x), x.size
    place = np.arange(n) / n
    V = float(np.max(place + 1 / n - x) + np.max(x - place))
    scaled = (np.sqrt(n) + 0.155 + 0.24 / np.sqrt(n)) * V
    j = np.arange(1, 101)
    terms = 2 * (4 * j**2 * scaled**2 - 1) * np.exp(-2 * j**2 * scaled**2)
    return float(np.clip(np.sum(terms), 0.0, 1.0)) if scaled > 0.4 else 1.0


def proportion(count: int, total: int) -> tuple[float, float, float]:
    """Return a share and the ends of its 95 % Wilson interval."""
    low, high = wilson(np.array([count]), np.array([total]))
    return count / total, float(low[0]), float(high[0])


def median_interval(values: npt.ArrayLike) -> tuple[float, float, float]:
    """Return the median of values (n,) and the ends of its exact 95 % interval, by order statistics.

    The interval is that of the binomial sign test; its ends are infinite where n is too small.
    """
    x = np.sort(np.ravel(np.asarray(values, dtype=np.float64)))
    n = x.size
    low = int(scipy.stats.binom.ppf(0.025, n, 0.5))
    if n == 0:
        return np.nan, np.nan, np.nan
    ends = (-np.inf, np.inf) if low < 1 else (x[low - 1], x[n - low])
    return float(np.median(x)), float(ends[0]), float(ends[1])


def in_words(share: tuple[float, float, float]) -> str:
    """Return a share with its interval in percent."""
    return f"{100 * share[0]:.1f} % ({100 * share[1]:.1f} to {100 * share[2]:.1f} %)"
