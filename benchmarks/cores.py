"""Time of a right-hand side in a run on one core and on all: in one compiled program, and in pieces.

    python benchmarks/cores.py                          # 512 x 512, 1024 x 1024 and 2048 x 2048
    python benchmarks/cores.py --sizes 256 --precision float32

Each figure is the median over processes of their own, of which each takes the least of three timings; memory
is the largest resident set. Needs an operating system that can bind a process to cores, such as Linux.
"""

from __future__ import annotations

import argparse
import os
import statistics
import subprocess
import sys

PROGRAM = """
import os, resource, sys, time
n, precision, pieces, cores = int(sys.argv[1]), sys.argv[2], sys.argv[3] == "pieces", int(sys.argv[4])
os.sched_setaffinity(0, sorted(os.sched_getaffinity(0))[-cores:])
import jax, numpy as np
import cyclosis as cy
from cyclosis.dynamics import stretch
from cyclosis.dynamics.advance import Control, start
from cyclosis.dynamics.steppers import METHODS
from cyclosis.model.precision import double
from cyclosis.model.system import system

stretch.LARGE = 0 if pieces else 2**60
grid, method, steps = cy.CylinderGrid(n, n, 5.0), METHODS["etdrk4"], max(2, 2**21 // n**2)
with double():
    cell = jax.device_put(system(cy.Parameters(), grid, precision=precision))
    spectrum = cell.spectrum(cy.initial.disordered(grid, 100, noise_grid=(64, 64)))
    now, run = start(cell, spectrum, np.float64(0.0), method), stretch.Stretch(cell, method)
    seconds = []
    for _ in range(4):  # the first compiles
        began = time.perf_counter()
        now = run.to(Control.of(1e-4, 1e-6, 1.5, dt=0.05), now, np.float64(1e3), steps)
        now.spectrum.block_until_ready()
        seconds.append(time.perf_counter() - began)
memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 2**10
print(min(seconds[1:]) / steps / method.evaluations, memory)
"""


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--sizes", type=int, nargs="+", default=[512, 1024, 2048])
    parser.add_argument("--precision", default="float64", choices=["float64", "float32"])
    parser.add_argument("--rounds", type=int, default=3)
    arguments = parser.parse_args()
    cores = len(os.sched_getaffinity(0))
    ways = [(way, count) for count in sorted({1, cores}) for way in ("one program", "pieces")]
    heads = " | ".join(f"{way}, {count} core{'s'[: count - 1]}" for way, count in ways)
    print(f"Milliseconds a right-hand side, and MiB ({arguments.precision})\n\n| n | {heads} |")
    print("|---:" * (1 + len(ways)) + "|")
    for n in arguments.sizes:
        found: dict[tuple[str, int], list[list[float]]] = {way: [] for way in ways}
        for _ in range(arguments.rounds):
            for way in ways:
                command = [sys.executable, "-c", PROGRAM, str(n), arguments.precision, *map(str, way)]
                out = subprocess.run(command, capture_output=True, text=True, check=True).stdout
                found[way].append([float(number) for number in out.split()])
        middles = [[statistics.median(column) for column in zip(*found[way], strict=True)] for way in ways]
        print(f"| {n} | {' | '.join(f'{1e3 * s:.1f}, {memory:.0f}' for s, memory in middles)} |", flush=True)


if __name__ == "__main__":
    main()
