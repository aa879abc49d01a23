"""A kymograph from a film: the light along a line against time."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from ...model.arrays import numbers
from ...model.errors import InputError
from .reading import STEADY, Film

Array = npt.NDArray[np.float64]
BROAD = 5
"""Width of the line in pixels, over which the light is averaged."""


def line_of(shot: Film, times: Array, line_px: Sequence[Sequence[float]]) -> tuple[Array, Array]:
    """Return the light along a line, (frames, places) with one place a pixel, and the ends of the line.

    The ends are ((x, y), (x, y)), in pixels of the file. Raises `InputError` for a line that is not in the
    picture or too short, and for frames that are not evenly spaced, which streaks cannot tell from speeds.
    """
    from scipy.ndimage import map_coordinates

    remedy = "give pixels of the film, y down"
    ends = numbers("line_px", line_px, "two points ((x, y), (x, y))", remedy)
    height, width = shot.binned * np.array(shot.pictures.shape[1:])
    if ends.shape != (2, 2) or not np.isfinite(ends).all():
        raise InputError("line_px", line_px, "two points ((x, y), (x, y))", remedy)
    if (ends < 0).any() or (ends > np.array([width - 1, height - 1])).any():
        rule = f"two points in the picture, which has {width} x {height} pixels"
        raise InputError("line_px", ends.tolist(), rule, remedy)
    steps = np.diff(times)
    if np.ptp(steps) > STEADY * float(np.median(steps)):
        rule = f"frames that are evenly spaced; they are {steps.min():.3g} to {steps.max():.3g} s apart"
        raise InputError("file", "a film", rule, "give the span of frames in which they are")
    long = float(np.hypot(*(ends[1] - ends[0])))
    count = int(long / shot.binned) + 1
    if count < 16:
        raise InputError("line_px", ends.tolist(), "a line of at least 16 pixels", "choose a longer one")
    along = (ends[1] - ends[0]) / long
    offsets = np.arange(BROAD) - 0.5 * (BROAD - 1)
    places = ends[0] + np.linspace(0.0, long, count)[:, None] * along
    aside = places[None] + offsets[:, None, None] * shot.binned * np.array([-along[1], along[0]])
    at = (aside - 0.5 * (shot.binned - 1)) / shot.binned
    rows: list[Any] = [
        map_coordinates(picture, (at[..., 1], at[..., 0]), order=1, mode="nearest").mean(axis=0)
        for picture in shot.pictures
    ]
    return np.asarray(rows, dtype=np.float64), ends
