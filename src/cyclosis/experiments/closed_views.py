"""Pictures of closed cells for experiments: what is seen from the side, as arrays, and how it is drawn."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt
from matplotlib.colors import ListedColormap

from ..closed.grid import Array, ClosedGrid
from ..figures.story import Drawn
from ..figures.style import INK, polarity_rgb

ACROSS, UP = 41, 81
"""Points of a picture, around the visible half and from pole to pole."""
FIELDS = ("x", "y", "colour", "u_x", "u_y")
"""What a picture is made of, at every point: its place, polarity, and the flow, as seen."""
COLOURS = ListedColormap([polarity_rgb(value) for value in np.linspace(-1, 1, 201)])


def seen(grid: ClosedGrid, P: Array, u: Array, angle: float, upright: bool = False) -> Array:
    """Return the `FIELDS` (5, ACROSS, UP) of a state, seen from the side that faces `angle`, axis upright.

    The colour is P_s, or, if `upright`, P_z: for spheres, whose poles mean nothing.
    """
    theta = np.linspace(-0.5 * np.pi, 0.5 * np.pi, ACROSS)[:, None]
    tau = np.linspace(0.01, np.pi - 0.01, UP)
    at = grid.surface.meridian(tau)
    around, along = theta + angle, at.r + 0 * theta
    points = np.stack([along * np.cos(around), along * np.sin(around), at.z + 0 * theta], axis=-1)
    P_at, u_at = (grid.cartesian(f, points.reshape(-1, 3)).reshape(points.shape) for f in (P, u))
    to_right = np.array([-np.sin(angle), np.cos(angle), 0.0])
    e_s = np.stack([at.slope * np.cos(around), at.slope * np.sin(around), at.rise + 0 * theta], axis=-1)
    colour = P_at[..., 2] if upright else np.sum(P_at * e_s, axis=-1)
    return np.stack([points @ to_right, points[..., 2], colour, u_at @ to_right, u_at[..., 2]])


def facing(grid: ClosedGrid, P: Array) -> float:
    """Return the angle at which polarity changes from one stream to the other, or 0 where it does not."""
    first = np.fft.rfft((P[1] * grid.weights).sum(axis=1))[1]
    return float(np.pi / 2 - np.angle(first))


def drawn(title: str, picture: npt.ArrayLike, arrows: bool = True) -> Drawn:
    """Return a picture as a part of the figure of an experiment."""
    x, y, colour, u_x, u_y = np.asarray(picture, dtype=np.float64)

    def draw(ax: Any) -> None:
        ax.pcolormesh(
            x, y, colour, cmap=COLOURS, vmin=-1, vmax=1, shading="gouraud", rasterized=True, zorder=1
        )
        outline = np.concatenate([np.stack([x[0], y[0]]), np.stack([x[-1], y[-1]])[:, ::-1]], axis=1)
        ax.fill(*outline, facecolor="none", edgecolor=INK, linewidth=0.6, zorder=3)
        if arrows:
            _arrows(ax, x, y, u_x, u_y)
        reach = np.abs(y).max() + 0.03
        ax.set(xlim=(-1.03, 1.03), ylim=(-reach, reach), aspect="equal")
        ax.set_axis_off()

    return Drawn(title, draw, 2.06, 2 * float(np.abs(y).max()) + 0.06, True)


def _arrows(ax: Any, x: Array, y: Array, u_x: Array, u_y: Array) -> None:
    """Draw the flow as arrows at points about as far apart everywhere; full length is a speed of 1."""
    high = float(np.abs(y).max())
    rows = max(5, round(high / 0.33))
    for level in (np.arange(rows) + 0.5) * 2 * high / rows - high:
        column = int(np.argmin(np.abs(y[0] - level)))
        reach = float(x[-1, column])
        places = np.linspace(-0.8, 0.8, max(1, round(5 * reach))) * reach
        for place in places:
            row = int(np.argmin(np.abs(x[:, column] - place)))
            ax.quiver(
                x[row, column], y[row, column], u_x[row, column], u_y[row, column], color=INK, angles="xy",
                scale_units="xy", scale=3.2, units="xy", width=0.028, zorder=4,
            )  # fmt: skip
