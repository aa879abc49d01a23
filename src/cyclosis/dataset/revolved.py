"""A closed surface of revolution as a file describes it: points in space, directions on it, and its poles."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ..model.errors import InputError
from ..model.grid import Array, covered

if TYPE_CHECKING:
    import xarray

EVEN = 1e-5
"""Latitudes are those of a whole cell if they lie symmetrically about its middle to within this, in radii."""


@dataclass(frozen=True, eq=False)
class Surface:
    """A surface in space whose seam, and whose poles if it has any, are closed by repeating points.

    `points`, and the unit vectors `around` and `along` its two directions, are (3, n, m); the second
    direction is that of the coordinate `axis`. `whole` completes a vector field (2, n_theta, k) to (2, n, m).
    """

    points: Array
    around: Array
    along: Array
    axis: str
    whole: Callable[[Array], Array]


def is_revolved(dataset: xarray.Dataset) -> bool:
    """Return whether a dataset is that of a run on a closed surface, which is stored with it."""
    return "s" in dataset.dims and {"r", "z", "area_weight"} <= set(dataset.data_vars)


def revolved(dataset: xarray.Dataset) -> Surface:
    """Return the closed surface of a dataset, with its poles.

    The meridian is a spline through the stored points, and its two ends follow by symmetry. Vectors at a pole
    are extrapolated in r² from the two circles next to it. Raises `InputError` for a part of a surface.
    """
    from scipy.interpolate import CubicSpline

    covered("theta", dataset["theta"].values, 2 * np.pi, "the dataset")
    s = np.asarray(dataset["s"].values, dtype=np.float64)
    r, z = (np.asarray(dataset[name].values, dtype=np.float64) for name in ("r", "z"))
    z = z[0]
    if s.size < 8 or np.abs(r - r[::-1]).max() > EVEN or np.abs(z + z[::-1]).max() > EVEN:
        shown = f"{s.size} latitudes from s = {s[0]:.6g}" if s.size else "no latitudes"
        rule = "all latitudes of the cell, from pole to pole"
        raise InputError("s in the dataset", shown, rule, "store the whole cell, not a part of it")
    length = s[0] + s[-1]
    beyond = np.concatenate([-s[3::-1], s, 2 * length - s[:-5:-1]])
    radius = CubicSpline(beyond, np.concatenate([-r[3::-1], r, -r[:-5:-1]]))
    height = CubicSpline(beyond, np.concatenate([z[3::-1], z, z[:-5:-1]]))
    at = np.concatenate([[0.0], s, [length]])
    slope, rise = radius(at, 1), height(at, 1)
    slope[[0, -1]], rise[[0, -1]] = (1.0, -1.0), 0.0
    size = np.hypot(slope, rise)
    theta = np.append(dataset["theta"].values, 2 * np.pi)[:, None]
    cos, sin, flat = np.cos(theta), np.sin(theta), np.ones((theta.size, at.size))
    whole_r = np.concatenate([[0.0], r, [0.0]])
    whole_z = np.concatenate([[height(0.0)], z, [height(length)]])
    points = np.stack([whole_r * cos, whole_r * sin, whole_z * flat])
    around = np.stack([-sin * flat, cos * flat, 0 * flat])
    along = np.stack([slope / size * cos, slope / size * sin, rise / size * flat])

    def whole(field: Array) -> Array:
        """Return a field with the seam and the poles; at a pole a vector is one, in directions that turn."""
        packed = np.concatenate([field, field[:, :1]], axis=1)
        vectors = packed[0] * around[:, :, 1:-1] + packed[1] * along[:, :, 1:-1]
        rings = vectors[:, :-1].mean(axis=1)
        ends = []
        for first, second, end in ((0, 1, 0), (-1, -2, -1)):
            share = r[first] ** 2 / (r[second] ** 2 - r[first] ** 2)
            pole = rings[:, first] + share * (rings[:, first] - rings[:, second])
            ends.append(np.stack([pole @ around[:, :, end], pole @ along[:, :, end]]))
        return np.concatenate([ends[0][:, :, None], packed, ends[1][:, :, None]], axis=2)

    return Surface(points, around, along, "s", whole)
