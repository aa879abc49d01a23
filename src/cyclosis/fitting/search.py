"""The most probable run behind a film: damped Gauss-Newton steps, first to its early frames, then to all.

Half of

    Σ (u_model - u)²/(σ² + b²) + Σ (x - x_0)²/s²

is minimised over the unknowns of a `Problem`, with prior means x_0 and deviations s. The Jacobian is exact
(forward differentiation), because gradients alone (L-BFGS) need thousands of runs: the combinations of
parameters differ by a factor 100 in how well they are known.

`approached` comes near the minimum. Where P has saturated its size does not tell what it was before, so that
frames are added bit by bit: from those in which u is first seen, and disorder still grows, to the last one.
The blur b stays at a share of the peak, and the parameters near their means. A start from which the film is
not matched is given up.

`ended` goes to the minimum with the whole film and the noise as it is. The amplitudes a and the width K of
the prior of P, s_k = a exp(-k²/2K²), are those of the largest evidence there: the probability of the film
with the unknowns integrated out, in the normal approximation. Each component of P has its own amplitude:
while disorder orders, repulsion damps one of them, and all waves of both grow or decay as
exp(-(d_s k² + ...)t).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from ..model.grid import Array
from .problem import Mask, Problem

BLUR = 1 / 16
"""The blur, as a share of the peak of u."""
SPAN = 1.0
"""Time in R/U after u is first seen that the first stage follows; each later one follows twice as much."""
NARROW = 0.5
"""Prior deviation of the logarithms of parameters while the end is approached."""
WIDTH = 2.0
"""Wave number at which the prior of P begins to fall off, before the film has told it."""
UNUSED = 0.03
"""Prior deviation of a wave, as a share of the largest, below which it is left out of the approach."""
LEFT, CHANCE = 0.05, 4.0
"""What χ²/N of an approach may exceed 1 by: a share for the prior that is not yet known, and standard
deviations for chance."""
TRIES, MOST, EARLY = 8, 15, 8
"""Damped trials per step, and most steps in a stage of the end and of the approach."""
CLOSE, CLOSED = 0.5, 1e-3
"""Expected gains at which a stage and the last one end: twice this is the squared distance to the
minimum in standard deviations."""
STALE, WORTH, AIM = 8, 0.3, 0.1
"""Most steps with the same slopes, the share of the expected gain below which these are computed again, and
how much closer than necessary such steps come, so that new slopes find the end."""
DAMPING = 1e-2, 1e-4
"""Damping of the first step of all, and of the first step of each later stage."""
LEAP = 0.7
"""Largest change of the logarithm of a parameter in one step."""
WIDTHS, SIZES = (1.0, 4.0), (0.003, 0.5)
"""Bounds of K, in waves per radian, and of the root mean square of P by the prior."""
Slopes = tuple[Array, Array, Array]
"""The slopes, the misfit and x - x_0 at a point."""


@dataclass(frozen=True, eq=False)
class Found:
    """The end of a search: `x`, the covariance of the logarithms, the misfit, and what x took of N values.

    `short` is the gain that one more step was expected to bring: the search has ended where it is small.
    `evidence` is the logarithm of that of the film, apart from a constant, and `gain` (logs, values)
    takes what is added to the misfit to what it moves.
    """

    x: Array
    covariance: Array
    left: Array
    effective: float
    short: float
    sizes: Array
    width: float
    evidence: float
    gain: Array


@dataclass(frozen=True, eq=False)
class Near:
    """The end of an approach: `y`, the deviations of its prior, stages that were passed, χ²/N of the last.

    It `fits` if all frames were matched.
    """

    y: Array
    scale: Array
    stages: int
    ratio: float
    fits: bool


def approached(
    problem: Problem,
    y: Array,
    sizes: Array,
    told: Callable[[], None],
    *,
    patient: bool = False,
) -> Near:
    """Return unknowns near the most probable ones, in y. Unless it is `patient` it may give up before."""
    later = problem.later()
    scale = later.scale(sizes, WIDTH)
    scale[: later.logs] = NARROW
    used = scale > UNUSED * scale[later.logs :].max(initial=0.0)
    blurred = 1 / np.sqrt(1 + (BLUR * problem.peak) ** 2)
    span, stage, last = SPAN, 0, float(problem.since.max(initial=0.0))
    while True:
        weight = np.where(problem.since <= span + 1e-9, blurred, 0.0)
        y, (_, left, _) = _descended(later, y, scale, weight, used, CLOSE, DAMPING[bool(stage)], EARLY, told)
        ratio = float((left**2 * problem.alike).sum() / (weight**2).sum())
        count = np.count_nonzero(weight) / float(problem.alike.max())
        fits = ratio < 1 + LEFT + CHANCE * np.sqrt(2 / count)
        if span >= last or not (fits or patient):
            return Near(y, scale, stage, ratio, bool(fits))
        # A last stage that would add little is joined to the one before.
        span, stage = 2 * span if 2.5 * span < last else last, stage + 1


def ended(
    problem: Problem,
    x: Array,
    sizes: Array,
    width: float,
    told: Callable[[], None],
    *,
    known: bool = False,
) -> Found:
    """Return the most probable unknowns, from x near them and a prior, which is final if it is `known`."""
    used, whole = np.ones(x.size, bool), np.ones(problem.peak.size)
    for again in range(1 if known else 3):
        scale = problem.scale(sizes, width)
        close = CLOSE if again < 2 and not known else CLOSED
        x, parts = _descended(problem, x, scale, whole, used, close, DAMPING[1], MOST, told)
        if again < 2 and not known:
            sizes, width = _evident(problem, parts, sizes, width)
    slopes, left, away = parts
    white = scale[:, None] * slopes
    hessian = white @ white.T + np.eye(x.size)
    inverse: Array = np.asarray(np.linalg.inv(hessian), np.float64)
    slope = white @ left + away / scale
    n = problem.logs
    return Found(
        x,
        inverse[:n, :n],
        left,
        float(x.size - np.trace(inverse)),
        0.5 * float(slope @ inverse @ slope),
        sizes,
        width,
        -0.5 * float(left @ left + ((away / scale) ** 2).sum() + np.linalg.slogdet(hessian)[1]),
        -(inverse[:n] @ white),
    )


def _descended(
    problem: Problem,
    x: Array,
    scale: Array,
    weight: Array,
    used: Mask,
    close: float,
    damping: float,
    most: int,
    told: Callable[[], None],
) -> tuple[Array, Slopes]:
    """Return the minimum of one stage, and what was last known of it."""
    mean = problem.mean

    def cost(x: Array) -> tuple[Array, float]:
        left = problem.misfit(x) * weight
        with np.errstate(over="ignore", invalid="ignore"):  # a run that diverges counts as infinitely far
            square = float(left @ left)
        value = 0.5 * square + 0.5 * float((((x - mean) / scale) ** 2).sum())
        return left, value if np.isfinite(value) else np.inf

    left, value = cost(x)
    for _ in range(most):
        slopes = problem.jacobian(x, used) * weight
        told()
        white = scale[:, None] * slopes
        square = white @ white.T
        hessian = square + np.eye(x.size)
        begun = x
        # Slopes change little along the last steps and cost as much as many runs: they serve several steps.
        for again in range(STALE):
            slope = white @ left + (x - mean) / scale
            expected = 0.5 * float(slope @ np.linalg.solve(hessian, slope))
            if expected < (AIM if again else 1.0) * close:
                break
            for _ in range(1 if again else TRIES):
                step = -np.linalg.solve(hessian + damping * np.diag(np.diag(square)), slope)
                step *= min(1.0, LEAP / max(float(np.abs(step[: problem.logs]).max(initial=0.0)), 1e-12))
                there, after = cost(x + scale * step)
                if after < value:
                    break
                damping *= 8
            else:
                break
            gained = value - after
            x, left, value, damping = x + scale * step, there, after, max(damping / 5, 1e-9)
            if gained < WORTH * expected:
                break
        if x is begun:
            break
    return x, (slopes, left, x - mean)


def _evident(problem: Problem, parts: Slopes, sizes: Array, width: float) -> tuple[Array, float]:
    """Return the sizes and the width of the prior of P with the largest evidence, linearised here."""
    from scipy.optimize import minimize

    slopes, left, away = parts
    square = slopes @ slopes.T
    pull = slopes @ (slopes.T @ away - left)

    def against(logs: npt.NDArray[np.float64]) -> float:
        scale = problem.scale(np.exp(logs[:-1]), float(np.exp(logs[-1])))
        white = scale[:, None] * square * scale + np.eye(scale.size)
        root = np.linalg.cholesky(white)
        solved = np.linalg.solve(root, scale * pull)
        return float(np.log(np.diag(root)).sum() - 0.5 * solved @ solved)

    bounds = [tuple(np.log(SIZES))] * problem.components + [tuple(np.log(WIDTHS))]
    begin = np.clip(np.log([*sizes, width]), *np.transpose(bounds))
    options: Any = {"maxfev": 60 * len(bounds), "xatol": 0.02, "fatol": 0.05}
    found = minimize(against, begin, method="Nelder-Mead", bounds=bounds, options=options)
    *found_sizes, found_width = np.exp(found.x)
    return np.array(found_sizes), float(found_width)
