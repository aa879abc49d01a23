"""Solving with more and more modes until the answer no longer changes."""

from __future__ import annotations

from collections.abc import Callable

from ..model.errors import InputError

SIZES = ((8, 16), (12, 24), (18, 36), (27, 54), (40, 80))
"""Waves around the axis and radial degrees, tried in this order."""
CLOSE = 1e-5
"""Relative change at which an answer is taken."""
ENOUGH = 1e-3
"""Relative change that is accepted between the last two sizes."""


def refined(solve: Callable[[tuple[int, int]], float], peclet: float) -> float:
    """Return `solve(size)` with the first of `SIZES` that changes it by less than `CLOSE`.

    Raises `InputError` if even the last one changes it by more than `ENOUGH`.
    """
    before = solve(SIZES[0])
    for size in SIZES[1:]:
        now = solve(size)
        change = abs(now - before) / max(abs(now), 1e-300)
        if change < CLOSE:
            return now
        before = now
    if change > ENOUGH:
        rule = f"low enough for {SIZES[-1][0]} waves around the axis to resolve its layers"
        raise InputError("peclet", peclet, rule, "lower it, or use cyclosis.vacuole.transport on many points")
    return now
