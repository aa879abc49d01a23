"""Two runs side by side at one time, and their difference."""

from __future__ import annotations

from typing import Any

import matplotlib
import numpy as np
from matplotlib.figure import Figure

from ..model.doors import door
from ..model.errors import InputError, number
from ..model.grid import interpolate
from ..model.units import scales_in
from .clock import time_text
from .frames import frame, grid_of, in_memory, indices_at, peak_speed
from .looks import setting
from .style import TYPE, WIDTH, blank, colour_key, place
from .unwrapped import mark_edges, paint_map

__all__ = [
    "compare",
]


def __dir__() -> list[str]:
    return sorted(__all__)


# Places in millimetres.
_MARGIN, _TITLE, _AXIS, _LABEL, _APART, _KEY = 3.0, 12.0, 7.0, 7.0, 5.0, 11.0
_DIFFERENCE = "berlin"
"""Colours of the difference: others than those of P_z, dark at zero too, and safe for all colour vision."""


@door
def compare(
    first: Any,
    second: Any,
    time: float | None = None,
    names: tuple[str, str] = ("A", "B"),
    width: float = WIDTH,
) -> Figure:
    """Return the maps of two runs on cylinders of one length at one time, and the difference in P_z.

    `first` and `second` are datasets of runs; of each the saved frame nearest to `time` (dimensionless) is
    drawn, by default the last time that both have reached. A state on another grid is interpolated to that
    of the first. The third map is P_z of the first minus that of the second, on a scale of its own, and its
    title is <|ΔP|²>^½, the root mean square of the whole difference of P. `names` are those above the maps;
    `width` is in millimetres. Raises `InputError` for closed cells, cells of different length, and times that
    one of the two does not have.

    Example:
        >>> import cyclosis as cy
        >>> from cyclosis.figures.compare import compare
        >>> grid = cy.CylinderGrid(16, 16)
        >>> state = cy.initial.stripes(grid, magnitude=0.5)
        >>> one, other = (
        ...     cy.simulate(cy.Parameters(alpha_u=value), grid, state, t_end=2.0).to_dataset()
        ...     for value in (0.5, 0.6)
        ... )
        >>> len(compare(one, other).axes)  # three maps and two keys
        5
    """
    grids = grid_of(first), grid_of(second)
    if grids[0].length != grids[1].length:
        rule = f"{grids[0].length:g}, as in the first"
        raise InputError("length of the second cell", grids[1].length, rule, "compare cells of one length")
    width = number("width", width, 89.0, 1000.0, "choose a width in millimetres")
    datasets = in_memory(first), in_memory(second)
    if time is None:
        time = min(float(data["time"].values[-1]) for data in datasets)
    indices = [indices_at(data, [time], "time")[0] for data in datasets]
    grid, scales = grids[0], scales_in(first)
    states = []
    for data, own, index in zip(datasets, grids, indices, strict=True):
        P, u = frame(data, index)
        states.append((P, u) if own == grid else (interpolate(P, grid.shape), interpolate(u, grid.shape)))
    peak = max(peak_speed(data) for data in datasets)
    room = (width - 2 * _MARGIN - _LABEL - 2 * _APART - 2 * _KEY) / 3
    high = room * grid.length / (2 * np.pi)
    with setting(TYPE):
        figure = blank(width, _AXIS + high + _TITLE)
        left = _MARGIN + _LABEL
        for k, (P, u) in enumerate(states):
            ax = place(figure, left, _AXIS, room, high)
            paint_map(ax, grid, P, u, peak_speed=peak)
            mark_edges(ax, grid, scales)
            when = time_text(scales, float(datasets[k]["time"].values[indices[k]]))
            ax.set_title(f"{names[k]}, {when}", fontsize=TYPE["font.size"], pad=4.0)
            ax.set_xlabel("$θ$", labelpad=-6.0)
            if k:
                ax.set_yticklabels([])
            left += room + _APART
        colour_key(place(figure, left - _APART + 3.0, _AXIS, 3.0, high - 5.0))
        left += _KEY
        _difference(figure, grid, states[0][0] - states[1][0], (left, _AXIS, room, high))
        return figure


def _difference(figure: Figure, grid: Any, difference: Any, box: tuple[float, float, float, float]) -> None:
    """Draw the difference in P_z with its key to the right of a place in millimetres."""
    ax = place(figure, *box)
    fine = interpolate(difference, (4 * grid.n_theta, 4 * grid.n_z))[1]
    most = max(float(np.abs(fine).max()), 1e-12)
    edges = (0.0, 2 * np.pi, 0.0, grid.length)
    how: dict[str, Any] = {"cmap": matplotlib.colormaps[_DIFFERENCE], "vmin": -most, "vmax": most}
    image = ax.imshow(fine.T, origin="lower", extent=edges, interpolation="bilinear", **how)
    mark_edges(ax, grid)
    ax.set_yticklabels([])
    ax.set_xlabel("$θ$", labelpad=-6.0)
    size = float(np.sqrt(np.mean(np.sum(difference**2, axis=0))))
    text = r"$\langle|\Delta\mathbf{P}|^2\rangle^{1/2}$" + f" = {size:.2g}"
    ax.set_title(text, fontsize=TYPE["font.size"], pad=4.0)
    left, bottom, across, up = box
    key = place(figure, left + across + 2.5, bottom, 3.0, up - 5.0)
    figure.colorbar(image, cax=key, ticks=[-most, 0.0, most], format="%.2g")
    key.tick_params(labelsize=7.5)
    key.set_title(r"$\Delta P_z$", pad=5.0, fontsize=TYPE["font.size"])
