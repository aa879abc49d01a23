"""The recorded quantities of a run of any model over time, one panel each."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray
from matplotlib.figure import Figure

from ..model.scales import Scales
from ..model.units import PURE, scales_in, speed_unit
from .clock import time_axis, time_label
from .looks import setting
from .style import INK, LEGEND, SMALL, TYPE, blank, mathtext, place

# Places in millimetres.
_LEFT, _RIGHT, _GAP, _ABOVE, _BELOW, _HEIGHT, _LABEL = 14.0, 3.0, 15.0, 8.0, 10.0, 36.0, 8.9
COLUMNS, NARROWEST, WIDE = 3, 80.0, 150.0
"""Panels side by side in a wide figure, least width of any, and width below which there are two (mm)."""
_NARROW_LEFT, _NARROW_GAP, _NARROW_HEIGHT, _NARROW_BELOW, _NARROW_LABEL = 11.0, 12.0, 25.0, 8.0, 7.8
_NARROW_ROW = _NARROW_HEIGHT + _ABOVE + _NARROW_BELOW
SPEEDS = ("peak_speed", "rms_speed", "net_flux")
"""Recorded quantities that are speeds."""
FONTS = TYPE | {"font.size": 9.0, "axes.labelsize": 9.0, "xtick.labelsize": 8.5}
"""The type of figures of many small panels."""
_SMALL_LEGEND = {"fontsize": 7.0, "ncols": 2, "labelspacing": 0.15, "borderaxespad": 0.3, "handlelength": 1.3}
STYLES = ("-", (0, (3, 1.5)), (0, (1, 1.5)), (0, (5, 1, 1, 1)))
"""How the components of one quantity are told apart."""


def is_polar(dataset: xarray.Dataset) -> bool:
    """Return whether a dataset is that of a run of the polar model, which it is if it names none."""
    return "model" not in json.loads(dataset.attrs.get("configuration", "{}"))


@dataclass(frozen=True, eq=False)
class Panels:
    """A figure of six or more small panels, in rows of three, or in rows of two if it is narrow."""

    figure: Figure
    width: float
    rows: int

    @classmethod
    def of(cls, width: float, count: int) -> Panels:
        """Return a figure with room for so many panels."""
        wide = width >= WIDE
        rows = -(-count // (COLUMNS if wide else 2))
        high = _BELOW + rows * (_HEIGHT + _ABOVE) if wide else rows * _NARROW_ROW
        return cls(blank(width, high), width, rows)

    @property
    def columns(self) -> int:
        """The number of panels in a row."""
        return COLUMNS if self.width >= WIDE else 2

    @property
    def stacked(self) -> bool:
        """Whether panels of one column share the labels of their horizontal axis."""
        return self.columns == COLUMNS

    def panel(self, column: int, row: int) -> Any:
        """Add the panel in a row and a column."""
        up = self.rows - 1 - row
        if self.stacked:
            start, gap, high = _LEFT, _GAP, _HEIGHT
            bottom = _BELOW + up * (_HEIGHT + _ABOVE)
        else:
            start, gap, high = _NARROW_LEFT, _NARROW_GAP, _NARROW_HEIGHT
            bottom = _NARROW_BELOW + up * _NARROW_ROW
        across = (self.width - start - _RIGHT - (self.columns - 1) * gap) / self.columns
        ax = place(self.figure, start + column * (across + gap), bottom, across, high)
        ax.spines[["top", "right"]].set_visible(False)
        ax.yaxis.set_label_coords(-(_LABEL if self.stacked else _NARROW_LABEL) / across, 0.5)
        return ax

    def pairs(self) -> list[list[Any]]:
        """Add three pairs of panels: one above the other in each column, or side by side if it is narrow."""
        if self.stacked:
            return [[self.panel(column, row) for row in (0, 1)] for column in range(COLUMNS)]
        return [[self.panel(column, row) for column in (0, 1)] for row in range(COLUMNS)]

    def label(self, pairs: Sequence[Sequence[Any]], text: str) -> None:
        """Write what the horizontal axes of pairs are: below each pair, or below each panel if narrow."""
        for upper, lower in pairs:
            lower.set_xlabel(text, labelpad=1.0)
            if self.stacked:
                upper.tick_params(labelbottom=False)
            else:
                upper.set_xlabel(text, labelpad=1.0)

    def legend(self, ax: Any, *entries: Any) -> None:
        """Draw the legend of a panel above it, in two lines if it needs them in a narrow figure."""
        ax.legend(*entries, **(LEGEND if self.stacked else LEGEND | _SMALL_LEGEND))


def fonts(width: float) -> dict[str, Any]:
    """Return the type of such a figure."""
    return FONTS if width >= WIDE else FONTS | SMALL


def recorded(dataset: xarray.Dataset) -> list[str]:
    """Return the names of the recorded quantities: those with a symbol, over time and few components."""
    return [
        str(name)
        for name, item in dataset.data_vars.items()
        if "symbol" in item.attrs and item.ndim <= 2 and (item.ndim == 1 or item.shape[1] <= len(STYLES))
    ]


def draw_records(dataset: xarray.Dataset, width: float) -> Figure:
    """Return a figure with one panel for each recorded quantity, over time on a square-root scale.

    `dataset` is a run's, `width` in millimetres.

    Example:
        >>> import cyclosis as cy
        >>> from cyclosis.figures.records import draw_records
        >>> grid, model = cy.CylinderGrid(8, 8), cy.models.kinetic
        >>> state = cy.kinetic.dressed(cy.initial.stripes(grid, magnitude=0.5), modes=12)
        >>> run = cy.simulate(cy.Parameters(d_r=0.1), grid, state, t_end=1.0, model=model)
        >>> len(draw_records(run.to_dataset(), 180.0).axes)
        16
    """
    names, scales = recorded(dataset), scales_in(dataset)
    with setting(fonts(width)):
        panels = Panels.of(width, len(names))
        for number, name in enumerate(names):
            row, column = divmod(number, panels.columns)
            ax = panels.panel(column, row)
            _over_time(ax, dataset[name], scales)
            if dataset[name].ndim == 2:
                panels.legend(ax)
            if number + panels.columns >= len(names):
                ax.set_xlabel(time_label(scales, float(dataset["time"].values[-1])), labelpad=1.0)
    return panels.figure


def _over_time(ax: Any, item: xarray.DataArray, scales: Scales | None) -> None:
    """Draw a quantity over time, one line for each of its components."""
    unit = speed_unit(scales) if item.name in SPEEDS else PURE
    times, values = item[item.dims[0]].values, unit.factor * np.atleast_2d(item.values.T)
    labels = item[item.dims[1]].values if item.ndim == 2 else [None]
    for label, line, style in zip(labels, values, STYLES, strict=False):
        ax.plot(times, line, color=INK, linewidth=1.1, linestyle=style, label=label)
    symbol = item.attrs["symbol"]
    name = mathtext(symbol) if symbol != "-" else str(item.name).replace("_", " ")
    ax.set_ylabel(name + unit.brackets)
    time_axis(ax, float(times[0]), float(times[-1]), scales)
