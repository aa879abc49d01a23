"""The parameters between two events of a protocol, and how each event leads from one stage to the next."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..model.regions import Mask
from .protocol import Change, Step, WashOut


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


Ramp = tuple[float, float, Any, Any]
"""When a ramp begins and ends, and the values of its parameter then."""


@dataclass(frozen=True, eq=False)
class Values:
    """A stage, and what the next event needs to know besides.

    `current` gives the parameters apart from the active `ramps`, and `changed` names those that any step has
    changed so far. What an event leaves as it was is shared with the stage before, not copied.
    """

    stage: Stage
    current: dict[str, Any]
    ramps: dict[str, Ramp]
    changed: frozenset[str]

    @classmethod
    def of(cls, params: Any) -> Values:
        """Return the stage before the first event."""
        return cls(Stage(params, params, {}, frozenset()), dict(params.items()), {}, frozenset())

    def after(self, time: float, due: Iterable[tuple[Step, Mask | None]], original: Any) -> Values:
        """Return the stage after the event at a time.

        `due` are the steps at that time with their regions; `original` are the parameters before all steps.
        """
        current, ramps = dict(self.current), dict(self.ramps)
        changed, spread = set(self.changed), set(self.stage.fields)
        for name in [name for name, ramp in ramps.items() if ramp[1] <= time]:
            current[name] = ramps.pop(name)[3]
        for step, mask in due:
            if isinstance(step, Change):
                changed |= dict(step.values).keys()
                spread |= dict(step.values).keys() if step.where is not None else set()
            for name, target in _targets(step, mask, current, original, changed).items():
                if getattr(step, "over", 0.0) and name != "zero_theta_flux":
                    ramps[name] = (step.at, step.until, current[name], target)
                else:
                    current[name] = target
        first = self.stage.first.replace(**(current | {name: ramp[2] for name, ramp in ramps.items()}))
        last = first.replace(**{name: ramp[3] for name, ramp in ramps.items()}) if ramps else first
        # What is kept are the arrays of the parameters themselves, so that none is held twice.
        current |= {name: getattr(first, name) for name in current.keys() - ramps.keys()}
        ramps = {n: (*ramp[:2], getattr(first, n), getattr(last, n)) for n, ramp in ramps.items()}
        moving = {name: ramp[:2] for name, ramp in ramps.items()}
        return Values(Stage(first, last, moving, frozenset(spread)), current, ramps, frozenset(changed))


def _targets(
    step: Step, mask: Mask | None, current: dict[str, Any], original: Any, changed: set[str]
) -> dict[str, Any]:
    """Return the values to which a step takes parameters, by name."""
    if isinstance(step, WashOut):
        return {name: getattr(original, name) for name in sorted(changed)}
    if not isinstance(step, Change):
        return {}
    return {
        name: value if mask is None else np.where(mask, value, current[name]) for name, value in step.values
    }
