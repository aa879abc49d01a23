"""Surviving filaments against the disorder of all others: which of the two decides where stripes return.

A disordered state grows at first by the linear equation, in which the wave once around the cell,
P_z ~ Re c exp(iθ), keeps its phase. For M filaments of random direction c is complex and normal, with the
standard deviation M^(-1/2) in both parts; survivors add a wave A. So the phase of the pattern that grows is
that of a plane normal vector displaced by a = A M^(1/2).

This is the prediction of the linear equation. Waves compete once they saturate, so that the effect of
survivors is smaller, by a factor that is measured (`effect`); and the equation does not say whether two
stripes return at all.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
import scipy.integrate
import scipy.optimize
import scipy.stats
import xarray

from ..analysis.regimes import REGIMES
from ..model.grid import Array
from .recovery import rising

DROP = 0.5 * float(scipy.stats.chi2.ppf(0.95, 1))
"""By how much the log likelihood falls to the ends of a 95 % interval."""
STRONGEST = 30.0
"""Largest factor considered."""


def within(angle: float, a: npt.ArrayLike) -> Array:
    """Return the probability that the phase of a plane normal vector displaced by a (n,) is within ±`angle`.

    For a right angle it is the normal distribution's Φ(a); for a = 0 `angle`/π.
    """
    phi = np.linspace(-angle, angle, 801)
    along = np.multiply.outer(np.asarray(a, dtype=np.float64), np.cos(phi))
    across = np.multiply.outer(np.asarray(a, dtype=np.float64), np.sin(phi))
    uniform = np.exp(-0.5 * (along**2 + across**2)) / (2 * np.pi)
    density = uniform + along * scipy.stats.norm.cdf(along) * np.exp(-0.5 * across**2) / np.sqrt(2 * np.pi)
    return np.asarray(scipy.integrate.trapezoid(density, phi, axis=-1))


def effect(a: npt.ArrayLike, kept: npt.ArrayLike, total: npt.ArrayLike) -> tuple[float, float, float]:
    """Return the factor r with which Φ(r a) fits counts best, and the ends of its 95 % likelihood interval.

    a (n,) is the prediction of the law, `kept` of `total` (n,) are the counts. r = 1 is the law itself.
    """
    x, good, all_of = (np.asarray(values, dtype=np.float64) for values in (a, kept, total))

    def loss(r: float) -> float:
        up, down = scipy.stats.norm.logcdf(r * x), scipy.stats.norm.logcdf(-r * x)
        return -float(np.sum(good * up + (all_of - good) * down))

    best = float(scipy.optimize.minimize_scalar(loss, bounds=(0.0, STRONGEST), method="bounded").x)
    least = loss(best) + DROP

    def above(r: float) -> float:
        return loss(r) - least

    low = scipy.optimize.brentq(above, 0.0, best) if above(0.0) > 0 else 0.0
    high = scipy.optimize.brentq(above, best, STRONGEST) if above(STRONGEST) > 0 else np.inf
    return best, float(low), float(high)


def wrapped(angle: npt.ArrayLike) -> Array:
    """Return angles in radians between -π and π."""
    return np.asarray(np.mod(np.asarray(angle, dtype=np.float64) + np.pi, 2 * np.pi) - np.pi)


def shifts(swept: xarray.Dataset) -> Array:
    """Return how far, from -π to π, stripes that rose at θ = 0 have moved; NaN unless there are two.

    For members (...), from their `profile` (..., component, theta) and `regime`.
    """
    profile = np.asarray(swept["profile"].sel(component="z").values)
    angle = np.apply_along_axis(rising, -1, profile)
    two = np.asarray(swept["regime"].values) == REGIMES.index("cyclosis")
    return np.where(two, wrapped(angle), np.nan)
