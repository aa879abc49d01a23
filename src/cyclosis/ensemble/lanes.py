"""Many members at once, each with its own time step: lanes of one compiled program.

Every lane takes steps from the ladder 2^{j/2}, whose coefficients are tabulated once: they depend only on
diffusion, so that all lanes share the table whatever their couplings. A lane waits, unchanged,
when its next step would pass its end or when it has failed. Lanes are independent: a member's
result does not depend on the members in other lanes.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from ..contract.members import Lanes
from ..contract.system import System
from ..dynamics.advance import Control, StepperState, length, one_step
from ..dynamics.steppers import Tableau, tableau
from .packing import packed

LOWEST, HIGHEST = -16, 10
"""Rungs that are tabulated: steps of 1/256 to 32. A member that needs shorter steps has diverged."""
CHECK_STEPS = 8
"""Steps between two checks of a member."""


class LaneState(NamedTuple):
    """The progress of a member in a lane.

    `t` is the time reached, `waits` whether the next step would pass the end, `failed` whether no step was
    short enough, `peak` the largest |P| so far; `signs` are those of its model. `level` says how many axial
    points it has, see `axial_lanes`.
    """

    t: Any
    waits: Any
    failed: Any
    peak: Any
    signs: Any
    level: Any


@jax.jit
def tables(system: System) -> Tableau:
    """Return the coefficients of every rung, stacked along a first dimension."""
    linear = system.linear()
    return jax.vmap(lambda rung: tableau(linear, length(rung)))(jnp.arange(LOWEST, HIGHEST + 1))


def stacked(members: Sequence[Any]) -> Any:
    """Return the values of several members as those of as many lanes."""
    # On the host: a program that joins thousands of arrays takes minutes to compile.
    on_host = [jax.tree.map(np.asarray, member) for member in members]
    return jax.tree.map(lambda *leaves: jnp.asarray(np.stack(leaves)), *on_host)


@partial(jax.jit, static_argnames="how", donate_argnames="lanes")
def run_lanes(
    systems: System, control: Control, table: Tableau, lanes: StepperState, t_end: Any, *, how: Lanes
) -> tuple[StepperState, jax.Array]:
    """Try `CHECK_STEPS` steps in every lane, and return the progress of its member, and a packed `LaneState`.

    The values of `systems` that differ and every leaf of `lanes` have a first dimension, the lanes;
    everything else is shared.
    """

    def one(values: Any, now: StepperState) -> tuple[StepperState, jax.Array]:
        system = how.with_values(systems, values)

        def step(_: Any, at: StepperState) -> StepperState:
            return try_step(system, control, table, at, t_end)

        now = jax.lax.fori_loop(0, CHECK_STEPS, step, now)
        return now, packed(lane_state(system, now, t_end, how=how))

    return jax.vmap(one)(how.values(systems), lanes)


@partial(jax.jit, static_argnames="how")
def lane_state(system: System, now: StepperState, t_end: Any, level: Any = 0, *, how: Lanes) -> LaneState:
    """Return what is seen of a member (traceable)."""
    signs = how.signs(system, now.spectrum)
    return LaneState(now.t, _waits(now, t_end), now.failed, now.peak, signs, jnp.asarray(level))


def _waits(now: StepperState, t_end: Any) -> Any:
    return now.t + _next(now) > t_end


def _next(now: StepperState) -> Any:
    return length(jnp.clip(now.rung, LOWEST, HIGHEST))


def try_step(system: System, control: Control, table: Tableau, now: StepperState, t_end: Any) -> StepperState:
    """Try one step of the member's rung, unless it waits or has failed (traceable)."""
    h = _next(now)
    rung = jnp.clip(now.rung, LOWEST, HIGHEST)
    coefficients = Tableau(*(values[rung - LOWEST] for values in table))
    aimed = now._replace(rung=rung, h=h, left=jnp.ones_like(now.left))
    new = one_step(system, control, aimed, now.t + h, system.linear(), coefficients)
    new = new._replace(failed=new.failed | (new.rung < LOWEST))
    waits = now.failed | _waits(now, t_end)
    return jax.tree.map(lambda a, b: jnp.where(waits, a, b), now, new)
