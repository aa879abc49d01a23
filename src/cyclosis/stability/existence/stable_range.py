"""The range of α_u in which two equal stripes are stable to all perturbations, found by stepping upwards."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.optimize import brentq

from ...model.errors import InputError
from .crossings import Found
from .equal import Equal, EqualStripes
from .fastest_growing import Growth, Perturbations

STEP = 1.3
"""Ratio of each α_u examined to the one before."""
FIRST = 0.01
"""Least α_u of the first step."""
HIGHEST = 30.0
"""Largest α_u examined."""


class Bracket(NamedTuple):
    """An interval of α_u in which a growth rate changes sign, the perturbation, and a state there."""

    low: float
    high: float
    growth: Growth
    near: Equal
    length: float


def opening(problem: EqualStripes, lowest: Found, length: float) -> Bracket | None:
    """Return where the last perturbation stops growing, or None where that is the threshold `lowest`.

    Raises `InputError` where some perturbation grows at every larger α_u.
    """
    there = Perturbations(problem, lowest.state, length)
    last = there.growing(but=lowest.cause)
    if last is None:
        return None
    state, low = lowest.state, lowest.alpha_u
    for alpha_u in _steps(low, HIGHEST):
        state = problem.steady(alpha_u, state.P)
        now = Perturbations(problem, state, length).growing()
        if now is None:
            return Bracket(low, alpha_u, last, state, length)
        low, last = alpha_u, now
    point = f"{problem.point}, kappa = {problem.params.kappa:g}, epsilon = {problem.params.epsilon:g}"
    rule = f"where two stripes are stable at some alpha_u, and {last.cause} grows at all up to {HIGHEST:g}"
    raise InputError("the parameter point", point, rule, "raise kappa, or set full=False")


def closing(problem: EqualStripes, start: float, most: float, length: float) -> Bracket | None:
    """Return where the first perturbation begins to grow above `start`, or None if none does up to `most`.

    Raises `InputError` if some perturbation grows at `start`.
    """
    state, low = problem.full(start), start
    begun = Perturbations(problem, state, length).growing()
    if begun is not None:
        raise InputError("start", start, f"where two stripes are stable, and {begun.cause} grows", "raise it")
    for alpha_u in _steps(start, most):
        before, state = state, problem.steady(alpha_u, state.P)
        now = Perturbations(problem, state, length).growing()
        if now is not None:
            return Bracket(low, alpha_u, now, before, length)
        low = alpha_u
    return None


def zero(problem: EqualStripes, bracket: Bracket) -> Found:
    """Return the α_u in an interval at which its growth rate vanishes."""
    near = bracket.near
    if near.P.size != problem.n:
        near = problem.full(near.alpha_u)

    def rate(alpha_u: float) -> float:
        there = Perturbations(problem, problem.steady(alpha_u, near.P), bracket.length)
        return there.rate(bracket.growth)

    ends = rate(bracket.low), rate(bracket.high)
    slope = (ends[1] - ends[0]) / (bracket.high - bracket.low)
    found = float(brentq(rate, bracket.low, bracket.high, xtol=1e-12, rtol=1e-10))
    scale = float(problem.params.d_s * problem.n**2 + problem.params.alpha_p + found)
    rounding = 1e-10 * found + np.finfo(float).eps * scale / abs(slope)
    return Found(found, float(rounding), bracket.growth.cause, problem.steady(found, near.P))


def _steps(low: float, high: float) -> list[float]:
    first = max(low * STEP, FIRST)
    count = int(np.ceil(np.log(max(high / first, 1.0)) / np.log(STEP)))
    return [min(first * STEP**k, high) for k in range(count + 1) if first < high]
