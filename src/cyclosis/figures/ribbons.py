"""Lines with a width, painted on the surface: indifferent zones and streamlines as polygons.

A polygon follows the surface, so that a line narrows towards the silhouette of a cylinder as paint would.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
import numpy.typing as npt
from matplotlib.collections import PolyCollection
from matplotlib.colors import to_rgb
from matplotlib.path import Path

from ..analysis.regimes import DISORDER
from ..analysis.zones import indifferent_zones
from ..model.grid import Array, CylinderGrid, interpolate
from .streamlines import streamlines

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


def zone_ribbons(grid: CylinderGrid, P: npt.ArrayLike, window: Window, scale: float = 1.0) -> list[Array]:
    """Return the indifferent zones of a state (2, n_theta, n_z) as polygons (n, 2) of (theta, z).

    Only what lies at angles within `window` is returned; in z the polygons may reach beyond the
    cylinder and should be clipped. `scale` multiplies the width. None in a disordered state
    (<|P|²>^½ < 0.05), where P_z changes sign all over without separating any streams.
    """
    state = grid.check_state(P)
    if np.sqrt(np.mean(np.sum(state**2, axis=0))) < DISORDER:
        return []
    factor = -(-ZONE_POINTS // min(grid.shape))
    fine = grid.resized(factor * grid.n_theta, factor * grid.n_z)
    polygons = []
    for zone in indifferent_zones(fine, interpolate(state, fine.shape)):
        width = np.full(zone.theta.size, scale * ZONE_WIDTH)
        polygons += list(_copies(zone.theta, zone.z, width, window, grid.length))
    return polygons


def stream_ribbons(
    grid: CylinderGrid, u: npt.ArrayLike, window: Window, peak_speed: float, scale: float = 1.0
) -> tuple[list[Array], Array]:
    """Return streamlines of a flow (2, n_theta, n_z) as polygons (n, 2) of (theta, z), and strengths.

    Each polygon widens downstream. Its strength, in 0 to 1 and also a factor of its width, is the square
    root of the line's mean speed over `peak_speed`; nothing is drawn below 2 % of that speed. `window`
    and `scale` are as for `zone_ribbons`, `scale` also spreads the lines.
    """
    if peak_speed <= 0:
        return [], np.empty(0)
    polygons: list[Array] = []
    strengths: list[float] = []
    lines = streamlines(
        grid, u, separation=0.095 * scale, length=1.25 * scale, slowest=NEGLIGIBLE * peak_speed
    )
    for line in lines:
        strength = float(np.sqrt(min(1.0, line.speed.mean() / peak_speed)))
        width = scale * STREAM_WIDTH * strength * np.linspace(THIN_END, 1.0, line.theta.size)
        copies = list(_copies(line.theta, line.z, width, window, grid.length))
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


def _copies(theta: Array, z: Array, width: Array, window: Window, length: float) -> Iterator[Array]:
    """Yield ribbons of all periodic copies of a line that show within the window, cut at its sides."""
    for dz in _shifts(z, length, (0.0, length)):
        for turn in _shifts(theta, 2 * np.pi, window):
            angle = theta + turn
            inside = np.flatnonzero((angle >= window[0]) & (angle <= window[1]))
            for run in np.split(inside, np.flatnonzero(np.diff(inside) > 1) + 1):
                if run.size > 1:
                    polygon = ribbon(angle[run], z[run] + dz, width[run])
                    polygon[:, 0] = np.clip(polygon[:, 0], *window)
                    yield polygon


def _shifts(values: Array, period: float, window: Window) -> Array:
    """Return the multiples of the period that bring part of the values into the window."""
    first = np.ceil((window[0] - values.max()) / period)
    last = np.floor((window[1] - values.min()) / period)
    return period * np.arange(first, last + 1)


def ribbon(theta: Array, z: Array, width: Array) -> Array:
    """Return the outline (n, 2) of a line (theta, z) of given widths (all (m,)), with round ends."""
    along = np.gradient(np.stack([theta, z]), axis=1)
    along /= np.maximum(np.hypot(*along), 1e-300)
    normal = np.stack([-along[1], along[0]])
    middle, half = np.stack([theta, z]), 0.5 * width

    def cap(end: int, sense: float) -> Array:
        out, side = sense * along[:, [end]], sense * normal[:, [end]]
        return middle[:, [end]] + half[end] * (np.cos(_CAP) * out + np.sin(_CAP) * side)

    left, right = middle + half * normal, (middle - half * normal)[:, ::-1]
    return np.concatenate([left, cap(-1, 1.0), right, cap(0, -1.0)], axis=1).T
