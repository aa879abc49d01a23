"""A state on a closed cell: an orthographic view of the side that faces the viewer."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from typing import Any

import numpy as np
import numpy.typing as npt
from matplotlib.patches import PathPatch
from matplotlib.path import Path
from scipy.ndimage import map_coordinates

from ..model.errors import number
from ..model.grid import Array
from .cylinder import PIXELS, project
from .marks import Mark, draw_marks
from .ribbons import Ribbon, paint
from .skin import Skin
from .style import INK, ZONE, state_rgb

TILT = 0.6
"""Default angle, in radians, by which the viewer looks down on the cell: enough to see its upper end."""
_DARKEST = 0.5
"""Brightness of the surface at the silhouette, over that of the part that faces the viewer."""
_EDGE = 0.03


def seen(skin: Skin, points: npt.ArrayLike, view_angle: float, tilt: float) -> tuple[Array, Array]:
    """Return where points (n, 3) of the surface appear, (n, 2), and their normals (n, 3) as they appear.

    Normals have a component to the right, one upwards, and one towards the viewer: where that is not positive
    a point is hidden, since the surface is convex. Lengths are in radii; (0, 0) is the middle of the cell.
    """
    x, y, z = np.asarray(points, dtype=np.float64).T
    theta, s = skin.chart((x, y, z))
    across, up, _ = project(theta, z, view_angle, tilt, np.hypot(x, y))
    normal = skin.frames(theta, s)[2]
    sideways = normal[1] * np.cos(view_angle) - normal[0] * np.sin(view_angle)
    ahead = normal[0] * np.cos(view_angle) + normal[1] * np.sin(view_angle)
    upwards = normal[2] * np.cos(tilt) - ahead * np.sin(tilt)
    towards = normal[2] * np.sin(tilt) + ahead * np.cos(tilt)
    return np.stack([across, up], axis=1), np.stack([sideways, upwards, towards], axis=1)


def extent(skin: Skin, tilt: float = TILT) -> tuple[float, float, float, float]:
    """Return left, right, bottom and top of the picture of a cell, in radii."""
    top = float(np.max(np.abs(skin.z) * np.cos(tilt) + skin.r * np.sin(tilt)))
    return -skin.widest, skin.widest, -top, top


def draw_closed(
    ax: Any,
    skin: Skin,
    P: Array,
    u: Array,
    *,
    view_angle: float = np.pi,
    tilt: float = TILT,
    streamlines: bool = True,
    peak_speed: float | None = None,
    ribbons: Sequence[Ribbon] | None = None,
    marks: Sequence[Mark] = (),
    pixels: int = PIXELS,
) -> None:
    """Draw a state P and its flow u, (2, around, n) on the chart of a `Skin`, into matplotlib axes.

    Colours and lines are as in `cyclosis.figures.cylinder.draw`, with P_s, along the meridian, for P_z; on a
    sphere, which has no axis, the colours are those of |P| and there are no indifferent zones. `marks` are
    the defects of P. The axis is upright in the picture and leans towards the viewer by `tilt` radians.
    """
    tilt = number("tilt", tilt, 0.0, 1.5, "choose an angle in radians")
    box = extent(skin, tilt)
    body = outline_of(skin, tilt)
    image = ax.imshow(
        _shaded(skin, P, view_angle, tilt, pixels),
        extent=box,
        origin="lower",
        interpolation="bilinear",
        zorder=1,
    )
    image.set_clip_path(body, ax.transData)

    def paint_on(found: Sequence[Array], colour: str, alpha: Sequence[float] | float = 1.0) -> None:
        flat, strengths = [], []
        every = np.broadcast_to(alpha, len(found)).tolist()
        for polygon, strength in zip(found, every, strict=True):
            places = cut(*seen(skin, polygon, view_angle, tilt), 2 * box[3])
            if len(places):
                flat.append(places)
                strengths.append(strength)
        paint(ax, flat, colour, np.array(strengths), clip=body)

    if streamlines:
        peak = float(np.hypot(*u).max()) if peak_speed is None else peak_speed
        lines = skin.streams(u, peak) if ribbons is None else ribbons
        paint_on([polygon for polygon, _ in lines], INK, [strength for _, strength in lines])
    paint_on(skin.zones(P), ZONE)
    ax.add_artist(PathPatch(body, facecolor="none", edgecolor=INK, linewidth=0.6, zorder=3))
    if marks:
        index, theta, s = np.array(marks).T
        places, normals = seen(skin, skin.at(theta, s).T, view_angle, tilt)
        front = normals[:, 2] > 0
        draw_marks(ax, places[front], index[front])
    ax.set(
        xlim=(box[0] - _EDGE, box[1] + _EDGE),
        ylim=(box[2] - _EDGE, box[3] + _EDGE),
        aspect="equal",
    )
    ax.set_axis_off()


def cut(polygon: Array, normals: Array, far: float) -> Array:
    """Return a polygon (n, 2) with its hidden parts outside the silhouette, where they are clipped.

    `normals` (n, 3) are those of `seen`. Hidden points move outwards by `far`, so that a polygon that passes
    behind the cell and comes back does not take a short cut across the picture. Nothing is left of a polygon
    that is hidden altogether.
    """
    facing = normals[:, 2]
    front = facing > 0
    if front.all():
        return polygon
    if not front.any():
        return np.empty((0, 2))
    ahead = np.roll(facing, -1)
    share = facing / np.where(facing == ahead, 1.0, facing - ahead)
    edge = polygon + share[:, None] * (np.roll(polygon, -1, axis=0) - polygon)
    outwards = normals[:, :2] / np.maximum(np.hypot.reduce(normals[:, :2], axis=1), 1e-300)[:, None]
    moved = np.where(front[:, None], polygon, polygon + far * outwards)
    # After each point the one where the line to the next crosses the silhouette, if it does.
    kept = np.stack([np.ones_like(front), front != (ahead > 0)], axis=1)
    return np.asarray(np.stack([moved, edge], axis=1)[kept])


@lru_cache(maxsize=8)
def outline_of(skin: Skin, tilt: float) -> Path:
    """Return the silhouette: where the normal is at a right angle to the direction of the view."""
    # normal · view = rise cos(tilt) cos(α) - slope sin(tilt) = 0, with α the angle from the viewer.
    chi = np.arctan2(skin.rise, skin.slope)
    alpha = np.linspace(0.0, np.pi, 181)
    bends = np.interp(np.arctan2(np.sin(tilt), np.cos(tilt) * np.cos(alpha)), chi, skin.s)
    inner = skin.s[(np.abs(skin.slope) * np.sin(tilt) < np.abs(skin.rise) * np.cos(tilt) * (1 - 1e-9))]
    s = np.sort(np.concatenate([bends, inner]))
    slope, rise = np.interp(s, skin.s, skin.slope), np.interp(s, skin.s, skin.rise)
    cosine = np.clip(slope * np.sin(tilt) / np.maximum(rise * np.cos(tilt), 1e-300), -1.0, 1.0)
    right = skin.at(np.arccos(cosine), s)
    x, y, _ = project(np.arccos(cosine), right[2], 0.0, tilt, np.hypot(right[0], right[1]))
    half = np.stack([x, y], axis=1)
    other = half[::-1] * np.array([-1.0, 1.0])
    return Path(np.concatenate([half, other, half[:1]]), closed=True)


@lru_cache(maxsize=8)
def _hits(skin: Skin, tilt: float, pixels: int) -> tuple[Array, Array, Array]:
    """Return theta from the viewer, s, and the brightness of what each pixel shows, (rows, columns).

    The line of sight through (x, y) meets the surface where x² + q² = r(z)², z = (y + q sin tilt)/cos tilt,
    at the largest such q, its distance from the axis towards the viewer. r² - q² is concave in q, for convex
    surfaces: its largest value is found by thirds, and the place beyond it by halves. Lines that miss show
    the point they come closest to.
    """
    left, right, bottom, top = extent(skin, tilt)
    rows = max(2, round(pixels * (top - bottom) / (right - left)))
    x = (np.arange(pixels) + 0.5) * (right - left) / pixels + left
    y = ((np.arange(rows) + 0.5) * (top - bottom) / rows + bottom)[:, None]
    sin, cos = np.sin(tilt), np.cos(tilt)
    square = skin.r**2
    fall = float(-(square[-1] - square[-2]) / (skin.z[-1] - skin.z[-2]))  # of r² near a pole

    def room(q: Array) -> Array:
        z = (y + q * sin) / cos
        beyond = np.maximum(np.abs(z) - skin.half_height, 0.0)
        return np.asarray(np.interp(z, skin.z, square) - fall * beyond - q**2)

    low, high = np.full((rows, pixels), -1.2), np.full((rows, pixels), 1.2)
    for _ in range(28):  # the largest room
        a, b = low + (high - low) / 3, high - (high - low) / 3
        rising = room(a) < room(b)
        low, high = np.where(rising, a, low), np.where(rising, high, b)
    far, near = 0.5 * (low + high), np.full((rows, pixels), 1.2 * skin.widest)
    meets = room(far) > x**2
    for _ in range(22):
        middle = 0.5 * (far + near)
        inside = room(middle) > x**2
        far, near = np.where(meets & inside, middle, far), np.where(meets & ~inside, middle, near)
    q = np.where(meets, 0.5 * (far + near), far)
    theta, s = skin.chart(np.stack(np.broadcast_arrays(q, x, (y + q * sin) / cos)))
    normal = skin.frames(theta, s)[2]
    facing = np.clip(normal[0] * cos + normal[2] * sin, 0.0, 1.0)
    return theta, s, _DARKEST + (1 - _DARKEST) * facing


def _shaded(skin: Skin, P: Array, view_angle: float, tilt: float, pixels: int) -> Array:
    """Return the colours (rows, columns, 3) of the picture, from its lower left corner."""
    theta, s, light = _hits(skin, tilt, pixels)
    return coloured(skin, P, theta + view_angle, s) * light[..., None]


def coloured(skin: Skin, P: Array, theta: Array, s: Array) -> Array:
    """Return the colours (..., 3) of a state (2, around, n) at angles and arc lengths (...)."""
    wrapped = np.pad(P, ((0, 0), (2, 3), (0, 0)), mode="wrap")
    place = [np.mod(theta, 2 * np.pi) * skin.around / (2 * np.pi) + 2, s * (skin.s.size - 1) / skin.length]
    found = np.stack([map_coordinates(part, place, order=1, mode="nearest") for part in wrapped])
    return state_rgb(found, size_only=not skin.axial)
