"""Bent zones of two stripes: prepared or grown from disorder, and how fast they become straight."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from ..analysis.zones import crossings
from ..dynamics.simulate import simulate
from ..model import initial
from ..model.definitions import TERM_NAMES
from ..model.grid import Array, CylinderGrid
from ..model.parameters import Parameters
from ..stability import cyclosis

GRID = CylinderGrid(48, 48, 5.0)
EPSILON = 0.1
"""The paper's ε, at which zones grow from disorder before it is changed."""
FIRST, LAST = 6.0, 60.0
"""Times between which two stripes are waited for, once in a unit of time."""
FOLLOWED = 80.0
"""For how long bent zones are followed."""
EVERY = 1.0
TIMES = tuple(float(time) for time in np.arange(0.0, FOLLOWED + EVERY / 2, EVERY))
LEVELS = (0.5, 0.1)
"""Shares of its first value at which a bend is timed."""
WITHOUT = tuple(name for name in TERM_NAMES if name != "shear")
"""Terms of the equation less alignment by shear."""


def zone_lines(grid: CylinderGrid, P: Array) -> Array | None:
    """Return the angles (2, n_z) of the two zones along the cell, without jumps at 2π, rising zone first.

    None unless every circle is crossed by exactly two, and both close on themselves along the cell.
    """
    if not np.all(crossings(P) == 2):
        return None
    up = P[1] > 0
    following = np.roll(up, -1, axis=0)
    lines = []
    along = np.arange(grid.n_z)
    for crossing in (~up & following, up & ~following):
        at = np.argmax(crossing, axis=0)
        here, there = P[1][at, along], P[1][(at + 1) % grid.n_theta, along]
        line = np.unwrap((at + here / (here - there)) * 2 * np.pi / grid.n_theta)
        if abs(line[-1] - line[0]) > np.pi:
            return None
        lines.append(line)
    return np.array(lines)


def bend(grid: CylinderGrid, P: Array) -> float:
    """Return the root mean square, in radians, by which zones depart from straight lines; NaN without two."""
    lines = zone_lines(grid, P)
    return np.nan if lines is None else float(np.sqrt(np.mean(np.var(lines, axis=1))))


def bent(grid: CylinderGrid, size: float) -> Array:
    """Return two stripes whose zones wave once along the cell by a root mean square of `size` radians."""
    profile = cyclosis(Parameters(), 64).P
    spectrum = np.fft.rfft(profile, norm="forward")[: grid.n_theta // 2]
    shift = np.sqrt(2) * size * np.sin(2 * np.pi * grid.z / grid.length)
    phase = np.multiply.outer(grid.theta, np.ones(grid.n_z)) - shift
    waves = [2 * (one * np.exp(1j * m * phase)).real for m, one in enumerate(spectrum) if m > 0]
    state = np.zeros((2, *grid.shape))
    # A little weaker than steady, so that no point exceeds 1 where the grid is coarse.
    state[1] = 0.95 * np.sum(waves, axis=0)
    return state


def straightening(start: Array, epsilon: float, shear: bool) -> Array:
    """Return the bend (time,) at `TIMES` of a cell from a state on, with or without shear alignment."""
    terms = TERM_NAMES if shear else WITHOUT
    params = Parameters(epsilon=epsilon)
    run = simulate(params, GRID, start, FOLLOWED, save_at=TIMES, rtol=1e-3, terms=terms)
    return np.array([bend(GRID, one) for one in run.frames])


def prepared(size: float, shear: bool) -> Array:
    """Return the bend (time,) of prepared zones that begin with a bend of `size` radians."""
    return straightening(bent(GRID, size), EPSILON, shear)


def grown(seed: int) -> tuple[float, float, Array]:
    """Return when two stripes first stand in a cell from disorder, how bent they are, and the state then.

    NaN and the last state where they do not by `LAST`.
    """
    times = tuple(np.arange(FIRST, LAST + 1.0))
    run = simulate(Parameters(), GRID, initial.disordered(GRID, seed=seed), LAST, save_at=times, rtol=1e-3)
    for time, state in zip(times, list(run.frames)[-len(times) :], strict=True):
        size = bend(GRID, state)
        if np.isfinite(size):
            return float(time), size, np.asarray(state / max(1.0, float(np.hypot(*state).max())))
    return np.nan, np.nan, np.asarray(run.final_state)


def from_disorder(seed: int, epsilons: Sequence[float]) -> tuple[float, float, Array, Array]:
    """Grow bent zones at the paper's ε, then straighten copies of them at other ε, with shear and without.

    Returns when they first stood, their bend, the times (epsilon, shear, level) at which that has fallen to
    `LEVELS`, infinite if it does not in time, and its courses (shear, time) at the paper's ε; shear: with,
    without. At ε = 0 there is none.
    """
    when, size, state = grown(seed)
    times = np.full((len(epsilons), 2, len(LEVELS)), np.nan)
    courses = np.full((2, len(TIMES)), np.nan)
    if np.isfinite(when):
        for k, epsilon in enumerate(epsilons):
            for j, shear in enumerate((True, False)):
                if epsilon == 0 and not shear:
                    times[k, j] = times[k, 0]
                    continue
                row = straightening(state, epsilon, shear)
                times[k, j] = [fallen(TIMES, row, level) for level in LEVELS]
                if epsilon == EPSILON:
                    courses[j] = row
    return when, size, times, courses


def fallen(times: npt.ArrayLike, bends: npt.ArrayLike, level: float) -> float:
    """Return when a bend (n,) has fallen to a share of its first value, infinite if never.

    Between samples by the exponential through both.
    """
    t, b = np.asarray(times, dtype=np.float64), np.asarray(bends, dtype=np.float64)
    below = b <= level * b[0]
    if not below.any():
        return np.inf
    k = int(np.argmax(below))
    if not np.isfinite(b[k - 1]):
        return float(t[k])
    passed = np.log(b[k - 1] / (level * b[0])) / np.log(b[k - 1] / b[k])
    return float(t[k - 1] + passed * (t[k] - t[k - 1]))


def late_rate(times: npt.ArrayLike, bends: npt.ArrayLike, since: float) -> float:
    """Return the rate at which a bend (n,) has decayed from a time on, by its logarithm's line."""
    t, b = np.asarray(times, dtype=np.float64), np.asarray(bends, dtype=np.float64)
    late = t >= since
    return -float(np.polyfit(t[late], np.log(b[late]), 1)[0])
