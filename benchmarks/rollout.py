"""Cost of a gradient through `cyclosis.traced.rollout`, in forward runs, and its memory.

    OPENBLAS_NUM_THREADS=1 taskset -c 0 python benchmarks/rollout.py

100 steps of 0.1 with ten saved times; the gradient is in seven parameters and the whole initial state.
Memory is
the temporary storage that XLA plans for the compiled program, times are those of the processor.
"""

from __future__ import annotations

import time
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

import cyclosis as cy

NAMES = ("alpha_p", "alpha_u", "epsilon", "d_s", "d_r", "kappa", "mu")


def measured(program: Any, *arguments: Any) -> tuple[float, float]:
    """Return the least processor time of a call in seconds, and the temporary memory in MB."""
    compiled = jax.jit(program).lower(*arguments).compile()
    jax.block_until_ready(compiled(*arguments))
    seconds = []
    for _ in range(5):
        begin = time.process_time()
        jax.block_until_ready(compiled(*arguments))
        seconds.append(time.process_time() - begin)
    return min(seconds), compiled.memory_analysis().temp_size_in_bytes / 1e6


def main() -> None:
    print("| grid | forward, s | gradient, s | ratio | memory forward, MB | memory gradient, MB |")
    print("|---|---:|---:|---:|---:|---:|")
    for n in (32, 64):
        grid, params = cy.CylinderGrid(n, n), cy.Parameters()
        times = np.arange(1.0, 11.0)
        with jax.enable_x64(True):
            start = jnp.asarray(cy.initial.disordered(grid, seed=0))
            values = jnp.array([getattr(params, name) for name in NAMES])

            def total(values: Any, start: Any, at: Any = (params, grid, times)) -> Any:
                named = dict(zip(NAMES, values, strict=True))
                return (cy.traced.rollout(*at[:2], start, at[2], 0.1, **named) ** 2).mean()

            forward, least = measured(total, values, start)
            reverse, most = measured(jax.value_and_grad(total, (0, 1)), values, start)
        cost = f"{forward:.3f} | {reverse:.3f} | {reverse / forward:.1f}"
        print(f"| {n} x {n} | {cost} | {least:.1f} | {most:.1f} |", flush=True)


if __name__ == "__main__":
    main()
