"""What `cyclosis sweep plan` says of three small sweeps, against what they take: prints a table.

    python benchmarks/plan.py [--workers 2]

The figures on the clock hold where nothing else runs; those in processor time hold beside other work as well.
"""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
import time
from pathlib import Path
from tempfile import TemporaryDirectory

GRID = {"n_theta": 24, "n_z": 24}
SWEEPS = {
    20: {
        "axes": {
            "alpha_p": {"start": 0.2, "stop": 1.0, "count": 5},
            "alpha_u": {"start": 0.1, "stop": 1.0, "count": 4},
        },
        "ensemble": {"block": 2},
    },
    100: {
        "axes": {
            "alpha_p": {"start": 0.1, "stop": 1.0, "count": 5},
            "kappa": {"start": 0.0, "stop": 1.0, "count": 5},
        },
        "ensemble": {"seeds": 4, "block": 8},
    },
    400: {
        "axes": {
            "alpha_p": {"start": 0.05, "stop": 1.0, "count": 5},
            "alpha_u": {"start": 0.05, "stop": 1.0, "count": 8},
        },
        "ensemble": {"seeds": 10},
    },
}
"""Sweeps by their number of members: an even spread of costs, an uneven one, and one of few large blocks."""


def processor() -> float:
    """Return the seconds of processor time of this process and of those that it started and that ended."""
    return sum(os.times()[:4])


def measured(members: int, workers: int, clock_name: str) -> None:
    """Print what is estimated and what is true of one sweep, on one clock."""
    from cyclosis.sweep.cluster.environment import idlest_cores, settle, wanted

    os.environ.update(wanted(os.environ))
    free = os.sched_getaffinity(0) if hasattr(os, "sched_getaffinity") else None
    settle(idlest_cores()[0])  # as `cyclosis sweep plan` does

    import cyclosis as cy
    from cyclosis.sweep.cluster.estimate import estimate

    clock = processor if clock_name == "processor" else time.perf_counter
    sweep = cy.Sweep.from_tables(SWEEPS[members] | {"grid": GRID})
    cost = estimate(sweep, workers, clock=clock)
    if free is not None:
        os.sched_setaffinity(0, free)
    with TemporaryDirectory() as folder:
        began = clock()
        cy.run_sweep(sweep, Path(folder) / "store", workers=workers)
        real = clock() - began
    low, high = cost.range
    said = cost.seconds
    if clock_name == "processor":
        starting = workers * cost.start
        said, low, high = (starting + seconds for seconds in (cost.core_seconds, cost.low, cost.high))
    how = f"({cost.members} members at {cost.points} points, start {cost.start:.1f} s)"
    times = f"{said:>8.1f}  {low:>6.1f} to {high:>6.1f}  {real:>6.1f}  {said / real:>6.2f}"
    print(f"{members:>7}  {clock_name:>9}  {times}  {how}", flush=True)


def main() -> None:
    """Measure every sweep on either clock, each in a process of its own."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--only", nargs=2, help=argparse.SUPPRESS)
    given = parser.parse_args()
    if given.only:
        measured(int(given.only[0]), given.workers, given.only[1])
        return
    print("members      clock  estimate             range    true   ratio")
    for members in SWEEPS:
        for clock in ("processor", "wall"):
            command = [
                sys.executable,
                __file__,
                "--workers",
                str(given.workers),
                "--only",
                str(members),
                clock,
            ]
            subprocess.run(command, check=True)


if __name__ == "__main__":
    main()
