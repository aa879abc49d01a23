"""From disorder to stripes: how large the patches of one polarity are, and how steadily the flow runs."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from ..analysis.zones import crossings, indifferent_zones
from ..dynamics.simulate import simulate
from ..model import initial
from ..model.grid import Array, CylinderGrid
from ..model.parameters import Parameters
from ..model.system import flow

GRID = CylinderGrid(48, 48, 5.0)
TIMES = (*np.arange(0.0, 16.0, 0.5), *np.arange(16.0, 40.0, 1.0), *np.arange(40.0, 101.0, 5.0))
"""Times (R/U) at which a course is taken."""
MOVING, STOPPED = 0.1, 0.05
"""Speeds, as shares of a cell's final root mean square, above which flow at a place moves, below which it
has stopped: what an observer could see."""
EARLY = 20.0
"""Time that parts early from late: the two stripes stand."""
COURSES = ("order", "global_order", "speed", "domain_size", "elongation", "stripes")
MOST = 4
"""Stops of this many or more are counted together."""


def course(seed: int) -> tuple[Array, Array, Array]:
    """Follow a cell from disorder: courses (6, time), reversals early and late, and places by stops.

    Courses are those named in `COURSES`. Reversals (2,) are visible ones per place and time; places
    (`MOST` + 1,) the share of the surface at which visible flow stopped and went on 0, 1, ... times.
    """
    params = Parameters()
    state = initial.disordered(GRID, seed=seed)
    run = simulate(params, GRID, state, TIMES[-1], save_at=TIMES, rtol=1e-3)
    P = np.stack(list(run.frames))
    u = np.stack([flow(params, GRID, one) for one in P])
    courses = np.array(
        [
            _size(P),
            [global_order(one) for one in P],
            _size(u),
            [domain_size(GRID, one) for one in P],
            [elongation(GRID, one) for one in P],
            [two_stripes(one) for one in P],
        ]
    )
    scale = courses[2, -1]
    times = np.array(TIMES)
    turned = reversals(u[:, 1] / scale)
    late = times > EARLY
    span = (EARLY, times[-1] - EARLY)
    turns = np.array([turned[~late].sum() / span[0], turned[late].sum() / span[1]])
    stopped = np.minimum(stops(np.hypot(u[:, 0], u[:, 1]) / scale), MOST)
    places = np.bincount(stopped.ravel(), minlength=MOST + 1) / stopped.size
    return courses, turns, places


def _size(v: Array) -> Array:
    return np.asarray(np.sqrt(np.mean(np.sum(v**2, axis=1), axis=(1, 2))))


def global_order(P: Array) -> float:
    """Return the root mean square of the one wave of P_z (2, n_theta, n_z) that goes once around the cell."""
    around = np.fft.fft(P[1].mean(axis=1), norm="forward")
    return float(np.sqrt(2) * np.abs(around[1]))


def domain_size(grid: CylinderGrid, P: Array) -> float:
    """Return the mean width of patches of one polarity: area over the length of the lines between them.

    Of two straight stripes π, the width of either; infinite if there is one polarity only.
    """
    length = sum(zone.arc_length for zone in indifferent_zones(grid, P))
    return 2 * np.pi * grid.length / length if length > 0 else np.inf


def expected_size(params: Parameters, time: npt.ArrayLike) -> Array:
    """Return the domain size of disorder that grows by the linear equation, 4 (d_s t)^½.

    Waves of P_z grow at a - d_s k², so that white noise becomes a normal field whose slope has 1/(4 d_s t)
    times its variance; by Rice's formula half the root of that is the length of its zeros per area.
    """
    return np.asarray(4 * np.sqrt(params.d_s * np.asarray(time, dtype=np.float64)))


def elongation(grid: CylinderGrid, P: Array) -> float:
    """Return by how much longer along the cell than around it patches are, by the slopes of P_z."""
    spectrum = np.abs(np.fft.fft2(P[1])) ** 2
    around = np.sum(grid.m[:, None] ** 2 * spectrum)
    along = np.sum(grid.q[None, :] ** 2 * spectrum)
    # Straight stripes are as long as one likes: what is beyond a hundred is not told apart.
    return float(np.sqrt(around / max(along, 1e-4 * around, 1e-300)))


def two_stripes(P: Array) -> bool:
    """Return whether every circle around the cell is crossed by exactly two zones."""
    return bool(np.all(crossings(P) == 2))


def reversals(v: Array) -> Array:
    """Return for each time the share of places whose velocity v (time, n_theta, n_z) has visibly reversed.

    That is, has come to exceed `MOVING` against the direction in which it last did.
    """
    last = np.zeros(v.shape[1:])
    out = np.zeros(len(v))
    for k, now in enumerate(v):
        sign = np.where(np.abs(now) > MOVING, np.sign(now), 0.0)
        out[k] = np.mean(sign * last < 0)
        last = np.where(sign != 0, sign, last)
    return out


def stops(speed: Array) -> Array:
    """Return how often speed (time, n_theta, n_z) fell below `STOPPED` and rose above `MOVING` again."""
    started = np.zeros(speed.shape[1:], dtype=bool)
    halted = np.zeros_like(started)
    count = np.zeros(speed.shape[1:], dtype=int)
    for now in speed:
        again = halted & (now > MOVING)
        count += again
        started |= now > MOVING
        halted = (halted & ~again) | (started & (now < STOPPED))
    return count


def reached(times: npt.ArrayLike, values: npt.ArrayLike, level: float) -> float:
    """Return the first time at which a course (n,) reaches a level, linear between samples; NaN if never."""
    t, x = np.asarray(times, dtype=np.float64), np.asarray(values, dtype=np.float64)
    above = x >= level
    if not above.any():
        return np.nan
    k = int(np.argmax(above))
    if k == 0:
        return float(t[0])
    return float(t[k - 1] + (level - x[k - 1]) * (t[k] - t[k - 1]) / (x[k] - x[k - 1]))


def since(times: npt.ArrayLike, holds: npt.ArrayLike) -> float:
    """Return the time (n,) since which something has held (n,) to the end; NaN if it does not at the end."""
    true = np.asarray(holds, dtype=bool)
    if not true[-1]:
        return np.nan
    return float(np.asarray(times)[true.size - int(np.argmin(np.append(true[::-1], False)))])
