"""Lines with a width, painted on the surface: indifferent zones and streamlines as polygons.

A polygon follows the surface, so that a line narrows towards the silhouette of a cylinder, as paint would.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator
from typing import Any

import numpy as np
import numpy.typing as npt
from matplotlib.collections import PolyCollection
from matplotlib.colors import to_rgb
from matplotlib.path import Path
from scipy.ndimage import map_coordinates

from ..analysis.zones import contrast, indifferent_zones, weight
from ..model.doors import door
from ..model.grid import Array, CylinderGrid, interpolate, resolved
from .streamlines import Streamline, streamlines

ZONE_WIDTH = 0.042
"""Width of an indifferent zone, in radii."""
STREAM_WIDTH = 0.056
"""Width of a streamline at its thick end where the flow is fastest, in radii."""
THIN_END = 0.1
"""Width of the thin end of a streamline over that of its thick end."""
NEGLIGIBLE = 0.02
"""Fraction of the peak speed below which no streamlines are drawn."""
ZONE_POINTS = 128
"""Zones are traced on at least this many points around, so that they look smooth."""
_CAP = np.linspace(0.5 * np.pi, -0.5 * np.pi, 7)[1:-1]

Window = tuple[float, float]
Ribbon = tuple[Array, float]
"""A streamline as a polygon (n, 2) of unwrapped (theta, z), and its strength."""


@door
def zone_ribbons(grid: CylinderGrid, P: npt.ArrayLike, window: Window, scale: float = 1.0) -> list[Array]:
    """Return the indifferent zones of a state (2, n_theta, n_z) as polygons (n, 2) of (theta, z).

    Only parts at angles within `window` are returned; in z the polygons may extend beyond the cylinder and
    should be clipped. `scale` multiplies the width. A line thins out and ends where the filaments on its two
    sides do not point in opposite directions (`cyclosis.zones.contrast`): none is drawn in disorder, where
    P_z changes sign everywhere without separating any streams.
    """
    state = resolved(grid.check_state(P))
    around = contrast(grid, state)
    if not np.any(weight(around)):
        return []
    least = grid.n_theta if grid.n_z == 1 else min(grid.shape)
    factor = -(-ZONE_POINTS // least)
    fine = grid.resized(factor * grid.n_theta, ZONE_POINTS if grid.n_z == 1 else factor * grid.n_z)
    polygons = []
    for zone in indifferent_zones(fine, interpolate(state, fine.shape)):
        place = np.stack([zone.theta * grid.n_theta / (2 * np.pi), zone.z * grid.n_z / grid.length])
        plain = weight(map_coordinates(around, place, order=1, mode="grid-wrap"))
        for run in runs(plain > 0):
            width = scale * ZONE_WIDTH * plain[run]
            polygons += list(_copies(ribbon(zone.theta[run], zone.z[run], width), window, grid.length))
    return polygons


def runs(chosen: npt.NDArray[np.bool_]) -> Iterator[slice]:
    """Yield the stretches of at least two consecutive points that are chosen."""
    edges = np.flatnonzero(np.diff(chosen, prepend=False, append=False))
    for first, end in zip(edges[::2], edges[1::2], strict=True):
        if end - first > 1:
            yield slice(int(first), int(end))


@door
def stream_ribbons(
    grid: CylinderGrid, u: npt.ArrayLike, window: Window, peak_speed: float, scale: float = 1.0
) -> tuple[list[Array], Array]:
    """Return streamlines of a flow (2, n_theta, n_z) as polygons (n, 2) of (theta, z), and strengths.

    They are made by `stream_ribbon`; nothing is drawn below 2 % of `peak_speed`. `window` and `scale` are
    as for `zone_ribbons`; `scale` also multiplies the distance between lines.
    """
    if peak_speed <= 0:
        return [], np.empty(0)
    lines = streamlines(
        grid, u, separation=0.095 * scale, length=1.25 * scale, slowest=NEGLIGIBLE * peak_speed
    )
    return placed([stream_ribbon(line, peak_speed, scale) for line in lines], window, grid.length)


def stream_ribbon(line: Streamline, peak_speed: float, scale: float = 1.0, shown: float = 1.0) -> Ribbon:
    """Return a streamline as a polygon that widens downstream, and its strength, in 0 to 1.

    The strength is the root of the line's mean speed over `peak_speed`, times `shown`, and also a factor
    of the width; `scale` is another.
    """
    width, strength = tapered(line.speed, peak_speed, scale, shown)
    return ribbon(line.theta, line.z, width), strength


def tapered(speed: Array, peak_speed: float, scale: float = 1.0, shown: float = 1.0) -> tuple[Array, float]:
    """Return the widths (n,) of a streamline with speeds (n,), and its strength, as for `stream_ribbon`."""
    strength = shown * float(np.sqrt(min(1.0, speed.mean() / peak_speed)))
    return scale * STREAM_WIDTH * strength * np.linspace(THIN_END, 1.0, speed.size), strength


def placed(ribbons: Iterable[Ribbon], window: Window, length: float) -> tuple[list[Array], Array]:
    """Return all periodic copies of ribbons that are visible in a window, and their strengths (n,)."""
    polygons: list[Array] = []
    strengths: list[float] = []
    for polygon, strength in ribbons:
        copies = list(_copies(polygon, window, length))
        polygons += copies
        strengths += [strength] * len(copies)
    return polygons, np.array(strengths)


def paint(
    ax: Any, polygons: list[Array], colour: str, alpha: Array | float = 1.0, clip: Path | None = None
) -> None:
    """Add polygons (n, 2) in picture coordinates to axes, in one colour, clipped to a path.

    `alpha` is one opacity or one for each polygon.
    """
    faces = np.empty((len(polygons), 4))
    faces[:, :3], faces[:, 3] = to_rgb(colour), alpha
    lines = PolyCollection(polygons, facecolors=faces, edgecolors="none", zorder=2)
    ax.add_collection(lines, autolim=False)
    if clip is not None:
        lines.set_clip_path(clip, ax.transData)


def _copies(polygon: Array, window: Window, length: float) -> Iterator[Array]:
    """Yield the periodic copies of a polygon that are visible in the window, cut at its sides."""
    low, high = polygon.min(axis=0), polygon.max(axis=0)
    for dz in _shifts(low[1], high[1], length, (0.0, length)):
        for turn in _shifts(low[0], high[0], 2 * np.pi, window):
            copy = polygon + np.array([turn, dz])
            # Points beyond a side are moved onto it, so that the part outside has no area.
            np.clip(copy[:, 0], *window, out=copy[:, 0])
            yield copy


def _shifts(low: float, high: float, period: float, window: Window) -> Iterator[float]:
    """Yield the multiples of the period that bring part of an interval into the window."""
    first, last = math.ceil((window[0] - high) / period), math.floor((window[1] - low) / period)
    return (period * k for k in range(first, last + 1))


def ribbon(theta: Array, z: Array, width: Array) -> Array:
    """Return the outline (n, 2) of a line (theta, z) of given widths (all (m,)), with round ends."""
    return outline(np.stack([theta, z]), width, lambda along: np.stack([-along[1], along[0]]))


def outline(middle: Array, width: Array, across: Callable[[Array], Array]) -> Array:
    """Return the outline (n, d) of a line (d, m) of given widths (m,), with round ends.

    `across` gives the unit vectors to the left of the line's directions (d, m).
    """
    half = 0.5 * width
    steps = np.diff(middle)
    along = np.concatenate([steps[:, :1], steps[:, 1:] + steps[:, :-1], steps[:, -1:]], axis=1)
    along /= np.maximum(np.hypot.reduce(along), 1e-300)
    normal = across(along)

    def cap(end: int, sense: float) -> Array:
        out, side = sense * along[:, [end]], sense * normal[:, [end]]
        return middle[:, [end]] + half[end] * (np.cos(_CAP) * out + np.sin(_CAP) * side)

    left, right = middle + half * normal, (middle - half * normal)[:, ::-1]
    return np.concatenate([left, cap(-1, 1.0), right, cap(0, -1.0)], axis=1).T
