"""A lane whose members have only as many axial points as they need.

A member goes on with fewer points (see `AxialPoints`) when its axial tail on them is below `ENOUGH` of
`rtol`, the error that a step may make, and with more when a step would leave a tail above `rtol` itself: that
step is not taken. What the points leave out, or fold back onto resolved waves, is then about a tenth of `rtol`.
"""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp

from ..contract.members import AxialPoints, Lanes
from ..contract.model import Problem
from ..contract.system import System
from ..dynamics.advance import Control, StepperState
from ..dynamics.steppers import Tableau
from .lanes import CHECK_STEPS, lane_state, tables, try_step
from .packing import packed

MOST = 3.0
ENOUGH = 1.0
"""Axial tail, in units of `rtol`, below which fewer points are enough: well below the limit, so that a member
does not go to and fro."""


class Level(NamedTuple):
    """A number of axial points: the system on it, and the coefficients of every rung."""

    system: Any
    table: Tableau


def levels(problem: Problem, axial: AxialPoints) -> tuple[Level, ...]:
    """Return the `Level` of each number of axial points that may be used, from all of them to the fewest."""
    grid = problem.grid
    grids = (grid, *(grid.resized(grid.n_theta, n) for n in axial.fewer(grid)))
    problems = (replace(problem, grid=on) for on in grids)
    systems = [jax.device_put(problem.model.system(own, True)) for own in problems]
    return tuple(Level(system, tables(system)) for system in systems)


@partial(jax.jit, static_argnames=("how", "points", "place"), donate_argnames="lanes")
def run_axial_lane(
    level: Level,
    whole: System,
    values: Any,
    control: Control,
    lanes: StepperState,
    changed: Any,
    usable: Any,
    t_end: Any,
    *,
    how: Lanes,
    points: tuple[int, ...],
    place: int,
) -> tuple[StepperState, jax.Array]:
    """Try up to `CHECK_STEPS` steps in the only lane: return its progress, and a packed `LaneState`.

    `level` has the number of axial points at `place` in `points`, `whole` all of them; the member may go on to
    those at the place `usable`. The lane stops early at a step that its points do not hold. Between two calls
    all modes of the progress are kept; `changed` says that the last one was made on other points.
    """
    axial = how.axial
    assert axial is not None
    n, system = points[place], how.with_values(level.system, jax.tree.map(_only, values))
    now = jax.tree.map(_only, lanes)
    spectrum = axial.fitted(now.spectrum, n)
    nonlinear = jax.lax.cond(
        changed,
        lambda: system.nonlinear(system.at(spectrum, now.t)),
        lambda: axial.fitted(now.nonlinear, n),
    )
    began = now._replace(spectrum=spectrum, nonlinear=nonlinear, evaluations=now.evaluations + changed)

    places = jnp.arange(len(points))

    def goes_on(carry: tuple[StepperState, Any, Any]) -> Any:
        return (carry[2] < CHECK_STEPS) & (carry[1] == place)

    def body(carry: tuple[StepperState, Any, Any]) -> tuple[StepperState, Any, Any]:
        now, _, tried = carry
        new = try_step(system, control, level.table, now, t_end)
        tails = axial.tails(new.spectrum, points) / control.rtol
        enough = (tails < ENOUGH) & (places > place) & (places <= usable)
        onward = jnp.max(jnp.where(enough, places, place))
        if place > 0:
            outgrown = tails[place] > MOST
            before = now._replace(evaluations=new.evaluations)
            new = jax.tree.map(lambda a, b: jnp.where(outgrown, a, b), before, new)
            onward = jnp.where(outgrown, place - 1, onward)
        return new, onward, tried + 1

    begin = (began, jnp.full_like(places[0], place), jnp.zeros_like(places[0]))
    end, onward, _ = jax.lax.while_loop(goes_on, body, begin)
    parts = (axial.fitted(modes, points[0]) for modes in (end.spectrum, end.nonlinear))
    full = end._replace(**dict(zip(("spectrum", "nonlinear"), parts, strict=True)))
    seen = lane_state(how.with_values(whole, jax.tree.map(_only, values)), full, t_end, onward, how=how)
    return jax.tree.map(lambda leaf: leaf[None], (full, packed(seen)))


def _only(leaf: Any) -> Any:
    return leaf[0]
