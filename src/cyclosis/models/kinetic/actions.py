"""What the steps of a protocol do to the density of filament angles."""

from __future__ import annotations

from typing import Any

import numpy as np

from ...model import actions
from ...model.grid import CylinderGrid
from ...model.spectral import pack
from .angular import NEAR_ONE, Moments, add_higher_noise, dressed


def act(step: Any, m: Moments, grid: CylinderGrid, seed: int) -> Moments:
    """Return moments (N + 1, n_theta, n_z) after a step of a protocol with a seed, wherever the step acts.

    The concentration stays.

    * depolymerise: keep m_n for n >= 1, so that a share 1 - keep of the filaments has any direction
    * align: a von Mises distribution of mean magnitude (cos angle, sin angle)
    * fragment: white noise of variance 1/(2N) in either part of m_1 to m_8, and 0 beyond
    * noise: size times white noise of variance 1 added to the same

    |P| is scaled back to 1 where noise has made it larger. m_1 gets what P gets in the polar model.
    """
    c, out = m[0].real, m.copy()
    if step.action == "depolymerise":
        out[1:] *= step.keep
        return out
    if step.action == "align":
        direction = np.array([np.cos(step.angle), np.sin(step.angle)])
        length = min(step.magnitude, NEAR_ONE)
        return c * dressed(np.broadcast_to(length * direction[:, None, None], (2, *c.shape)), len(m) - 1)
    p = m[1] / c
    before = np.stack([p.real, p.imag])
    out[1] = c * pack(actions.act(step, before, grid, seed))
    if step.action == "fragment":
        out[2:] = 0.0
        size = np.sqrt(0.5 / step.filaments_per_square)
    else:
        size = step.size
    sequence = np.random.SeedSequence(seed, spawn_key=(step.seed or 0, 1))
    add_higher_noise(out, grid, sequence, c * size, step.noise_grid)
    return out
