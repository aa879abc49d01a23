"""A member with a protocol: it is integrated alone, from event to event, to t_end.

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
    """Return the outcome of a member at t_end; to be called in double precision.

    Raises `InputError` for a state or a region that does not fit the grid.
    """
    return _ScheduledRun(member, how).run()


class _ScheduledRun:
    """A member that is being integrated, and what has been recorded about it so far."""

    def __init__(self, member: Member, how: EnsembleSettings) -> None:
        self.member, self.how, self.began = member, how, clock.perf_counter()
        self.start = member.model.check_state(member.grid, member.state(), "the initial state")
        self.problem = how.problem(member, self.start.shape)
        self.course = Course(self.problem, member.protocol)
        control = Control.of(how.rtol, how.atol, self.course.bound(0))
        self.follower = Follower(self.course, control, steps=CHECK_STEPS)
        self.watch = Watch(self.problem, self.course.system(0), how.run)
        self.looks: list[tuple[float, Look]] = []
        self.tail = 0.0

    def run(self) -> Outcome:
        """Integrate the member and return its outcome."""
        self.follower.begin(self.problem.model.modes(self.course.system(0), self.start))
        for target in sorted({*self.course.times, self.how.t_end}):
            if target > self.how.t_end:
                break
            self._reach(target)
            if self.follower.failed:
                break
            note = self.follower.intervene()
            if note is not None:
                self.watch.disturbed(note.time, self.follower.system)
        return self._outcome()

    def _reach(self, target: float) -> None:
        while self.follower.can_go(target):
            self.follower.advance(target)
            t, (tails, largest) = self.follower.t, self._seen()
            if t >= self.watch.patience:
                self.tail = max(self.tail, float(tails["spectral_tail"]))
            self.watch.look(t, tails, largest)

    def _seen(self) -> tuple[Mapping[str, Any], float]:
        """Record the signs of the member, and return its tails and its largest |P|."""
        now, system, model = self.follower.now, self.follower.system, self.problem.model
        if model.lanes is None:
            found = model.measure(system, now.spectrum, now.t)
            return found, float(found[model.peak])
        seen = jax.device_get(_signs(system, now.spectrum, model.lanes))
        self.looks.append((self.follower.t, model.lanes.look(seen)))
        return {"spectral_tail": seen.tail}, float(seen.largest)

    def _outcome(self) -> Outcome:
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
            seconds=clock.perf_counter() - self.began,
        )


@partial(jax.jit, static_argnames="lanes")
def _signs(system: System, spectrum: Any, lanes: Lanes) -> Any:
    return lanes.signs(system, spectrum)
