"""The axial velocity on a cross-section of the vacuole, and along a diameter of it."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Circle

from ..model.doors import door
from ..model.errors import number
from ..model.grid import Array
from ..vacuole.flow import VacuoleFlow
from . import looks, quantities
from .looks import setting
from .style import INK, QUIET, TYPE, WIDTH, ZONE, blank, place, polarity_rgb, scale_bar

__all__ = [
    "ARROWS",
    "RING",
    "vacuole_section",
]


def __dir__() -> list[str]:
    return sorted(__all__)


RADII, AROUND = 65, 360
"""Points of the colours on the section."""
ARROWS = 15
"""Arrows across the section."""
RING = 0.07
"""Width of the ring that shows the wall, in radii."""
# Places in millimetres.
_LEFT, _SIDE, _BELOW, _ABOVE, _KEY, _GAP, _RIGHT = 4.0, 62.0, 12.0, 9.0, 3.0, 22.0, 4.0


@door
def vacuole_section(
    flow: VacuoleFlow, z: float = 0.0, angle: float | None = None, width: float = WIDTH
) -> Figure:
    """Return the figure of the axial velocity on the section at `z`, and along a diameter of it.

    Colours show v_z (purple up, green down), white lines v_z = 0, and arrows the velocity across the axis, if
    there is any; the ring is the wall. On the right is v_z along the diameter at `angle`, by default
    the one through the fastest place of the wall, with the arctangent that two sharp bands of that speed
    would drive: (2/π) arctan(2r/(1 - r²)). Lengths are in R, speeds in U; `width` is in millimetres.

    Example:
        >>> import cyclosis as cy
        >>> from cyclosis.figures.vacuole_section import vacuole_section
        >>> grid = cy.CylinderGrid(16, 16)
        >>> flow = cy.vacuole.flow_of_state(cy.Parameters(), grid, cy.initial.stripes(grid))
        >>> len(vacuole_section(flow, z=2.5).axes)
        3
    """
    height = number("z", z, -1e9, 1e9, "give a position along the axis, in R")
    theta = np.linspace(0.0, 2 * np.pi, AROUND + 1)
    rim = flow.at(np.stack([np.ones_like(theta), theta, np.full_like(theta, height)], axis=1))[:, 2]
    if angle is None:
        angle = float(theta[np.argmax(np.abs(rim))])
    angle = number("angle", angle, -1e6, 1e6, "choose an angle in radians")
    width = number("width", width, 130.0, 1000.0, "choose a width in millimetres")
    with setting(TYPE):
        figure = blank(width, _BELOW + _SIDE + _ABOVE)
        peak = max(float(np.abs(rim).max()), 1e-300)
        _map(place(figure, _LEFT, _BELOW, _SIDE, _SIDE), flow, height, angle, rim, peak)
        key = place(figure, _LEFT + _SIDE + 4.0, _BELOW + 6.0, _KEY, _SIDE - 12.0)
        levels = np.linspace(-1.0, 1.0, 512)
        key.imshow(polarity_rgb(levels)[:, None], extent=(0, 1, -peak, peak), origin="lower", aspect="auto")
        unit = quantities.unit("speed")
        end = f"{unit.factor * peak:.3g}" if unit.name else f"{peak:.2g}"
        key.set(xticks=[], yticks=[-peak, 0.0, peak], yticklabels=[f"−{end}", "0", end])
        key.yaxis.tick_right()
        key.set_title(f"$v_z${unit.brackets}", pad=5.0, fontsize=10.0)
        start = _LEFT + _SIDE + 4.0 + _KEY + _GAP
        _diameter(place(figure, start, _BELOW, width - start - _RIGHT, _SIDE), flow, height, angle)
        return figure


def _map(ax: Any, flow: VacuoleFlow, z: float, angle: float, rim: Array, peak: float) -> None:
    radii = np.sin(0.5 * np.pi * np.linspace(0.0, 1.0, RADII))
    v_z = flow.section(z, radii=radii, n_theta=rim.size - 1)["v_z"].values
    v_z = np.concatenate([v_z, v_z[:, :1]], axis=1)
    theta = np.linspace(0.0, 2 * np.pi, rim.size)
    x, y = radii[:, None] * np.cos(theta), radii[:, None] * np.sin(theta)
    ring = np.array([[1.0], [1 + RING]])
    for across, up, values in (
        (x, y, v_z),
        (ring * np.cos(theta), ring * np.sin(theta), np.stack([rim, rim])),
    ):
        ax.pcolormesh(
            across,
            up,
            values / peak,
            cmap=looks.polarity_map(),
            vmin=-1,
            vmax=1,
            shading="gouraud",
            rasterized=True,
            zorder=1,
        )
    if np.min(v_z) < -1e-9 * peak < 1e-9 * peak < np.max(v_z):
        ax.contour(x, y, v_z, levels=[0.0], colors=[ZONE], linewidths=1.4, zorder=2)
    _arrows(ax, flow, z, peak)
    for radius in (1.0, 1 + RING):
        ax.add_patch(Circle((0, 0), radius, facecolor="none", edgecolor=INK, linewidth=0.6, zorder=4))
    end = np.array([np.cos(angle), np.sin(angle)])
    for sign in (-1, 1):
        near, far = sign * (1 + RING) * end, sign * (1 + 2.2 * RING) * end
        ax.plot(*np.stack([near, far], axis=1), color=INK, linewidth=1.0, zorder=5)
    edge = 1 + 2.4 * RING
    ax.set(xlim=(-edge, edge), ylim=(-edge, edge), aspect="equal")
    ax.set_axis_off()
    ax.set_title(f"$z$ = {quantities.words(z, 'length', 'g')}", loc="left", fontsize=10.0, pad=2.0)
    scale_bar(ax, looks.scales(), (-edge, edge, -edge, edge))


def _arrows(ax: Any, flow: VacuoleFlow, z: float, peak: float) -> None:
    data = flow.section(z, points=ARROWS)
    v_x, v_y = data["v_x"].values, data["v_y"].values
    x, y = np.meshgrid(data["x"].values, data["y"].values, indexing="ij")
    inside = np.hypot(x, y) < 0.97
    fastest = float(np.hypot(v_x, v_y)[inside].max())
    if fastest < 1e-6 * peak:
        return
    ax.quiver(
        *(part[inside] for part in (x, y, v_x, v_y)),
        angles="xy",
        scale_units="xy",
        scale=fastest * (ARROWS - 1) / 2,
        pivot="mid",
        width=0.0055,
        color="white",
        alpha=0.85,
        zorder=2,
    )
    ax.set_title(
        f"arrows: to {quantities.words(fastest, 'speed', '.2g')}", loc="right", fontsize=9.0, pad=2.0
    )


def _diameter(ax: Any, flow: VacuoleFlow, z: float, angle: float) -> None:
    x = np.sin(np.linspace(-0.5 * np.pi, 0.5 * np.pi, 241))
    points = np.stack([np.abs(x), np.where(x < 0, angle + np.pi, angle), np.full_like(x, z)], axis=1)
    v_z = flow.at(points)[:, 2]
    top = v_z[np.argmax(np.abs(v_z))]
    sharp = 2 / np.pi * np.arctan2(2 * x, 1 - x**2) * (top if np.abs(v_z[-1]) >= np.abs(v_z[0]) else -top)
    ax.axhline(0.0, color=QUIET, linewidth=0.6)
    ax.axvline(0.0, color=QUIET, linewidth=0.6)
    ax.plot(x, sharp, color=QUIET, linewidth=1.1, dashes=(4, 2), label="two sharp bands")
    ax.plot(x, v_z, color=INK, linewidth=1.5, label="this flow")
    peak = np.abs(v_z).max() or 1.0
    colours = polarity_rgb(v_z[::10] / peak)
    ax.scatter(x[::10], v_z[::10], c=colours, s=14, zorder=3, linewidths=0)
    ax.set(xlim=(-1.02, 1.02), xticks=[-1, -0.5, 0, 0.5, 1])
    quantities.name(ax.xaxis, f"along the diameter at θ = {angle:.2f}", "length", labelpad=2.0)
    quantities.name(ax.yaxis, "$v_z$", "speed")
    ax.spines[["top", "right"]].set_visible(False)
    ax.legend(loc="upper left", frameon=False, fontsize=9.0, handlelength=1.6)
