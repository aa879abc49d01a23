"""A member with a protocol: followed alone from event to event, to t_end.

Its course depends on nothing but itself, so that lanes, blocks and workers cannot change one bit of it. All
members of one shape share their compiled programs, whatever their protocols' times and values.
"""

from __future__ import annotations

import time as clock

import jax
import numpy as np

from ..analysis.regimes import regime
from ..dynamics.advance import Control, Progress, advance, start
from ..dynamics.course import Course
from ..dynamics.run import NEVER, Watch
from ..model.grid import Array
from .lanes import CHECK_STEPS, signs
from .looks import Look
from .members import EnsembleSettings, Member, Outcome, uncertain


def follow_scheduled(member: Member, how: EnsembleSettings) -> Outcome:
    """Return the outcome of a member at t_end; call in double precision.

    Raises `InputError` for a state or a region that does not fit the grid.
    """
    return _Ride(member, how).go()


class _Ride:
    """A member on its way: what has been seen of it so far."""

    def __init__(self, member: Member, how: EnsembleSettings) -> None:
        self.member, self.how, self.began = member, how, clock.perf_counter()
        self.course = Course(
            member.params, member.grid, member.protocol, how.terms, how.dealias, how.precision
        )
        tolerances = (np.float64(x) for x in (how.rtol, how.atol, 0.1, NEVER))
        self.control = Control(*tolerances)
        self.cell = jax.device_put(self.course.system(0))
        self.watch = Watch(self.course.system(0), how.run)
        self.looks: list[tuple[float, Look]] = []
        self.tail, self.done = 0.0, 0

    def go(self) -> Outcome:
        """Follow the member and return its outcome."""
        state = self.member.grid.check_state(self.member.state(), "the initial state", bounded=True)
        now = start(self.cell, self.cell.spectrum(state), np.float64(0.0))
        final = None
        for target in sorted({*self.course.times, self.how.t_end}):
            if target > self.how.t_end:
                break
            now = self._reach(now, target)
            if bool(now.failed):
                final = None
                break
            now, final = self._intervene(now)
        return self._outcome(now, self.cell.state(np.asarray(now.spectrum)) if final is None else final)

    def _reach(self, now: Progress, target: float) -> Progress:
        control = self.control._replace(bound=self.course.bound(self.done))
        while float(now.t) < target and not bool(now.failed):
            now = advance(self.cell, control, now, np.float64(target), np.int64(CHECK_STEPS))
            seen = jax.device_get(signs(self.cell, now, self.how.t_end))
            t = float(seen.t)
            self.looks.append((t, Look.of_signs(seen)))
            if t >= self.watch.patience:
                self.tail = max(self.tail, float(seen.tail))
            self.watch.look(t, float(seen.tail), float(seen.largest))
        return now

    def _intervene(self, now: Progress) -> tuple[Progress, Array | None]:
        """Do what the protocol does at the time reached; return also the state, if that was acted on."""
        if self.done == len(self.course.times) or self.course.times[self.done] != float(now.t):
            return now, None
        now, note = self.course.intervene(now, self.done)
        self.done += 1
        self.cell = jax.device_put(self.course.system(self.done))
        if note is None:
            return now, None
        self.watch.disturbed(note.time, self.cell)
        return now, note.after

    def _outcome(self, now: Progress, state: Array) -> Outcome:
        t, status = float(now.t), "diverged" if bool(now.failed) else "completed"
        found = regime(self.course.schedule.params_at(t), self.member.grid, state, self.how.terms)
        reason = uncertain(status, found.rate)
        if status != "diverged" and self.watch.time is not None:
            status = "underresolved"
        ordered = found.name != "disordered"
        return Outcome(
            regime=found.name,
            status=status,
            reason=reason,
            t_final=t,
            t_order=Look.of_state(state).since(self.looks, t) if ordered else np.nan,
            state=state,
            eigenvalue=np.nan,
            tail=self.tail,
            evaluations=int(now.evaluations),
            seconds=clock.perf_counter() - self.began,
        )
