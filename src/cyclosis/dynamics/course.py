"""A schedule prepared for computing: the right-hand side of every stage, and what an event does to a run.

Stages of equal structure share one compiled program. A parameter that a step made a field stays a field, and
each stage has its own list of ramps, so that the program of a stage does not depend on later steps.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import jax.numpy as jnp
import numpy as np

from ..contract.model import Array, Problem
from ..contract.system import System
from ..display.shown import shown
from .advance import FIRST_RUNG, StepperState, start
from .multistep import forget
from .protocol import Protocol
from .schedule import Schedule
from .stage import Stage


@shown
@dataclass(frozen=True, eq=False)
class Intervention:
    """What was done to a state at a time: the state just before and just after all steps."""

    time: float
    before: Array
    after: Array


class Course:
    """The stages of a problem under a protocol, as systems; an empty protocol has one stage.

    `split` says that the stepper treats linear terms separately.
    """

    def __init__(self, problem: Problem, protocol: Protocol, split: bool = True) -> None:
        self.problem, self.protocol, self.split = problem, protocol, split
        self.schedule = Schedule(problem.params, problem.grid, protocol)
        self.times = self.schedule.times
        self._kept: tuple[int, System] | None = None

    def bound(self, done: int) -> float:
        """Return the magnitude |P| beyond which the run has diverged, once `done` events are done."""
        model = self.problem.model
        return model.sharp_bound if self.schedule.disturbed_by(done) else model.bound

    def system(self, done: int) -> System:
        """Return the active system once `done` events are done."""
        if self._kept is None or self._kept[0] != done:
            stage, model = self.schedule.after(done), self.problem.model
            first, last = self.ends(done)
            if stage.moving:
                made = model.ramped(first, last, stage.moving, self.split)
            else:
                made = model.system(first, self.split)
            self._kept = (done, made)
        return self._kept[1]

    def ends(self, done: int) -> tuple[Problem, Problem]:
        """Return the problems at the beginnings and the ends of the ramps once `done` events are done."""
        stage = self.schedule.after(done)
        first = self._at(stage, stage.first)
        return first, self._at(stage, stage.last) if stage.moving else first

    def intervene(self, now: StepperState, event: int) -> tuple[StepperState, Intervention | None]:
        """Return a run after an event at the time reached, and what was done to its state, if anything.

        The right-hand side is new: step control restarts, from the length of a first step or shorter.
        """
        system, model, note = self.system(event + 1), self.problem.model, None
        spectrum = now.spectrum
        if self.schedule.disturbs(event):
            before = model.state(self.problem.grid, np.asarray(spectrum))
            after = self.schedule.disturbed(event, before, model.act)
            note = Intervention(float(now.t), before, after)
            spectrum = model.whole_modes(system, after)
        fresh = start(system, spectrum, now.t)
        return now._replace(
            spectrum=fresh.spectrum,
            nonlinear=fresh.nonlinear,
            rate=fresh.rate,
            calm_since=fresh.calm_since,
            least_rate=fresh.least_rate,
            peak=fresh.peak if note is not None else now.peak,
            rung=jnp.minimum(now.rung, FIRST_RUNG),
            left=jnp.zeros_like(now.left),
            past=forget(now.past),
            evaluations=now.evaluations + 1,
        ), note

    def _at(self, stage: Stage, params: Any) -> Problem:
        """Return the problem at parameters of a stage, with those as fields that are fields by then."""
        whole = {name: getattr(params, name) for name in stage.fields}
        shape = self.problem.grid.shape
        spread = {name: np.broadcast_to(value, shape).copy() for name, value in whole.items()}
        return self.problem.at(params.replace(**spread))
