"""Values of samples in the image at points of the surface: interpolated on a grid, averaged where scattered."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from .observation import Array, Frame
from .view import View

NEAR = 1e-9
"""Weights below this do not count: a bad vector does not spoil a point on the grid line beside it."""


def interpolated(frame: Frame, values: Sequence[Array], x: Array, y: Array) -> list[Array]:
    """Return values on a frame's grid at points of the image.

    Where all 4 x 4 samples around a point are good they are interpolated by cubics (Catmull-Rom), elsewhere
    linearly between the nearest four. Where one of these is bad, the plane through the other three
    replaces it, which is exact for linear fields; where two are, and beyond the grid, the result is NaN.
    """
    assert frame.grid is not None
    rows, columns = frame.grid
    xs, ys = frame.x.reshape(rows, columns)[0], frame.y.reshape(rows, columns)[:, 0]
    (i, a), (j, b) = _between(xs, x), _between(ys, y)
    weights = np.stack([(1 - b) * (1 - a), (1 - b) * a, b * (1 - a), b * a])
    signs = np.array([1.0, -1.0, -1.0, 1.0]).reshape(4, *[1] * x.ndim)
    good = frame.good.reshape(rows, columns)
    across, down = _catmull_rom(a), _catmull_rom(b)
    out = []
    for each in values:
        grid = np.where(good, each.reshape(rows, columns), np.nan)
        corners = np.stack([grid[j, i], grid[j, i + 1], grid[j + 1, i], grid[j + 1, i + 1]])
        missing = np.isnan(corners)
        plane = -signs * (signs * np.where(missing, 0.0, corners)).sum(axis=0)
        corners = np.where(missing & (missing.sum(axis=0) == 1), plane, corners)
        linear = np.where(weights > NEAR, corners * weights, 0.0).sum(axis=0)
        wide = np.pad(grid, 1, constant_values=np.nan)
        cubic = sum(down[m] * across[n] * wide[j + m, i + n] for m in range(4) for n in range(4))
        found = np.where(np.isnan(cubic), linear, cubic)
        out.append(np.where(np.isnan(a) | np.isnan(b), np.nan, found))
    return out


def _catmull_rom(t: Array) -> list[Array]:
    """Return the weights of the four samples around a point at a share t between the middle two."""
    return [
        0.5 * (-t + 2 * t**2 - t**3),
        0.5 * (2 - 5 * t**2 + 3 * t**3),
        0.5 * (t + 4 * t**2 - 3 * t**3),
        0.5 * (-(t**2) + t**3),
    ]


def _between(axis: Array, at: Array) -> tuple[Array, Array]:
    """Return the index of the grid line before each point, and the share of the way to the next; NaN outside."""
    k = np.clip(np.searchsorted(axis, at, side="right") - 1, 0, axis.size - 2)
    share = (at - axis[k]) / (axis[k + 1] - axis[k])
    slack = 1e-9
    outside = (share < -slack) | (share > 1 + slack) | np.isnan(at)
    return k, np.where(outside, np.nan, np.clip(share, 0.0, 1.0))


def binned(
    frame: Frame, view: View, values: Sequence[Array], theta: Array, z: Array
) -> tuple[list[Array], Array]:
    """Return the means of values over the cells around the points of the surface's grid, and the counts."""
    found, along, _ = view.to_surface(frame.x, frame.y)
    phi, middle = view.phi(found), view.phi(theta)
    i, j = _cell(middle, phi), _cell(z, along)
    ok = frame.good & (i >= 0) & (j >= 0)
    for each in values:
        ok &= np.isfinite(each)
    place, size = i[ok] * z.size + j[ok], theta.size * z.size
    count = np.bincount(place, minlength=size).astype(float)
    with np.errstate(invalid="ignore", divide="ignore"):
        means = [np.bincount(place, each[ok], minlength=size) / count for each in values]
    shape = (theta.size, z.size)
    return [mean.reshape(shape) for mean in means], count.reshape(shape)


def _cell(points: Array, at: Array) -> Array:
    """Return the index of the cell around a point that holds each value, -1 outside."""
    if points.size == 1:
        return np.where(np.isfinite(at), 0, -1)
    order = np.argsort(points)
    ordered = points[order]
    edges = np.concatenate(
        [
            [1.5 * ordered[0] - 0.5 * ordered[1]],
            0.5 * (ordered[1:] + ordered[:-1]),
            [1.5 * ordered[-1] - 0.5 * ordered[-2]],
        ]
    )
    k = np.searchsorted(edges, at, side="right") - 1
    inside = np.isfinite(at) & (k >= 0) & (k < points.size)
    return np.where(inside, order[np.clip(k, 0, points.size - 1)], -1)


def lines(frame: Frame, view: View, values: Sequence[Array], theta: Array, z: Array) -> tuple[Array, Array]:
    """Return values along a line of the image, in the cells of the surface that it crosses."""
    one_by_one = [np.where(np.isfinite(each), each, 0.0) for each in values]
    found, count = binned(frame, view, one_by_one, theta, z)
    none = [not np.isfinite(each).any() for each in values]
    out = [np.full_like(f, np.nan) if empty else f for f, empty in zip(found, none, strict=True)]
    return np.stack(out), count
