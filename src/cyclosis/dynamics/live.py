"""A run whose protocol is still being written: followed frame by frame, it takes steps as they come.

What it comes to is, bit for bit, what `simulate` computes with the protocol that it has at the end, saving
every `every`: it lands on the same times, and no stage of a course depends on what comes later.
"""

from __future__ import annotations

import time as clock
from collections.abc import Mapping
from typing import Any

import jax
import numpy as np
import numpy.typing as npt

from ..analysis.diagnostics import measure
from ..model.errors import InputError
from ..model.grid import Array, CylinderGrid
from ..model.parameters import Parameters
from ..model.precision import double
from ..model.system import flow_spectrum
from .advance import Control, Progress, advance, start
from .course import Course
from .protocol import Protocol
from .run import NEVER
from .settings import Settings

SLICE_SECONDS = 0.05
"""About how long one call of `forward` computes."""


class Live:
    """A cell under way, at a frame or between two of them.

    `params`, `grid`, and the initial `state` (2, n_theta, n_z) are those of `simulate`; frames are `every`
    apart, dimensionless (R/U). `protocol` is what is to be done so far. Raises `InputError` as `simulate`.
    """

    def __init__(
        self,
        params: Parameters,
        grid: CylinderGrid,
        state: npt.ArrayLike,
        every: float,
        protocol: Protocol | None = None,
    ) -> None:
        every = Settings(save_every=every).save_every
        self.how = Settings(t_end=every, save_every=every)
        self.params, self.grid, self.every = params, grid, self.how.save_every
        self.frame, self.failed = 0, False
        P = grid.check_state(state, "the initial state", bounded=True)
        self._take(protocol or Protocol())
        cell = self.course.system(0)
        self._done, self._steps = 0, 8
        self._after: Array | None = None
        self._before: Progress | None = None
        numbers = (np.float64(x) for x in (self.how.rtol, self.how.atol, 0.1, NEVER))
        self._control = Control(*numbers)
        with double():
            self._cell = jax.device_put(cell)
            self._now = start(self._cell, cell.spectrum(P), np.float64(0.0))
            self._intervene()

    @property
    def t(self) -> float:
        """The time reached, dimensionless."""
        return float(self._now.t)

    @property
    def at_frame(self) -> bool:
        """Whether the time reached is that of a frame, at which steps are taken."""
        return self.t == self._time_of(self.frame)

    @property
    def protocol(self) -> Protocol:
        """What was done so far and what is still to be done."""
        return self.course.protocol

    @property
    def params_now(self) -> Parameters:
        """The parameters in force."""
        return self.course.schedule.params_at(self.t)

    @property
    def state(self) -> Array:
        """P now, shape (2, n_theta, n_z)."""
        if self._after is not None:
            return self._after
        return self._cell.state(np.asarray(self._now.spectrum))

    def flow(self) -> Array:
        """Return the flow now, shape (2, n_theta, n_z)."""
        with double():
            return self._cell.state(flow_spectrum(self._cell, self._now.spectrum, self._now.t))

    def record(self) -> Mapping[str, Any]:
        """Return the quantities of `cyclosis.diagnostics.QUANTITIES` now, by name."""
        with double():
            return jax.device_get(measure(self._cell, self._now.spectrum, self._now.t))

    def forward(self) -> bool:
        """Compute on for a moment, towards the next frame; return whether it is reached.

        A run that can go no further has `failed` and stays where it is.
        """
        if self.failed:
            return False
        frame = self._time_of(self.frame + 1)
        events = (t for t in self.course.times[self._done :] if t > self.t)
        target = min(frame, next(events, frame))
        control = self._control._replace(bound=self.course.bound(self._done))
        with double():
            began = clock.perf_counter()
            now = advance(self._cell, control, self._now, np.float64(target), np.int64(self._steps))
            now.t.block_until_ready()
            spent = clock.perf_counter() - began
            self._steps = int(np.clip(self._steps * SLICE_SECONDS / spent, 1, 4096))
            if float(now.t) != self.t:
                self._after, self._before = None, None
            self._now, self.failed = now, bool(now.failed)
            if not self.failed and self.t == target:
                self._intervene()
        if self.t == frame and not self.failed:
            self.frame += 1
            return True
        return False

    def do(self, protocol: Protocol) -> None:
        """Go on under a protocol that has more steps than that so far, at the time reached or later.

        Raises `InputError` for steps in the past or where time stands between two frames, and leaves
        everything as it was.
        """
        old, new = list(self.protocol), list(protocol)
        past = [step for step in new if step.at < self.t]
        if past != [step for step in old if step.at < self.t] or protocol.seed != self.protocol.seed:
            if late := [step.at for step in past if step not in old]:
                raise InputError("at", late[0], f"at least {self.t:g}, the time reached", "move it there")
            rule = "that so far, with the same seed and the steps already done"
            found = f"{len(new)} steps, seed {protocol.seed}"
            raise InputError("protocol", found, rule, "add steps to `protocol`")
        if not self.at_frame:
            raise InputError("at", self.t, "the time of a frame", "go forward to the next frame first")
        self._take(protocol)
        with double():
            if self._before is not None:  # what was done at this time is done again, together with the new
                self._now = self._before
            self._done = sum(t < self.t for t in self.course.times)
            self._cell = jax.device_put(self.course.system(self._done))
            self._after = None
            self._intervene()
        self.failed = False

    def _take(self, protocol: Protocol) -> None:
        self.course = Course(self.params, self.grid, protocol, None, self.how.dealias, self.how.precision)

    def _intervene(self) -> None:
        """Do what the protocol does at the time reached."""
        while self._done < len(self.course.times) and self.course.times[self._done] == self.t:
            self._before = self._before or self._now
            self._now, note = self.course.intervene(self._now, self._done)
            self._done += 1
            self._cell = jax.device_put(self.course.system(self._done))
            self._after = note.after if note is not None else self._after

    def _time_of(self, frame: int) -> float:
        return float(np.round(self.every * frame, 12))
