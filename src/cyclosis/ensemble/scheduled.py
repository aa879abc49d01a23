"""A member with a protocol: it is integrated from event to event, to t_end, alone or in a lane.

Its result does not depend on anything else, so that it is the same bit for bit whatever the lanes, blocks and
workers. All members of one shape share compiled programs, whatever the times and values of their protocols.
"""

from __future__ import annotations

import time as clock
from collections.abc import Mapping
from functools import partial
from typing import Any

import jax
import numpy as np

from ..contract.members import Lanes, Look
from ..contract.system import System
from ..dynamics.advance import Control
from ..dynamics.course import Course
from ..dynamics.follow import Follower
from ..dynamics.watch import Watch
from .lanes import CHECK_STEPS
from .members import DISORDERED, EnsembleSettings, Member, Outcome, ended, uncertain


def follow_scheduled(member: Member, how: EnsembleSettings) -> Outcome:
    """Return the outcome of a member at t_end, computed alone; to be called in double precision.

    Raises `InputError` for a state or a region that does not fit the grid.
    """
    run = ScheduledRun(member, how)
    while not run.over:
        run.follower.advance(run.target)
        run.measure()
        run.arrive()
    return run.outcome(clock.perf_counter() - run.began)


class ScheduledRun:
    """A member that is being integrated, and what has been recorded about it so far.

    `follower` integrates it towards `target`, the time of the next event or the end. After every stretch call
    `measure` or `look`, and `arrive` once the target is reached, until the run is `over`.
    """

    def __init__(self, member: Member, how: EnsembleSettings) -> None:
        self.member, self.how, self.began = member, how, clock.perf_counter()
        start = member.model.check_state(member.grid, member.state(), "the initial state")
        self.problem = how.problem(member, start.shape)
        self.course = Course(self.problem, member.protocol)
        control = Control.of(how.rtol, how.atol, self.course.bound(0))
        self.follower = Follower(self.course, control, steps=CHECK_STEPS)
        self.watch = Watch(self.problem, self.course.system(0), how.run)
        self.looks: list[tuple[float, Look]] = []
        self.tail = 0.0
        self.follower.begin(self.problem.model.modes(self.course.system(0), start))
        times = {*(time for time in self.course.times if time <= how.t_end), how.t_end}
        self.left = sorted(times, reverse=True)
        self.arrive()

    @property
    def over(self) -> bool:
        """Whether the run has reached its end or failed."""
        return not self.left or self.follower.failed

    @property
    def target(self) -> float:
        """The time up to which the present system is active."""
        return self.left[-1]

    def arrive(self) -> None:
        """Do what the protocol does at the time reached, if it is that of an event."""
        while not self.over and not self.follower.can_go(self.target):
            self.left.pop()
            note = self.follower.intervene()
            if note is not None:
                self.watch.disturbed(note.time, self.follower.system)

    def measure(self) -> None:
        """Record what the member looks like."""
        now, system, model = self.follower.now, self.follower.system, self.problem.model
        if model.lanes is not None:
            self.look(self.follower.t, jax.device_get(_signs(system, now.spectrum, model.lanes)), model.lanes)
            return
        found = model.measure(system, now.spectrum, now.t)
        self._watch(self.follower.t, found, float(found[model.peak]))

    def look(self, t: float, signs: Any, lanes: Lanes) -> None:
        """Record the signs of the member at a time."""
        self.looks.append((t, lanes.look(signs)))
        self._watch(t, {"spectral_tail": signs.tail}, float(signs.largest))

    def _watch(self, t: float, tails: Mapping[str, Any], largest: float) -> None:
        if t >= self.watch.patience:
            self.tail = max(self.tail, float(tails["spectral_tail"]))
        self.watch.look(t, tails, largest)

    def outcome(self, seconds: float) -> Outcome:
        """Return how the member has ended, given the seconds that it took."""
        t, state, lanes = self.follower.t, self.follower.state, self.problem.model.lanes
        status = "diverged" if self.follower.failed else "completed"
        found = ended(self.problem.at(self.course.schedule.params_at(t)), state)
        reason = uncertain(status, found.rate)
        if status != "diverged" and self.watch.time is not None:
            status = "underresolved"
        ordered = lanes is not None and found.name != DISORDERED
        since = lanes.look_of_state(state).since(self.looks, t) if lanes and ordered else np.nan
        return Outcome(
            regime=found.name,
            status=status,
            reason=reason,
            t_final=t,
            t_order=since,
            state=state,
            eigenvalue=np.nan,
            tail=self.tail,
            evaluations=int(self.follower.now.evaluations),
            seconds=seconds,
        )


@partial(jax.jit, static_argnames="lanes")
def _signs(system: System, spectrum: Any, lanes: Lanes) -> Any:
    return lanes.signs(system, spectrum)
