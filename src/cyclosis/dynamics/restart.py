"""What a run needs to continue bit for bit as if it had never stopped."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import numpy.typing as npt

from ..display.shown import shown
from .advance import StepperState
from .multistep import Past

PAST = "past_"
"""How the names of what a multistep method remembers begin."""


@shown
@dataclass(frozen=True, eq=False)
class Restart:
    """The stepper's whole state, and what the run has found so far.

    `progress` holds the fields of `StepperState` (spectral state, its nonlinear part, step control and
    counters) by name, and the `Past` of a multistep method as past_times, past_modes and past_local;
    `sign_time` and `sign` the first sign of an underresolved run; `wall_time` the seconds spent; `done` the
    number of the protocol's events that are done.
    """

    progress: dict[str, npt.NDArray[Any]]
    sign_time: float | None
    sign: str
    wall_time: float
    done: int = 0

    @property
    def t(self) -> float:
        """The time reached, dimensionless."""
        return float(self.progress["t"])

    @classmethod
    def of(
        cls, now: StepperState, sign_time: float | None, sign: str, wall_time: float, done: int = 0
    ) -> Restart:
        """Return the restart of a run."""
        whole = now._asdict()
        if (past := whole.pop("past")) is not None:
            whole |= {PAST + name: value for name, value in past._asdict().items()}
        arrays = {name: np.asarray(value) for name, value in whole.items()}
        return cls(arrays, sign_time, sign, wall_time, done)

    def to_stepper_state(self) -> StepperState:
        """Return the `StepperState` to continue from; call in double precision."""
        own, past = dict(self.progress), {}
        for name in [name for name in own if name.startswith(PAST)]:
            past[name.removeprefix(PAST)] = own.pop(name)
        # A run that an earlier version stored lacks some fields: they get their defaults.
        now = StepperState(**own, past=Past(**past) if past else None)
        return jax.tree.map(jnp.asarray, now)
