"""A state on the unrolled surface of a closed cell: an equal-area map, as wide at every s as the cell.

The sinusoidal projection x = r(s) (theta - π), y = s: meridians bend, but dx dy = r dtheta ds, so that areas
are true, and so are lengths along circles around the cell and along the meridian in the middle.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from typing import Any

import numpy as np
import numpy.typing as npt
from matplotlib.patches import PathPatch
from matplotlib.path import Path

from ..model.grid import Array
from ..model.scales import Scales
from ..model.units import length_text
from .closed_solid import coloured
from .edges import mark_height
from .marks import Mark, draw_marks
from .ribbons import Ribbon, paint
from .skin import Skin
from .style import INK, ZONE
from .unwrapped import SCALE

PIXELS = 480
"""Number of colour samples across the map."""
TORN = 1.0
"""Lines that turn about a pole by more than this, in radians, from one point to the next are left out."""
_EDGE = 0.02


def mapped(skin: Skin, theta: npt.ArrayLike, s: npt.ArrayLike) -> tuple[Array, Array]:
    """Return x and y, in radii, of angles theta and arc lengths s (...)."""
    along = np.asarray(s, dtype=np.float64)
    x = np.interp(along, skin.s, skin.r) * (np.asarray(theta, dtype=np.float64) - np.pi)
    return np.asarray(x), along


def frame_of(skin: Skin) -> tuple[float, float, float, float]:
    """Return left, right, bottom and top of the map, in radii, with room for its outline."""
    half = np.pi * skin.widest + _EDGE
    return -half, half, -_EDGE, skin.length + _EDGE


def paint_closed(
    ax: Any,
    skin: Skin,
    P: Array,
    u: Array,
    *,
    streamlines: bool = True,
    peak_speed: float | None = None,
    ribbons: Sequence[Ribbon] | None = None,
    marks: Sequence[Mark] = (),
    scale: float = SCALE,
) -> None:
    """Paint the map of a state and its flow, (2, around, n) on the chart of a `Skin`, into matplotlib axes.

    Colours, lines and `marks` are as in `cyclosis.figures.closed_solid.draw_closed`; `scale` is as in
    `cyclosis.figures.unwrapped.paint_map`.
    """
    box = frame_of(skin)
    edge = _edge(skin)
    theta, s = _places(skin)
    image = ax.imshow(
        coloured(skin, P, theta, s), extent=box, origin="lower", interpolation="bilinear", zorder=1
    )
    image.set_clip_path(edge, ax.transData)

    def paint_on(found: Sequence[Array], colour: str, alpha: Sequence[float] | float = 1.0) -> None:
        flat, strengths = [], []
        every = np.broadcast_to(alpha, len(found)).tolist()
        for polygon, strength in zip(found, every, strict=True):
            for copy in copies(skin, polygon):
                flat.append(copy)
                strengths.append(strength)
        paint(ax, flat, colour, np.array(strengths), clip=edge)

    if streamlines:
        peak = float(np.hypot(*u).max()) if peak_speed is None else peak_speed
        lines = skin.streams(u, peak, scale) if ribbons is None else ribbons
        paint_on([polygon for polygon, _ in lines], INK, [strength for _, strength in lines])
    paint_on(skin.zones(P, scale), ZONE)
    ax.add_artist(PathPatch(edge, facecolor="none", edgecolor=INK, linewidth=0.6, zorder=3))
    if marks:
        index, angle, along = np.array(marks).T
        draw_marks(ax, np.stack(mapped(skin, np.mod(angle, 2 * np.pi), along), axis=1), index)
    ax.set(xlim=box[:2], ylim=box[2:], aspect="equal")


def paint_values(ax: Any, skin: Skin, values: Array, **how: Any) -> Any:
    """Paint a field (around, n) of numbers on the map into matplotlib axes, and return the image."""
    box, edge = frame_of(skin), _edge(skin)
    theta, s = _places(skin)
    image = ax.imshow(skin.sampled(values[None], theta, s)[0], extent=box, zorder=1, **how)
    image.set_clip_path(edge, ax.transData)
    ax.add_artist(PathPatch(edge, facecolor="none", edgecolor=INK, linewidth=0.6, zorder=3))
    ax.set(xlim=box[:2], ylim=box[2:], aspect="equal")
    return image


def copies(skin: Skin, polygon: Array) -> list[Array]:
    """Return the copies (n, 2) on the map of a polygon (n, 3) in space: two where it crosses theta = 0."""
    theta, s = skin.chart(polygon.T)
    theta = np.unwrap(theta)
    steps = np.abs(np.diff(theta, append=theta[0]))
    if steps.max() > TORN:
        return []
    theta -= 2 * np.pi * np.floor(theta.min() / (2 * np.pi))
    turns = range(int(theta.max() // (2 * np.pi)) + 1)
    return [np.stack(mapped(skin, theta - 2 * np.pi * turn, s), axis=1) for turn in turns]


def mark_edges(ax: Any, skin: Skin, scales: Scales | None = None) -> None:
    """Put ticks at the edges of a map, in radii or units along the axis, and lines along two of its sides."""
    half = np.pi * skin.widest
    ax.set_xticks([-half, half], ["0", "2π"])
    mark_height(ax, length_text(skin.length, scales, ".2g"), skin.length)
    ax.spines[["top", "right"]].set_visible(False)
    ax.spines["left"].set_bounds(0, skin.length)
    ax.spines["bottom"].set_bounds(-half, half)


@lru_cache(maxsize=8)
def _edge(skin: Skin) -> Path:
    right = np.stack(mapped(skin, 2 * np.pi, skin.s), axis=1)
    whole = np.concatenate([right, right[::-1] * np.array([-1.0, 1.0])])
    return Path(np.concatenate([whole, whole[:1]]), closed=True)


@lru_cache(maxsize=8)
def _places(skin: Skin) -> tuple[Array, Array]:
    """Return theta and s of the pixels; those outside show the nearest edge."""
    left, right, bottom, top = frame_of(skin)
    rows = round(PIXELS * (top - bottom) / (right - left))
    x = (np.arange(PIXELS) + 0.5) * (right - left) / PIXELS + left
    s = np.clip((np.arange(rows) + 0.5) * (top - bottom) / rows + bottom, 0.0, skin.length)[:, None]
    r = np.maximum(np.interp(s, skin.s, skin.r), 1e-6)
    return np.pi + np.clip(x / r, -np.pi, np.pi), np.broadcast_to(s, (rows, PIXELS))
