"""Tracers in the vacuole of a cell that is still being computed: cheap, for pictures.

Nothing is compiled. The velocity comes from the cubic splines of `splines`, on the points of the cell's grid,
and is evaluated by SciPy. It is that of `VacuoleFlow.at` to 2 % of the largest speed in disorder, whose waves
are short, and to 0.1 % once streams have formed; `cyclosis.vacuole.trace` follows tracers accurately.
"""

from __future__ import annotations

import numpy as np

from ..model.grid import Array
from .flow import VacuoleFlow
from .splines import FRONT, coefficients, lattice_of

DIAMETER = 16
"""Points over the diameter."""
LONGEST = 0.15
"""Longest step of a tracer that moves as fast as the wall, in radii."""
RIM = 0.995
"""Tracers start within this share of the radius."""


class Interior:
    """A flow prepared for evaluation at many points at once."""

    def __init__(self, flow: VacuoleFlow) -> None:
        self.lattice = lattice_of(flow, 3, 1, DIAMETER)
        self._table = coefficients(flow, self.lattice)

    def at(self, xyz: Array) -> Array:
        """Return the velocity (3, n), Cartesian, at points (3, n) of x, y, z; beyond the wall that at it."""
        from scipy.ndimage import map_coordinates  # slow to load

        x, y, z = xyz
        _, n_theta, n_z, length, _ = lattice = self.lattice
        radius = np.minimum(np.hypot(x, y), 1.0)
        places = [
            np.arccos(radius) * (lattice.n_s / np.pi) - 0.5,
            (np.arctan2(y, x) * (n_theta / (2 * np.pi))) % n_theta,
            (z * (n_z / length)) % n_z,
        ]
        where = np.stack(places) + FRONT
        how = {"order": lattice.order, "mode": "nearest", "prefilter": False}
        return np.stack([map_coordinates(part, where, **how) for part in self._table])

    def carried(self, xyz: Array, duration: float, speed: float, most: int = 8) -> Array:
        """Return points (3, n) after a time in the flow as it is, by at most `most` steps of fourth order.

        `speed` is the largest one of the wall, which sets the steps. z is within the cell, and no point
        beyond the wall: as in `cyclosis.vacuole.trace`, a step there is reflected.
        """
        steps = max(1, min(most, int(np.ceil(duration * speed / LONGEST))))
        h, at = duration / steps, xyz
        for _ in range(steps):
            k1 = self.at(at)
            k2 = self.at(at + 0.5 * h * k1)
            k3 = self.at(at + 0.5 * h * k2)
            k4 = self.at(at + h * k3)
            at = _held(at + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4), self.lattice.length)
        return at


def scattered(count: int, length: float, seed: int = 0) -> Array:
    """Return points (3, count) of x, y, z spread evenly over a vacuole of a length."""
    draw = np.random.default_rng(seed)
    r, theta = RIM * np.sqrt(draw.random(count)), 2 * np.pi * draw.random(count)
    return np.stack([r * np.cos(theta), r * np.sin(theta), length * draw.random(count)])


def _held(xyz: Array, length: float) -> Array:
    x, y, z = xyz
    r = np.hypot(x, y)
    factor = np.where(r > 1, np.maximum(2 - r, 0.0) / np.maximum(r, 1.0), 1.0)
    z = z % length
    return np.stack([x * factor, y * factor, np.where(z < length, z, 0.0)])
