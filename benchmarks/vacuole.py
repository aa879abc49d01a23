"""Time and memory of the flow in the vacuole: tables, fields, points and sections, and tracers.

    python benchmarks/vacuole.py            # 64 x 64 x 32 radii, and 32 x 32 x 16, 128 x 128 x 32
    python benchmarks/vacuole.py tracers    # 100 000 tracers to t = 100 R/U; some minutes

Times are processor seconds of the best of several, and the median on the clock beside them; the exit code is
0 only if a table of 64 x 64 x 32 takes less than 2 s, and a field less than 30 ms both of the processor and
on the clock. Tracers of every setting are followed for a fifth of the time, of the usual one for all: the
exit code is 0 only if that takes less than a minute on the clock. Errors are those of the places of 500
tracers at t = 10, against order 5 on a table twice as fine, in steps of 0.05.
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
    """Return the least processor time and the median time on the clock of a call, in seconds."""
    spent = []
    for _ in range(repeats):
        busy, clock = time.process_time(), time.perf_counter()
        call()
        spent.append((time.process_time() - busy, time.perf_counter() - clock))
    return min(busy for busy, _ in spent), float(np.median([clock for _, clock in spent]))


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


USUAL = "usual: order 3, 128 points"
SETTINGS = {
    USUAL: {},
    "usual, in single precision": {"precision": "float32"},
    "order 3, twice the grid": {"refine": 2, "n_s": 48},
    "order 5, twice the grid": {"order": 5, "refine": 2, "n_s": 48},
}
"""Settings of `trace`; the last is as accurate as the first."""
MANY, DURATION, MINUTE = 100_000, 100.0, 60.0


def spread(count):
    """Return places (count, 3) all over the vacuole."""
    r, theta, z = np.random.default_rng(0).random((3, count))
    return np.stack([np.sqrt(r), 2 * np.pi * theta, 5.0 * z], axis=1)


def spent(flow, duration, given):
    """Return the processor time and the time on the clock of tracers, in seconds, for `DURATION`."""
    cy.vacuole.trace(flow, spread(MANY), 0.4, [0.4], **given)  # compiles
    busy, clock = time.process_time(), time.perf_counter()
    cy.vacuole.trace(flow, spread(MANY), duration, [duration], **given)
    share = DURATION / duration
    return share * (time.process_time() - busy), share * (time.perf_counter() - clock)


def tracers() -> None:
    grid = cy.CylinderGrid(32, 32, 5.0)
    profile = cy.stability.cyclosis(cy.Parameters()).u
    flow = cy.vacuole.flow(grid, cy.vacuole.helical_bands(grid, np.asarray(profile), 5.0))
    few = spread(500)
    exact = cy.vacuole.trace(flow, few, 10.0, [10.0], dt=0.05, order=5, refine=8).xyz
    busy, clock = spent(flow, DURATION, {})
    high = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    print(
        f"{MANY} tracers to t = {DURATION:g}: {busy:.0f} s of the processor, {clock:.0f} s on the clock,",
        end=" ",
    )
    print(f"peak of the process {high:.0f} MiB\n", flush=True)
    print("| setting | processor | clock | median error of a place | largest |\n|---|---:|---:|---:|---:|")
    for name, given in SETTINGS.items():
        times = spent(flow, DURATION / 5, given)
        off = np.linalg.norm(cy.vacuole.trace(flow, few, 10.0, [10.0], **given).xyz - exact, axis=-1)
        cells = [f"{one:.0f} s" for one in times] + [f"{np.median(off):.1e}", f"{off.max():.1e}"]
        print(f"| {name} | {' | '.join(cells)} |", flush=True)
    sys.exit(clock > MINUTE)


def main() -> None:
    if sys.argv[1:] == ["tracers"]:
        tracers()
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
        times = [f"{1e3 * busy:.1f} ms ({1e3 * clock:.1f})" for busy, clock in (table, field, at, section)]
        print(
            f"| {n} x {n} x {count} | {' | '.join(times)} | {held / 1e6:.1f} MB | {high / 1e6:.1f} MB |",
            flush=True,
        )
        if n == 64:
            met = max(table) < LIMITS[0] and max(field) < LIMITS[1]
    print(f"\npeak of the process: {resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024:.0f} MiB")
    sys.exit(not met)


if __name__ == "__main__":
    main()
