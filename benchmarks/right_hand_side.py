"""Cost of one right-hand side, against twelve bare real transforms by FFTW, interleaved in one process.

    python benchmarks/right_hand_side.py            # 64 x 64 and from 32 to 512, needs the extra `bench`

Run it on one core (`taskset -c 0` on Linux). The right-hand side is timed where it is used, in a
compiled loop; FFTW plans with FFTW_MEASURE and one thread.
"""

from __future__ import annotations

import argparse
import os
import statistics
import time

os.environ.setdefault("XLA_FLAGS", "--xla_cpu_multi_thread_eigen=false")

import jax
import numpy as np

import cyclosis as cy
from cyclosis.model.precision import double
from cyclosis.model.system import system


def looped(grid: cy.CylinderGrid, repeats: int, precision: str = "float64"):
    """Return a compiled loop over `repeats` right-hand sides, and its arguments."""
    cell = system(cy.Parameters(), grid, precision=precision)
    spectrum = cell.spectrum(cy.initial.disordered(grid, 100))

    @jax.jit
    def loop(cell, spectrum):
        def once(_, Z):
            return Z + 1e-9 * cell.nonlinear(cell.at(Z))

        return jax.lax.fori_loop(0, repeats, once, spectrum)

    with double():
        return loop, jax.device_put(cell), spectrum


def right_hand_sides(n: int, repeats: int, precision: str):
    """Return a function that evaluates `repeats` right-hand sides and returns the seconds they took."""
    loop, cell, spectrum = looped(cy.CylinderGrid(n, n, 5.0), repeats, precision)

    def timed() -> float:
        with double():
            began = time.perf_counter()
            loop(cell, spectrum).block_until_ready()
            return (time.perf_counter() - began) / repeats

    timed()
    return timed


def transforms(n: int, repeats: int):
    """Return a function that does 5 forward and 7 backward real 2D transforms by FFTW `repeats` times."""
    import pyfftw

    real = pyfftw.empty_aligned((n, n), "float64")
    packed = pyfftw.empty_aligned((n, n // 2 + 1), "complex128")
    options = {"axes": (0, 1), "flags": ("FFTW_MEASURE",), "threads": 1}
    forward = pyfftw.FFTW(real, packed, **options)
    backward = pyfftw.FFTW(packed, real, direction="FFTW_BACKWARD", **options)
    real[:] = np.random.default_rng(0).normal(size=(n, n))

    def timed() -> float:
        began = time.perf_counter()
        for _ in range(repeats):
            for _ in range(5):
                forward.execute()
            for _ in range(7):
                backward.execute()
        return (time.perf_counter() - began) / repeats

    timed()
    return timed


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--sizes", type=int, nargs="+", default=[32, 48, 64, 96, 128, 256, 512])
    parser.add_argument("--rounds", type=int, default=21)
    parser.add_argument("--precision", default="float64", choices=["float64", "float32"])
    arguments = parser.parse_args()
    print(f"| n | right-hand side, us | 12 FFTW transforms, us | ratio ({arguments.precision}) |")
    print("|---:|---:|---:|---:|")
    for n in arguments.sizes:
        repeats = max(2, int(200 * (64 / n) ** 2))
        ours, bare = right_hand_sides(n, repeats, arguments.precision), transforms(n, repeats)
        pairs = [(ours(), bare()) for _ in range(arguments.rounds)]
        a, b = (statistics.median(column) * 1e6 for column in zip(*pairs, strict=True))
        ratio = statistics.median(x / y for x, y in pairs)
        print(f"| {n} | {a:.1f} | {b:.1f} | {ratio:.2f} |", flush=True)


if __name__ == "__main__":
    main()
