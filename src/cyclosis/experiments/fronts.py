"""Fronts between opposite streams in cells that do not vary along their axis: their motion and its law."""

from __future__ import annotations

import numpy as np

from ..analysis.zones import zone_angles
from ..dynamics.simulate import simulate
from ..model.grid import Array, CylinderGrid
from ..model.parameters import Parameters
from ..stability import elliptic_growth

FASTEST = 1e-9
"""Speed below which rounding dominates."""
SETTLED, LONGEST = 30.0, 5000.0
POINTS = 192
"""Points around cells that do not vary along their axis: with 48 the grid pins the fronts of α_p = 1."""
WEAK = 0.1
"""Bundling of cells whose threshold is measured: there fronts move fast enough to observe."""
END = 1e5
"""Time by which the fate of fronts at that bundling is decided."""


def front(params: Parameters) -> tuple[float, float]:
    """Return width w and order P0 of a front at α_u = 0."""
    a = params.alpha_p - params.d_r
    return float(np.sqrt(2 * params.d_s / a)), float(np.sqrt(a / params.alpha_p))


def fronts(params: Parameters, grid: CylinderGrid, distance: float) -> Array:
    """Return two fronts: a stripe of a width in radians about θ = π points down, everything else up."""
    w, order = front(params)
    state = np.zeros((2, *grid.shape))
    state[1] = (order * np.tanh((np.abs(grid.theta - np.pi) - 0.5 * distance) / w))[:, None]
    return state


def apart(P: Array) -> float:
    """Return the width, in radians, of the stripe about θ = π of a state (2, n_theta, n_z), 0 without one."""
    zones = zone_angles(P[1].mean(axis=1))
    return float(zones[1] - zones[0]) if zones.size == 2 else 0.0


def closing(params: Parameters, distance: float) -> float:
    """Return the theoretical closing speed of two fronts at a distance in radians at α_u = 0.

    The distance is D = π - 2δ; the law is dδ/dt = λ (w/4) sinh(4δ/w).
    """
    w, _ = front(params)
    return float(elliptic_growth(params) * 0.5 * w * np.sinh(2 * (np.pi - distance) / w))


def life(alpha_p: float, width: float) -> float:
    """Return the time until a stripe of a width in turns has vanished at α_u = 0, by the integrated law."""
    params = Parameters(alpha_p=alpha_p, alpha_u=0.0)
    y = np.pi * (1 - 2 * width) / front(params)[0]
    return float(-np.log(np.tanh(y)) / elliptic_growth(params))


def creep(alpha_p: float, far: float) -> tuple[float, float, float]:
    """Return distance, closing speed and that of the law for fronts `far` widths apart at α_u = 0, or NaN."""
    params = Parameters(alpha_p=alpha_p, alpha_u=0.0)
    w, _ = front(params)
    if far * w > 0.46 * 2 * np.pi:
        return np.nan, np.nan, np.nan
    grid = CylinderGrid(POINTS, 8, 5.0)
    span = min(0.1 * w / closing(params, far * w), LONGEST)
    times = (SETTLED, SETTLED + 0.5 * span, SETTLED + span)
    run = simulate(params, grid, fronts(params, grid, far * w), times[-1], save_at=times, rtol=1e-6)
    before, middle, after = (apart(P) for P in list(run.frames)[-3:])
    speed = (before - after) / span
    if after == 0 or speed < FASTEST:
        return np.nan, np.nan, np.nan
    return middle, speed, closing(params, middle)


def fate(alpha_u: float, width: float) -> tuple[float, float]:
    """Return the width of the narrow stripe, in turns, once its profile has relaxed and at the end."""
    params = Parameters(alpha_p=WEAK, alpha_u=alpha_u)
    grid = CylinderGrid(POINTS, 8, 5.0)
    start = fronts(params, grid, 2 * np.pi * width)
    run = simulate(params, grid, start, END, save_at=(3.0, END), rtol=1e-4, steady_rate=1e-8)
    return apart(run.frames[0]) / (2 * np.pi), apart(run.final_state) / (2 * np.pi)


def growth(alpha_u: float) -> float:
    """Return the growth rate of a small difference of widths."""
    params = Parameters(alpha_p=WEAK, alpha_u=alpha_u)
    grid = CylinderGrid(POINTS, 8, 5.0)
    times = (100.0, 300.0)
    run = simulate(params, grid, fronts(params, grid, np.pi - 0.02), times[-1], save_at=times, rtol=1e-6)
    first, last = (np.pi - apart(P) for P in list(run.frames)[-2:])
    return float(np.log(last / first) / (times[1] - times[0]))
