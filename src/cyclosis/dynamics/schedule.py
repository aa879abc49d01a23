"""What a protocol means for one cell: the parameters in force at any time, and what becomes of a state.

At a time when something is done, everything "at" that time is after it: the parameters in force, a frame, a
record. A ramp is straight in time.
"""

from __future__ import annotations

from bisect import bisect_right
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..model import initial
from ..model.errors import InputError
from ..model.grid import Array, CylinderGrid
from ..model.parameters import Parameters
from ..model.regions import Mask
from .protocol import Change, Depolymerise, Fragment, Noise, Protocol, Step, WashOut


@dataclass(frozen=True, eq=False)
class Stage:
    """The time between two events: its beginning and end, and the parameters there.

    `last` is None where no parameter is on its way.
    """

    begin: float
    end: float
    first: Parameters
    last: Parameters | None = None


class Schedule:
    """The events of a protocol on a cell.

    `times` are those at which a step or the end of a ramp falls; `stages` the stretches before, between and
    after them, so that stage k is in force once k events are done. `fields` names the parameters that a step
    makes differ from place to place, `ramped` those that are ever on a ramp. Raises `InputError` for
    fields that do not match the grid, and for a region that is not on the cell or has no point of the grid.
    """

    def __init__(self, params: Parameters, grid: CylinderGrid, protocol: Protocol) -> None:
        params.require_shape(grid.shape)
        self.params, self.grid, self.protocol = params, grid, protocol
        self.masks = {id(step): _mask(step, grid) for step in protocol}
        self.times = tuple(sorted({time for step in protocol for time in (step.at, step.until)}))
        changes = [step for step in protocol if isinstance(step, Change)]
        self.changed = {name for step in changes for name, _ in step.values}
        self.fields = tuple({name for step in changes if step.where is not None for name, _ in step.values})
        self.ramped = {name for step in changes if step.over for name, _ in step.values}
        if any(isinstance(step, WashOut) and step.over for step in protocol):
            self.ramped |= self.changed - {"zero_theta_flux"}
        self.stages = self._stages()

    def done(self, t: float) -> int:
        """Return the number of events up to and at a time."""
        return bisect_right(self.times, t)

    def params_at(self, t: float) -> Parameters:
        """Return the parameters in force at a time, after whatever is done then."""
        stage = self.stages[self.done(t)]
        if stage.last is None:
            return stage.first
        share = (t - stage.begin) / (stage.end - stage.begin)
        values = {name: getattr(stage.first, name) for name in self.ramped}
        return stage.first.replace(
            **{name: value + share * (getattr(stage.last, name) - value) for name, value in values.items()}
        )

    def disturbs(self, event: int) -> bool:
        """Return whether an event acts on the state."""
        return any(step.acts_on_state for step in self._steps(event))

    def last_disturbance(self, done: int) -> float | None:
        """Return the time of the last of the events done that acted on the state."""
        return next((self.times[k] for k in reversed(range(done)) if self.disturbs(k)), None)

    def disturbed(self, event: int, state: Array) -> Array:
        """Return a state (2, n_theta, n_z) after an event; outside the regions every bit is as before."""
        for step in self._steps(event):
            if step.acts_on_state:
                new, mask = self._acted(step, state), self.masks[id(step)]
                state = new if mask is None else np.where(mask, new, state)
        return state

    def _steps(self, event: int) -> list[Step]:
        return [step for step in self.protocol if step.at == self.times[event]]

    def _acted(self, step: Step, state: Array) -> Array:
        if isinstance(step, Depolymerise):
            return step.keep * state
        assert isinstance(step, Fragment | Noise)
        sequence = np.random.SeedSequence(self.protocol.seed, spawn_key=(step.seed or 0,))
        drawn = initial.standard_noise(self.grid, np.random.default_rng(sequence), step.noise_grid)
        if isinstance(step, Fragment):
            return _bounded(drawn * np.sqrt(0.5 / step.filaments_per_square))
        return _bounded(state + step.size * drawn)

    def _stages(self) -> list[Stage]:
        current: dict[str, Any] = dict(self.params.items())
        ramps: dict[str, tuple[float, float, Any, Any]] = {}
        out = [Stage(0.0, self.times[0] if self.times else np.inf, self.params)]
        ends = [*self.times[1:], np.inf]
        for time, end in zip(self.times, ends, strict=False):
            for name in [name for name, ramp in ramps.items() if ramp[1] <= time]:
                current[name] = ramps.pop(name)[3]
            for step in (step for step in self.protocol if step.at == time):
                for name, target in self._targets(step, current).items():
                    if getattr(step, "over", 0.0) and name in self.ramped:
                        ramps[name] = (step.at, step.until, current[name], target)
                    else:
                        current[name] = target
            first = {name: _along(ramp, time) for name, ramp in ramps.items()}
            last = {name: _along(ramp, end) for name, ramp in ramps.items()}
            begin = self.params.replace(**(current | first))
            out.append(Stage(time, end, begin, begin.replace(**last) if ramps else None))
        return out

    def _targets(self, step: Step, current: dict[str, Any]) -> dict[str, Any]:
        """Return the values to which a step takes parameters, by name."""
        if isinstance(step, WashOut):
            return {name: getattr(self.params, name) for name in self.changed}
        if not isinstance(step, Change):
            return {}
        mask = self.masks[id(step)]
        return {
            name: value if mask is None else np.where(mask, value, current[name])
            for name, value in step.values
        }


def _mask(step: Step, grid: CylinderGrid) -> Mask | None:
    region = getattr(step, "where", None)
    if region is None:
        return None
    mask: Mask = region.mask(grid)
    if not mask.any():
        rule = f"a region with at least one point of the grid of {grid.n_theta} x {grid.n_z}"
        raise InputError(
            f"where of {step.action} at t = {step.at:g}", str(region), rule, "enlarge it, or refine the grid"
        )
    return mask


def _along(ramp: tuple[float, float, Any, Any], time: float) -> Any:
    """Return the value of a ramp (begin, end, first, last) at a time, exact at either end."""
    begin, end, first, last = ramp
    if time >= end:
        return last
    return first + (time - begin) / (end - begin) * (last - first)


def _bounded(P: Array) -> Array:
    """Return a state with |P| scaled back to 1 where it is larger."""
    bounded: Array = P / np.maximum(np.hypot(*P), 1.0)
    return bounded
