"""Throughput against the number of lanes, on whatever device JAX computes on.

python benchmarks/lanes.py [--lanes 1 2 4 8 32] [--n 48] [--precision float64] [--runs 0]

Prints microseconds for one right-hand side of one member, and its ratio to the memory-bandwidth floor of its
transforms: seven packed complex transforms, each read and written once at the bandwidth of a plain copy of
a large array, measured beside it. On a CPU the arrays stay in its caches, so that the floor means little
there. With --runs N, N members of Figure 5 are followed to their certain regimes as well, in each number of
lanes.
"""

from __future__ import annotations

import argparse
import time
from functools import partial

import jax
import jax.numpy as jnp
import numpy as np

import cyclosis as cy
from cyclosis.dynamics.advance import Control, start
from cyclosis.ensemble import EnsembleSettings, Member, follow
from cyclosis.ensemble.lanes import CHECK_STEPS, run_lanes, stacked, tables
from cyclosis.model.system import system

TRANSFORMS = 7
STAGES = 4
VALUES = np.linspace(0.025, 1.0, 20)


def bandwidth() -> float:
    """Return bytes a second, read and written, of a copy of a large array."""
    size = 2**28 if jax.default_backend() != "cpu" else 2**26
    array = jnp.zeros(size // 8)
    copy = jax.jit(lambda x: x + 1.0)
    copy(array).block_until_ready()
    times = []
    for _ in range(10):
        began = time.perf_counter()
        copy(array).block_until_ready()
        times.append(time.perf_counter() - began)
    return 2 * size / float(np.median(times))


def step_cost(grid: cy.CylinderGrid, lanes: int, precision: str) -> float:
    """Return seconds for one right-hand side of one member among `lanes`."""
    params = cy.Parameters()
    host = system(params, grid, precision=precision)
    cell = jax.device_put(host)
    control = Control.of(rtol=1e-3, atol=1e-10, bound=cy.models.polar.bound)
    one = start(cell, host.spectrum(cy.initial.disordered(grid)), np.float64(0.0))
    batch, cells = stacked([one] * lanes), cell.with_values(stacked([cell.values] * lanes))
    table, times = tables(cell), []
    for _ in range(12):
        began = time.perf_counter()
        batch, stands = run_lanes(cells, control, table, batch, np.float64(1e9), how=cy.models.polar.lanes)
        jax.block_until_ready(stands)
        times.append(time.perf_counter() - began)
    return float(np.median(times[2:])) / (CHECK_STEPS * STAGES * lanes)


def runs(grid: cy.CylinderGrid, lanes: int, precision: str, count: int) -> float:
    """Return runs of Figure 5 a second, compilation left out."""
    drawn = np.random.default_rng(5).integers(0, (20, 20, 50), size=(count, 3))
    members = [
        Member(
            cy.Parameters(alpha_p=VALUES[i], alpha_u=VALUES[j]),
            grid,
            partial(cy.initial.disordered, grid, seed=int(seed)),
        )
        for i, j, seed in sorted(map(tuple, drawn))
    ]
    how = EnsembleSettings(rtol=1e-3, lanes=lanes, precision=precision)
    follow(members[:2], how)
    began = time.perf_counter()
    follow(members, how)
    return count / (time.perf_counter() - began)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--lanes", type=int, nargs="+", default=[1, 2, 4, 8, 32])
    parser.add_argument("--n", type=int, default=48)
    parser.add_argument("--precision", choices=("float64", "float32"), default="float64")
    parser.add_argument("--runs", type=int, default=0)
    asked = parser.parse_args()
    grid = cy.CylinderGrid(asked.n, asked.n, 5.0)
    with jax.enable_x64(True):
        speed = bandwidth()
        each = 16 if asked.precision == "float64" else 8
        floor = TRANSFORMS * 2 * each * asked.n**2 / speed
        device = jax.devices()[0]
        print(f"{device.device_kind}: copy {speed / 1e9:.0f} GB/s, floor {floor * 1e6:.2f} us")
        for lanes in asked.lanes:
            cost = step_cost(grid, lanes, asked.precision)
            line = f"{lanes:>6} lanes: {cost * 1e6:8.2f} us a right-hand side and member"
            line += f", {cost / floor:6.1f} times the floor"
            if asked.runs:
                line += f", {runs(grid, lanes, asked.precision, asked.runs):.1f} runs a second"
            print(line, flush=True)


if __name__ == "__main__":
    main()
