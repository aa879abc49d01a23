"""The section of Poincaré of a flow in the vacuole: where tracers pass one cross-section, again and again."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib import colormaps
from matplotlib.figure import Figure
from matplotlib.patches import Circle

from ..model.doors import door
from ..model.errors import InputError, number, whole
from ..vacuole import poincare, stream_function, trace
from ..vacuole.flow import VacuoleFlow
from ..vacuole.section import winding
from . import looks, quantities
from .looks import setting
from .style import INK, QUIET, TYPE, blank, place, scale_bar

__all__ = [
    "vacuole_poincare",
]


def __dir__() -> list[str]:
    return sorted(__all__)


TRACERS, DURATION = 32, 800.0
"""Tracers, and how long they are followed, in R/U."""
LEVELS, ACROSS = 13, 161
"""Lines of the stream function, and points across the section for them."""
# Places in millimetres.
_MARGIN, _ABOVE, _BAR = 3.0, 8.0, 6.0


@door
def vacuole_poincare(
    flow: VacuoleFlow, z: float = 0.0, tracers: int = TRACERS, t_end: float = DURATION, width: float = 90.0
) -> Figure:
    """Return the figure of where tracers cross the section at `z`, or its images a period away.

    The flow is that of one time, which stays as it is, periodic along z. Each of `tracers` has a colour, by
    the radius at which it begins; dots are its crossings within `t_end`, in either direction. In a straight
    flow a tracer has one place. In a helical flow its dots lie on a line ψ = constant, which are drawn; dots
    that fill an area would show chaos. Lengths are in R, times in R/U; `width` is in millimetres. Raises
    `InputError` for anything but a steady flow, and for values out of range.

    Example:
        >>> import numpy as np
        >>> import cyclosis as cy
        >>> from cyclosis.figures.vacuole_poincare import vacuole_poincare
        >>> grid = cy.CylinderGrid(16, 16)
        >>> flow = cy.vacuole.flow(grid, cy.vacuole.helical_bands(grid, np.sin, 5.0))
        >>> figure = vacuole_poincare(flow, tracers=4, t_end=40.0)
        >>> len(figure.axes[0].collections[-1].get_offsets()) > 4
        True
    """
    if not isinstance(flow, VacuoleFlow):
        rule, remedy = "a VacuoleFlow", "use cyclosis.vacuole.flow(run, t=...)"
        raise InputError("flow", type(flow).__name__, rule, remedy)
    height = number("z", z, -1e9, 1e9, "give a position along the axis, in R")
    count = whole("tracers", tracers, 1, 1000, "choose a number of tracers")
    duration = number("t_end", t_end, 1.0, 1e5, "give a duration in R/U")
    # Spread evenly over the section by the golden angle.
    share = (np.arange(count) + 0.5) / count
    angle = np.pi * (3 - np.sqrt(5.0)) * np.arange(count)
    starts = np.stack([np.sqrt(share), angle, np.full(count, height)], axis=1)
    found = poincare(trace(flow, starts, duration), height)
    width = number("width", width, 60.0, 1000.0, "choose a width in millimetres")
    with setting(TYPE):
        side = width - 2 * _MARGIN
        below = _MARGIN if looks.scales() is None else _MARGIN + _BAR
        figure = blank(width, side + below + _ABOVE)
        ax = place(figure, _MARGIN, below, side, side)
        if winding(flow):
            _lines(ax, flow, height)
        colours = colormaps["viridis"](np.sqrt(share))
        ax.scatter(*found.xy.T, c=colours[found.tracer], s=2.2, linewidths=0, rasterized=True, zorder=2)
        ax.add_patch(Circle((0, 0), 1.0, facecolor="none", edgecolor=INK, linewidth=0.8, zorder=3))
        ax.set(xlim=(-1.03, 1.03), ylim=(-1.03, 1.03), aspect="equal")
        ax.set_axis_off()
        ax.set_title(f"$z$ = {quantities.words(height, 'length', 'g')}", loc="left", fontsize=10.0, pad=2.0)
        told = f"{count} tracers, {quantities.words(duration, 'time', 'g', '$R/U$')}"
        scale_bar(ax, looks.scales(), (-1.0, 1.0, -1.0, 1.0))
        ax.set_title(told, loc="right", fontsize=9.0, pad=2.0)
        return figure


def _lines(ax: Any, flow: VacuoleFlow, z: float) -> None:
    """Draw the lines of the stream function of a helical flow."""
    try:
        psi = stream_function(flow)
    except InputError:  # a helical wall with a divergence has none
        return
    across = np.linspace(-1.0, 1.0, ACROSS)
    x, y = np.meshgrid(across, across, indexing="ij")
    r = np.hypot(x, y)
    points = np.stack([np.minimum(r, 1.0), np.arctan2(y, x), np.full_like(r, z)], axis=-1)
    values = psi.at(points.reshape(-1, 3)).reshape(r.shape)
    levels = np.linspace(-1, 1, 2 * (LEVELS // 2) + 3)[1:-1] * np.abs(values).max()
    shown = np.where(r <= 1.0, values, np.nan)
    ax.contour(
        across, across, shown.T, levels=levels, colors=[QUIET], linewidths=0.6, linestyles="solid", zorder=1
    )
