"""Particles at the surface of a cell, carried by its flow."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from .body import Array, Body

FARTHEST = 0.05
"""Longest way of a particle in one step of the method, in radii, at the speed U."""


def carried(body: Body, xyz: Array, start: float, duration: float) -> Array:
    """Return positions (3, n) after a time in the flow of a run, by Runge and Kutta's fourth-order method.

    Times in R/U.
    """
    steps = max(1, int(np.ceil(duration / FARTHEST)))
    h, at = duration / steps, xyz
    frozen = len(body.times) == 1
    for k in range(steps):
        t = start + k * h
        middle, end = (start, start) if frozen else (t + 0.5 * h, t + h)
        k1 = body.velocity(at, t)
        k2 = body.velocity(at + 0.5 * h * k1, middle)
        k3 = body.velocity(at + 0.5 * h * k2, middle)
        k4 = body.velocity(at + h * k3, end)
        at = body.held(at + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4))
    return at


def repeated(body: Body, xyz: Array, low: float, high: float) -> tuple[Array, npt.NDArray[np.int64]]:
    """Return positions (3, n) with their copies whole periods on, from `low` to `high`, and whose they are.

    The second result is (2, n): the number of the particle, and that of the copy. A cell without a period is
    returned as it is.
    """
    own = np.arange(xyz.shape[1])
    if body.period is None:
        return xyz, np.stack([own, 0 * own])
    first = int(np.floor((low - xyz[2].max()) / body.period))
    last = int(np.ceil((high - xyz[2].min()) / body.period))
    copies, numbers = [], []
    for turn in range(first, last + 1):
        at = xyz + np.array([[0.0], [0.0], [turn * body.period]])
        inside = (at[2] >= low) & (at[2] <= high)
        copies.append(at[:, inside])
        numbers.append(np.stack([own[inside], np.full(int(inside.sum()), turn)]))
    return np.concatenate(copies, axis=1), np.concatenate(numbers, axis=1)
