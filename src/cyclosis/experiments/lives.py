"""How long stripes of unequal widths last without alignment by flow, timed in cells the same all along."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from ..analysis.zones import stripe_widths, zone_angles
from ..dynamics.simulate import simulate
from ..model.grid import Array, CylinderGrid
from ..model.parameters import Parameters
from ..stability import elliptic_growth
from .fronts import front, fronts

SETTLING, LONGEST = 10.0, 5000.0
"""Time after which zones of prepared stripes have their own profile, and the longest life waited for."""
GRID = CylinderGrid(48, 8, 5.0)


def timed(alpha_p: float, share: float) -> tuple[float, float]:
    """Return by how many widths zones are displaced once settled, and how long stripes last, in units of 1/λ.

    The stripe that points down begins with a share of the circle. NaN for what does not end in time.
    """
    params = Parameters(alpha_p=alpha_p, alpha_u=0.0)
    start = fronts(params, GRID, 2 * np.pi * share)
    run = simulate(params, GRID, start, LONGEST, save_every=2.0, rtol=1e-4, steady_rate=1e-6)
    profiles = [state[1].mean(axis=1) for state in run.frames]
    times = np.asarray(run.times)
    first = int(np.argmax(times >= SETTLING))
    widths = stripe_widths(zone_angles(profiles[first]))
    if widths.size != 2:
        return np.nan, np.nan
    end = ending(times[first:], np.array([row.min() for row in profiles[first:]]))
    displaced = float(np.pi * (widths.max() - 0.5)) / front(params)[0]
    return displaced, (end - float(times[first])) * elliptic_growth(params)


def ending(times: npt.ArrayLike, least: npt.ArrayLike) -> float:
    """Return the time, between those given (n,), at which the least P_z (n,) rises through zero, or NaN."""
    t, low = np.asarray(times, dtype=np.float64), np.asarray(least, dtype=np.float64)
    if not (low > 0).any() or low[0] > 0:
        return np.nan
    k = int(np.argmax(low > 0))
    return float(t[k - 1] - low[k - 1] * (t[k] - t[k - 1]) / (low[k] - low[k - 1]))


def by_law(displaced: npt.ArrayLike) -> Array:
    """Return the life, in units of 1/λ, of stripes whose zones are displaced (n,) by so many widths.

    The law of fronts, dδ/dt = λ (w/4) sinh(4δ/w), followed from δ to infinity: ln coth(2δ/w).
    """
    return np.asarray(-np.log(np.tanh(2 * np.asarray(displaced))), dtype=np.float64)
