"""Cells of which a band loses the direction that filaments avoid, or gets another; order that tips over."""

from __future__ import annotations

import numpy as np
import xarray

from ..dynamics.protocol import Protocol, change
from ..dynamics.simulate import simulate
from ..dynamics.trajectory import Trajectory
from ..model import initial, regions
from ..model.grid import Array, CylinderGrid
from ..model.parameters import Parameters
from ..stability import orders
from .lab import frames

TREATMENTS = {"lost": {"kappa": 0.0}, "turned": {"repulsion_angle": 0.5 * np.pi}}
"""What becomes of the cue: nothing is avoided any more, or the direction along the cell is."""
NOISE = 4000.0
TREATED, END = 20.0, 150.0
"""Times at which a band of an established cell is treated, and is looked at."""
BETWEEN, SMALL = (2.0, 12.0), 1e-4
"""Times between which a small tilt is timed, and its size."""
GRID = CylinderGrid(48, 48, 5.0)


def cell(treatment: str, length: float, times: tuple[float, ...]) -> xarray.Dataset:
    """Return the frames at some times of a cell of which a band of a length is treated."""
    return frames(treated(treatment, length, 1, times), times)


def band(treatment: str, length: float, seed: int) -> tuple[float, float]:
    """Return the share of order that runs around the axis in a treated band of a length, and outside it."""
    mask = where(length).mask(GRID)
    last = treated(treatment, length, seed, (END,)).frames[-1]
    return around(last, mask), around(last, ~mask)


def where(length: float) -> regions.Region:
    """Return the band of a length in the middle of the cell."""
    return regions.band("z", 0.5 * (GRID.length - length), 0.5 * (GRID.length + length))


def treated(treatment: str, length: float, seed: int, times: tuple[float, ...]) -> Trajectory:
    """Return the run of an established cell of which a band is treated."""
    protocol = Protocol(change(at=TREATED, where=where(length), **TREATMENTS[treatment]))
    start = initial.with_noise(initial.stripes(GRID), GRID, NOISE, seed)
    return simulate(Parameters(), GRID, start, END, save_at=times, protocol=protocol, rtol=1e-3)


def around(state: Array, mask: regions.Mask) -> float:
    """Return the share of <|P|²> in P_theta of a state (2, n_theta, n_z) where a mask is true."""
    square = state[:, mask] ** 2
    return float(square[0].sum() / square.sum())


def tilt_growth(alpha_u: float) -> float:
    """Return the growth rate of a small uniform tilt of unidirectional order."""
    params = Parameters(alpha_u=alpha_u)
    grid = CylinderGrid(8, 8, 5.0)
    state = initial.unidirectional(grid, orders(params, "unidirectional")[0])
    state[0] = SMALL
    run = simulate(params, grid, state, BETWEEN[1], save_at=BETWEEN, rtol=1e-8)
    first, last = (float(run.frames[k][0].mean()) for k in (-2, -1))
    return float(np.log(last / first) / (BETWEEN[1] - BETWEEN[0]))
