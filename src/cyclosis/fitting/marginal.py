"""Parameters with the initial state integrated out, not fixed at its most probable value.

The posterior of the parameters θ alone is, with the state p integrated out in the normal approximation,

    -½ χ²(θ, p̂(θ)) - ½ ln det H(θ) ,        H the curvature in p, whitened by the prior.

The joint optimum leaves out the second term. A state that grows faster is known better and has been smaller:
the joint optimum takes a smaller state for a more probable one, and with it growth that is too fast, by up to
two standard deviations where the state has as many unknowns as here. The optimum of the sum is away by
-C ∇(½ ln det H), with C the covariance of θ.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from ..model.grid import Array
from .problem import Problem
from .search import Found

STEP = 0.5
"""Steps along the axes of the covariance by which slopes are taken, in standard deviations."""


def integrated(problem: Problem, found: Found, told: Callable[[], None]) -> Found:
    """Return the same end with the parameters most probable with the state integrated out."""
    n = problem.logs
    scale, used = problem.scale(found.sizes, found.width), np.ones(found.x.size, bool)

    def curved(x: Array) -> tuple[Array, Array, float]:
        told()
        white = np.asarray(scale[:, None] * problem.jacobian(x, used), np.float64)
        inside = white[n:] @ white[n:].T + np.eye(x.size - n)
        return inside, white[n:] @ white[:n].T, float(np.linalg.slogdet(inside)[1])

    inside, across, before = curved(found.x)
    follows = -np.linalg.solve(inside, across)  # the state goes with the parameters
    sizes, axes = np.linalg.eigh(found.covariance)
    away = np.zeros(n)
    for deviation, axis in zip(np.sqrt(sizes), axes.T, strict=True):
        step = STEP * deviation * axis
        after = curved(found.x + np.concatenate([step, scale[n:] * (follows @ step)]))[2]
        if np.isfinite(after):
            away -= deviation * axis * (after - before) / (2 * STEP)
    x = found.x + np.concatenate([away, scale[n:] * (follows @ away)])
    return replace(found, x=x, left=problem.misfit(x))
