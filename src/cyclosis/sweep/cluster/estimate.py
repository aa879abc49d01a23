"""The cost of a sweep, estimated from a few members that are computed in this process.

A worker first starts: it loads its modules and compiles. Each point of the axes then takes some time, for its
steady states, and each member at the point some more. The start is measured by starting one worker, the
other times are sampled; a sample during which a program was compiled is computed again, so that no sample
includes compilation.
"""

from __future__ import annotations

import math
import os
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

import jax.monitoring
import numpy as np
import psutil
import scipy.special

from ...ensemble import default_lanes
from ...model.grid import Array
from ..plan.sweep import Sweep
from ..store.block import computed
from ..store.block_file import Arrays, pack
from .environment import processes
from .queue import spread

BUDGET_SECONDS = 12.0
"""Time, without compilation, after which sampling ends once the mean cost of a point is known `ROUGHLY`."""
PATIENCE = 4
"""Sampling ends after this many budgets, however uncertain the mean cost is."""
ENOUGH = 32
"""Sampling ends after this many points once their mean cost is known `WELL`."""
ROUGHLY, WELL = 0.3, 0.1
"""Relative errors of a mean."""
SEEDS = 2
"""Most members sampled at one point: costs vary so much between points that more points are better."""
CONFIDENCE = 0.9
"""Probability that the mean cost lies in the range that is given."""

Clock = Callable[[], float]


@dataclass(frozen=True)
class Estimate:
    """The estimated cost of a sweep on `workers` like this process, in seconds of wall time.

    `members` at `points` of the axes were computed. All members together take `core_seconds`, or from `low`
    to `high`, which are NaN if only one of several points was sampled; `busiest` is the share of members that
    the busiest worker computes. A worker takes `start` before it computes, with the compiled programs that
    are on this machine now, and `compiling` is the time that this process spent on compiling them. `memory`
    is what this process uses at the end, in bytes, and `disk` the size of all blocks.
    """

    workers: int
    members: int
    points: int
    core_seconds: float
    low: float
    high: float
    start: float
    compiling: float
    busiest: float
    memory: int
    disk: int

    @property
    def seconds(self) -> float:
        """Wall time until the busiest worker is done."""
        return self.start + self.busiest * self.core_seconds

    @property
    def range(self) -> tuple[float, float]:
        """The shortest and the longest wall time to expect."""
        return self.start + self.low / self.workers, self.start + self.busiest * self.high


