"""Cells without bundling, by force law: how the wave once around them grows, and what theory says of them."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
import scipy.stats

from ..dynamics.simulate import simulate
from ..model import initial
from ..model.errors import InputError
from ..model.grid import Array, CylinderGrid
from ..model.parameters import Parameters
from ..stability import cyclosis

GRID = CylinderGrid(48, 48, 5.0)
BETWEEN = (10.0, 30.0)
"""Times between which growth is measured: the other waves have faded, and this one is small still."""


def wave_growth(exponent: float, alpha_u: float, seed: int) -> float:
    """Return the growth rate of the wave of P_z once around a disordered cell without bundling."""
    params = Parameters(alpha_p=0.0, alpha_u=alpha_u, force_exponent=exponent)
    state = initial.disordered(GRID, seed=seed)
    run = simulate(params, GRID, state, BETWEEN[1], save_at=BETWEEN, rtol=1e-5)
    first, last = (abs(np.fft.fft(run.frames[k][1].mean(axis=1))[1]) for k in (-2, -1))
    return float(np.log(last / first) / (BETWEEN[1] - BETWEEN[0]))


def stripe_speed(exponent: float, alpha_u: float) -> float:
    """Return the peak speed of steady stripes without bundling; NaN where there are none."""
    try:
        state = cyclosis(Parameters(alpha_p=0.0, alpha_u=alpha_u, force_exponent=exponent), 64)
    except InputError:
        return np.nan
    return float(np.abs(state.u).max())


def onsets(strength: npt.ArrayLike, rates: npt.ArrayLike) -> Array:
    """Return, for each seed, the strength (n,) at which the line through rates (n, seeds) crosses zero."""
    slope, at_zero = np.polyfit(np.asarray(strength), np.asarray(rates), 1)
    crossing: Array = -at_zero / slope
    return crossing


def mean_interval(values: npt.ArrayLike) -> tuple[float, float, float]:
    """Return the mean of values (n,), n >= 2, and the ends of its 95 % interval by Student's t."""
    x = np.asarray(values, dtype=np.float64)
    half = float(scipy.stats.t.ppf(0.975, x.size - 1) * x.std(ddof=1) / np.sqrt(x.size))
    return float(x.mean()), float(x.mean()) - half, float(x.mean()) + half
