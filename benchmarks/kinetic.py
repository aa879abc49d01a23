"""What the kinetic model costs: one right-hand side against its own transforms, a ring, and Figure 4.

    python benchmarks/kinetic.py          # on one core: taskset -c 0 python benchmarks/kinetic.py

A right-hand side of N + 1 moments needs one batch of transforms to the surface and three back. The ratio is
to the faster of SciPy's and XLA's transforms of the same arrays; medians of interleaved times.
"""

from __future__ import annotations

import time

import jax
import jax.numpy as jnp
import numpy as np
import scipy.fft

import cyclosis as cy
from cyclosis.model.precision import double

MODES, REPEATS = 48, 25


def transforms(x):
    """Return one batch of transforms to the surface, and three back, by XLA."""
    return jnp.fft.ifft2(x), jnp.fft.fft2(x + 1), jnp.fft.fft2(x * 2), jnp.fft.fft2(x - 1)


def by_scipy(x):
    """Do as many transforms by SciPy."""
    scipy.fft.ifft2(x, workers=1)
    for _ in range(3):
        scipy.fft.fft2(x, workers=1)


def seconds(call):
    """Return how long a call takes."""
    start = time.perf_counter()
    call()
    return time.perf_counter() - start


def right_hand_side(side):
    """Print the cost of one right-hand side on side x side points."""
    grid = cy.CylinderGrid(side, side)
    model = cy.models.kinetic
    system = model.system(model.problem(cy.Parameters(), grid, shape=(MODES + 1, *grid.shape)), True)
    m = cy.kinetic.with_noise(cy.kinetic.dressed(cy.initial.stripes(grid), MODES), grid, seed=1)
    with double():
        modes, x = jnp.asarray(model.modes(system, m)), jnp.asarray(m)
        whole, own = jax.jit(lambda s, y: s.nonlinear(s.at(y))), jax.jit(transforms)
        jax.block_until_ready((whole(system, modes), own(x)))
        calls = (
            lambda: whole(system, modes).block_until_ready(),
            lambda: by_scipy(m),
            lambda: jax.block_until_ready(own(x)),
        )
        found = 1e3 * np.median([[seconds(call) for call in calls] for _ in range(REPEATS)], axis=0)
    print(
        f"{side} x {side} x {MODES + 1}: {found[0]:.2f} ms, {found[0] / min(found[1:]):.2f} times its "
        f"transforms (SciPy {found[1]:.2f} ms, XLA {found[2]:.2f} ms)"
    )


def run(n_z, t_end):
    """Print the cost of a second run from disorder at Figure 4's parameters, whose programs are compiled."""
    grid = cy.CylinderGrid(48 if n_z == 1 else 32, n_z)
    for seed in (0, 1):
        state, start = cy.kinetic.disordered(grid, seed=seed), time.perf_counter()
        done = cy.simulate(cy.Parameters(), grid, state, t_end, save_every=50.0, model=cy.models.kinetic)
        took = time.perf_counter() - start
    print(
        f"{grid.n_theta} x {n_z} x {MODES + 1} to t = {t_end:g}: {took:.1f} s, "
        f"{done.effort.evaluations} right-hand sides, {done.effort.rejected} steps rejected"
    )


if __name__ == "__main__":
    for side in (32, 64):
        right_hand_side(side)
    run(1, 100.0)
    run(32, 200.0)
