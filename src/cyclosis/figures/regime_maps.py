"""Every regime's share over a sweep's parameters, and how long order takes."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from typing import Any

import numpy as np
from matplotlib.colors import LogNorm, Normalize
from matplotlib.figure import Figure

from ..analysis.outcomes import time_to_order
from ..analysis.regimes import REGIMES
from ..model.doors import door
from ..model.errors import number
from ..model.grid import Array
from ..model.units import scales_in, shown_in
from . import plane, quantities
from .looks import setting
from .style import INK, SHADE, UP, WIDTH, ZONE, blank, place
from .swept import Swept, grouped, swept

__all__ = [
    "COLOURS",
    "regimes_and_time",
    "shares",
    "time_norm",
]


def __dir__() -> list[str]:
    return sorted(__all__)


COLOURS = {
    "disordered": (SHADE, ""),
    "unidirectional": ("#87ec98", ""),
    "cyclosis": (UP, ""),
    "multistripe": ("#b377e3", "...."),
    "circumferential": ("#2b5232", ""),
    "travelling": ("#e9b949", "\\\\\\\\"),
    "undecided": (ZONE, "////"),
}
"""Colour and hatch of each regime where they are stacked."""
_TIME = "median time to order"
# Places in millimetres.
_LEFT, _AXIS, _GAP, _KEYS, _ABOVE, _ROW = 13.0, 9.0, 4.0, 14.0, 8.0, 15.0
_UPPER, _LOWER, _LARGEST = 42.0, 30.0, 80.0


@door
def regimes_and_time(
    dataset: Any,
    select: Mapping[str, float] | None = None,
    log: Collection[str] | None = None,
    width: float = WIDTH,
) -> Figure:
    """Return the figure of all regimes and of the median time to order over one or two swept parameters.

    Two axes: a map for each regime that occurs, in the order of `cyclosis.REGIMES`, its colour the
    percentage of members in it (white: none), with the number of runs. The last map is the median, over the
    ordered members of a point, of the time to order (dimensionless, R/U); points with none are grey. Points
    without computed members are hatched; lines are those between the regions of `phase_diagram`. One
    axis: the shares stacked, and below them the median time with its quartiles.

    `select` and `log` are as in `phase_diagram`, `width` is in millimetres. Raises `InputError` for anything
    but a sweep with t_order, and for more than two axes.

    Example:
        >>> import cyclosis as cy
        >>> from cyclosis.figures.regime_maps import regimes_and_time
        >>> from cyclosis.sweep.store.block import compute
        >>> from cyclosis.sweep.store.store import Store
        >>> tables = {"axes": {"alpha_p": {"values": [0.01, 0.02]}}, "ensemble": {"seeds": 2}}
        >>> sweep = cy.Sweep.from_tables(tables | {"grid": {"n_theta": 16, "n_z": 16}})
        >>> path = Store.create("regimes", sweep).write(0, compute(sweep, 0))
        >>> regimes_and_time(cy.open_sweep("regimes")).get_size_inches().round(1)
        array([7.1, 3.9])
    """
    sweep = swept(dataset, select, log)
    times = sweep.variable("t_order")
    width = number("width", width, 140.0, 1000.0, "choose a width in millimetres")
    with shown_in(scales_in(dataset)), setting(plane.TYPE):
        if len(sweep.axes) == 1:
            return _stack(sweep, times, width)
        return _maps(sweep, time_to_order(sweep.regime, times), width)


def shares(sweep: Swept, name: str) -> Array:
    """Return the percentage (axes...) of members in one regime; NaN without members."""
    trials = np.where(sweep.trials > 0, sweep.trials, np.nan)
    found: Array = 100 * sweep.counts[..., REGIMES.index(name)] / trials
    return found


def time_norm(times: Array) -> LogNorm:
    """Return the logarithmic scale of colours from the shortest to the longest of times (...)."""
    finite = times[np.isfinite(times) & (times > 0)]
    if not finite.size:
        return LogNorm(1.0, 10.0)
    return LogNorm(float(finite.min()), max(float(finite.max()), 1.01 * float(finite.min())))


def _maps(sweep: Swept, times: Array, width: float) -> Figure:
    names = sweep.present
    count = len(names) + 1
    columns = count if count <= 4 else 3 if count <= 6 else 4
    rows = -(-count // columns)
    # In a single row the key of shares is left of the map of times, else at the end of the first row.
    extra = _KEYS if rows == 1 else 0.0
    side = (width - _LEFT - _KEYS - extra - (columns - 1) * _GAP) / columns
    side = min(side, _LARGEST)
    below = plane.foot(sweep, width) + _AXIS
    figure = blank(width, below + rows * (side + _ROW) - _ROW + _ABOVE)
    for k, name in enumerate([*names, _TIME]):
        row, column = divmod(k, columns)
        left = _LEFT + column * (side + _GAP) + (extra if name == _TIME else 0.0)
        bottom = below + (rows - 1 - row) * (side + _ROW)
        ax = place(figure, left, bottom, side, side)
        drawn = _time_cells(ax, sweep, times) if name == _TIME else _share_cells(ax, sweep, name)
        lowest = k + columns >= count
        plane.label(ax.xaxis, sweep.axes[0], 1.0, lowest)
        plane.label(ax.yaxis, sweep.axes[1], 2.0, column == 0)
        ax.tick_params(labelleft=column == 0)
        if name == _TIME or k == min(columns, len(names)) - 1:
            bar = place(figure, left + side + 2.0, bottom, 2.6, side)
            unit = quantities.unit("time", drawn.norm.vmax)
            plane.key(bar, drawn, f"$t${unit.brackets}" if name == _TIME else "%")
            if name == _TIME:
                quantities.ticks(bar.yaxis, unit)
    plane.notes(figure, sweep)
    return figure


def _share_cells(ax: Any, sweep: Swept, name: str) -> Any:
    x, y = sweep.axes
    percent = shares(sweep, name)
    plane.prepare(ax, x, y, roomy=False)
    plane.plain(ax, x, y, percent == 0, plane.NONE)
    some = np.where(percent > 0, percent, np.nan)
    drawn = plane.cells(ax, x, y, some, plane.SOME, Normalize(0.0, 100.0))
    plane.outline(ax, x, y, sweep.regions, 0.7)
    ax.set_title(f"{name}, {_runs(sweep, name)}", loc="left", pad=3.5, fontsize=9.0)
    return drawn


def _time_cells(ax: Any, sweep: Swept, times: Array) -> Any:
    x, y = sweep.axes
    plane.prepare(ax, x, y, roomy=False)
    plane.plain(ax, x, y, sweep.trials > 0, plane.DISORDERED)
    drawn = plane.cells(ax, x, y, times, plane.TIME, time_norm(times))
    plane.outline(ax, x, y, sweep.regions, 0.7)
    ax.set_title(_TIME, loc="left", pad=3.5, fontsize=9.0)
    return drawn


def _runs(sweep: Swept, name: str) -> str:
    return grouped(int(sweep.counts[..., REGIMES.index(name)].sum()))


def _stack(sweep: Swept, times: Array, width: float) -> Figure:
    (x,) = sweep.axes
    across = width - _LEFT - 5.0
    below = plane.foot(sweep, width) + _AXIS
    figure = blank(width, below + _LOWER + 5.0 + _UPPER + _ABOVE + 4.0 * (len(sweep.present) > 4))
    upper = place(figure, _LEFT + 2.0, below + _LOWER + 5.0, across, _UPPER)
    lower = place(figure, _LEFT + 2.0, below, across, _LOWER)
    widths, base = np.diff(x.edges), np.zeros(x.values.size)
    for name in sweep.present:
        percent = np.nan_to_num(shares(sweep, name))
        upper.bar(
            x.edges[:-1], percent, widths, base, align="edge", linewidth=0.3, edgecolor=ZONE,
            facecolor=COLOURS[name][0], hatch=COLOURS[name][1], label=f"{name}, {_runs(sweep, name)}",
        )  # fmt: skip
        base += percent
    middle, low, high = (time_to_order(sweep.regime, times, q) for q in (0.5, 0.25, 0.75))
    lower.fill_between(x.values, low, high, color=SHADE, linewidth=0)
    lower.plot(x.values, middle, ".-", color=INK, linewidth=1.0, markersize=4.0)
    lower.set(yscale="log", ylim=plane.rounded(low, high))
    plane.round_ticks(lower.yaxis)
    quantities.name(lower.yaxis, "time to order", "time")
    upper.set(ylim=(0, 100), ylabel="% of runs", yticks=[0, 50, 100])
    for ax in (upper, lower):
        ax.set(xscale=x.scale, xlim=x.edges[[0, -1]])
        plane.tick(ax.xaxis, x)
        ax.spines[["top", "right"]].set_visible(False)
        ax.yaxis.set_label_coords(-0.06, 0.5)
    upper.tick_params(labelbottom=False)
    if sweep.present:
        upper.legend(**plane.KEY | {"ncols": 4, "handlelength": 1.1})
    plane.label(upper.xaxis, x, 1.0, False)
    plane.label(lower.xaxis, x, 1.0)
    plane.notes(figure, sweep)
    return figure