def estimate(
    sweep: Sweep, workers: int | None = None, budget: float = BUDGET_SECONDS, clock: Clock = time.perf_counter
) -> Estimate:
    """Compute a sample of members in this process, and return the estimated cost of the sweep.

    `workers` is by default the number that `run_sweep` would start here. Points are sampled evenly over all
    axes for `budget` seconds of computing: fewer if their mean cost is well known earlier, more if it is not
    even roughly known. At each point up to `SEEDS` members are computed: the cost of its steady states is
    shared by all its seeds. Where members run side by side, as on a GPU, whole blocks are sampled.
    """
    count = workers or processes(os.environ)
    sample = _Sample(sweep, clock)
    costs: list[float] = []
    mean = error = math.nan
    for part in spread(sample.parts, sample.parts // 2):
        costs.append(sample.cost(part))
        mean, error = float(np.mean(costs)), _error(costs, 1 - sample.members / sweep.members)
        if (
            sample.spent >= PATIENCE * budget
            or (sample.spent >= budget and error <= ROUGHLY * mean)
            or (len(costs) >= ENOUGH and error <= WELL * mean)
        ):
            break
    block = len(sweep.block(0).members)
    start = started(sweep, sample.first, clock)
    return Estimate(
        workers=count,
        members=sample.members,
        points=len(costs) if sample.lanes == 1 else sample.points,
        core_seconds=sample.parts * mean,
        low=sample.parts * max(mean - error, min(costs)),
        high=sample.parts * (mean + error),
        start=max(start - sample.first_seconds, 0.0),
        compiling=sample.compiling,
        busiest=_busiest(sweep, count) / sweep.members,
        memory=psutil.Process().memory_info().rss,
        disk=sweep.blocks
        * len(pack(sweep, 0, {n: np.repeat(a[:1], block, axis=0) for n, a in sample.arrays.items()})),
    )


class _Sample:
    """Parts of a sweep that are computed to measure their cost: points, or blocks if there are `lanes`."""

    def __init__(self, sweep: Sweep, clock: Clock) -> None:
        self.sweep, self.clock = sweep, clock
        self.lanes = sweep.settings.lanes or default_lanes(sweep.build(0).grid, sweep.settings.precision)
        self.seeds = len(sweep.seeds)
        self.points = sweep.members // self.seeds
        self.parts = sweep.blocks if self.lanes > 1 else self.points
        self.arrays: Arrays = {}
        self.members = 0
        self.spent = self.compiling = 0.0
        self.first, self.first_seconds = 0, 0.0

    def cost(self, part: int) -> float:
        """Return the seconds that a part of the sweep takes."""
        if self.lanes > 1:
            return self._timed(self.sweep.block(part).members)
        chosen = np.random.default_rng(part).choice(self.seeds, min(SEEDS, self.seeds), replace=False)
        seconds = self._timed([part * self.seeds + int(seed) for seed in sorted(chosen)])
        each = self._shares() * seconds
        once = max(float(each[0] - np.mean(each[1:])), 0.0) if len(each) > 1 else 0.0
        return _pieces(self.sweep) / self.points * once + self.seeds * (seconds - once) / len(each)

    def _shares(self) -> Array:
        """Return each computed member's share of the time: the first one also computes steady states."""
        each = np.asarray(self.arrays["seconds"], dtype=np.float64)
        return each / each.sum() if each.sum() > 0 else np.full(each.size, 1.0 / each.size)

    def _timed(self, numbers: Sequence[int]) -> float:
        """Compute some members, and return the time that this takes once everything is compiled."""
        before, began = compilations(), self.clock()
        self.arrays = computed(self.sweep, numbers)
        seconds = self.clock() - began
        if compilations() > before:
            began = self.clock()
            self.arrays = computed(self.sweep, numbers)
            again = self.clock() - began
            self.compiling += max(seconds - again, 0.0)
            seconds = again
        if self.members == 0:
            self.first, self.first_seconds = numbers[0], float(self._shares()[0]) * seconds
        self.members += len(numbers)
        self.spent += seconds
        return seconds


def started(sweep: Sweep, number: int, clock: Clock) -> float:
    """Return the seconds that a worker takes to start and compute one member, with programs compiled."""
    from ..execute import run_sweep

    point, seed = sweep.member(number)
    axes = {name: {"values": [value]} for name, value in point.items()}
    ensemble = sweep.tables["ensemble"] | {"seeds": 1, "first_seed": seed, "block": 1}
    one = Sweep.from_tables(sweep.tables | {"axes": axes, "ensemble": ensemble})
    with TemporaryDirectory() as folder:
        began = clock()
        summary = run_sweep(one, Path(folder) / "store", workers=1, progress=False)
        if summary.status == "interrupted":
            raise KeyboardInterrupt
        return clock() - began


def compilations() -> int:
    """Return how many programs this process has compiled, or loaded compiled, since the first call."""
    return len(_compiled())


@cache
def _compiled() -> list[str]:
    found: list[str] = []

    def heard(event: str, duration_secs: float, **kwargs: str | int) -> None:
        if event.endswith("backend_compile_duration"):
            found.append(event)

    jax.monitoring.register_event_duration_secs_listener(heard)
    return found


def _pieces(sweep: Sweep) -> int:
    """Return into how many pieces blocks divide the points of a sweep: steady states are computed in each."""
    seeds, block = len(sweep.seeds), sweep.block_size
    cuts = (sweep.members - 1) // block
    return sweep.members // seeds + cuts - (sweep.members - 1) // math.lcm(seeds, block)


def _error(costs: Sequence[float], left: float) -> float:
    """Return how far the mean of all costs may be from the mean of these, by Student's t; NaN if unknown.

    `left` is the share of members that were not sampled.
    """
    count = len(costs)
    if left == 0:
        return 0.0
    if count < 2:
        return math.nan
    quantile = float(scipy.special.stdtrit(count - 1, 0.5 + 0.5 * CONFIDENCE))
    return quantile * float(np.std(costs, ddof=1)) * math.sqrt(left / count)


def _busiest(sweep: Sweep, workers: int) -> int:
    """Return how many members the busiest worker computes, if all blocks take the same time."""
    rounds, rest = divmod(sweep.blocks, workers)
    if rest == 1 and rounds > 0:  # the last block alone, which may be smaller
        return rounds * sweep.block_size + len(sweep.block(sweep.blocks - 1).members)
    return min((rounds + (rest > 0)) * sweep.block_size, sweep.members)
