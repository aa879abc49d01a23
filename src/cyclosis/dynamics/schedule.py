"""What a protocol means for one cell: the parameters at any time, and what steps do to a state.

At the time of a step, everything "at" that time is after it: the parameters, a frame, a record. A ramp is
linear in time. Nothing here looks ahead: later steps of a protocol do not change a single bit of the results
before them, so that a cell can be integrated while its protocol is still being written; only the default step
of `rk4` is chosen for all stages together.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..contract.model import Array
from ..model.errors import InputError
from ..model.instants import instant
from ..model.regions import Mask
from .protocol import Change, Protocol, Step, WashOut


@dataclass(frozen=True, eq=False)
class Stage:
    """What is active between two events.

    `first` and `last` are the parameters at the beginnings and the ends of the active ramps, and are equal if
    there are none; `moving` gives the beginning and the end of each ramp by name. `fields` names the
    parameters that a step, now or before, has made differ from place to place.
    """

    first: Any
    last: Any
    moving: dict[str, tuple[float, float]]
    fields: frozenset[str]

    def at(self, t: float) -> Any:
        """Return the parameters at a time within the stage."""
        values = {}
        for name, (begin, end) in self.moving.items():
            first = getattr(self.first, name)
            values[name] = first + (t - begin) / (end - begin) * (getattr(self.last, name) - first)
        return self.first.replace(**values) if values else self.first


class Schedule:
    """The events of a protocol on a cell.

    `times` are those of the steps and of the ends of ramps; `stages` are the stretches before, between and
    after them, so that stage k is active once k events are done. Raises `InputError` for fields that do not
    match the grid, and for a region that is not on the cell or has no point of the grid.
    """

    def __init__(self, params: Any, grid: Any, protocol: Protocol) -> None:
        params.require_grid(grid)
        self.params, self.grid, self.protocol = params, grid, protocol
        self.steps = [(step, _mask(step, grid)) for step in protocol]
        self.times = tuple(sorted({time for step in protocol for time in (step.at, step.until)}))
        self.stages = self._stages()

    def done(self, t: float) -> int:
        """Return the number of events up to and at a time."""
        t = instant(t)
        return bisect_right(self.times, t)

    def stage(self, t: float) -> Stage:
        """Return the stage at a time, after any steps at that time."""
        return self.stages[self.done(t)]

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

    def _stages(self) -> list[Stage]:
        current: dict[str, Any] = dict(self.params.items())
        ramps: dict[str, tuple[float, float, Any, Any]] = {}
        changed, spread = set[str](), set[str]()
        out = [Stage(self.params, self.params, {}, frozenset())]
        for time in self.times:
            for name in [name for name, ramp in ramps.items() if ramp[1] <= time]:
                current[name] = ramps.pop(name)[3]
            for step, mask in self._due(time):
                if isinstance(step, Change):
                    changed |= dict(step.values).keys()
                    spread |= dict(step.values).keys() if step.where is not None else set()
                for name, target in self._targets(step, mask, current, changed).items():
                    if getattr(step, "over", 0.0) and name != "zero_theta_flux":
                        ramps[name] = (step.at, step.until, current[name], target)
                    else:
                        current[name] = target
            first = self.params.replace(**(current | {name: ramp[2] for name, ramp in ramps.items()}))
            last = first.replace(**{name: ramp[3] for name, ramp in ramps.items()})
            out.append(Stage(first, last, {n: r[:2] for n, r in ramps.items()}, frozenset(spread)))
        return out

    def _targets(
        self, step: Step, mask: Mask | None, current: dict[str, Any], changed: set[str]
    ) -> dict[str, Any]:
        """Return the values to which a step takes parameters, by name."""
        if isinstance(step, WashOut):
            return {name: getattr(self.params, name) for name in sorted(changed)}
        if not isinstance(step, Change):
            return {}
        return {
            name: value if mask is None else np.where(mask, value, current[name])
            for name, value in step.values
        }


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
