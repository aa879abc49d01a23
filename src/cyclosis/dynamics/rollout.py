"""A run that JAX can differentiate: fixed ETDRK4 steps in a scan, each computed again on the way back.

The intervals between saved times are cut into equal steps as in `simulate`. Every step is a checkpoint: the
backward pass keeps one spectrum per step and repeats the four right-hand sides of a step, which needs less
memory than keeping their intermediate fields and is also faster. The choice of the coefficients, and whether
a step is taken at all, lie within the checkpoint: outside it, ten fields of coefficients are kept with every
step.
"""

from __future__ import annotations

from functools import partial
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
import numpy.typing as npt

from ..contract.system import System
from .steppers import step, tableau


class Plan(NamedTuple):
    """The steps of a rollout: their distinct `lengths`, and of each interval `which` length and `counts`."""

    lengths: npt.NDArray[np.float64]
    which: npt.NDArray[np.int64]
    counts: npt.NDArray[np.int64]


def plan(times: npt.NDArray[np.float64], dt: float) -> Plan:
    """Return how the intervals from 0 to the first time, and from each time to the next, are cut."""
    intervals = np.diff(times, prepend=0.0)
    counts = np.where(intervals > 0, np.maximum(np.ceil(intervals / dt - 1e-9), 1), 0).astype(np.int64)
    lengths: list[float] = []
    which = np.zeros(counts.size, np.int64)
    for k, (interval, count) in enumerate(zip(intervals, counts, strict=True)):
        if count == 0:
            continue
        h = float(interval / count)
        # Lengths that differ only by rounding share their coefficients.
        known = next((j for j, other in enumerate(lengths) if abs(other - h) < 1e-12 * h), None)
        which[k] = len(lengths) if known is None else known
        if known is None:
            lengths.append(h)
    return Plan(np.array(lengths or [dt]), which, counts)


@partial(jax.jit, static_argnames="most")
def march(system: System, spectrum: jax.Array, steps: Plan, most: int) -> jax.Array:
    """Return the spectra (n, n_theta, n_z) at the ends of the intervals; `most` is the largest count."""
    linear = system.linear()
    tables = jax.vmap(partial(tableau, linear))(jnp.asarray(steps.lengths))
    many = len(steps.lengths) > 1

    @jax.checkpoint
    def one(Z: jax.Array, j: Any, which: Any, count: Any) -> jax.Array:
        row = which if many else 0
        table, h = jax.tree.map(lambda rows: rows[row], (tables, jnp.asarray(steps.lengths)))

        def once(Z: jax.Array) -> jax.Array:
            return step(system, table, 0.0, h, Z, system.nonlinear(system.at(Z, 0.0))).spectrum

        return jax.lax.cond(j < count, once, lambda Z: Z, Z)

    def interval(Z: jax.Array, item: tuple[Any, Any]) -> tuple[jax.Array, jax.Array]:
        Z, _ = jax.lax.scan(lambda Z, j: (one(Z, j, *item), None), Z, jnp.arange(most))
        return Z, Z

    return jax.lax.scan(interval, spectrum, (jnp.asarray(steps.which), jnp.asarray(steps.counts)))[1]
