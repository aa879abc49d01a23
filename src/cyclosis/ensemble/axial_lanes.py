"""A lane whose members have only as many axial points as they need.

A member goes on with fewer points (see `AxialPoints`) when its axial tail on them is below `ENOUGH` of
`rtol`, the error that a step may make, and with more when a step would leave a tail above `MOST` of it: that
step is not taken.
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

MOST, ENOUGH = 3.0, 1.0
"""Axial tail, in units of `rtol`, above which more points are needed, and below which fewer are enough. Waves
that the points leave out, or fold back onto others, have about a tenth of this amplitude."""


class Level(NamedTuple):
    """A number of axial points: the system on it, and the coefficients of every rung."""

    system: Any
    table: Tableau


def levels(problem: Problem, axial: AxialPoints) -> tuple[Level, ...]:
    """Return the `Level` of each number of axial points that may be used, from all of them to the fewest."""
    grid = problem.grid
    grids = (grid, *(grid.resized(grid.n_theta, n) for n in axial.fewer(grid)))
    problems = (replace(problem, grid=on) for on in grids)
    systems = [jax.device_put(axial.on_few(problem.model.system(own, True))) for own in problems]
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

    `level` has the number of axial points at `place` in `points`, `whole` all of them; the member may go on
    to those at the place `usable`. The lane stops early at a step that its points do not hold. Between two
    calls all modes of the progress are kept; `changed` says that the last one was made on other points.
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

    def tail_on(at: int, spectrum: jax.Array) -> Any:
        return axial.tails(spectrum, points[at : at + 1])[0] / control.rtol

    def goes_on(carry: tuple[StepperState, Any, Any]) -> Any:
        return (carry[2] < CHECK_STEPS) & ~carry[1]

    def body(carry: tuple[StepperState, Any, Any]) -> tuple[StepperState, Any, Any]:
        now, _, tried = carry
        new = try_step(system, control, level.table, now, t_end)
        if place == 0:
            fewer_do = (usable > 0) & (tail_on(1, new.spectrum) < ENOUGH) if len(points) > 1 else False
            return new, jnp.asarray(fewer_do), tried + 1
        outgrown = tail_on(place, new.spectrum) > MOST
        before = now._replace(evaluations=new.evaluations)
        return jax.tree.map(lambda a, b: jnp.where(outgrown, a, b), before, new), outgrown, tried + 1

    end, stopped, _ = jax.lax.while_loop(goes_on, body, (began, jnp.asarray(False), jnp.asarray(0)))
    places = jnp.arange(len(points))
    enough = (axial.tails(end.spectrum, points) / control.rtol < ENOUGH) & (places <= usable)
    onward = jnp.max(jnp.where(enough & (places > place), places, place))
    if place > 0:
        onward = jnp.where(stopped, place - 1, onward)
    parts = (axial.fitted(modes, points[0]) for modes in (end.spectrum, end.nonlinear))
    full = end._replace(**dict(zip(("spectrum", "nonlinear"), parts, strict=True)))
    seen = lane_state(how.with_values(whole, jax.tree.map(_only, values)), full, t_end, onward, how=how)
    return jax.tree.map(lambda leaf: leaf[None], (full, packed(seen)))


def _only(leaf: Any) -> Any:
    return leaf[0]
