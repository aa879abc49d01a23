"""The most probable run behind a film: damped Gauss-Newton steps, first to a blurred likelihood, then to it.

The unknowns x are logarithms of parameters and Fourier coefficients of P at the first frame, with a Gaussian
prior of mean x_0 and deviations s. Half of

    Σ (u_model - u)²/(σ² + b²) + Σ (x - x_0)²/s²

is minimised for b that falls to 0: with a large b the first steps see the large streams only, and do not
follow the noise of early frames into a wrong state. The Jacobian is exact (forward differentiation), because
gradients alone (L-BFGS) need thousands of runs: the combinations of parameters differ by a factor 100 in how
well they are known.

The amplitudes a and the width K of the prior of P, s_k = a exp(-k²/2K²), are those of the largest evidence:
the probability of the film with the unknowns integrated out, in the normal approximation. Each component of P
has its own amplitude: while disorder orders, repulsion damps one of them, and all waves of both grow or decay
as exp(-(d_s k² + ...)t).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from ..model.grid import Array

BLUR, FALL = 0.25, 4.0
"""The first blur, as a share of the peak of u, and the factor by which it falls from stage to stage."""
TRIES, MOST = 8, 15
"""Damped trials per step, and steps in a stage."""
CLOSE, CLOSED = 0.5, 1e-3
"""Expected gains at which a blurred stage and the last one end: twice this is the squared distance to the
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


@dataclass(frozen=True, eq=False)
class Problem:
    """What is minimised: `misfit(x)` is (u_model - u)/σ, `jacobian(x)` its slopes, one row per unknown.

    The first `logs` unknowns have the prior mean `begin` and deviation 1, all others mean 0. `squares` are
    k² of those, `weights` the mean square of their waves, 1 or 1/2 or 1/4, and `component` (0, 1, ...) says
    to which component of P they belong. `peak` is that of u in σ.
    """

    misfit: Callable[[Array], Array]
    jacobian: Callable[[Array], Array]
    begin: Array
    squares: Array
    weights: Array
    component: npt.NDArray[np.intp]
    peak: Array

    @property
    def logs(self) -> int:
        """The number of parameters."""
        return self.begin.size

    @property
    def components(self) -> int:
        """The number of components of P."""
        return int(self.component.max()) + 1

    def scale(self, sizes: Array, width: float) -> Array:
        """Return the deviations of all unknowns.

        `sizes` are the root mean squares of the components of P, and `width` is up to where waves reach.
        """
        fall = np.exp(-self.squares / (2 * width**2))
        power = np.bincount(self.component, self.weights * fall**2)
        return np.concatenate([np.ones(self.logs), fall * (sizes / np.sqrt(power))[self.component]])


@dataclass(frozen=True, eq=False)
class Found:
    """The end of a search: `x`, the covariance of the logarithms, the misfit, and what x took of N values.

    `short` is the gain that one more step was expected to bring: the search has ended where it is small.
    """

    x: Array
    covariance: Array
    left: Array
    effective: float
    short: float
    sizes: Array
    width: float


def search(
    problem: Problem,
    x: Array,
    sizes: Array,
    width: float,
    told: Callable[[], None],
    *,
    blurred: bool = True,
) -> Found:
    """Return the most probable unknowns, from x and the prior of some sizes and a width.

    Without `blurred` x is taken to be near them.
    """
    mean = np.concatenate([problem.begin, np.zeros(x.size - problem.logs)])
    scale = problem.scale(sizes, width)
    for stage, blur in enumerate(_blurs(problem.peak)[0 if blurred else -1 :]):
        weight = 1 / np.sqrt(1 + blur**2)
        last = not np.any(blur)
        for again in range(2 if last else 1):
            x, parts = _descended(
                problem, x, mean, scale, weight, CLOSED if last else CLOSE, DAMPING[bool(stage)], told
            )
            if stage and not again:
                sizes, width = _evident(problem, parts, sizes, width)
                scale = problem.scale(sizes, width)
    slopes, left, _ = parts
    white = scale[:, None] * slopes
    hessian = white @ white.T + np.eye(x.size)
    inverse: Array = np.asarray(np.linalg.inv(hessian), np.float64)
    slope = white @ left + (x - mean) / scale
    n = problem.logs
    return Found(
        x,
        inverse[:n, :n],
        left,
        float(x.size - np.trace(inverse)),
        0.5 * float(slope @ inverse @ slope),
        sizes,
        width,
    )


def _blurs(peak: Array) -> list[Array]:
    """Return b/σ of every value, stage by stage."""
    out, share = [], BLUR
    while share * float(np.median(peak)) > 1.0:
        out.append(share * peak)
        share /= FALL
    return [*out, np.zeros_like(peak)]


def _descended(
    problem: Problem,
    x: Array,
    mean: Array,
    scale: Array,
    weight: Array,
    close: float,
    damping: float,
    told: Callable[[], None],
) -> tuple[Array, tuple[Array, Array, Array]]:
    """Return the minimum of one stage, and the slopes, the misfit and x - x_0 there."""

    def cost(x: Array) -> tuple[Array, float]:
        left = problem.misfit(x) * weight
        with np.errstate(over="ignore", invalid="ignore"):  # a run that diverges counts as infinitely far
            square = float(left @ left)
        value = 0.5 * square + 0.5 * float((((x - mean) / scale) ** 2).sum())
        return left, value if np.isfinite(value) else np.inf

    left, value = cost(x)
    for _ in range(MOST):
        slopes = problem.jacobian(x) * weight
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


def _evident(
    problem: Problem, parts: tuple[Array, Array, Array], sizes: Array, width: float
) -> tuple[Array, float]:
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
