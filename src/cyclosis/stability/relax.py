"""The one-dimensional equation in time, by the time stepper of the whole cell."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..dynamics.advance import Control, advance, start
from ..model.grid import Array
from ..model.precision import on_host
from .reduced import Reduced

RTOL, ATOL = 1e-4, 1e-10
MOST_STEPS = 1_000_000


@dataclass(frozen=True, eq=False)
class Relaxed:
    """Where a state (2n,) has got to after a time, and its relative rate of change there."""

    y: Array
    rate: float
    failed: bool


def relax(problem: Reduced, y: Array, duration: float) -> Relaxed:
    """Integrate dy/dt over `duration` (dimensionless), with the default tolerances of `simulate`."""
    control = Control(*(np.float64(x) for x in (RTOL, ATOL, 0.1, -1.0)))
    spectrum = problem.packed(y).reshape(problem.line.space.shape)
    with on_host():
        began = start(problem.line, spectrum, np.float64(0.0))
        end = advance(problem.line, control, began, np.float64(duration), np.int64(MOST_STEPS))
    return Relaxed(problem.from_packed(np.asarray(end.spectrum).ravel()), float(end.rate), bool(end.failed))
