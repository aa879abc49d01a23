"""What becomes of established stripes without (or with little) bundling: runs, and the branches of theory."""

from __future__ import annotations

from functools import cache

import numpy as np

from ..dynamics.simulate import simulate
from ..model import initial
from ..model.grid import Array, CylinderGrid
from ..model.parameters import Parameters
from ..model.system import flow
from ..stability.crossings import existing_from
from ..stability.equal import EqualStripes

STREAMING = 0.05
"""Peak speed from which on a cell streams; that of two stripes at the paper's parameters is 0.97."""
SHORT = CylinderGrid(48, 8, 5.0)
"""Stripes do not vary along the cell."""
SETTLING, LONGEST = 20.0, 2000.0
POINTS = 96
"""Points around the cell in theory."""
HALVINGS = 8
"""Halvings of the interval in which the least order that stripes need is looked for."""


@cache
def established() -> Array:
    """Return two stripes (2, n_theta, n_z) as they stream with the paper's parameters."""
    run = simulate(Parameters(), SHORT, initial.stripes(SHORT), SETTLING, save_at=(SETTLING,), rtol=1e-3)
    return run.final_state


def left_over(alpha_p: float, alpha_u: float, keep: float = 1.0) -> float:
    """Return the peak speed at which established stripes, their order times `keep`, stream in the end."""
    params = Parameters(alpha_p=alpha_p, alpha_u=alpha_u)
    start = keep * established()
    run = simulate(params, SHORT, start, LONGEST, save_every=LONGEST, rtol=1e-3, steady_rate=1e-6)
    return float(np.hypot(*flow(params, SHORT, run.final_state)).max())


def least_order(alpha_p: float, alpha_u: float) -> float:
    """Return the factor by which the order of established stripes may be multiplied so that they just last.

    1 where they do not even if all of it is left.
    """
    low, high = 0.0, 1.0
    if left_over(alpha_p, alpha_u) < STREAMING:
        return high
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        if left_over(alpha_p, alpha_u, middle) < STREAMING:
            low = middle
        else:
            high = middle
    return 0.5 * (low + high)


def fold(alpha_p: float) -> float:
    """Return the least alpha_u with which two stripes exist, for alpha_p < d_r + d_s."""
    return existing_from(EqualStripes(Parameters(alpha_p=alpha_p), 2, POINTS)).alpha_u


def branch(alpha_p: float, most: float, count: int) -> Array:
    """Return alpha_u, first wave and peak speed (count, 3) along the branch of two stripes, through its fold.

    From `most` alpha_u on the stable side down to small order on the other. The first wave is that of P_z.
    """
    problem = EqualStripes(Parameters(alpha_p=alpha_p), 2, POINTS)
    state = problem.full(most)
    wavenumber = np.fft.rfftfreq(POINTS, 1 / POINTS)
    rows = []
    for amplitude in np.linspace(problem.amplitude(state.P), 0.05, count):
        state = problem.at_amplitude(float(amplitude), state)
        force = np.fft.rfft(state.P**3) / (1 + problem.params.mu * wavenumber**2)
        speed = float(np.abs(np.fft.irfft(force, POINTS)).max())
        rows.append((state.alpha_u, float(amplitude), speed))
    return np.array(rows)


def first_wave(state: Array) -> float:
    """Return the amplitude of the wave of P_z once around the cell, of a state (2, n_theta, n_z)."""
    return float(2 * np.abs(np.fft.rfft(state[1].mean(axis=-1))[1]) / state.shape[1])
