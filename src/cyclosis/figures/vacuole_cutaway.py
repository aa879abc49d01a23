"""The cell cut open: the far half of its wall coloured by P_z, and streamlines of the flow inside."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from matplotlib.patches import Ellipse, PathPatch
from matplotlib.path import Path
from scipy.ndimage import map_coordinates, spline_filter

from ..model.doors import door
from ..model.errors import InputError, number, whole
from ..model.grid import Array, CylinderGrid, resolved
from ..model.precision import double
from ..vacuole.flow import VacuoleFlow
from ..vacuole.splines import coefficients, compiled_velocity, lattice_of
from ..vacuole.tracers import cartesian_places
from . import looks
from .cylinder import TILT, checked_tilt
from .looks import setting
from .streamlines import traced
from .style import INK, PAPER, QUIET, TYPE, ZONE, blank, colour_key, place, polarity_rgb, scale_bar

__all__ = [
    "ACROSS",
    "LINES",
    "LONG",
    "PIXELS",
    "STEPS",
    "spread_streamlines",
    "vacuole_cutaway",
    "velocity_in",
]


def __dir__() -> list[str]:
    return sorted(__all__)


PIXELS = 480
"""Colour samples across the diameter."""
LINES = 70
"""Streamlines."""
LONG = 2.4
"""Length of a streamline, in radii."""
STEPS = 60
"""Steps along it."""
ACROSS = 32
"""Points across the diameter from which the velocity is interpolated."""
_MARGIN, _KEY, _BELOW, _BAR = 4.0, 16.0, 3.0, 8.0
_NARROW = 0.2
"""Width of a streamline at its thin end over that at its thick end."""


@door
def vacuole_cutaway(
    flow: VacuoleFlow,
    P: Any,
    view_angle: float = np.pi,
    tilt: float = TILT,
    lines: int = LINES,
    width: float = 90.0,
) -> Figure:
    """Return the figure of a cell whose near half is cut away, with the streamlines inside.

    The inner side of the far wall shows P_z of the state `P` (2, n_theta, n_z): purple up, green down, white
    lines P_z = 0. Streamlines run from their thin to their thick ends; their colours show v_z in the same
    way, and those nearer to the viewer are stronger. The viewer looks at the inner side of the meridian
    opposite to `view_angle` (radians), down by `tilt` (radians). Lengths are in R; `width` is in millimetres.

    Example:
        >>> import cyclosis as cy
        >>> from cyclosis.figures.vacuole_cutaway import vacuole_cutaway
        >>> grid = cy.CylinderGrid(16, 16)
        >>> P = cy.initial.stripes(grid)
        >>> flow = cy.vacuole.flow_of_state(cy.Parameters(), grid, P)
        >>> len(vacuole_cutaway(flow, P, lines=8).axes)
        2
    """
    if not isinstance(flow, VacuoleFlow):
        raise InputError(
            "flow", type(flow).__name__, "a VacuoleFlow", "use cyclosis.vacuole.flow(run, t=...)"
        )
    grid = flow.grid
    state = resolved(grid.check_state(P, "P"))
    view_angle = number("view_angle", view_angle, -1e6, 1e6, "choose an angle in radians")
    tilt = checked_tilt(tilt)
    lines = whole("lines", lines, 0, 2000, "choose a number of streamlines")
    width = number("width", width, 60.0, 1000.0, "choose a width in millimetres")
    up = float(grid.length * np.cos(tilt) + 2 * np.sin(tilt))
    with setting(TYPE):
        across = width - 2 * _MARGIN - _KEY
        below = _BELOW if looks.scales() is None else _BELOW + _BAR
        figure = blank(width, across * up / 2 + below + _BELOW)
        ax = place(figure, _MARGIN, below, across, across * up / 2)
        _wall(ax, grid, state[1], view_angle, tilt)
        if lines:
            _streamlines(ax, flow, view_angle, tilt, lines)
        low = -float(np.sin(tilt))
        scale_bar(ax, looks.scales(), (-1.0, 1.0, low, low + up))
        colour_key(
            place(figure, _MARGIN + across + 5.0, below + 0.3 * across * up / 2, 3.0, 0.4 * across * up / 2)
        )
        return figure


def _wall(ax: Any, grid: CylinderGrid, P_z: Array, view_angle: float, tilt: float) -> None:
    """Draw the far half of the wall, from inside, between the lower end and the rim of the upper one."""
    low, high = -float(np.sin(tilt)), float(grid.length * np.cos(tilt) + np.sin(tilt))
    rows = max(2, round(PIXELS * (high - low) / 2))
    x = (np.arange(PIXELS) + 0.5) * 2 / PIXELS - 1
    y = (np.arange(rows) + 0.5) * (high - low) / rows + low
    away = np.sqrt(1.0 - x**2)
    theta = np.broadcast_to(np.pi - np.arcsin(x) + view_angle, (rows, PIXELS))
    z = (y[:, None] - away * np.sin(tilt)) / np.cos(tilt)
    index = np.stack([theta * grid.n_theta / (2 * np.pi), z * grid.n_z / grid.length])
    values = map_coordinates(
        spline_filter(P_z, order=3, mode="grid-wrap"), index, order=3, mode="grid-wrap", prefilter=False
    )
    colours = polarity_rgb(values) * (0.55 + 0.45 * away)[:, None]
    outline = _far_half(grid.length, tilt)
    image = ax.imshow(colours, extent=(-1, 1, low, high), origin="lower", interpolation="bilinear", zorder=1)
    image.set_clip_path(outline, ax.transData)
    if values.min() < -0.02 < 0.02 < values.max():
        zones = ax.contour(x, y, values, levels=[0.0], colors=[ZONE], linewidths=1.5, zorder=2)
        zones.set_clip_path(outline, ax.transData)
    floor = Ellipse((0, 0), 2, 2 * np.sin(tilt), facecolor=PAPER, edgecolor=INK, linewidth=0.6, zorder=3)
    ax.add_artist(PathPatch(outline, facecolor="none", edgecolor=INK, linewidth=0.6, zorder=4))
    ax.add_artist(floor)
    # The near half of the rim, where the wall was cut away.
    angle = np.linspace(0.5 * np.pi, -0.5 * np.pi, 91)
    top = grid.length * np.cos(tilt) - np.cos(angle) * np.sin(tilt)
    ax.plot(np.sin(angle), top, color=QUIET, linewidth=0.8, zorder=2000, dashes=(4, 2))
    ax.set(xlim=(-1.03, 1.03), ylim=(low - 0.02, high + 0.02), aspect="equal")
    ax.set_axis_off()


def _far_half(length: float, tilt: float) -> Path:
    angle = np.linspace(-0.5 * np.pi, 0.5 * np.pi, 91)
    rise = np.cos(angle) * np.sin(tilt)
    low = np.stack([np.sin(angle), rise], axis=1)
    high = np.stack([np.sin(angle), length * np.cos(tilt) + rise], axis=1)
    return Path(np.concatenate([low, high[::-1], low[:1]]), closed=True)


def _streamlines(ax: Any, flow: VacuoleFlow, view_angle: float, tilt: float, count: int) -> None:
    paths, speed = spread_streamlines(flow, count)
    fastest = max(float(speed.max()), 1e-300)
    turn = np.array([np.cos(view_angle), np.sin(view_angle)])
    length = flow.grid.length
    layers = [(k, shift) for shift in (-length, 0.0, length) for k in range(count)]  # the cell is periodic
    near = paths[:, :, 0] * turn[0] + paths[:, :, 1] * turn[1]  # towards the viewer
    right = -paths[:, :, 0] * turn[1] + paths[:, :, 1] * turn[0]
    slope = np.gradient(paths[:, :, 2], axis=1) / (LONG / STEPS)
    share = np.linspace(_NARROW, 1.0, STEPS)
    layers.sort(key=lambda item: float(near[item[0]].mean()))
    for layer, (k, shift) in enumerate(layers):
        z = paths[k, :, 2] + shift
        inside = (np.minimum(z[:-1], z[1:]) >= 0) & (np.maximum(z[:-1], z[1:]) <= length)
        if not inside.any():
            continue
        line = np.stack([right[k], z * np.cos(tilt) - near[k] * np.sin(tilt)], axis=1)
        parts = np.stack([line[:-1], line[1:]], axis=1)[inside]
        strength = float(np.sqrt(min(1.0, speed[k].mean() / fastest)))
        # Lighter than the wall behind, and fainter far away.
        colour = 0.35 + 0.65 * polarity_rgb(slope[k][:-1] * speed[k][:-1] / fastest)
        wide = 2.6 * strength * share * (0.75 + 0.45 * np.clip(near[k][:-1], -1, 1))
        for tint, extra in ((np.full((STEPS, 3), 0.08), 0.9), (colour, 0.0)):
            drawn = LineCollection(
                list(parts),
                colors=tint[inside],
                linewidths=wide[inside] + extra,
                capstyle="round",
                zorder=10 + layer + 0.5 * (extra == 0),
            )
            ax.add_collection(drawn, autolim=False)


def spread_streamlines(flow: VacuoleFlow, count: int) -> tuple[Array, Array]:
    """Return streamlines (count, steps + 1, 3) in x, y, z from places spread over the cell, and speeds.

    They have one length, whatever the speed. z is not wrapped.
    """
    velocity = velocity_in(flow)
    golden = 0.5 * (np.sqrt(5.0) - 1)
    k = np.arange(count)
    r, theta = np.sqrt((k + 0.5) / count) * 0.96, 2 * np.pi * golden * k
    z = np.mod(k * 0.7548776662466927, 1.0) * flow.grid.length
    paths = traced(velocity, cartesian_places(np.stack([r, theta, z], axis=1)), STEPS, LONG / STEPS)
    speeds = np.linalg.norm(velocity(paths.reshape(3, -1)), axis=0).reshape(paths.shape[1:])
    return paths.transpose(2, 1, 0), speeds.T


def velocity_in(flow: VacuoleFlow) -> Callable[[Array], Array]:
    """Return the velocity (3, n) at points (3, n) of x, y, z, by cubic splines: good enough to draw."""
    lattice = lattice_of(flow, order=3, refine=1, n_s=ACROSS)
    with double():
        table = coefficients(flow, lattice)

    def velocity(at: Array) -> Array:
        with double():
            return np.asarray(compiled_velocity(lattice)(table, at))

    return velocity
