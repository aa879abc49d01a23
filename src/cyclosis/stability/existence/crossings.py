"""On one grid: the α_u at which two equal stripes cease to exist, or to be stable against unequal widths.

Existence. With the amplitude b of the branch (twice the first sine coefficient of P) as its coordinate,
α_u(b) is a smooth function, with or without a fold. For α_p < d_r + d_s the branch comes down from large α_u
and turns back at a fold, dα_u/db = 0, of finite amplitude.

Stability. The threshold is where the growth rate λ of unequal widths passes through zero, or the fold if
λ < 0 there already. Where λ is small it is not computed as an eigenvalue, but by

    λ(α_u) = λ(0) + ∫ dλ/dα_u     from 0 to α_u

with λ(0) in closed form (`elliptic`) and dλ/dα_u from eigenvectors (`equal`). Both are accurate to all
digits, and so is the zero of their sum, however far λ itself is below the rounding error of eigenvalues.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.optimize import brentq

from ...model.definitions import definition
from ...model.errors import InputError
from ..profiles.elliptic import elliptic_growth, front_threshold
from .equal import OWN, WIDTHS, Equal, EqualStripes
from .fastest_growing import CAUSES

NEAR = 1.2
"""Up to this multiple of d_r + d_s in α_p the branch is parametrised by its amplitude."""
SMALL = 1e-3
"""Growth rates at α_u = 0 below this are continued by their derivative."""
MOST = definition("parameters", "alpha_u").maximum
RELATIVE = 1e-12
"""Relative effect of rounding on α_u, apart from its effect on eigenvalues."""
DOWN = 0.94
"""Ratio of each amplitude on the way down to the one before."""
LEAST = 1e-3
"""Least amplitude to which the branch is continued."""


class Found(NamedTuple):
    """A zero on one grid: its α_u, its rounding error, what ends there, and the state."""

    alpha_u: float
    rounding: float
    cause: str
    state: Equal


def stable_from(problem: EqualStripes) -> Found:
    """Return where the growth of unequal widths ends, or the fold; raises `InputError` without either."""
    params = problem.params
    if params.alpha_p <= NEAR * (params.d_r + params.d_s * (problem.count / 2) ** 2):
        return _down(problem, True)
    at_rest = elliptic_growth(params, problem.count)
    return continued(problem) if at_rest < SMALL else directly(problem)


def existing_from(problem: EqualStripes) -> Found:
    """Return the fold of the branch. Raises `InputError` if there is none."""
    return _down(problem, False)


def directly(problem: EqualStripes) -> Found:
    """Return the zero of λ(α_u) as an eigenvalue; it is positive at α_u = 0."""
    low, high = 0.0, 2 * front_threshold(problem.params, problem.count)
    state = problem.full(0.0)
    while problem.leading(state := problem.steady(high, state.P), WIDTHS).rate > 0:
        low, high = high, 2 * high
        if high > MOST:
            raise _never(problem)

    def rate(alpha_u: float) -> float:
        return problem.leading(problem.steady(alpha_u, state.P), WIDTHS).rate

    found = float(brentq(rate, low, high, xtol=1e-15, rtol=1e-14))
    there = problem.steady(found, state.P)
    last = problem.sloping(there, WIDTHS)
    return Found(found, RELATIVE * found + 4 * last.rounding / abs(last.slope), CAUSES[WIDTHS], there)


def continued(problem: EqualStripes) -> Found:
    """Return the zero of λ(0) + ∫ dλ/dα_u, by Newton's method and Gauss's rule."""
    still = problem.full(0.0)
    at_rest = elliptic_growth(problem.params, problem.count)

    def average(alpha_u: float, order: int) -> float:
        nodes, weights = np.polynomial.legendre.leggauss(order)
        slopes = [
            problem.sloping(problem.steady(x, still.P), WIDTHS).slope for x in alpha_u * (nodes + 1) / 2
        ]
        return float(weights @ slopes) / 2

    alpha_u = -at_rest / problem.sloping(still, WIDTHS).slope
    for _ in range(4):
        # The average changes little with α_u, so that this is nearly Newton's method.
        before, alpha_u = alpha_u, -at_rest / average(alpha_u, 3)
        if abs(alpha_u - before) < 1e-6 * alpha_u:
            break
    better = -at_rest / average(alpha_u, 5)
    there = problem.steady(better, still.P)
    return Found(better, abs(better - alpha_u) + RELATIVE * better, CAUSES[WIDTHS], there)


def _down(problem: EqualStripes, stable: bool) -> Found:
    """Continue the branch down from large α_u to its fold or, if `stable`, to λ > 0, whichever is first."""
    state = _somewhere(problem, stable)
    amplitude = problem.amplitude(state.P)
    state = problem.at_amplitude(amplitude, state)
    while amplitude > LEAST:
        lower = DOWN * amplitude
        below = problem.at_amplitude(lower, state)
        ends = []
        if below.slope < 0:
            ends.append(_fold(problem, lower, amplitude, below))
        if stable and problem.leading(below, WIDTHS).rate > 0:
            ends.append(_crossing(problem, lower, amplitude, below))
        if ends:
            return max(ends, key=lambda end: problem.amplitude(end.state.P))
        amplitude, state = lower, below
    rule = "farther from d_r + d_s, where the fold has a finite amplitude"
    raise InputError("alpha_p", problem.params.alpha_p, rule, "set it to d_r + d_s exactly")


def _somewhere(problem: EqualStripes, stable: bool) -> Equal:
    """Return a state of full order at an α_u of 1 or more, `stable` or any; raises `InputError` if none."""
    alpha_u = 1.0
    while True:
        try:
            state = problem.full(alpha_u)
            if not stable or problem.leading(state, WIDTHS).rate < 0:
                return state
        except InputError:
            if alpha_u > MOST / 2:
                raise
        alpha_u *= 2
        if alpha_u > MOST:
            raise _never(problem)


def _never(problem: EqualStripes) -> InputError:
    rule = f"where some alpha_u stabilises {problem.count} stripes, and here none does"
    return InputError("the parameter point", problem.point, rule, "lower mu")


def _fold(problem: EqualStripes, low: float, high: float, near: Equal) -> Found:
    def slope(amplitude: float) -> float:
        return problem.at_amplitude(amplitude, near).slope

    there = problem.at_amplitude(float(brentq(slope, low, high, xtol=1e-12, rtol=1e-12)), near)
    return Found(there.alpha_u, RELATIVE * there.alpha_u, CAUSES[OWN], there)


def _crossing(problem: EqualStripes, low: float, high: float, near: Equal) -> Found:
    def rate(amplitude: float) -> float:
        return problem.leading(problem.at_amplitude(amplitude, near), WIDTHS).rate

    there = problem.at_amplitude(float(brentq(rate, low, high, xtol=1e-13, rtol=1e-13)), near)
    steep = (rate(high) - rate(low)) / (high - low)
    rounding = 4 * problem.leading(there, WIDTHS).rounding * abs(there.slope / steep)
    return Found(there.alpha_u, RELATIVE * there.alpha_u + rounding, CAUSES[WIDTHS], there)
