"""A state on the unwrapped surface: theta to the right, z up."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from ..model.doors import door
from ..model.grid import CylinderGrid, interpolate
from ..model.scales import Scales
from ..model.units import length_text
from .edges import mark_height
from .ribbons import Ribbon, paint, placed, stream_ribbons, zone_ribbons
from .style import INK, ZONE, state_rgb

__all__ = [
    "SCALE",
    "draw_map",
    "mark_edges",
    "paint_map",
]


def __dir__() -> list[str]:
    return sorted(__all__)


SCALE = 1.35
"""Lines are wider and sparser than on a cylinder, because maps are printed at a smaller scale."""
_EDGE = 0.2


@door
def draw_map(
    ax: Any,
    grid: CylinderGrid,
    P: npt.ArrayLike,
    u: npt.ArrayLike,
    *,
    streamlines: bool = True,
    peak_speed: float | None = None,
) -> None:
    """Draw a state P and its flow u, both (2, n_theta, n_z), as a map into matplotlib axes.

    theta increases from 0 to 2π to the right and z from 0 to the grid's length upwards, on one scale.
    Colours, lines and `peak_speed` are as in `cyclosis.figures.cylinder.draw`. Everything is
    dimensionless. Raises `InputError` for fields that do not match the grid.

    Example:
        >>> import matplotlib.figure
        >>> import cyclosis as cy
        >>> from cyclosis.figures.unwrapped import draw_map
        >>> grid = cy.CylinderGrid(16, 16, length=5.0)
        >>> P = cy.initial.stripes(grid)
        >>> ax = matplotlib.figure.Figure().add_subplot()
        >>> draw_map(ax, grid, P, cy.flow(cy.Parameters(), grid, P))
        >>> [float(end) for end in ax.get_ylim()]
        [0.0, 5.0]
    """
    paint_map(ax, grid, P, u, streamlines=streamlines, peak_speed=peak_speed)
    mark_edges(ax, grid)


@door
def mark_edges(ax: Any, grid: CylinderGrid, scales: Scales | None = None) -> None:
    """Put ticks at the edges of a map: its height is in radii, or in micrometres with `scales`."""
    ax.set_xticks([0, 2 * np.pi], ["0", "2π"])
    mark_height(ax, length_text(grid.length, scales), grid.length)


@door
def paint_map(
    ax: Any,
    grid: CylinderGrid,
    P: npt.ArrayLike,
    u: npt.ArrayLike,
    *,
    streamlines: bool = True,
    peak_speed: float | None = None,
    ribbons: Sequence[Ribbon] | None = None,
    scale: float = SCALE,
) -> None:
    """Paint a map as `draw_map` does and set the limits of the axes, but not their ticks.

    `ribbons` are as in `cyclosis.figures.cylinder.draw`; `scale` multiplies the widths of lines, and the
    distances between new ones.
    """
    state, flow = grid.check_state(P), grid.check_state(u, "the flow")
    # Lines are sought a little beyond the edges and clipped there, so that they continue seamlessly.
    window = (-_EDGE, 2 * np.pi + _EDGE)
    fine = interpolate(state, (4 * grid.n_theta, 4 * grid.n_z))
    d_theta, d_z = 2 * np.pi / fine.shape[1], grid.length / fine.shape[2]
    ax.imshow(
        state_rgb(np.pad(fine, ((0, 0), (0, 1), (0, 1)), mode="wrap").transpose(0, 2, 1)),
        origin="lower",
        interpolation="bilinear",
        extent=(-0.5 * d_theta, 2 * np.pi + 0.5 * d_theta, -0.5 * d_z, grid.length + 0.5 * d_z),
        zorder=1,
    )
    if streamlines:
        peak = float(np.hypot(*flow).max()) if peak_speed is None else peak_speed
        lines, strength = (
            stream_ribbons(grid, flow, window, peak, scale)
            if ribbons is None
            else placed(ribbons, window, grid.length)
        )
        paint(ax, lines, INK, strength)
    paint(ax, zone_ribbons(grid, state, window, scale), ZONE)
    ax.set(xlim=(0, 2 * np.pi), ylim=(0, grid.length), aspect="equal")
