"""Cost of one right-hand side, against its bare transforms by FFTW and by XLA, interleaved in one process.

    python benchmarks/right_hand_side.py            # 64 x 64 and from 32 to 512, needs the extra `bench`

Run it on one core (`taskset -c 0` on Linux). The right-hand side is timed where it is used, in a
compiled loop; FFTW plans with FFTW_MEASURE and one thread. The floor is the faster of twelve real and of
seven complex transforms by FFTW.
"""

from __future__ import annotations

import argparse
import os
import time

os.environ.setdefault("XLA_FLAGS", "--xla_cpu_multi_thread_eigen=false")

import jax
import jax.numpy as jnp
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


def bare(n: int, repeats: int, precision: str):
    """Return a function that evaluates `repeats` times seven complex transforms by XLA alone."""
    kind = np.complex128 if precision == "float64" else np.complex64
    rng = np.random.default_rng(0)
    field = (rng.normal(size=(n, n)) + 1j * rng.normal(size=(n, n))).astype(kind)

    @jax.jit
    def loop(field):
        return jax.lax.fori_loop(0, 7 * repeats, lambda _, x: jnp.fft.fft2(x) * kind(1 / n), field)

    def timed() -> float:
        with double():
            began = time.perf_counter()
            loop(field).block_until_ready()
            return (time.perf_counter() - began) / repeats

    timed()
    return timed


def transforms(n: int, repeats: int, precision: str, packed: bool):
    """Return a function that does the transforms of a right-hand side by FFTW `repeats` times.

    They are 5 forward and 7 backward real ones, or, if `packed`, 3 forward and 4 backward complex ones.
    """
    import pyfftw

    kinds = {"float64": ("float64", "complex128"), "float32": ("float32", "complex64")}[precision]
    one = pyfftw.empty_aligned((n, n), kinds[1 if packed else 0])
    other = pyfftw.empty_aligned((n, n if packed else n // 2 + 1), kinds[1])
    options = {"axes": (0, 1), "flags": ("FFTW_MEASURE",), "threads": 1}
    forward = pyfftw.FFTW(one, other, **options)
    backward = pyfftw.FFTW(other, one, direction="FFTW_BACKWARD", **options)
    one[:] = np.random.default_rng(0).normal(size=(n, n))
    forward.execute()
    counts = (3, 4) if packed else (5, 7)

    def timed() -> float:
        began = time.perf_counter()
        for _ in range(repeats):
            for plan, count in zip((forward, backward), counts, strict=True):
                for _ in range(count):
                    plan.execute()
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
    heads = ("right-hand side", "7 transforms by XLA", "12 real by FFTW", "7 complex by FFTW")
    print(f"| n | {', us | '.join(heads)}, us | ratio ({arguments.precision}) | ratio of XLA's transforms |")
    print("|---:|---:|---:|---:|---:|---:|---:|")
    for n in arguments.sizes:
        repeats, precision = max(2, int(200 * (64 / n) ** 2)), arguments.precision
        timers = [right_hand_sides(n, repeats, precision), bare(n, repeats, precision)]
        timers += [transforms(n, repeats, precision, packed) for packed in (False, True)]
        rows = np.array([[timer() for timer in timers] for _ in range(arguments.rounds)])
        middle = np.median(rows, axis=0)
        # The floor is the faster of the two sets of transforms, as a rule.
        floor = rows[:, 2 + int(np.argmin(middle[2:]))]
        ratios = [np.median(rows[:, k] / floor) for k in (0, 1)]
        numbers = " | ".join(f"{1e6 * x:.1f}" for x in middle)
        print(f"| {n} | {numbers} | {ratios[0]:.2f} | {ratios[1]:.2f} |", flush=True)


if __name__ == "__main__":
    main()
