"""The axis and the radius of a cell, measured in an image of it."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from ..display.shown import shown
from ..model.arrays import numbers
from ..model.doors import door
from ..model.errors import InputError, number

Array = npt.NDArray[np.float64]
LARGEST = 200
"""Pixels along a side to which an image is reduced for the first search."""
FINEST = 1000
"""The same for the last search."""
LEAST_CONTRAST = 3.0
"""How many times the spread of the background the brightness within the rim must differ from it."""


@shown
@dataclass(frozen=True)
class Rim:
    """The place of a cell in an image: what a `View` needs, except for z = 0 and the angle that faces it.

    `radius_px` is half the distance of the two edges, `axis_deg` the direction of the axis,
    counter-clockwise from the right as seen, in (-90, 90], and `on_axis_px` a point (x, y) of the axis, y
    down. `contrast` is the difference of brightness inside and outside, in units of the spread outside.

    Example:
        >>> import cyclosis as cy
        >>> cy.observations.Rim(100.0, 17.0, (280.0, 150.0), 12.0).axis_deg
        17.0
    """

    radius_px: float
    axis_deg: float
    on_axis_px: tuple[float, float]
    contrast: float


@door
def rim(image: npt.ArrayLike, kernel_px: float = 4.0) -> Rim:
    """Return the place of a straight cell that is brighter or darker than what surrounds it.

    Two parallel edges are sought that separate the brightness of the image (rows, columns) best: direction,
    offset and half the distance. Several images (n, rows, columns) of one cell are averaged. Tracers at the
    edge make a cell wider by the radius of their images, and so does a filter: half of `kernel_px`, the
    diameter of a tracer's image or the width of the filter, is subtracted. Check the result in a picture:
    radius and axis are those of what is bright. Raises `InputError` if no such edges stand out.

    Example:
        >>> import numpy as np
        >>> import cyclosis as cy
        >>> rows, columns = np.indices((200, 300))
        >>> cell = np.abs(rows - 90.0) < 60.0
        >>> tracers = np.random.default_rng(0).random(cell.shape) < 0.1
        >>> found = cy.observations.rim(1.0 * (cell & tracers), kernel_px=1.0)
        >>> bool(abs(found.radius_px - 60.0) < 1.5), bool(abs(found.axis_deg) < 0.5)
        (True, True)
    """
    picture = numbers("image", image, "numbers (rows, columns), or (n, rows, columns)", "give an image")
    if picture.ndim == 3:
        picture = picture.mean(axis=0)
    if picture.ndim != 2 or min(picture.shape) < 16 or not np.isfinite(picture).all():
        raise InputError(
            "image", picture, "a finite image of at least 16 x 16 pixels", "give the whole image"
        )
    box = number("kernel_px", kernel_px, 0.0, 1000.0, "give the diameter of a tracer in pixels")
    every = max(1, max(picture.shape) // LARGEST)
    fine = max(1, max(picture.shape) // FINEST)
    pixels: list[Any] = [*np.indices(picture.shape)[::-1], picture]
    x, y, light = (each[::every, ::every].ravel().astype(float) for each in pixels)
    best = max((_edges(x, y, light, float(a)) for a in np.arange(-90, 90, 3)), key=_score)
    x, y, light = (each[::fine, ::fine].ravel().astype(float) for each in pixels)
    for step in (1.0, 0.25, 0.05):
        near = [best[1] + step * k for k in range(-4, 5)]
        best = max((_edges(x, y, light, angle) for angle in near), key=_score)
    _, angle, offset, half, inner, outer, spread = best
    contrast = abs(inner - outer) / max(spread, 1e-12)
    radius = half - 0.5 * box if inner > outer else half + 0.5 * box
    if contrast < LEAST_CONTRAST or radius <= 1.0:
        rule = "an image with two parallel edges between a cell and a background"
        raise InputError("image", picture, rule, "give a contrast that shows the cell, or measure it by hand")
    axis = 90.0 - (90.0 - angle) % 180.0
    middle = ((picture.shape[1] - 1) / 2, (picture.shape[0] - 1) / 2)
    a = math.radians(angle)
    away = offset - (middle[0] * math.sin(a) + middle[1] * math.cos(a))
    return Rim(radius, axis, (middle[0] + away * math.sin(a), middle[1] + away * math.cos(a)), contrast)


def _score(found: tuple[float, ...]) -> float:
    return found[0]


def _edges(x: Array, y: Array, brightness: Array, angle: float) -> tuple[float, ...]:
    """Return how well two edges along `angle` (degrees) separate the brightness, and their place.

    (score, angle, offset, half width, mean inside, mean outside, spread outside); the offset is the distance
    across, x sin a + y cos a.
    """
    a = math.radians(angle)
    across = x * math.sin(a) + y * math.cos(a)
    low = across.min()
    cell = np.floor(across - low).astype(int)
    count = np.bincount(cell).astype(float)
    total = np.bincount(cell, brightness)
    square = np.bincount(cell, brightness**2)
    n, s = (np.concatenate([[0.0], np.cumsum(each)]) for each in (count, total))
    i, j = np.triu_indices(n.size, 4)
    inside = n[j] - n[i]
    outside = n[-1] - inside
    enough = (inside > 0.02 * n[-1]) & (outside > 0.02 * n[-1])
    if not enough.any():
        return (-1.0, angle, 0.0, 0.0, 0.0, 0.0, 1.0)
    i, j, inside, outside = i[enough], j[enough], inside[enough], outside[enough]
    mean_in, mean_out = (s[j] - s[i]) / inside, (s[-1] - s[j] + s[i]) / outside
    score = inside * outside / n[-1] ** 2 * (mean_in - mean_out) ** 2
    k = int(score.argmax())
    left = np.concatenate([np.arange(0, i[k]), np.arange(j[k], count.size)])
    variance = square[left].sum() / outside[k] - mean_out[k] ** 2
    spread = math.sqrt(max(float(variance), 1e-12))
    offset, half = low + 0.5 * (i[k] + j[k]), 0.5 * (j[k] - i[k])
    return (float(score[k]), angle, float(offset), float(half), float(mean_in[k]), float(mean_out[k]), spread)
