"""What the steps of a protocol do to the order vector."""

from __future__ import annotations

from typing import Any

import numpy as np

from . import initial
from .grid import Array, CylinderGrid


def act(step: Any, state: Array, grid: CylinderGrid, seed: int) -> Array:
    """Return a state (2, n_theta, n_z) after a step of a protocol with a seed, as if it acted everywhere.

    * depolymerise: keep P
    * align: magnitude (cos angle, sin angle)
    * fragment: white noise of variance 1/(2N) a component
    * noise: P + size times white noise of variance 1

    |P| is scaled back to 1 where noise has made it larger.
    """
    if step.action == "depolymerise":
        kept: Array = step.keep * state
        return kept
    if step.action == "align":
        direction = np.array([np.cos(step.angle), np.sin(step.angle)])
        return np.broadcast_to(step.magnitude * direction[:, None, None], state.shape).copy()
    sequence = np.random.SeedSequence(seed, spawn_key=(step.seed or 0,))
    drawn = initial.standard_noise(grid, np.random.default_rng(sequence), step.noise_grid)
    if step.action == "fragment":
        return _bounded(drawn * np.sqrt(0.5 / step.filaments_per_square))
    return _bounded(state + step.size * drawn)


def _bounded(P: Array) -> Array:
    """Return a state with |P| scaled back to 1 where it is larger."""
    bounded: Array = P / np.maximum(np.hypot(*P), 1.0)
    return bounded
