"""The signs that a grid does not resolve the state on it."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from ..contract.model import Problem
from ..model.wording import beside
from .settings import Settings
from .steppers import METHODS


class Watch:
    """The first sign of an under-resolved run: a heavy spectral tail or an overshoot of |P| = 1."""

    def __init__(self, problem: Problem, system: object, settings: Settings) -> None:
        self.problem = problem
        self.patience = problem.model.decay_time(system)
        self.blind_until = 0.0
        # Steps of finite accuracy may overshoot by about their tolerance; more is due to the grid.
        self.overshoot = 1.0 + 1e-6 + (settings.rtol if METHODS[settings.stepper].adaptive else 0.0)
        self.time: float | None = None
        self.sign = ""

    def disturbed(self, t: float, system: object) -> None:
        """Ignore signs until the noise and sharp edges that an intervention left have diffused."""
        self.blind_until = self.patience = t + self.problem.model.decay_time(system)

    def look(self, t: float, tails: Mapping[str, Any], peak: float) -> None:
        """Check a recorded instant, its tails by name and max |P|, and keep the first sign."""
        if self.time is not None or t < self.blind_until:
            return
        heavy = (
            (name, float(tails[name]), limit)
            for name, limit in self.problem.model.tails.items()
            if tails[name] > limit
        )
        name, tail, limit = next(heavy, ("", 0.0, 0.0))
        if t >= self.patience and name:
            found = beside(tail, limit, 2)
            self.time, self.sign = t, f"{_beginning(name)} {found} (limit {limit:g})"
        elif peak > self.overshoot:
            self.time, self.sign = t, f"|P| overshoots 1 by {peak - 1:.1e}"


def remedy(problem: Problem, sign: str) -> str | None:
    """Return what a sign calls for, if its tail has a remedy of its own."""
    own = problem.model.remedies.items()
    return next((words for name, words in own if sign.startswith(_beginning(name))), None)


def _beginning(name: str) -> str:
    return f"the {name.replace('_', ' ')} is"
