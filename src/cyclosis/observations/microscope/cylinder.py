"""The cell that is a piece of a long cylinder."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ...model.errors import InputError
from ...model.grid import CylinderGrid, interpolate
from .body import FINER, Array, Series, saved_times

if TYPE_CHECKING:
    import xarray


class Cylinder:
    """The surface r = 1 of a run on the periodic cylinder, which goes on beyond both ends of the picture."""

    def __init__(self, data: xarray.Dataset) -> None:
        from ...vacuole import flow

        self.flow = flow(data)
        grid = self.grid = self.flow.grid
        self.times = saved_times(data)
        self.period: float | None = grid.length
        self.ends = (0.0, grid.length)
        self.area = 2 * np.pi * grid.length
        self._fine = (FINER * grid.n_theta, FINER * grid.n_z)
        self._u = Series(self.times, lambda index: self._spline(self.flow.frame(index)))
        self._P = Series(self.times, lambda index: self._spline(_filaments(data, grid, index)))

    def radius_at(self, z: Array) -> Array:
        """Return 1 everywhere."""
        return np.ones_like(z)

    def normal(self, xyz: Array) -> Array:
        """Return the outward unit normals at positions."""
        x, y, z = xyz
        r = np.hypot(x, y)
        return np.stack([x / r, y / r, 0 * z])

    def velocity(self, xyz: Array, t: float) -> Array:
        """Return the velocity at positions, in U."""
        return self._vectors(self._u.at(t), xyz)

    def filaments(self, xyz: Array, t: float) -> Array:
        """Return the mean direction P of the filaments at positions."""
        return self._vectors(self._P.at(t), xyz)

    def scattered(self, count: int, rng: np.random.Generator) -> Array:
        """Return positions that are spread evenly over the surface."""
        theta = 2 * np.pi * rng.random(count)
        return np.stack([np.cos(theta), np.sin(theta), self.grid.length * rng.random(count)])

    def held(self, xyz: Array) -> Array:
        """Return positions at r = 1; z goes on beyond the period."""
        x, y, z = xyz
        r = np.hypot(x, y)
        return np.stack([x / r, y / r, z])

    def _spline(self, field: Array) -> Array:
        from scipy.ndimage import spline_filter

        fine = interpolate(field, self._fine)
        return np.stack([spline_filter(part, 3, mode="grid-wrap") for part in fine])

    def _vectors(self, table: Array, xyz: Array) -> Array:
        from scipy.ndimage import map_coordinates

        x, y, z = xyz
        theta = np.arctan2(y, x)
        places = np.stack([theta / (2 * np.pi) * self._fine[0], z / self.grid.length * self._fine[1]])
        how = {"order": 3, "mode": "grid-wrap", "prefilter": False}
        around, along = (map_coordinates(part, places, **how) for part in table)
        return np.stack([-np.sin(theta) * around, np.cos(theta) * around, along])


def _filaments(data: xarray.Dataset, grid: CylinderGrid, index: int) -> Array:
    if "P" not in data:
        rule = "those of a run, with P"
        raise InputError("the dataset's variables", list(data.data_vars), rule, "keep P in the dataset")
    return grid.check_state(data["P"].isel(time=index), "P")
