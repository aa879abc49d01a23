"""What storing a run costs, beside computing it.

    python benchmarks/storage.py

The same run of 200 saved fields is computed alone, and computed and streamed to a file, in turn and several
times; everything has been compiled before. The processor time of all threads is counted, the least of all
turns, since other work on the machine lengthens the time on the clock.
"""

from __future__ import annotations

import argparse
import tempfile
import time
from pathlib import Path
from typing import Any

import cyclosis as cy


def seconds(action: Any) -> tuple[float, float]:
    """Return the processor time and the time on the clock that an action takes."""
    began, clock = time.process_time(), time.perf_counter()
    action()
    return time.process_time() - began, time.perf_counter() - clock


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--sizes", type=int, nargs="+", default=[64, 128])
    parser.add_argument("--frames", type=int, default=200)
    parser.add_argument("--turns", type=int, default=5)
    arguments = parser.parse_args()
    print("| n | frames | computing, s | storing, s | storing / computing | file, MB | MB/s on the clock |")
    print("|---:|---:|---:|---:|---:|---:|---:|")
    with tempfile.TemporaryDirectory() as folder:
        for n in arguments.sizes:
            print(measured(n, arguments.frames, arguments.turns, Path(folder) / "run.nc"), flush=True)


def measured(n: int, frames: int, turns: int, path: Path) -> str:
    """Return the row of a grid of n x n points."""
    params, grid = cy.Parameters(), cy.CylinderGrid(n, n)
    state = cy.initial.disordered(grid, seed=0, noise_grid=(64, 64))

    def computed(checkpoint: Any = None) -> cy.Trajectory:
        return cy.simulate(params, grid, state, frames - 1.0, 1.0, checkpoint=checkpoint)

    def alone() -> None:
        computed()

    def streamed() -> None:
        writer = cy.RunWriter(path, force=True)
        writer.finish(computed(writer))

    streamed()
    pairs = [(seconds(alone), seconds(streamed)) for _ in range(turns)]
    computing = min(first[0] for first, _ in pairs)
    storing = min(second[0] for _, second in pairs) - computing
    clock = min(second[1] for _, second in pairs) - min(first[1] for first, _ in pairs)
    size = path.stat().st_size / 1e6
    return (
        f"| {n} | {frames} | {computing:.2f} | {storing:.2f} | {storing / computing:.2f} | {size:.0f} "
        f"| {size / clock:.0f} |"
    )


if __name__ == "__main__":
    main()
