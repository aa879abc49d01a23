"""The device that JAX computes on beside one core of its host: the same programs, in one process.

    python benchmarks/device.py [--sizes 64 256 1024] [--members 250] [--lanes 256]

Run it on one core (`taskset -c 0` on Linux). Three tables: the cost of one right-hand side in a compiled
loop; the difference between the fields of a run on either, after t = 5 from a disordered state; and members
of Figure 5, followed to their certain regimes in `--lanes` lanes on the device and one lane on the core.
"""

from __future__ import annotations

import argparse
import statistics
import time

import agreement
import jax
import numpy as np
from right_hand_side import right_hand_sides

import cyclosis as cy
from cyclosis.ensemble import EnsembleSettings


def costs(sizes: list[int], rounds: int, places: dict[str, jax.Device]) -> None:
    """Print microseconds for one right-hand side on every place, at every size and precision."""
    print("| n | precision | " + ", us | ".join(places) + ", us | ratio |\n|---:|---|---:|---:|---:|")
    for n in sizes:
        for precision in ("float64", "float32"):
            cost = []
            for where in places.values():
                repeats = max(4, int((50 if where.platform == "cpu" else 1000) * min(1.0, (128 / n) ** 2)))
                with jax.default_device(where):
                    timed = right_hand_sides(n, repeats, precision)
                    cost.append(1e6 * statistics.median(timed() for _ in range(rounds)))
            cells = " | ".join(f"{value:.1f}" for value in cost)
            print(f"| {n} | {precision} | {cells} | {cost[-1] / cost[0]:.2f} |", flush=True)


def fields(n: int, places: dict[str, jax.Device]) -> None:
    """Print how far apart the fields of one run are, and the seconds it takes on every place."""
    grid = cy.CylinderGrid(n, n, 5.0)
    state = cy.initial.disordered(grid, seed=100)
    for precision in ("float64", "float32"):
        ends, seconds = [], []
        for where in places.values():
            with jax.default_device(where):
                for t_end in (0.1, 5.0):  # the first compiles
                    began = time.perf_counter()
                    run = cy.simulate(cy.Parameters(), grid, state, t_end, precision=precision)
            seconds.append(time.perf_counter() - began)
            ends.append(run.final_state)
        apart = np.abs(ends[0] - ends[-1]).max()
        print(f"{n} x {n}, {precision}, t = 5: at most {apart:.1e} apart", end="; ")
        print(", ".join(f"{name} {s:.2f} s" for name, s in zip(places, seconds, strict=True)), flush=True)


def regimes(members: int, lanes: int, places: dict[str, jax.Device]) -> None:
    """Print how many members have another regime on the device than on the core, and what each costs."""
    points, found, cost = agreement.sample(members), [], []
    for where in places.values():
        how = EnsembleSettings(rtol=1e-3, lanes=1 if where.platform == "cpu" else lanes)
        with jax.default_device(where):
            outcomes, seconds = agreement.run(points, how)
        found.append([outcome.regime for outcome in outcomes])
        cost.append(seconds)
    differ = sum(a != b for a, b in zip(found[0], found[-1], strict=True))
    print(f"{members} members: {differ} regimes differ", end="; ")
    print(", ".join(f"{name} {1e3 * s:.1f} ms" for name, s in zip(places, cost, strict=True)) + " a member")


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--sizes", type=int, nargs="*", default=[64, 128, 256, 512, 1024, 2048])
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--members", type=int, default=250)
    parser.add_argument("--lanes", type=int, default=256)
    asked = parser.parse_args()
    device, host = jax.devices()[0], jax.devices("cpu")[0]
    places = {device.device_kind: device, "one core of the host": host}
    with jax.enable_x64(True):
        costs(asked.sizes, asked.rounds, places)
    fields(64, places)
    fields(512, places)
    regimes(asked.members, asked.lanes, places)


if __name__ == "__main__":
    main()
