"""How cyclosis emerges from disorder: cells in time, and maps of some of them (the paper's Figure 4)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from matplotlib.figure import Figure
from matplotlib.patches import ConnectionPatch

from ..model.doors import door
from ..model.errors import InputError, number
from ..model.units import scales_in
from . import cylinder
from .clock import time_text
from .edges import name_axes
from .frames import frame, in_memory, indices_at, peak_speed, story
from .looks import setting
from .portraits import Look
from .style import QUIET, TYPE, WIDTH, blank, place, scale_bar
from .subjects import Subject, subject_of

__all__ = [
    "CYLINDERS",
    "MAPS",
    "emergence",
]


def __dir__() -> list[str]:
    return sorted(__all__)


CYLINDERS = 6
"""Number of cylinders where no times are given."""
MAPS = 3
"""Number of maps where no times are given for them."""
# Places in millimetres.
_MARGIN, _LABEL, _LINKS, _AXIS, _KEY, _GAP = 2.0, 6.5, 9.0, 6.5, 12.5, 7.0
_TALLEST = 72.0


@door
def emergence(
    dataset: Any,
    times: Sequence[float] | None = None,
    map_times: Sequence[float] | None = None,
    view_angle: float | None = None,
    tilt: float | None = None,
    width: float = WIDTH,
) -> Figure:
    """Return the figure of a run: a row of cells over time, and unwrapped maps of some of them.

    `dataset` is a run's `xarray.Dataset` with P and u. Closed cells have their true shape, the defects of P
    marked by their index, and equal-area maps (see `cyclosis.figures.closed_map`). `times` of the cells (2 to
    8): the saved frames nearest to them are drawn and labelled with their actual times; by default six that
    show how the state developed. `map_times` are those of them to unwrap, at most half as many; by default
    every second. `view_angle` (radians) is the angle that faces the viewer, by default one that shows an
    indifferent zone of the last frame; `tilt` (radians) is how far the viewer looks down, by default 0.2, and
    0.6 on a closed cell, to show its end; `width` is in millimetres.
    Colours, lines and strengths mean the same in all frames. Raises `InputError` for times outside the
    dataset, too few frames, or a dataset without fields.

    Example:
        >>> import cyclosis as cy
        >>> from cyclosis.figures import style
        >>> from cyclosis.figures.emergence import emergence
        >>> params, grid = cy.Parameters(), cy.CylinderGrid(16, 16)
        >>> run = cy.simulate(params, grid, cy.initial.stripes(grid, magnitude=0.5), t_end=2.0)
        >>> style.save(emergence(run.to_dataset(), times=[0, 2], map_times=[2]), "emergence.png").name
        'emergence.png'
    """
    subject = subject_of(dataset)
    dataset = in_memory(dataset)
    tilt = cylinder.checked_tilt(subject.portrait.tilt if tilt is None else tilt)
    width = number("width", width, 60.0, 1000.0, "choose a width in millimetres")
    shown = story(dataset, CYLINDERS) if times is None else indices_at(dataset, times)
    if not 2 <= len(shown) <= 8:
        raise InputError("the number of times", len(shown), "from 2 to 8", "choose more or fewer times")
    unwrapped = _unwrapped(dataset, shown, map_times)
    if view_angle is None:
        view_angle = subject.facing(frame(dataset, shown[-1])[0])
    with setting(TYPE):
        layout = _Layout(dataset, subject, shown, unwrapped, width, subject.portrait.extent(tilt))
        return layout.drawn(view_angle, tilt)


def _unwrapped(dataset: Any, shown: list[int], map_times: Sequence[float] | None) -> list[int]:
    """Return the frames to unwrap, all of them among those shown."""
    if map_times is None:
        count = min(MAPS, len(shown) // 2)
        return shown[len(shown) - 2 * count + 1 :: 2]
    found = indices_at(dataset, map_times, "map_times")
    most = len(shown) // 2
    if len(found) > most:
        raise InputError("the number of map_times", len(found), f"at most {most}", "choose fewer maps")
    for index, time in zip(found, map_times, strict=True):
        if index not in shown:
            rule = "among the times of the cylinders: " + ", ".join(_time(dataset, i) for i in shown)
            raise InputError("map_times", time, rule, "choose from these, or give `times` too")
    return found


def _time(dataset: Any, index: int) -> str:
    return f"{float(dataset['time'].values[index]):.4g}"


class _Layout:
    """The positions of all parts, in millimetres from the lower left corner."""

    def __init__(
        self,
        dataset: Any,
        subject: Subject,
        shown: list[int],
        unwrapped: list[int],
        width: float,
        box: tuple[float, float, float, float],
    ) -> None:
        self.dataset, self.shown, self.unwrapped = dataset, shown, unwrapped
        self.subject, self.portrait = subject, subject.portrait
        self.peak, self.scales = peak_speed(dataset), scales_in(dataset)
        self.column = (width - 2 * _MARGIN) / max(len(shown), 4)
        across, up = box[1] - box[0] + 0.06, box[3] - box[2] + 0.06
        scale = min(0.88 * self.column / across, _TALLEST / up)
        self.cylinder = (scale * across, scale * up)
        room = (width - 2 * _MARGIN - _KEY - _AXIS) / max(len(unwrapped), 2) - _GAP
        left, right, bottom, top = self.portrait.map_extent()
        scale = min(room / (right - left), _TALLEST / (top - bottom))
        self.map = (scale * (right - left), scale * (top - bottom))
        self.floor = _AXIS + self.map[1] + _LINKS
        self.left = 0.5 * (width - self.column * len(shown))
        self.width = width
        self.figure = blank(width, self.floor + self.cylinder[1] + _LABEL)

    def drawn(self, view_angle: float, tilt: float) -> Figure:
        """Draw everything and return the figure."""
        cells, looks, times = {}, {}, self.dataset["time"].values
        for k, index in enumerate(self.shown):
            left = self.left + (k + 0.5) * self.column - 0.5 * self.cylinder[0]
            ax = cells[index] = place(self.figure, left, self.floor, *self.cylinder)
            look = looks[index] = self.subject.look(*frame(self.dataset, index))
            self.portrait.solid(ax, look, view_angle=view_angle, tilt=tilt, peak_speed=self.peak)
            if k == 0:
                scale_bar(ax, self.scales, self.portrait.extent(tilt))
            when = time_text(self.scales, float(times[index]), last=float(times[self.shown[-1]]))
            ax.set_title(when, pad=4.0, fontsize=TYPE["font.size"])
        for k, index in enumerate(self.unwrapped):
            self._map(k, looks[index], cells[index])
        self.portrait.key(place(self.figure, self.width - _MARGIN - _KEY + 4.0, _AXIS, 3.2, self.map[1]))
        return self.figure

    def _map(self, k: int, look: Look, cell: Any) -> None:
        slot = (self.width - 2 * _MARGIN - _AXIS - _KEY) / len(self.unwrapped)
        left = _MARGIN + _AXIS + (k + 0.5) * slot - 0.5 * (self.map[0] + _GAP)
        ax = place(self.figure, left, _AXIS, *self.map)
        self.portrait.flat(ax, look, peak_speed=self.peak)
        self.portrait.edges(ax, self.scales)
        name_axes(ax, self.portrait.across, None if k else self.portrait.along)
        if k:
            ax.set_yticklabels([])
        # Lines of unrolling, from the lower end of the cell to the upper edge of its map.
        for below, above in self.portrait.links():
            link = ConnectionPatch(
                below,
                above,
                "data",
                "axes fraction",
                axesA=cell,
                axesB=ax,
                color=QUIET,
                linewidth=0.6,
                zorder=0,
            )
            self.figure.add_artist(link)
