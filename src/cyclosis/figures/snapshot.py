"""One moment of a run: the cell, its map, or both."""

from __future__ import annotations

from typing import Any

import matplotlib
from matplotlib.figure import Figure

from ..model.doors import door
from ..model.errors import choice, number
from ..model.units import scales_in
from .clock import time_text
from .edges import name_axes
from .frames import frame, in_memory, indices_at, peak_speed
from .looks import setting
from .style import SMALL, TYPE, WIDTH, blank, place, scale_bar
from .subjects import subject_of

__all__ = [
    "VIEWS",
    "snapshot",
]


def __dir__() -> list[str]:
    return sorted(__all__)


VIEWS = ("both", "cylinder", "map")
"""What of a cell can be shown."""
# Places in millimetres.
_MARGIN, _TITLE, _AXIS, _LABEL, _APART, _KEY, _FOOT = 3.0, 7.0, 6.5, 6.5, 9.0, 12.0, 7.0
_TALLEST = 110.0
NARROWEST, NARROWEST_BOTH = 40.0, 60.0
"""Least width of one view, and of both; between them the type is small."""


@door
def snapshot(
    dataset: Any,
    time: float | None = None,
    view: str = "both",
    width: float = WIDTH,
    view_angle: float | None = None,
    streamlines: bool = True,
) -> Figure:
    """Return the figure of one moment of a run: its cell, its unwrapped map, or both on one scale.

    `dataset` is a run's `xarray.Dataset` with P and u; closed cells have their true shape and an equal-area
    map. `time` is dimensionless, by default the end; the saved frame nearest to it is drawn and labelled with
    its actual time. `view` is "both", "cylinder" (the cell of whatever shape) or "map". `width` is in
    millimetres, at least 40, or 60 for both; where the cell would be higher than 110 mm, it is drawn
    smaller. `view_angle` (radians) is the angle that faces the viewer, by default one that shows an
    indifferent zone. Of a dataset with scales the time and the axes are in units, and there is a scale bar.
    For other colours and fonts see `cyclosis.figures.looks.chosen`. Raises `InputError` for a time outside
    the dataset, other views, and a dataset without fields.

    Example:
        >>> import cyclosis as cy
        >>> from cyclosis.figures.snapshot import snapshot
        >>> params, grid = cy.Parameters(), cy.CylinderGrid(16, 16)
        >>> run = cy.simulate(params, grid, cy.initial.stripes(grid, magnitude=0.5), t_end=2.0)
        >>> figure = snapshot(run.to_dataset(), time=1.0, view="map", width=89.0)
        >>> figure.get_size_inches().round(1), len(figure.axes)
        (array([3.5, 2.6]), 2)
    """
    subject = subject_of(dataset)
    choice("view", view, VIEWS)
    least = NARROWEST_BOTH if view == "both" else NARROWEST
    width = number("width", width, least, 1000.0, "choose a width in millimetres, or another view")
    index = -1 if time is None else indices_at(dataset, [time], "time")[0]
    dataset, scales = in_memory(dataset), scales_in(dataset)
    P, u = frame(dataset, index)
    look, cell = subject.look(P, u), subject.portrait
    view_angle = subject.facing(P) if view_angle is None else view_angle
    box, flat = cell.extent(cell.tilt), cell.map_extent()
    solid = (box[1] - box[0] + 0.06, box[3] - box[2] + 0.06)
    chart = (flat[1] - flat[0], flat[3] - flat[2])
    shown = [part for part, wanted in ((solid, view != "map"), (chart, view != "cylinder")) if wanted]
    beside = (
        2 * _MARGIN + _KEY + (0.0 if view == "cylinder" else _LABEL) + (_APART if view == "both" else 0.0)
    )
    scale = min((width - beside) / sum(part[0] for part in shown), _TALLEST / max(part[1] for part in shown))
    bar = _FOOT if scales is not None and view != "map" else 0.0
    floor = max(bar, _MARGIN if view == "cylinder" else _AXIS)
    high = scale * max(part[1] for part in shown)
    peak = peak_speed(dataset)
    with setting(TYPE | (SMALL if width < NARROWEST_BOTH else {})):
        size, figure = matplotlib.rcParams["font.size"], blank(width, floor + high + _TITLE)
        left = _MARGIN + 0.5 * (width - beside - scale * sum(part[0] for part in shown))
        if view != "map":
            up = floor + 0.5 * (high - scale * solid[1])
            ax = place(figure, left, up, scale * solid[0], scale * solid[1])
            lines = {"streamlines": streamlines, "peak_speed": peak}
            cell.solid(ax, look, view_angle=view_angle, tilt=cell.tilt, **lines)
            scale_bar(ax, scales, box)
            left += scale * solid[0] + (_APART if view == "both" else 3.0)
        if view != "cylinder":
            left += _LABEL
            ax = place(
                figure, left, floor + 0.5 * (high - scale * chart[1]), scale * chart[0], scale * chart[1]
            )
            cell.flat(ax, look, peak_speed=peak, streamlines=streamlines)
            cell.edges(ax, scales)
            name_axes(ax, cell.across, cell.along)
            left += scale * chart[0] + 3.5
        cell.key(place(figure, left, floor, 3.2, high - 1.0))
        when = time_text(scales, float(dataset["time"].values[index]))
        begin = ax.get_position().x0 if view == "map" else _MARGIN / width  # not above the map's labels
        figure.text(begin, 1 - 4.5 / (floor + high + _TITLE), when, fontsize=size)
        return figure
