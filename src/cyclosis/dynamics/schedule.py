"""What a protocol means for one cell: the parameters at any time, and what steps do to a state.

At the time of a step, everything "at" that time is after it: the parameters, a frame, a record. A ramp is
linear in time. Nothing here looks ahead: later steps of a protocol do not change a single bit of the results
before them, so that a cell can be integrated while its protocol is still being written; only the default step
of `rk4` is chosen for all stages together.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Callable
from typing import Any

import numpy as np

from ..contract.model import Array
from ..model.errors import InputError
from ..model.instants import instant
from ..model.regions import Mask
from .protocol import Protocol, Step
from .stage import Stage, Values

KEPT = 4
"""Stages that a schedule keeps; others are made again when they are needed."""


class Schedule:
    """The events of a protocol on a cell.

    `times` are those of the steps and of the ends of ramps. Stages are the stretches before, between and
    after them, so that stage k is active once k events are done. Parameters may be fields, so the stages of a
    long protocol can be larger than everything else: only the last `KEPT` of them are kept. Raises
    `InputError` for fields that do not match the grid, and for a region that is not on the cell or has no
    point of the grid.
    """

    def __init__(self, params: Any, grid: Any, protocol: Protocol) -> None:
        params.require_grid(grid)
        self.params, self.grid, self.protocol = params, grid, protocol
        self.steps = [(step, _mask(step, grid)) for step in protocol]
        self.times = tuple(sorted({time for step in protocol for time in (step.at, step.until)}))
        self._kept = {0: Values.of(params)}
        self.after(len(self.times))  # a mistake in any step is found now

    def done(self, t: float) -> int:
        """Return the number of events up to and at a time."""
        t = instant(t)
        return bisect_right(self.times, t)

    def after(self, done: int) -> Stage:
        """Return the stage once `done` events are done."""
        reached = max(k for k in self._kept if k <= done)
        while reached < done:
            time = self.times[reached]
            values = self._kept[reached].after(time, self._due(time), self.params)
            reached += 1
            self._kept[reached] = values
            if len(self._kept) > 1 + KEPT:
                del self._kept[next(k for k in self._kept if k)]  # the one made first
        return self._kept[done].stage

    def stage(self, t: float) -> Stage:
        """Return the stage at a time, after any steps at that time."""
        return self.after(self.done(t))

    def params_at(self, t: float) -> Any:
        """Return the parameters at a time, after any steps at that time."""
        return self.stage(t).at(instant(t))

    def disturbs(self, event: int) -> bool:
        """Return whether an event acts on the state."""
        return any(step.acts_on_state for step, _ in self._due(self.times[event]))

    def disturbed_by(self, done: int) -> bool:
        """Return whether any of the events done acted on the state."""
        return any(map(self.disturbs, range(done)))

    def disturbed(self, event: int, state: Array, act: Callable[[Step, Array, Any, int], Array]) -> Array:
        """Return a state after an event; outside the regions every bit is as before.

        `act(step, state, grid, seed)` applies a step to a state, see `Model`.
        """
        for step, mask in self._due(self.times[event]):
            if step.acts_on_state:
                new = act(step, state, self.grid, self.protocol.seed)
                state = new if mask is None else np.where(mask, new, state)
        return state

    def _due(self, time: float) -> list[tuple[Step, Mask | None]]:
        """Return the steps at a time with their regions."""
        return [(step, mask) for step, mask in self.steps if step.at == time]


def _mask(step: Step, grid: Any) -> Mask | None:
    region = getattr(step, "where", None)
    if region is None:
        return None
    mask: Mask = region.mask(grid)
    if not mask.any():
        rule = f"a region with at least one point of the grid of {grid.shape[0]} x {grid.shape[1]}"
        raise InputError(
            f"where of {step.action} at t = {step.at:g}", str(region), rule, "enlarge it, or refine the grid"
        )
    return mask
