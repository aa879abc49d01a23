"""What the steps of a protocol do to the order vector on a closed surface."""

from __future__ import annotations

from typing import Any

import numpy as np

from ...closed.grid import Array, ClosedGrid
from ...closed.initial import SQUARE, standard_modes
from ...closed.space import closed_space
from ...closed.system import vector
from ...model.errors import InputError


def act(step: Any, state: Array, grid: ClosedGrid, seed: int) -> Array:
    """Return a state (2, n_theta, n_s) after a step of a protocol with a seed, as if it acted everywhere.

    * depolymerise: keep P
    * align: magnitude r (cos angle, sin angle), smooth at the poles, where no direction is "around"
    * fragment: `cyclosis.closed.noise`
    * noise: P + size times white noise of variance 1 a component in every 0.00767 radii squared

    |P| is scaled back to 1 where noise has made it larger. Raises `InputError` for a `noise_grid`.
    """
    if step.action == "depolymerise":
        kept: Array = step.keep * state
        return kept
    if step.action == "align":
        direction = np.array([np.cos(step.angle), np.sin(step.angle)])[:, None, None]
        return step.magnitude * direction * np.minimum(grid.r, 1.0) * np.ones(grid.shape)
    if step.noise_grid is not None:
        rule = "left out on a closed surface, where noise is drawn in surface harmonics"
        raise InputError("noise_grid", step.noise_grid, rule, "remove it")
    drawn = standard_modes(grid, [seed, step.seed or 0, 1])
    if step.action == "fragment":
        scale = np.sqrt(SQUARE / (2 * np.pi * step.filaments_per_square))
        return _bounded(vector(closed_space(grid), scale * drawn))
    scale = step.size * np.sqrt(2 * SQUARE / (2 * np.pi))
    return _bounded(state + vector(closed_space(grid), scale * drawn))


def _bounded(P: Array) -> Array:
    """Return a state with |P| scaled back to 1 where it is larger."""
    bounded: Array = P / np.maximum(np.hypot(*P), 1.0)
    return bounded
