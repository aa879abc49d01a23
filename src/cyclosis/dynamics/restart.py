"""What a run needs to go on bitwise as if it had never stopped."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import jax.numpy as jnp
import numpy as np
import numpy.typing as npt

from .advance import Progress


@dataclass(frozen=True, eq=False)
class Restart:
    """The stepper's whole state, and what the run has noticed so far.

    `progress` holds the fields of `Progress` (spectral state, its nonlinear part, step control and
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
        cls, now: Progress, sign_time: float | None, sign: str, wall_time: float, done: int = 0
    ) -> Restart:
        """Return the restart of a running calculation."""
        arrays = {name: np.asarray(value) for name, value in now._asdict().items()}
        return cls(arrays, sign_time, sign, wall_time, done)

    def to_progress(self) -> Progress:
        """Return the `Progress` to go on from; call in double precision."""
        return Progress(**{name: jnp.asarray(value) for name, value in self.progress.items()})
