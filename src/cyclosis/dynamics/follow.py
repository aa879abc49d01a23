"""The loop of every run: integrate to a time, do what the protocol does there, and continue."""

from __future__ import annotations

import time as clock
from typing import Any

import jax
import numpy as np
import numpy.typing as npt

from ..contract.model import Array
from .advance import NEVER, Control, StepperState, is_steady, start
from .course import Course, Intervention
from .steppers import METHODS, Method
from .stretch import Stretch

MOST_STEPS = 4096
"""Largest number of steps that are tried in one stretch."""


class Follower:
    """A running integration: the stepper's state (`now`), the events done, and the system since the last.

    `active` is what controls the steps until the next event.
    It computes in stretches of `steps` steps; with `seconds` their number is adapted so that a stretch takes
    about that long. A run may become steady only once the protocol has nothing more to do. Call in double
    precision (`cyclosis.model.precision.double`).
    """

    now: StepperState

    def __init__(
        self,
        course: Course,
        control: Control,
        method: Method = METHODS["adaptive"],
        steps: int = 8,
        seconds: float | None = None,
    ) -> None:
        self.course, self.control, self.method = course, control, method
        self.steps, self.seconds = steps, seconds
        self._set_done(0)

    def begin(self, spectrum: npt.NDArray[Any]) -> None:
        """Begin a run at t = 0."""
        self.now = start(self.system, spectrum, np.float64(0.0), self.method)

    def take_up(self, now: StepperState, done: int, course: Course | None = None) -> None:
        """Continue from the state of a run after `done` events; on another course, if one is given."""
        self.now, self.course = now, course or self.course
        self._set_done(done)

    def _set_done(self, done: int) -> None:
        self.done, self.system = done, jax.device_put(self.course.system(done))
        self.stretch = Stretch(self.system, self.method)
        self.note: Intervention | None = None
        rate = self.control.steady_rate if done == len(self.course.times) else np.float64(NEVER)
        self.active = self.control._replace(steady_rate=rate, bound=self.course.bound(done))

    @property
    def t(self) -> float:
        """The time reached, dimensionless."""
        return float(self.now.t)

    @property
    def failed(self) -> bool:
        """Whether no step was short enough, or |P| passed its bound."""
        return bool(self.now.failed)

    @property
    def state(self) -> Array:
        """The state reached, bit for bit as an intervention at this time left it."""
        if self.note is not None and self.note.time == self.t:
            return self.note.after
        problem = self.course.problem
        return problem.model.state(problem.grid, np.asarray(self.now.spectrum))

    @property
    def ended(self) -> bool:
        """Whether the run has failed or is steady."""
        return self.failed or bool(is_steady(self.now))

    def can_go(self, target: float) -> bool:
        """Return whether the target is ahead and the run has not ended before it."""
        return self.t < target and not self.ended

    def advance(self, target: float) -> None:
        """Compute one stretch towards a time, which is hit exactly."""
        began = clock.perf_counter()
        self.now = self.stretch.to(self.active, self.now, np.float64(target), self.steps)
        self.now.t.block_until_ready()
        if self.seconds is not None:
            spent = clock.perf_counter() - began
            self.steps = int(np.clip(self.steps * self.seconds / spent, 1, MOST_STEPS))

    def intervene(self) -> Intervention | None:
        """Do what the protocol does at the time reached; return what was done to the state, if anything."""
        if self.done == len(self.course.times) or self.course.times[self.done] > self.t:
            return None
        self.now, note = self.course.intervene(self.now, self.done)
        self._set_done(self.done + 1)
        self.note = note
        return note
