"""Samples in any order of rows, put on the grid that they fill."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import numpy.typing as npt

from ..model.errors import InputError
from .observation import Array, Frame

SAME = 2e-3
"""Positions nearer than this, as a share of the typical step, are one: files round to a few digits."""
LEAST_FILLED = 0.3
"""A grid of which less is filled holds scattered samples."""


def lattice(frame: Frame, complete: bool, source: str) -> Frame:
    """Return a frame on its grid, row by row, with x and y increasing; as it is if its samples are scattered.

    A format that writes all vectors is `complete`. Raises `InputError` if one of its grids is not, and if two
    samples are at one place.
    """
    where = np.isfinite(frame.x) & np.isfinite(frame.y)
    if not where.all():
        if complete:
            raise InputError("file", source, "one whose positions are all finite", "write it again")
        frame = _taken(frame, where)
    if frame.x.size == 0:
        raise InputError("file", source, "one with vectors in it", "check it")
    columns, i = _axis(frame.x)
    rows, j = _axis(frame.y)
    places = j * columns.size + i
    filled = frame.x.size / (rows.size * columns.size)
    regular = _even(columns) and _even(rows)
    if complete and (filled != 1.0 or np.unique(places).size != places.size or not regular):
        rule = (
            f"one whose {frame.x.size} vectors fill a regular grid; they have {columns.size} values of x and "
            f"{rows.size} of y"
        )
        raise InputError("file", source, rule, "write it again if it was cut off or changed")
    if filled < LEAST_FILLED or min(columns.size, rows.size) < 2:
        return frame
    if np.unique(places).size != places.size:
        raise InputError("file", source, "one without two vectors at one place", "remove the repeated rows")
    xx, yy = np.meshgrid(columns, rows)
    shape = (rows.size, columns.size)

    def spread(values: Array | None) -> Array | None:
        if values is None:
            return None
        out = np.full(rows.size * columns.size, np.nan)
        out[places] = values
        return out

    good = np.zeros(rows.size * columns.size, dtype=bool)
    good[places] = frame.good
    return replace(
        frame,
        x=xx.ravel(),
        y=yy.ravel(),
        good=good,
        vx=spread(frame.vx),
        vy=spread(frame.vy),
        angle=spread(frame.angle),
        grid=shape,
    )


def _axis(values: Array) -> tuple[Array, npt.NDArray[np.intp]]:
    """Return the different values of a coordinate, increasing, and the index of each sample among them."""
    found, inverse = np.unique(values, return_inverse=True)
    steps = np.diff(found)
    if not steps.size:
        return found, inverse
    span = found[-1] - found[0]
    apart = steps > max(SAME * float(np.median(steps[steps > 1e-9 * span])), 1e-9 * span)
    group = np.concatenate([[0], np.cumsum(apart)])
    first = np.concatenate([[0], np.flatnonzero(apart) + 1])
    return found[first], np.asarray(group[inverse])


def _even(axis: Array) -> bool:
    """Return whether the steps of a grid are equal, as far as a few written digits tell."""
    steps = np.diff(axis)
    return not steps.size or bool(np.abs(steps / np.median(steps) - 1).max() < 0.1)


def _taken(frame: Frame, where: Any) -> Frame:
    def part(values: Array | None) -> Array | None:
        return None if values is None else values[where]

    return replace(
        frame,
        x=frame.x[where],
        y=frame.y[where],
        good=frame.good[where],
        vx=part(frame.vx),
        vy=part(frame.vy),
        angle=part(frame.angle),
    )
