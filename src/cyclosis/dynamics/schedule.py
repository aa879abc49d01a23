"""What a protocol means for one cell: the parameters in force at any time, and what becomes of a state.

At a time when something is done, everything "at" that time is after it: the parameters in force, a frame, a
record. A ramp is straight in time. Nothing here looks ahead: what a protocol does later changes no bit of
what comes before, so that a cell may be followed while its protocol is still being written; only the default
step of `rk4` is chosen for all stages at once.
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
from .protocol import Align, Change, Depolymerise, Fragment, Noise, Protocol, Step, WashOut


@dataclass(frozen=True, eq=False)
class Stage:
    """What is in force between two events.

    `first` and `last` are the parameters at the beginnings and the ends of the ramps that are under way, and
    the same where there are none; `moving` gives the times of either by name. `fields` names the parameters
    that a step has made differ from place to place, now or before.
    """

    first: Parameters
    last: Parameters
    moving: dict[str, tuple[float, float]]
    fields: frozenset[str]

    @property
    def cubic(self) -> bool:
        """Whether the force is cubic throughout."""
        return {self.first.force_exponent, self.last.force_exponent} == {2.0}

    def at(self, t: float) -> Parameters:
        """Return the parameters at a time within the stage."""
        values = {}
        for name, (begin, end) in self.moving.items():
            first = getattr(self.first, name)
            values[name] = first + (t - begin) / (end - begin) * (getattr(self.last, name) - first)
        return self.first.replace(**values)


class Schedule:
    """The events of a protocol on a cell.

    `times` are those at which a step or the end of a ramp falls; `stages` the stretches before, between and
    after them, so that stage k is in force once k events are done. Raises `InputError` for fields that do not
    match the grid, and for a region that is not on the cell or has no point of the grid.
    """

    def __init__(self, params: Parameters, grid: CylinderGrid, protocol: Protocol) -> None:
        params.require_shape(grid.shape)
        self.params, self.grid, self.protocol = params, grid, protocol
        self.masks = {id(step): _mask(step, grid) for step in protocol}
        self.times = tuple(sorted({time for step in protocol for time in (step.at, step.until)}))
        self.stages = self._stages()

    def done(self, t: float) -> int:
        """Return the number of events up to and at a time."""
        return bisect_right(self.times, t)

    def stage(self, t: float) -> Stage:
        """Return the stage in force at a time, after whatever is done then."""
        return self.stages[self.done(t)]

    def params_at(self, t: float) -> Parameters:
        """Return the parameters in force at a time, after whatever is done then."""
        return self.stage(t).at(t)

    def disturbs(self, event: int) -> bool:
        """Return whether an event acts on the state."""
        return any(step.acts_on_state for step in self._steps(event))

    def disturbed_by(self, done: int) -> bool:
        """Return whether any of the events done acted on the state."""
        return any(map(self.disturbs, range(done)))

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
        if isinstance(step, Align):
            direction = np.array([np.cos(step.angle), np.sin(step.angle)])
            return np.broadcast_to(step.magnitude * direction[:, None, None], state.shape).copy()
        assert isinstance(step, Fragment | Noise)
        sequence = np.random.SeedSequence(self.protocol.seed, spawn_key=(step.seed or 0,))
        drawn = initial.standard_noise(self.grid, np.random.default_rng(sequence), step.noise_grid)
        if isinstance(step, Fragment):
            return _bounded(drawn * np.sqrt(0.5 / step.filaments_per_square))
        return _bounded(state + step.size * drawn)

    def _stages(self) -> list[Stage]:
        current: dict[str, Any] = dict(self.params.items())
        ramps: dict[str, tuple[float, float, Any, Any]] = {}
        changed, spread = set[str](), set[str]()
        out = [Stage(self.params, self.params, {}, frozenset())]
        for time in self.times:
            for name in [name for name, ramp in ramps.items() if ramp[1] <= time]:
                current[name] = ramps.pop(name)[3]
            for step in (step for step in self.protocol if step.at == time):
                if isinstance(step, Change):
                    changed |= dict(step.values).keys()
                    spread |= dict(step.values).keys() if step.where is not None else set()
                for name, target in self._targets(step, current, changed).items():
                    if getattr(step, "over", 0.0) and name != "zero_theta_flux":
                        ramps[name] = (step.at, step.until, current[name], target)
                    else:
                        current[name] = target
            first = self.params.replace(**(current | {name: ramp[2] for name, ramp in ramps.items()}))
            last = first.replace(**{name: ramp[3] for name, ramp in ramps.items()})
            out.append(Stage(first, last, {n: r[:2] for n, r in ramps.items()}, frozenset(spread)))
        return out

    def _targets(self, step: Step, current: dict[str, Any], changed: set[str]) -> dict[str, Any]:
        """Return the values to which a step takes parameters, by name."""
        if isinstance(step, WashOut):
            return {name: getattr(self.params, name) for name in sorted(changed)}
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


def _bounded(P: Array) -> Array:
    """Return a state with |P| scaled back to 1 where it is larger."""
    bounded: Array = P / np.maximum(np.hypot(*P), 1.0)
    return bounded
