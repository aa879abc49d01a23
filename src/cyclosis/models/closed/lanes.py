"""What an ensemble measures of a closed cell every few steps, and what members share."""

from __future__ import annotations

from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from ...analysis.appearance import Look
from ...analysis.zones import DISORDER, DOMINANT
from ...closed.grid import Array, ClosedGrid
from ...closed.system import ClosedSystem
from ...contract.members import Lanes
from ...model.parameters import Parameters
from ...model.spectral import dot
from .quantities import energy, tail


class Signs(NamedTuple):
    """A few numbers of a state.

    max |P|, <|P|²>^½, <P_theta²>^½, the spectral tail, and the fewest and the most sign changes of P_s around
    a circle of the middle half of the latitudes.
    """

    largest: Any
    order: Any
    around: Any
    tail: Any
    low: Any
    high: Any


def signs(system: ClosedSystem, modes: jax.Array) -> Signs:
    """Return the signs of modes (traceable)."""
    p = system.space.to_physical(modes)
    up = _middle(p.imag) > 0
    changes = jnp.sum(up != jnp.roll(up, 1, axis=0), axis=0)
    share = energy(system, modes)
    return Signs(
        largest=jnp.sqrt(jnp.max(dot(p, p))),
        order=jnp.sqrt(jnp.sum(share, dtype=jnp.float64)),
        around=jnp.sqrt(system.space.mean(p.real**2)),
        tail=tail(system, share),
        low=jnp.min(changes),
        high=jnp.max(changes),
    )


def _middle(field: Any) -> Any:
    quarter = field.shape[1] // 4
    return field[:, quarter : field.shape[1] - quarter]


def look_of_state(P: Array) -> Look:
    """Return the look of a state (2, n_theta, n_s)."""
    up = _middle(P[1]) > 0
    changes = np.sum(up != np.roll(up, 1, axis=0), axis=0)
    middle = np.stack([_middle(part) for part in P])
    order2, around2 = float(np.mean(np.sum(middle**2, axis=0))), float(np.mean(middle[0] ** 2))
    circling = around2 >= DOMINANT * order2
    return Look(order2 >= DISORDER**2, int(changes.min()), int(changes.max()), circling)


def shared(params: Parameters, grid: ClosedGrid) -> Any:
    """Return what must be equal for members that share lanes."""
    built_in = (params.d_s, params.d_r, params.mu, params.force_exponent == 2)
    fields = tuple((n, v.tobytes()) for n, v in params.items() if isinstance(v, np.ndarray))
    return (grid, built_in, fields)


LANES = Lanes(
    signs=signs,
    look=Look.of_signs,
    look_of_state=look_of_state,
    shared=shared,
    values=lambda system: system.values,
    with_values=ClosedSystem.with_values,
    certain=None,
)
