"""Sweeps around made-up blocks: the real engine and the real store, where only the physics costs nothing.

python -m measure.sweeps STORE [--seconds S] [--way NAME] computes one, as `cyclosis sweep run` would.
"""

from __future__ import annotations

import argparse
import os
import resource
import sys
import time
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from cyclosis.dataset.whole import temporary
from cyclosis.sweep.plan.sweep import Sweep
from cyclosis.sweep.store.store import Store

TABLES: dict[str, Any] = {
    "parameters": {"d_s": 0.1},
    "grid": {"n_theta": 16, "n_z": 16},
    "initial": {"filaments_per_square": 50.0},
    "axes": {"alpha_p": {"start": 0.2, "stop": 1.0, "count": 4}, "alpha_u": {"values": [0.1, 0.5, 0.9]}},
    "ensemble": {"seeds": 4, "block": 4},
    "run": {"t_end": 50.0},
}
ODD = 5
"""The block with which something is the matter, where something is."""


def sweep(**tables: dict[str, Any]) -> Sweep:
    """Return a sweep of 48 members in 12 blocks, with some tables changed."""
    return Sweep.from_tables(TABLES | {name: TABLES.get(name, {}) | table for name, table in tables.items()})


def made_up(plan: Sweep, index: int, seconds: float = 0.0) -> dict[str, np.ndarray]:
    """Return arrays for a block that depend on its number alone, after some time."""
    time.sleep(seconds)
    members = np.array(plan.block(index).members)
    out = {}
    for number, item in enumerate(plan.variables):
        shape = (members.size, *(plan.sizes[dim] for dim in item.dims))
        out[item.name] = np.random.default_rng([index, number]).normal(size=shape).astype(item.dtype)
    return out | {"regime": (members % 3).astype("int8"), "status": (members % 2).astype("int8")}


def raising(plan: Sweep, index: int, seconds: float = 0.0) -> dict[str, np.ndarray]:
    """The same, but one block raises an exception."""
    if index == ODD:
        raise ZeroDivisionError("nothing can be divided\nby nothing")
    return made_up(plan, index, seconds)


def hopeless(plan: Sweep, index: int, seconds: float = 0.0) -> dict[str, np.ndarray]:
    """Raise an exception for every block."""
    raise OSError("a library is missing")


def deadly(plan: Sweep, index: int, seconds: float = 0.0) -> dict[str, np.ndarray]:
    """The same as `made_up`, but one block takes its worker with it."""
    if index == ODD:
        os._exit(77)
    return made_up(plan, index, seconds)


def crowded(plan: Sweep, index: int, seconds: float = 0.0) -> dict[str, np.ndarray]:
    """The same as `made_up`, but from one block on the worker can write no file of any length."""
    if index == ODD:
        resource.setrlimit(resource.RLIMIT_FSIZE, (100, resource.getrlimit(resource.RLIMIT_FSIZE)[1]))
    return made_up(plan, index, seconds)


def half_written(plan: Sweep, index: int, store: Path) -> dict[str, np.ndarray]:
    """The same as `crowded`, and its worker is still writing another block when the sweep ends."""
    half = temporary(Store(store).path_of(index))
    half.parent.mkdir(parents=True, exist_ok=True)
    half.touch()
    return crowded(plan, index)


WAYS = {item.__name__: item for item in (made_up, raising, hopeless, deadly, crowded)}


def slow(seconds: float, way: str = "made_up") -> Any:
    """Return one of these ways to compute a block, that takes some time."""
    return partial(WAYS[way], seconds=seconds)


def differences(first: Path, second: Path) -> list[str]:
    """Return what two stores do not have in common, bit by bit; what a member took in seconds may differ."""
    a, b = Store(first), Store(second)
    out = [f"block {index} stands in one only" for index in sorted(a.present() ^ b.present())]
    for index in sorted(a.present() & b.present()):
        x, y = a.read(index), b.read(index)
        out += [f"block {index}: {name}" for name in x if name != "seconds" and not _same(x[name], y[name])]
    return out


def _same(a: np.ndarray, b: np.ndarray) -> bool:
    return a.dtype == b.dtype and a.shape == b.shape and a.tobytes() == b.tobytes()


def main() -> None:
    """Compute a made-up sweep."""
    from cyclosis.dynamics.interrupts import carried, terminable
    from cyclosis.sweep.execute import run_sweep

    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("store", type=Path)
    parser.add_argument("--seconds", type=float, default=0.0)
    parser.add_argument("--way", choices=WAYS, default="made_up")
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--script", action="store_true", help="a loop over stores, as a user writes it")
    given = parser.parse_args()
    compute = slow(given.seconds, given.way)
    if given.script:
        for number in range(100):
            store = given.store.with_name(f"{given.store.name}-{number}")
            run_sweep(sweep(), store, workers=given.workers, compute=compute)
        sys.exit(0)
    try:
        with terminable():
            summary = run_sweep(sweep(), given.store, workers=given.workers, compute=compute)
    except KeyboardInterrupt as stopped:
        summary = carried(stopped)
    print(summary.message)
    sys.exit({"complete": 0, "interrupted": 130}.get(summary.status, 1))


if __name__ == "__main__":
    main()
