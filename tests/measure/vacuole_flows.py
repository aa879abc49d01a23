"""Flows of the tests: straight and helical bands with the profile of two stripes, or with one wave."""

from functools import cache

import numpy as np

import cyclosis as cy
from cyclosis.stability import cyclosis


@cache
def stripes_profile():
    """The speed around the wall, (256,), of two stripes at alpha_p = 1, alpha_u = 0.5."""
    return np.asarray(cyclosis(cy.Parameters(alpha_p=1.0, alpha_u=0.5)).u)


def bands(profile, q=0.0, n=64, length=5.0, n_z=16):
    """A wall velocity of speed f(theta - q z) along the helix, f a function of phi or a whole profile."""
    if q:
        length, n_z = 2 * np.pi / abs(q), n
    grid = cy.CylinderGrid(n, n_z, length)
    phi = grid.theta[:, None] - q * grid.z
    if not callable(profile):
        waves = np.fft.rfft(profile) / len(profile) * np.where(np.arange(len(profile) // 2 + 1) == 0, 1, 2)
        kept = np.arange((n - 1) // 2 + 1)
        profile = lambda at: np.tensordot(waves[kept], np.exp(1j * np.multiply.outer(kept, at)), 1).real  # noqa: E731
    speed = profile(phi)
    return cy.vacuole.flow(grid, speed * np.array([q, 1.0])[:, None, None] / np.hypot(1, q))


def twisted(q, n=64):
    """Two stripes that wind with pitch 2 pi/q; straight for q = 0."""
    return bands(stripes_profile(), q, n)


def stirred(n=16, seed=0, length=5.0):
    """A flow without symmetry: a few random waves around and along, with a peak speed of 1 at the wall."""
    grid = cy.CylinderGrid(n, n, length)
    rng = np.random.default_rng(seed)
    theta, z = grid.theta[:, None], 2 * np.pi * grid.z / length
    u = np.zeros((2, n, n))
    for m in (0, 1, 2, 3):
        for j in (0, 1, 2):
            size, phase = rng.normal() / (1 + m + j), 2 * np.pi * rng.random()
            wave = size * np.cos(m * theta + j * z + phase)
            u += np.stack([2 * np.pi * j / length * wave, -m * wave])  # without divergence
    return cy.vacuole.flow(grid, u / np.hypot(*u).max())
