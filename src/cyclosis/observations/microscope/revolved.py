"""The closed cell, seen from the side."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ...dataset.revolved import revolved
from .body import Array, Series, saved_times

if TYPE_CHECKING:
    import xarray

BEYOND = 6
"""Points that are repeated, beyond each pole on the other side and around the cell, for the splines."""
FINE = 2001
"""Points of the tables along the meridian."""


class Revolved:
    """The closed surface of revolution of a run: a capsule, a spheroid or a sphere.

    Vectors are interpolated in their Cartesian components, which are smooth at the poles.
    """

    def __init__(self, data: xarray.Dataset) -> None:
        from scipy.interpolate import CubicSpline

        surface = revolved(data)
        self.times = saved_times(data)
        self.period: float | None = None
        self.theta, s = np.asarray(data["theta"].values), np.asarray(data["s"].values)
        self._around, self._along = surface.around[:, :-1, 1:-1], surface.along[:, :-1, 1:-1]
        length = s[0] + s[-1]
        whole = np.concatenate([[0.0], s, [length]])
        r, z = np.hypot(*surface.points[:2, 0]), surface.points[2, 0]
        fine = np.linspace(0.0, length, FINE)
        # The meridian goes on smoothly beyond a pole, with r < 0.
        beyond = np.concatenate([-s[BEYOND - 1 :: -1], whole, 2 * length - s[: -BEYOND - 1 : -1]])
        radius = CubicSpline(beyond, np.concatenate([-r[BEYOND:0:-1], r, -r[-2 : -BEYOND - 2 : -1]]))
        height = CubicSpline(beyond, np.concatenate([z[BEYOND:0:-1], z, z[-2 : -BEYOND - 2 : -1]]))
        self._s, self._r, self._z = fine, np.maximum(radius(fine), 0.0), height(fine)
        slope, rise = radius(fine, 1), height(fine, 1)
        size = np.hypot(slope, rise)
        self._normal = np.stack([rise / size, -slope / size])
        self._angle = np.arctan2(self._r, -self._z)  # grows from the south pole to the north pole
        self._share = np.cumsum(self._r) / self._r.sum()
        self.area = float(2 * np.pi * np.sum(self._r) * (fine[1] - fine[0]))
        self.ends = (float(self._z[0]), float(self._z[-1]))
        self._places = CubicSpline(
            np.concatenate([-s[BEYOND - 1 :: -1], s, 2 * length - s[: -BEYOND - 1 : -1]]),
            np.arange(s.size + 2.0 * BEYOND),
        )
        self._u = Series(self.times, lambda index: self._spline(data["u"], index))
        self._P = Series(self.times, lambda index: self._spline(data["P"], index))

    def radius_at(self, z: Array) -> Array:
        """Return the distance of the surface from the axis at heights z, NaN beyond the poles."""
        return np.interp(z, self._z, self._r, left=np.nan, right=np.nan)

    def normal(self, xyz: Array) -> Array:
        """Return the outward unit normals at positions."""
        theta, s = self._coordinates(xyz)
        out, up = (np.interp(s, self._s, part) for part in self._normal)
        return np.stack([out * np.cos(theta), out * np.sin(theta), up])

    def velocity(self, xyz: Array, t: float) -> Array:
        """Return the velocity at positions, in U."""
        return self._vectors(self._u.at(t), xyz)

    def filaments(self, xyz: Array, t: float) -> Array:
        """Return the mean direction P of the filaments at positions."""
        return self._vectors(self._P.at(t), xyz)

    def scattered(self, count: int, rng: np.random.Generator) -> Array:
        """Return positions that are spread evenly over the surface."""
        theta = 2 * np.pi * rng.random(count)
        s = np.interp(rng.random(count), self._share, self._s)
        return self._position(theta, s)

    def held(self, xyz: Array) -> Array:
        """Return the positions of the surface in the same direction from the middle of the cell."""
        return self._position(*self._coordinates(xyz))

    def _coordinates(self, xyz: Array) -> tuple[Array, Array]:
        x, y, z = xyz
        return np.arctan2(y, x), np.interp(np.arctan2(np.hypot(x, y), -z), self._angle, self._s)

    def _position(self, theta: Array, s: Array) -> Array:
        r, z = np.interp(s, self._s, self._r), np.interp(s, self._s, self._z)
        return np.stack([r * np.cos(theta), r * np.sin(theta), z])

    def _spline(self, variable: xarray.DataArray, index: int) -> Array:
        from scipy.ndimage import spline_filter

        field = np.asarray(variable.isel(time=index).values, dtype=np.float64)
        cartesian = field[0] * self._around + field[1] * self._along
        turned = np.roll(cartesian, self.theta.size // 2, axis=1)
        south, north = turned[:, :, BEYOND - 1 :: -1], turned[:, :, : -BEYOND - 1 : -1]
        whole = np.concatenate([south, cartesian, north], axis=2)
        round_ = np.concatenate([whole[:, -BEYOND:], whole, whole[:, :BEYOND]], axis=1)
        return np.stack([spline_filter(part, 3, mode="mirror") for part in round_])

    def _vectors(self, table: Array, xyz: Array) -> Array:
        from scipy.ndimage import map_coordinates

        theta, s = self._coordinates(xyz)
        around = np.mod(theta, 2 * np.pi) / (2 * np.pi) * self.theta.size + BEYOND
        places = np.stack([around, self._places(s)])
        how = {"order": 3, "mode": "mirror", "prefilter": False}
        return np.stack([map_coordinates(part, places, **how) for part in table])
