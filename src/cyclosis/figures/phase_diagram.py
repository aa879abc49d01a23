"""How many cells stream: the share of cyclosis over a sweep's parameters (the paper's Figure 5)."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.colors import Normalize
from matplotlib.figure import Figure

from ..analysis.regimes import REGIMES
from ..analysis.wilson import wilson
from ..model.doors import door
from ..model.errors import InputError, number
from ..model.grid import Array
from ..model.units import scales_in, shown_in
from . import plane
from .looks import setting
from .regime_maps import regimes_and_time as regimes_and_time
from .style import INK, SHADE, WIDTH, blank, place
from .swept import Axis, Swept, place_of, swept
from .thresholds import BorderCurve, given, thresholds

__all__ = [
    "CUTS",
    "MOST_CUTS",
    "PERCENT",
    "chosen_cuts",
    "draw_cut",
    "percentages",
    "phase_diagram",
    "regimes_and_time",
]


def __dir__() -> list[str]:
    return sorted(__all__)


CUTS = 4
"""Largest number of cuts chosen by default."""
MOST_CUTS = 6
"""Largest number of cuts that may be requested."""
PERCENT = Normalize(0.0, 100.0)
# Places in millimetres.
_LEFT, _AXIS, _MAP, _KEY, _GAP, _RIGHT, _BETWEEN = 13.0, 9.0, 84.0, 3.0, 18.0, 3.0, 6.5
_TITLE, _CURVE, _STRIP = 6.5, 62.0, 6.0
_CYCLOSIS = REGIMES.index("cyclosis")


@door
def phase_diagram(
    dataset: Any,
    select: Mapping[str, float] | None = None,
    curves: Iterable[Any] = (),
    cuts: Sequence[float] | None = None,
    log: Collection[str] | None = None,
    width: float = WIDTH,
) -> Figure:
    """Return the figure of the share of runs that end in cyclosis over one or two swept parameters.

    `dataset` is a sweep's `xarray.Dataset` (as from `open_sweep`). Of two axes the first is horizontal, the
    second vertical; every parameter point is a cell, coloured by the percentage of its members in cyclosis.
    Cells without an ordered member are grey, cells without any computed member hatched. Lines along the
    cells border the regions of `cyclosis.analysis.outcomes.regions`, each named where it has most room: D
    no ordered member, C all cyclosis, C/U both it and the unidirectional state. Broken lines are theory:
    α_p = d_r, and the α_u beyond which the unidirectional state tilts or breaks into stripes, where these are
    axes; then `curves`, a list of further (name, x, y).

    On the right are cuts along the first axis with Wilson's 95 % intervals, at the values `cuts` of
    the second (1 to 6 of them), by default those that cross most mixed points; marks on the edge of the map
    show where they are. With one axis the cut is alone, below the regions.

    `select` = {axis: value} chooses values of further axes. `log` names the axes to draw on logarithmic
    scales, the others being linear; by default each scale is the one on which the values are more even.
    `width` is in millimetres; all quantities are dimensionless. Raises `InputError` for anything but a sweep,
    for more than two axes, and for values that were not swept.

    Example:
        >>> import cyclosis as cy
        >>> from cyclosis.figures.phase_diagram import phase_diagram
        >>> from cyclosis.sweep.store.block import compute
        >>> from cyclosis.sweep.store.store import Store
        >>> tables = {"axes": {"alpha_p": {"values": [0.01, 0.02]}}, "ensemble": {"seeds": 2}}
        >>> sweep = cy.Sweep.from_tables(tables | {"grid": {"n_theta": 16, "n_z": 16}})
        >>> path = Store.create("diagram", sweep).write(0, compute(sweep, 0))
        >>> phase_diagram(cy.open_sweep("diagram")).get_size_inches().round(1)
        array([7.1, 3.7])
    """
    sweep = swept(dataset, select, log)
    width = number("width", width, 140.0, 1000.0, "choose a width in millimetres")
    lines = [*thresholds(sweep.params, sweep.axes), *given(curves)]
    with shown_in(scales_in(dataset)), setting(plane.TYPE):
        if len(sweep.axes) == 1:
            return _curve(sweep, lines, width)
        return _map(sweep, lines, chosen_cuts(sweep, cuts), width)


def percentages(sweep: Swept) -> tuple[Array, Array, Array]:
    """Return the percentage of cyclosis and both ends of its 95 % interval, each (axes...).

    NaN without members.
    """
    low, high = wilson(sweep.counts[..., _CYCLOSIS], sweep.trials)
    return 100 * sweep.share, 100 * low, 100 * high


def chosen_cuts(sweep: Swept, cuts: Sequence[float] | None = None) -> list[int]:
    """Return the indices of the cuts on the second axis, the highest first.

    Those of the swept values `cuts`; by default of the at most four with most points where some members, but
    not all, became cyclosis, or evenly spread ones where there are no such points. Raises `InputError`
    for values that were not swept, and for fewer than one or more than six.
    """
    axis = sweep.axes[1]
    if cuts is not None:
        places = {place_of(axis.name, axis.values, value) for value in cuts}
        if not 1 <= len(places) <= MOST_CUTS:
            raise InputError("the number of cuts", len(places), f"from 1 to {MOST_CUTS}", "choose others")
        return sorted(places, reverse=True)
    mixed = np.sum((sweep.share > 0) & (sweep.share < 1), axis=0)
    order = np.argsort(-mixed, kind="stable")[:CUTS]
    chosen = [int(k) for k in order if mixed[k] > 0]
    if not chosen:
        chosen = np.unique(np.linspace(0, axis.values.size - 1, CUTS).round().astype(int)).tolist()
    return sorted(chosen, reverse=True)


def _map(sweep: Swept, lines: list[BorderCurve], cuts: list[int], width: float) -> Figure:
    x, y = sweep.axes
    side = min(_MAP, 0.47 * width)
    below, above = plane.foot(sweep, width) + _AXIS, plane.head(lines) + _TITLE
    figure = blank(width, below + side + above)
    ax = place(figure, _LEFT, below, side, side)
    percent = percentages(sweep)
    plane.prepare(ax, x, y)
    drawn = plane.cells(ax, x, y, percent[0], plane.SHARE, PERCENT)
    plane.plain(ax, x, y, sweep.disordered, plane.DISORDERED)
    plane.outline(ax, x, y, sweep.regions)
    handles = plane.draw_curves(ax, lines)
    plane.label_regions(ax, x, y, sweep.regions, lines)
    plane.label(ax.xaxis, x, 1.0)
    plane.label(ax.yaxis, y, 2.0)
    if handles:
        ax.legend(handles=handles, **plane.KEY)
    plane.key(place(figure, _LEFT + side + 3.0, below, _KEY, side), drawn, "% cyclosis")
    left = _LEFT + side + 3.0 + _KEY + _GAP
    # The cuts are stacked, together as high as the map; marks on its edge show where they are.
    high = (side + _BETWEEN) / len(cuts) - _BETWEEN
    for k, row in enumerate(cuts):
        last = k == len(cuts) - 1
        bottom = below + (len(cuts) - 1 - k) * (high + _BETWEEN)
        panel = place(figure, left, bottom, width - left - _RIGHT, high)
        draw_cut(panel, x, *(values[:, row] for values in percent))
        panel.set_title(f"{y.symbol} = {plane.told(y, y.values[row])}", loc="left", pad=2.5, fontsize=9.0)
        panel.set_title("95 % intervals" if k == 0 else "", loc="right", pad=2.5, fontsize=9.0)
        plane.label(panel.xaxis, x, 1.0, last)
        panel.tick_params(labelbottom=last)
        where = ax.get_yaxis_transform()
        ax.plot(1.018, y.values[row], "<", markersize=3.6, color=INK, mew=0, clip_on=False, transform=where)
    plane.notes(figure, sweep)
    return figure


def draw_cut(ax: Any, x: Axis, percent: Array, low: Array, high: Array) -> None:
    """Draw percentages (n,) along an axis with their intervals, as points with bars on a band."""
    at = x.values
    ax.set(xscale=x.scale, xlim=x.edges[[0, -1]], ylim=(-6, 106))
    plane.tick(ax.xaxis, x)
    ax.set_yticks([0, 50, 100], ["0", "50", "100 %"])
    ax.fill_between(at, low, high, where=np.isfinite(low), color=SHADE, linewidth=0, alpha=0.7, zorder=1)
    ax.vlines(at, low, high, color=INK, linewidth=0.8, zorder=2)
    ax.plot(at, percent, color=INK, linewidth=0.6, zorder=2)
    ax.scatter(
        at, percent, s=13.0, c=percent, cmap=plane.SHARE, norm=PERCENT, edgecolors=INK, linewidths=0.6,
        zorder=3, clip_on=False,
    )  # fmt: skip
    ax.spines[["top", "right"]].set_visible(False)


def _curve(sweep: Swept, lines: list[BorderCurve], width: float) -> Figure:
    (x,) = sweep.axes
    left, across = _LEFT + 2.0, width - _LEFT - 2.0 - _RIGHT
    below = plane.foot(sweep, width) + _AXIS
    figure = blank(width, below + _CURVE + _STRIP + plane.head(lines) + 2.0)
    ax = place(figure, left, below, across, _CURVE)
    draw_cut(ax, x, *percentages(sweep))
    plane.label(ax.xaxis, x, 1.0)
    ax.set_ylabel("cyclosis, with 95 % intervals")
    handles = plane.draw_curves(ax, lines)
    strip = place(figure, left, below + _CURVE + 1.5, across, _STRIP - 1.5)
    plane.strip(strip, x, sweep.regions)
    if handles:
        strip.legend(handles=handles, **plane.KEY)
    plane.notes(figure, sweep)
    return figure
