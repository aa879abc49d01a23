"""Velocities of a prepared film: means over pairs of frames, on a grid of its pictures."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from ..observation import Frame, gridded
from .moving import Bools, Fields, between
from .trial import Plan

Array = npt.NDArray[np.float64]

UNSURE = 0.15
"""A sample counts if the standard error of a component is below this share of the fastest displacements."""
LEAST_SAMPLES = 50
"""Samples that a noise is estimated from, at least."""


@dataclass(frozen=True)
class Prepared:
    """Frames to measure: `pictures` (n, rows, columns), their times `when` (n,), and where something moves.

    `binned` pixels of the file, in each direction, make one here.
    """

    pictures: Fields
    when: Array
    live: Bools
    binned: int


@dataclass(frozen=True)
class Mean:
    """The mean velocity of some pairs: `v` (2, rows, columns) in pixels per time, its error, where it counts.

    `time` is that of the middle of the pairs.
    """

    v: Array
    error: Array
    good: Bools
    time: float


def mean_velocity(film: Prepared, start: int, plan: Plan, fastest: float) -> Mean:
    """Return the mean velocity of `plan.average` pairs from the frame `start` on, weighted by their errors.

    `fastest` is the largest displacement of a pair in pixels.
    """
    weights = np.zeros(film.live.shape)
    seen = np.zeros(film.live.shape, dtype=np.int64)
    total = np.zeros((2, *film.live.shape))
    middles = []
    for k in range(start, start + plan.average):
        flow = between(film.pictures[k], film.pictures[k + plan.gap], plan.radius)
        took = float(film.when[k + plan.gap] - film.when[k])
        sure = flow.consistent / np.maximum(flow.error / took, 1e-12).astype(np.float64) ** 2
        weights += sure
        seen += flow.consistent
        total += sure * flow.v / took
        middles.append(0.5 * (film.when[k] + film.when[k + plan.gap]))
    usual = float(np.median(np.diff(film.when))) * plan.gap
    error = 1 / np.sqrt(np.maximum(weights, 1e-24))
    good = film.live & (2 * seen > plan.average) & (error * usual < UNSURE * max(fastest, 1.0))
    return Mean(total / np.maximum(weights, 1e-24), error, good, float(np.mean(middles)))


def measured(
    film: Prepared,
    plan: Plan,
    fastest: float,
    most: int,
    step: int,
    told: Callable[..., None] | None = None,
) -> tuple[list[Frame], Array]:
    """Return velocities at times spread evenly over a film, from at most `most` pairs, and their errors.

    The velocities are in pixels of the file per unit of time, `step` such pixels apart. The errors are
    those of one component, at the samples that count. `told` is called with how many velocities of how many
    are done.
    """
    pairs = len(film.pictures) - plan.gap
    count = max(1, min(most, pairs) // plan.average)
    starts = np.unique(np.linspace(0, pairs - plan.average, count).round().astype(int))
    rows, columns = film.live.shape
    apart = max(1, round(step / film.binned))
    y, x = np.arange(apart // 2, rows, apart), np.arange(apart // 2, columns, apart)
    offset = 0.5 * (film.binned - 1)
    frames, errors = [], []
    for done, start in enumerate(starts, start=1):
        mean = mean_velocity(film, int(start), plan, fastest)
        vx, vy = mean.v[:, y[:, None], x] * film.binned
        good = mean.good[y[:, None], x]
        frames.append(gridded(film.binned * x + offset, film.binned * y + offset, vx, vy, good, mean.time))
        errors.append(mean.error[y[:, None], x][good] * film.binned)
        if told is not None:
            told(done, starts.size)
    return frames, np.concatenate(errors)


def noise(film: Prepared, plan: Plan, fastest: float) -> float | None:
    """Return the noise of a velocity component in pixels per time, or None if the film is too short.

    It comes from second differences of three successive means in the middle of the film.
    """
    pairs = len(film.pictures) - plan.gap
    first = (pairs - 3 * plan.average) // 2
    if first < 0:
        return None
    means = [mean_velocity(film, first + k * plan.average, plan, fastest) for k in range(3)]
    good = np.logical_and.reduce([mean.good for mean in means])
    if good.sum() < LEAST_SAMPLES:
        return None
    a, b, c = (mean.v for mean in means)
    bend = (a - 2 * b + c)[:, good]
    return float(1.4826 * np.median(np.abs(bend)) / np.sqrt(6) * film.binned)
