"""Lanes whose members need only some of their axial points: steps that the points hold, how many suffice.

A member goes on with fewer points (`Lanes.axial`) when its axial tail on them is below `ENOUGH` of `rtol`,
the error that a step may make, and with more when a step would leave a tail above `rtol` itself: that step is
not taken. What the points leave out, or fold back onto resolved waves, is then about a tenth of `rtol`.
"""

from __future__ import annotations

from functools import partial
from typing import Any

import jax
import jax.numpy as jnp

from ..contract.members import Lanes
from ..contract.system import System
from ..dynamics.advance import Control, StepperState
from ..dynamics.steppers import Tableau
from .lanes import CHECK_STEPS, LaneState, lane_state, try_step

ENOUGH = 0.3
"""Axial tail, in units of `rtol`, below which fewer points are enough: well below the limit, so that a member
does not go to and fro."""


@partial(jax.jit, static_argnames=("how", "n"))
def fitted(system: System, now: StepperState, *, how: Lanes, n: int) -> StepperState:
    """Return the progress of a member on n axial points, those of `system`."""
    assert how.axial is not None
    spectrum = how.axial.fitted(now.spectrum, n)
    nonlinear = system.nonlinear(system.at(spectrum, now.t))
    return now._replace(spectrum=spectrum, nonlinear=nonlinear, evaluations=now.evaluations + 1)


@partial(jax.jit, static_argnames=("how", "points", "level"), donate_argnames="lanes")
def run_axial_lanes(
    systems: System,
    whole: System,
    control: Control,
    table: Tableau,
    lanes: StepperState,
    t_end: Any,
    *,
    how: Lanes,
    points: tuple[int, ...],
    level: int,
) -> tuple[StepperState, LaneState]:
    """Try up to `CHECK_STEPS` steps in every lane, and return the progress of its member.

    `points` are all numbers of axial points, from most to fewest; `systems` and `lanes` are on those of
    `level`, `whole` is on all of them. A lane stops early at a step that its points do not hold. The signs
    are those of the same state on all points.
    """
    axial = how.axial
    assert axial is not None

    def one(values: Any, now: StepperState) -> tuple[StepperState, LaneState]:
        system = how.with_values(systems, values)

        def goes_on(carry: tuple[StepperState, Any, Any]) -> Any:
            return (carry[2] < CHECK_STEPS) & ~carry[1]

        def body(carry: tuple[StepperState, Any, Any]) -> tuple[StepperState, Any, Any]:
            now, _, tried = carry
            new = try_step(system, control, table, now, t_end)
            outgrown = jnp.asarray(False)
            if level > 0:
                outgrown = axial.tail(new.spectrum, points[level]) > control.rtol
                before = now._replace(evaluations=new.evaluations)
                new = jax.tree.map(lambda a, b: jnp.where(outgrown, a, b), before, new)
            return new, outgrown, tried + 1

        now, outgrown, _ = jax.lax.while_loop(goes_on, body, (now, jnp.asarray(False), jnp.asarray(0)))
        seen = lane_state(whole, now._replace(spectrum=axial.fitted(now.spectrum, points[0])), t_end, how)
        tails = jnp.stack([axial.tail(now.spectrum, n) for n in points])
        enough = jnp.sum((tails < ENOUGH * control.rtol)[level + 1 :])
        return now, seen._replace(level=jnp.where(outgrown, level - 1, level + enough))

    return jax.vmap(one)(how.values(systems), lanes)
