"""The figure of an experiment: cylinders before, during and after, and below them the measurements."""

from __future__ import annotations

import textwrap
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
import xarray
from matplotlib.figure import Figure

from ..model.errors import InputError, number
from ..model.grid import Array, CylinderGrid
from ..model.units import scales_text
from . import cylinder, looks
from .frames import facing_zone
from .looks import setting
from .style import INK, QUIET, TYPE, WIDTH, blank, place, scale_bar

# Places in millimetres.
_MARGIN, _LEFT, _RIGHT, _BELOW, _ABOVE, _GAP, _LINE = 3.0, 15.0, 4.0, 11.0, 8.0, 17.0, 4.0
_TALL, _PANEL, _TITLE = 44.0, 46.0, 5.5
_LETTER = 1.25
"""Mean width of a letter of the text below, in millimetres."""


@dataclass(frozen=True, eq=False)
class Cell:
    """One cylinder of the figure: its title, P and u (2, n_theta, n_z), and the cell's length."""

    title: str
    P: Array
    u: Array
    length: float


@dataclass(frozen=True, eq=False)
class Drawn:
    """Another picture in the place of a cylinder: `draw(ax)` draws it, `across` and `up` radii large.

    `solid` tells that it is the picture of a cell, which has a bar of a round length in physical units.
    """

    title: str
    draw: Callable[[Any], None]
    across: float
    up: float
    solid: bool = False


@dataclass(frozen=True)
class Panel:
    """One panel of the figure: `draw(ax)` draws it, `share` is its width relative to the others'."""

    draw: Callable[[Any], None]
    share: float = 1.0


def cells(dataset: xarray.Dataset, titles: Sequence[str]) -> list[Cell]:
    """Return the cylinders of a dataset's frames (frame, component, theta, z), one for each title."""
    P, u = (np.asarray(dataset[name].values, dtype=np.float64) for name in ("P", "u"))
    length = float(dataset.attrs["length"])
    return [Cell(title, P[k], u[k], length) for k, title in enumerate(titles)]


def story(
    shown: Sequence[Cell] | Sequence[Drawn],
    panels: Sequence[Panel],
    text: str = "",
    same_view: bool = True,
    width: float = WIDTH,
) -> Figure:
    """Return the figure of cylinders, or other pictures, in a row, panels below them, and a text at the foot.

    All cylinders are seen from the same side, on which the last shows a zone, unless `same_view` is False.
    Speeds are drawn on one scale. `width` is in millimetres. Raises `InputError` without panels.

    Example:
        >>> import cyclosis as cy
        >>> from cyclosis.figures.story import Cell, Panel, story
        >>> grid = cy.CylinderGrid(16, 16)
        >>> P = cy.initial.stripes(grid)
        >>> cell = Cell("stripes", P, cy.flow(cy.Parameters(), grid, P), grid.length)
        >>> figure = story([cell], [Panel(lambda ax: ax.plot([0, 1]))], text="An example.")
        >>> len(figure.axes)
        2
    """
    width = number("width", width, 100.0, 1000.0, "choose a width in millimetres")
    if not panels:
        raise InputError("panels", 0, "at least one", "give what was measured")
    scales = looks.scales()
    if scales is not None:
        text = f"{text} {scales_text(scales)}".strip()
    lines = textwrap.wrap(text, int((width - 2 * _MARGIN) / _LETTER)) if text else []
    foot = _LINE * len(lines) + (2.0 if lines else 0.0)
    row = _TALL + _TITLE if shown else 0.0
    with setting(TYPE):
        figure = blank(width, foot + _BELOW + _PANEL + _ABOVE + row)
        _panels(figure, panels, foot + _BELOW, width)
        if shown:
            _cylinders(figure, shown, foot + _BELOW + _PANEL + _ABOVE, same_view, width)
        high = figure.get_size_inches()[1] * 25.4
        for k, line in enumerate(reversed(lines)):
            figure.text(_MARGIN / width, (1.5 + _LINE * k) / high, line, fontsize=8.5, color=INK, va="bottom")
        return figure


def _panels(figure: Figure, panels: Sequence[Panel], bottom: float, width: float) -> None:
    room = width - _LEFT - _RIGHT - _GAP * (len(panels) - 1)
    whole = sum(panel.share for panel in panels)
    left = _LEFT
    for panel in panels:
        across = room * panel.share / whole
        ax = place(figure, left, bottom, across, _PANEL)
        ax.spines[["top", "right"]].set_visible(False)
        panel.draw(ax)
        left += across + _GAP


def _cylinders(
    figure: Figure, shown: Sequence[Cell] | Sequence[Drawn], bottom: float, same_view: bool, width: float
) -> None:
    cylinders = [one for one in shown if isinstance(one, Cell)]
    others = [one for one in shown if isinstance(one, Drawn)]
    column = (width - 2 * _MARGIN) / len(shown)
    for k, one in enumerate([*_seen(cylinders, same_view), *others]):
        scale = min(0.9 * column / one.across, _TALL / one.up)
        left = _MARGIN + (k + 0.5) * column - 0.5 * scale * one.across
        ax = place(figure, left, bottom, scale * one.across, scale * one.up)
        one.draw(ax)
        ax.set_title(one.title, fontsize=9.0, pad=2.5)
        if one.solid and k == 0:
            scale_bar(ax, looks.scales(), (-1.0, 1.0, ax.get_ylim()[0], 0.0))


def _seen(shown: Sequence[Cell], same_view: bool) -> Iterator[Drawn]:
    """Yield the pictures of cylinders, with speeds on one scale."""
    if not shown:
        return
    peak = max(float(np.hypot(*cell.u).max()) for cell in shown)
    view = facing_zone(shown[-1].P)
    for cell in shown:
        box = cylinder.extent(cell.length)
        grid = CylinderGrid(cell.P.shape[1], cell.P.shape[2], cell.length)
        angle = view if same_view else facing_zone(cell.P)
        how: dict[str, Any] = {"view_angle": angle, "peak_speed": max(peak, 1e-6)}
        draw = partial(cylinder.draw, grid=grid, P=cell.P, u=cell.u, **how)
        yield Drawn(cell.title, draw, box[1] - box[0] + 0.06, box[3] - box[2] + 0.06, True)


def interval(ax: Any, x: Array, value: Array, low: Array, high: Array, colour: str, label: str = "") -> None:
    """Draw values (n,) over x with their intervals: points, bars, and a thin line through them."""
    ax.vlines(x, low, high, color=colour, linewidth=1.0)
    ax.plot(
        x, value, "o-", color=colour, markersize=3.4, linewidth=0.7, markeredgewidth=0, label=label or None
    )


def reference(ax: Any, value: float, text: str, upright: bool = False) -> None:
    """Draw a reference value as a quiet broken line with a name."""
    line = ax.axvline if upright else ax.axhline
    line(value, color=QUIET, linewidth=0.8, linestyle=(0, (4, 2)), zorder=0)
    where = ax.get_xaxis_transform() if upright else ax.get_yaxis_transform()
    place_at = (value, 1.01) if upright else (0.99, value)
    ax.text(
        *place_at, text, transform=where, fontsize=8.0, color=QUIET, ha="center" if upright else "right",
        va="bottom",
    )  # fmt: skip
