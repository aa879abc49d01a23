"""A run whose protocol is still being written: integrated frame by frame, it takes steps as they arrive.

Its result equals bit for bit that of `simulate` with its final protocol, saving every `every`: it lands on
the same times, and no stage of a course depends on later steps.
"""

from __future__ import annotations

import copy
from collections.abc import Mapping
from typing import Any

import jax
import numpy.typing as npt

from ..contract.model import Array, Model
from ..model.errors import InputError
from ..model.instants import instant
from ..model.precision import double
from ..model.wording import beside
from ..models import polar
from .advance import Control, StepperState
from .course import Course
from .follow import Follower
from .protocol import Protocol
from .settings import Settings

SLICE_SECONDS = 0.05
"""About how long one call of `forward` computes."""


class Live:
    """A running cell, at a frame or between two of them.

    `params`, `grid`, and the initial `state` (2, n_theta, n_z) are those of `simulate`; frames are `every`
    apart, dimensionless (R/U). `protocol` is what is to be done, as far as it is known. Raises
    `InputError` as `simulate`.
    """

    def __init__(
        self,
        params: Any,
        grid: Any,
        state: npt.ArrayLike,
        every: float,
        protocol: Protocol | None = None,
        model: Model = polar,
    ) -> None:
        every = Settings(save_every=every).save_every
        self.how = Settings(t_end=every, save_every=every)
        self.params, self.grid, self.every = params, grid, self.how.save_every
        self.frame, self.failed = 0, False
        P = model.check_state(grid, state, "the initial state")
        self.problem = model.problem(params, grid, None, self.how.dealias, self.how.precision, P.shape)
        self._take(protocol or Protocol())
        self._before: StepperState | None = None
        with double():
            control = Control.of(self.how.rtol, self.how.atol, model.bound)
            self._follower = Follower(self.course, control, seconds=SLICE_SECONDS)
            self._follower.begin(model.modes(self.course.system(0), P))
            self._intervene()

    @property
    def t(self) -> float:
        """The time reached, dimensionless."""
        return self._follower.t

    @property
    def at_frame(self) -> bool:
        """Whether the time reached is that of a frame, at which steps of the protocol are accepted."""
        return self.t == self._time_of(self.frame)

    @property
    def protocol(self) -> Protocol:
        """What was done so far and what remains to be done."""
        return self.course.protocol

    @property
    def params_now(self) -> Any:
        """The current parameters."""
        return self.course.schedule.params_at(self.t)

    @property
    def state(self) -> Array:
        """The state now, of the shape of the first."""
        return self._follower.state

    def flow(self) -> Array:
        """Return the flow now, shape (2, n_theta, n_z)."""
        now, flow = self._follower.now, self.problem.model.flow
        if flow is None:
            raise InputError("model", self.problem.model.name, "one with a flow", "choose another")
        with double():
            return flow(self._follower.system, now.spectrum, now.t)

    def record(self) -> Mapping[str, Any]:
        """Return the quantities of `cyclosis.diagnostics.QUANTITIES` now, by name."""
        now = self._follower.now
        with double():
            return jax.device_get(self.problem.model.measure(self._follower.system, now.spectrum, now.t))

    def forward(self) -> bool:
        """Compute one stretch towards the next frame; return whether it is reached.

        A run that cannot continue has `failed` and stays at its time.
        """
        if self.failed:
            return False
        frame = self._time_of(self.frame + 1)
        target = min([frame, *self.course.times[self._follower.done :]])
        with double():
            began = self.t
            self._follower.advance(target)
            if self.t != began:
                self._before = None
            self.failed = self._follower.failed
            if not self.failed and self.t == target:
                self._intervene()
        if self.t == frame and not self.failed:
            self.frame += 1
            return True
        return False

    def copy(self) -> Live:
        """Return a run that starts where this one is and continues apart from it."""
        other = copy.copy(self)
        other._follower = copy.copy(self._follower)
        return other

    def do(self, protocol: Protocol) -> None:
        """Continue under a protocol with further steps, at the time reached or later.

        Raises `InputError` for steps in the past or if the time is between two frames, and then changes
        nothing.
        """
        old, new = list(self.protocol), list(protocol)
        past = [step for step in new if step.at < self.t]
        if past != [step for step in old if step.at < self.t] or protocol.seed != self.protocol.seed:
            if late := [step.at for step in past if step not in old]:
                rule = f"at least {beside(self.t, late[0])}, the time reached"
                raise InputError("at", late[0], rule, "move it there")
            rule = "that so far, with the same seed and the steps already done"
            found = f"{len(new)} steps, seed {protocol.seed}"
            raise InputError("protocol", found, rule, "add steps to `protocol`")
        if not self.at_frame:
            raise InputError("at", self.t, "the time of a frame", "go forward to the next frame first")
        self._take(protocol)
        with double():
            # What was done at this time is done again, together with the new steps.
            now = self._follower.now if self._before is None else self._before
            self._follower.take_up(now, sum(t < self.t for t in self.course.times), self.course)
            self._intervene()
        self.failed = False

    def _take(self, protocol: Protocol) -> None:
        self.course = Course(self.problem, protocol)

    def _intervene(self) -> None:
        """Do what the protocol does at the time reached."""
        before, done = self._follower.now, self._follower.done
        self._follower.intervene()
        if self._follower.done > done and self._before is None:
            self._before = before

    def _time_of(self, frame: int) -> float:
        return instant(self.every * frame)
