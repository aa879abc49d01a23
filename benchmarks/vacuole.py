"""Time and memory of the flow in the vacuole: tables, fields, points and sections.

    python benchmarks/vacuole.py            # 64 x 64 x 32 radii, and 32 x 32 x 16, 128 x 128 x 32

Times are processor seconds of the best of several, and on the clock beside them; the exit code is 0 only if a
table of 64 x 64 x 32 takes less than 2 s and a field less than 30 ms of the processor.
"""

from __future__ import annotations

import resource
import sys
import time
import tracemalloc

import numpy as np

import cyclosis as cy
from cyclosis.vacuole.tables import Table

SIZES = ((32, 16), (64, 32), (128, 32))
LIMITS = (2.0, 0.03)


def best(call, repeats=7):
    """Return the least processor time and the least time on the clock of a call, in seconds."""
    spent = []
    for _ in range(repeats):
        busy, clock = time.process_time(), time.perf_counter()
        call()
        spent.append((time.process_time() - busy, time.perf_counter() - clock))
    return tuple(min(column) for column in zip(*spent, strict=True))


def peak(call):
    """Return the largest memory that a call holds at once, in bytes."""
    tracemalloc.start()
    call()
    found = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    return found


def both(grid, u, radii):
    """Make a table and, besides, a field by another one."""
    return Table(grid, radii), cy.vacuole.flow(grid, u).volume(radii)


def main() -> None:
    print("| grid x radii | table | field | 1000 points | section of 65 x 65 | table holds | peak |")
    print("|---|---:|---:|---:|---:|---:|---:|")
    met = True
    for n, count in SIZES:
        grid = cy.CylinderGrid(n, n, 5.0)
        u = cy.flow(cy.Parameters(), grid, cy.initial.disordered(grid, seed=0))
        radii = np.cos((np.arange(count) + 0.5) * np.pi / (2 * count))
        flow = cy.vacuole.flow(grid, u)
        points = np.random.default_rng(0).uniform(0, 1, (1000, 3))
        flow.volume(radii)  # loads and keeps the table
        table = best(lambda grid=grid, radii=radii: Table(grid, radii))
        field = best(lambda grid=grid, u=u, radii=radii: cy.vacuole.flow(grid, u).volume(radii))
        at = best(lambda flow=flow, points=points: flow.at(points))
        section = best(lambda flow=flow: flow.section(1.0, points=65))
        held = sum(part.nbytes for part in Table(grid, radii).radial)
        high = peak(lambda grid=grid, u=u, radii=radii: both(grid, u, radii))
        times = [f"{1e3 * busy:.1f} ms ({1e3 * clock:.0f})" for busy, clock in (table, field, at, section)]
        print(
            f"| {n} x {n} x {count} | {' | '.join(times)} | {held / 1e6:.1f} MB | {high / 1e6:.1f} MB |",
            flush=True,
        )
        if n == 64:
            met = table[0] < LIMITS[0] and field[0] < LIMITS[1]
    print(f"\npeak of the process: {resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024:.0f} MiB")
    sys.exit(not met)


if __name__ == "__main__":
    main()
