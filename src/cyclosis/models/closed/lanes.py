"""What an ensemble measures of a closed cell every few steps, and what members share."""

from __future__ import annotations

from dataclasses import replace
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from ...analysis.appearance import Look
from ...closed.grid import Array
from ...closed.system import ClosedSystem
from ...model.spectral import dot
from ..polar_cylinder import polar
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
    """Return the look of the middle half of a state (2, n_theta, n_s)."""
    return Look.of_field(np.stack([_middle(part) for part in P]))


assert polar.lanes is not None
LANES = replace(polar.lanes, signs=signs, look_of_state=look_of_state, certain=None, axial=None)
"""What members share is the same as on a cylinder."""
