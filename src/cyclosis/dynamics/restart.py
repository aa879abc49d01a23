"""What a run needs to continue bit for bit as if it had never stopped."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import jax.numpy as jnp
import numpy as np
import numpy.typing as npt

from ..display.shown import shown
from .advance import StepperState


@shown
@dataclass(frozen=True, eq=False)
class Restart:
    """The stepper's whole state, and what the run has found so far.

    `progress` holds the fields of `StepperState` (spectral state, its nonlinear part, step control and
    counters) by name; `sign_time` and `sign` the first sign of an underresolved run; `wall_time` the
    seconds spent; `done` the number of the protocol's events that are done.
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
        arrays = {name: np.asarray(value) for name, value in now._asdict().items()}
        return cls(arrays, sign_time, sign, wall_time, done)

    def to_stepper_state(self) -> StepperState:
        """Return the `StepperState` to continue from; call in double precision."""
        # A run that an earlier version stored lacks some fields: they get their defaults.
        whole = StepperState(**self.progress)._asdict()
        return StepperState(**{name: jnp.asarray(value) for name, value in whole.items()})
