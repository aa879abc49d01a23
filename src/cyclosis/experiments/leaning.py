"""Order that leans towards the circumference: from disorder, in stripes that turn, and by theory."""

from __future__ import annotations

import numpy as np

from ..dynamics.simulate import simulate
from ..model import initial
from ..model.errors import InputError
from ..model.grid import Array, CylinderGrid
from ..model.parameters import Parameters
from ..stability import cyclosis, drifting, orders

SEEN = (250.0, 300.0)
"""Times between which turning stripes are timed."""
EARLY_END, STEP = 8.0, 0.25
HALF = 0.5
"""Order at which a cell is judged: what grows first has grown, and flow has hardly begun to steer."""
GRID = CylinderGrid(48, 48, 5.0)


def turning(kappa: float, seed: int) -> float:
    """Return the speed at which stripes from disorder turn, positive towards their mean P_theta."""
    run = simulate(
        Parameters(kappa=kappa), GRID, initial.disordered(GRID, seed=seed), SEEN[1], save_at=SEEN, rtol=1e-4
    )
    first, last = run.frames[-2], run.frames[-1]
    return turned(first, last, SEEN[1] - SEEN[0])


def turned(first: Array, last: Array, time: float) -> float:
    """Return the speed at which the first wave of P_z turns from one state (2, n_theta, n_z) to another."""
    waves = [np.fft.rfft(state[1].mean(axis=1))[1] for state in (first, last)]
    return float(-np.angle(waves[1] / waves[0]) / time * np.sign(last[0].mean()))


def beginning(kappa: float, seed: int) -> Array:
    """Return the share of order around the axis: when order reaches a half, that time, and over time."""
    state = initial.disordered(GRID, seed=seed)
    run = simulate(Parameters(kappa=kappa), GRID, state, EARLY_END, save_every=STEP, rtol=1e-3)
    square = np.array([np.mean(P**2, axis=(1, 2)) for P in run.frames])
    share = square[:, 0] / square.sum(axis=1)
    order = np.sqrt(square.sum(axis=1))
    at = int(np.argmax(order >= HALF)) if (order >= HALF).any() else -1
    return np.array([share[at], float(run.times[at]), *share])


def tilted(kappa: float) -> tuple[float, float]:
    """Return the drift of tilted stripes and their mean P_theta by theory; NaN where there are none."""
    try:
        state = drifting(Parameters(kappa=kappa), 96)
    except InputError:
        return np.nan, np.nan
    return state.drift, float(state.P[0].mean())


def upright(params: Parameters) -> float:
    """Return the kappa above which two stripes stand upright; their growth rate of a tilt falls with it."""
    modes = cyclosis(params, 96).spectrum(1, components="theta")
    return float(params.kappa + modes.eigenvalues[0].real)


def circumferential_end(params: Parameters) -> float:
    """Return the kappa below which order around the axis is stable, d_s + α_u P0² μ/(1 + μ)."""
    kappa = 0.0
    for _ in range(50):
        order = orders(params.replace(kappa=kappa), "circumferential")[0]
        kappa = params.d_s + params.alpha_u * order**2 * params.mu / (1 + params.mu)
    return float(kappa)
