"""Stripes that wind about the axis: made, recognised, and what theory says of them under a tilted d."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from ..model.grid import Array, CylinderGrid
from ..model.parameters import Parameters
from ..stability import cyclosis, steady_state


def wound(grid: CylinderGrid, turns: int, magnitude: float = 0.8) -> Array:
    """Return two stripes that wind about the axis `turns` times to the left, with filaments along them."""
    angle = np.arctan(2 * np.pi * turns / grid.length)
    phase = grid.theta[:, None] + 2 * np.pi * turns * grid.z[None, :] / grid.length
    return magnitude * np.stack([-np.sin(angle) * np.sin(phase), np.cos(angle) * np.sin(phase)])


def winding(zones: Iterable[tuple[int, int]]) -> float:
    """Return how often two zones go round on their way along the cell, to the left, from their windings.

    NaN unless there are just two, alike, that run along the cell. Closed loops do not count.
    """
    open_ones = [turns for turns in zones if turns != (0, 0)]
    if len(open_ones) != 2 or any(abs(along) != 1 for _, along in open_ones):
        return float("nan")
    first, second = (-around * along for around, along in open_ones)
    return float(first) if first == second else float("nan")


def filament_tilt(P: Array) -> float:
    """Return the angle to the left of the axis, in radians, of the line along which P (2, ...) lies."""
    across, along, mixed = np.mean(P[0] ** 2), np.mean(P[1] ** 2), np.mean(P[0] * P[1])
    return float(0.5 * np.arctan2(-2 * mixed, along - across))


def leaning(tilt: float) -> float:
    """Return the tilt of the filaments of the steady state with straight zones, in theory."""
    grid = CylinderGrid(48, 8, 5.0)
    return filament_tilt(steady_state(Parameters(repulsion_angle=tilt), grid, wound(grid, 0)).state)


def speed_along(tilt: float) -> float:
    """Return the peak speed of stripes along the easy direction of a tilted d, in theory.

    They are those of d = e_theta, as far apart as a cut at right angles to them is long: 2π cos(tilt), for
    which lengths in d_s and μ are measured in cos(tilt).
    """
    narrower, params = np.cos(tilt) ** 2, Parameters()
    params = params.replace(d_s=params.d_s / narrower, mu=params.mu / narrower)
    return float(np.abs(cyclosis(params).u).max())
