"""Steady and steadily drifting states of the one-dimensional equation, by Newton's method.

The unknowns are y and c in dy/dt + c y' = 0: the state moves at speed c without changing. Where y varies,
its position is fixed by requiring that it has not moved from the first guess, <y', y - guess> = 0.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...dynamics.advance import Control, advance, start
from ...model.grid import Array
from ...model.precision import on_host
from ...models import polar
from .reduced import Reduced

RTOL, ATOL = 1e-4, 1e-10
MOST_STEPS = 1_000_000


@dataclass(frozen=True, eq=False)
class Relaxed:
    """A state (2n,) after some time, and its relative rate of change there."""

    y: Array
    rate: float
    failed: bool


def relax(problem: Reduced, y: Array, duration: float) -> Relaxed:
    """Integrate dy/dt over `duration` (dimensionless), with the default tolerances of `simulate`."""
    control = Control.of(RTOL, ATOL, polar.bound)
    packed = problem.packed(y).reshape(problem.line.space.shape)
    with on_host():
        began = start(problem.line, packed, np.float64(0.0))
        end = advance(problem.line, control, began, np.float64(duration), np.int64(MOST_STEPS))
    return Relaxed(problem.from_packed(np.asarray(end.spectrum).ravel()), float(end.rate), bool(end.failed))


TOLERANCE = 1e-10
"""Root mean square of dy/dt + c y' below which a state counts as found; rounding leaves about 1e-15."""
UNIFORM = 1e-7
"""Root mean square slope, relative to the state, below which it counts as uniform and c as zero."""
LONGEST = 0.3
"""Root mean square length of the longest step, which keeps Newton's method near its guess."""


@dataclass(frozen=True, eq=False)
class Steady:
    """A state y (2n,) that moves at speed `drift` (dimensionless) along its direction, or is at rest."""

    y: Array
    drift: float
    uniform: bool
    residual: float


def steady(problem: Reduced, guess: Array, iterations: int = 12) -> Steady | None:
    """Return the steady state next to a guess (2n,), or None where Newton's method finds none there."""
    y, drift = guess.copy(), 0.0
    slope = problem.slope(guess)
    uniform = rms(slope) <= UNIFORM * max(rms(guess), 1e-12)
    for _ in range(iterations):
        residual = problem.rate(y) + (0.0 if uniform else drift * problem.slope(y))
        size = rms(residual)
        if size < TOLERANCE:
            return Steady(y, drift, uniform, size)
        step, faster = _newton(problem, y, drift, residual, slope, guess, uniform)
        if not np.all(np.isfinite(step)) or rms(step) > LONGEST:
            return None
        y, drift = y + step, drift + faster
    return None


def _newton(
    problem: Reduced, y: Array, drift: float, residual: Array, slope: Array, guess: Array, uniform: bool
) -> tuple[Array, float]:
    jacobian = problem.jacobian(y)
    try:
        if uniform:
            return np.asarray(-np.linalg.solve(jacobian, residual), dtype=np.float64), 0.0
        size = y.size
        bordered = np.zeros((size + 1, size + 1))
        bordered[:size, :size] = jacobian + drift * problem.derivative
        bordered[:size, size] = problem.slope(y)
        bordered[size, :size] = slope
        right = np.append(residual, slope @ (y - guess))
        solution = np.asarray(-np.linalg.solve(bordered, right), dtype=np.float64)
    except np.linalg.LinAlgError:
        return np.full(y.size, np.nan), 0.0
    return solution[:-1], float(solution[-1])


def rms(y: Array) -> float:
    """Return the root mean square of |P| over the points of y (2n,)."""
    return float(np.sqrt(2.0 * np.mean(y**2)))
