"""What a sweep will cost, from a few of its members computed here and now."""

from __future__ import annotations

import math
import os
import time
from dataclasses import dataclass

import numpy as np
import psutil

from .block import compute
from .environment import processes
from .packed import pack
from .plan import Sweep

BUDGET_SECONDS = 12.0
"""Time that the sample may take, about, compiling included."""
CAUTION = 1.5
"""A larger sample is tried only if it fits even if its members take longer by this factor."""
MOST_VALUES = 8
"""Most values of one axis that are tried."""


@dataclass(frozen=True)
class Estimate:
    """What a sweep will cost on `workers` like this process.

    `member_seconds` is the mean over `sampled` members, spread over the axes, that took `sample_seconds`
    after the time `compiling`; `seconds` is the time of the whole. `memory` is what this process
    holds in the end, in bytes, and `disk` the size of all blocks.
    """

    workers: int
    member_seconds: float
    sampled: int
    sample_seconds: float
    compiling: float
    seconds: float
    memory: int
    disk: int


def estimate(sweep: Sweep, workers: int | None = None, budget: float = BUDGET_SECONDS) -> Estimate:
    """Return what a sweep will cost, having computed a sample of its members in this process.

    `workers` are by default as many as `run_sweep` would start here. The sample is made of ever more points,
    evenly spread over all axes, with the first seed, as long as the next would fit into `budget` seconds.
    """
    count = workers or processes(os.environ)
    began = time.perf_counter()
    arrays = compute(_sample(sweep, 1), 0)
    first = time.perf_counter() - began
    sampled, seconds = _timed(_sample(sweep, 1))
    compiling = max(first - seconds, 0.0)
    for values in range(2, MOST_VALUES + 1):
        thinned = _sample(sweep, values)
        expected = CAUTION * thinned.members * seconds / sampled
        if thinned.members == sampled or time.perf_counter() - began + expected > budget:
            break
        sampled, seconds = _timed(thinned)
    block = len(sweep.block(0).members)
    return Estimate(
        workers=count,
        member_seconds=seconds / sampled,
        sampled=sampled,
        sample_seconds=seconds,
        compiling=compiling,
        seconds=math.ceil(sweep.blocks / count) * block * seconds / sampled,
        memory=psutil.Process().memory_info().rss,
        disk=sweep.blocks * len(pack(sweep, 0, {n: np.repeat(a, block, axis=0) for n, a in arrays.items()})),
    )


def _timed(sweep: Sweep) -> tuple[int, float]:
    """Return the number of members of a sweep in one block, and the time that they take."""
    began = time.perf_counter()
    compute(sweep, 0)
    return sweep.members, time.perf_counter() - began


def _sample(sweep: Sweep, values: int) -> Sweep:
    """Return the sweep with at most so many values on every axis, in one block, and one seed."""
    axes = {name: {"values": _spread(list(all_), values)} for name, all_ in sweep.axes.items()}
    members = math.prod(len(table["values"]) for table in axes.values())
    ensemble = sweep.tables["ensemble"] | {"seeds": 1, "block": members}
    return Sweep.from_tables(sweep.tables | {"axes": axes, "ensemble": ensemble})


def _spread(values: list[float], count: int) -> list[float]:
    count = min(count, len(values))
    return [values[int((i + 0.5) * len(values) / count)] for i in range(count)]
