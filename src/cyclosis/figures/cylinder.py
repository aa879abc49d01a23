"""A state on a cylinder: an orthographic view of the side that faces the viewer."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import numpy.typing as npt
from matplotlib.patches import Ellipse, PathPatch
from matplotlib.path import Path
from scipy.ndimage import map_coordinates, spline_filter

from ..model.doors import door
from ..model.errors import number
from ..model.grid import Array, CylinderGrid, resolved
from .ribbons import Ribbon, paint, placed, stream_ribbons, zone_ribbons
from .style import INK, PAPER, ZONE, state_rgb

__all__ = [
    "PIXELS",
    "TILT",
    "checked_tilt",
    "draw",
    "extent",
    "project",
]


def __dir__() -> list[str]:
    return sorted(__all__)


TILT = 0.2
"""Default angle, in radians, by which the viewer looks down on the cylinder."""
PIXELS = 320
"""Default number of colour samples across the diameter: 300 dpi for a cylinder 27 mm wide."""
_DARKEST = 0.58


def project(
    theta: npt.ArrayLike, z: npt.ArrayLike, view_angle: float, tilt: float, r: npt.ArrayLike = 1.0
) -> tuple[Array, Array, npt.NDArray[np.bool_]]:
    """Return where points of the surface appear: picture coordinates x, y, and whether they are visible.

    Orthographic; the axis is vertical, the meridian theta = `view_angle` faces the viewer, theta grows to
    the right, and the viewer looks down by `tilt` radians. Lengths are in radii; y = 0 is the middle of
    the lower end. Points beyond the silhouette, on the far half of the surface, are hidden. `r` is the
    distance from the axis.
    """
    angle = np.asarray(theta, dtype=np.float64) - view_angle
    facing, radius = np.cos(angle), np.asarray(r, dtype=np.float64)
    y = np.asarray(z, dtype=np.float64) * np.cos(tilt) - radius * facing * np.sin(tilt)
    return radius * np.sin(angle), y, facing > 0


def checked_tilt(tilt: float) -> float:
    """Return a tilt in radians, or raise `InputError` for one that would hide the side of the cylinder."""
    return number("tilt", tilt, 0.0, 1.2, "choose an angle in radians")


def extent(length: float, tilt: float = TILT) -> tuple[float, float, float, float]:
    """Return left, right, bottom and top of the picture of a cylinder, in radii."""
    return -1.0, 1.0, -float(np.sin(tilt)), float(length * np.cos(tilt) + np.sin(tilt))


@door
def draw(
    ax: Any,
    grid: CylinderGrid,
    P: npt.ArrayLike,
    u: npt.ArrayLike,
    *,
    view_angle: float = np.pi,
    tilt: float = TILT,
    streamlines: bool = True,
    peak_speed: float | None = None,
    ribbons: Sequence[Ribbon] | None = None,
    pixels: int = PIXELS,
) -> None:
    """Draw a state P and its flow u, both (2, n_theta, n_z), as a cylinder into matplotlib axes.

    Colours show P_z (purple up, green down, darker for smaller magnitude), white lines the indifferent
    zones P_z = 0, dark lines the flow, from their thin to their thick ends. `view_angle` (radians) is
    the angle theta that faces the viewer, `tilt` (radians, 0 to 1.2) how far the viewer looks down.
    `peak_speed` is the speed of the strongest lines, by default that of this flow; give a run's peak
    to compare frames. `ribbons` are streamlines to draw instead of new ones.
    `pixels` is the number of colour samples across the diameter. Everything is dimensionless. Raises
    `InputError` for fields that do not match the grid.

    Example:
        >>> import matplotlib.figure
        >>> import cyclosis as cy
        >>> from cyclosis.figures import cylinder
        >>> grid = cy.CylinderGrid(16, 16)
        >>> P = cy.initial.stripes(grid)
        >>> ax = matplotlib.figure.Figure().add_subplot()
        >>> cylinder.draw(ax, grid, P, cy.flow(cy.Parameters(), grid, P), view_angle=0.0)
        >>> len(ax.images) > 0
        True
    """
    state, flow = resolved(grid.check_state(P)), grid.check_state(u, "the flow")
    view_angle = number("view_angle", view_angle, -1e6, 1e6, "choose an angle in radians")
    tilt = checked_tilt(tilt)
    box = extent(grid.length, tilt)
    body = _body(grid.length, tilt)
    image = ax.imshow(
        _shaded(grid, state, view_angle, tilt, pixels),
        extent=box,
        origin="lower",
        interpolation="bilinear",
        zorder=1,
    )
    image.set_clip_path(body, ax.transData)
    window = (view_angle - 0.5 * np.pi, view_angle + 0.5 * np.pi)

    def paint_on(polygons: list[Array], colour: str, alpha: Array | float = 1.0) -> None:
        flat = [np.stack(project(p[:, 0], p[:, 1], view_angle, tilt)[:2], axis=1) for p in polygons]
        paint(ax, flat, colour, alpha, clip=body)

    if streamlines:
        peak = float(np.hypot(*flow).max()) if peak_speed is None else peak_speed
        lines, strength = (
            stream_ribbons(grid, flow, window, peak)
            if ribbons is None
            else placed(ribbons, window, grid.length)
        )
        paint_on(lines, INK, strength)
    paint_on(zone_ribbons(grid, state, window), ZONE)
    lid = Ellipse(
        (0.0, grid.length * np.cos(tilt)),
        2.0,
        2.0 * np.sin(tilt),
        facecolor=PAPER,
        edgecolor=INK,
        linewidth=0.6,
        zorder=4,
    )
    # As artists, because patches would be measured to set limits that are already known.
    ax.add_artist(PathPatch(body, facecolor="none", edgecolor=INK, linewidth=0.6, zorder=3))
    ax.add_artist(lid)
    ax.set(xlim=(-1.03, 1.03), ylim=(box[2] - 0.03, box[3] + 0.03), aspect="equal")
    ax.set_axis_off()


def _body(length: float, tilt: float) -> Path:
    """Return the outline of the visible side: two straight edges and the near halves of the ends."""
    angle = np.linspace(-0.5 * np.pi, 0.5 * np.pi, 91)
    low = np.stack(project(angle, 0.0 * angle, 0.0, tilt)[:2], axis=1)
    high = np.stack(project(angle, length + 0.0 * angle, 0.0, tilt)[:2], axis=1)
    return Path(np.concatenate([low, high[::-1], low[:1]]), closed=True)


def _shaded(grid: CylinderGrid, P: Array, view_angle: float, tilt: float, pixels: int) -> Array:
    """Return the colours (rows, columns, 3) of the picture, from its lower left corner."""
    left, right, bottom, top = extent(grid.length, tilt)
    rows = max(2, round(pixels * (top - bottom) / (right - left)))
    x = (np.arange(pixels) + 0.5) * (right - left) / pixels + left
    y = (np.arange(rows) + 0.5) * (top - bottom) / rows + bottom
    facing = np.sqrt(1.0 - x**2)
    theta = np.broadcast_to(np.arcsin(x) + view_angle, (rows, pixels))
    z = (y[:, None] + facing * np.sin(tilt)) / np.cos(tilt)
    index = np.stack([theta * grid.n_theta / (2 * np.pi), z * grid.n_z / grid.length])
    splines = [spline_filter(part, order=3, mode="grid-wrap") for part in P]
    found = [map_coordinates(part, index, order=3, mode="grid-wrap", prefilter=False) for part in splines]
    colours = state_rgb(np.stack(found))
    return colours * (_DARKEST + (1 - _DARKEST) * facing)[:, None]
