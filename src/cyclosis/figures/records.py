"""The recorded quantities of a run of any model over time, one panel each."""

from __future__ import annotations

import json
from collections.abc import Callable
from typing import Any

import numpy as np
import xarray
from matplotlib.figure import Figure

from ..model.scales import Scales
from ..model.units import PURE, scales_in, speed_unit
from .clock import time_axis, time_label
from .looks import setting
from .style import INK, LEGEND, TYPE, blank, mathtext, place

# Places in millimetres.
_LEFT, _RIGHT, _GAP, _ABOVE, _BELOW, _HEIGHT = 14.0, 3.0, 15.0, 8.0, 10.0, 36.0
COLUMNS = 3
SPEEDS = ("peak_speed", "rms_speed", "net_flux")
"""Recorded quantities that are speeds."""
FONTS = TYPE | {"font.size": 9.0, "axes.labelsize": 9.0, "xtick.labelsize": 8.5}
"""The type of figures of many small panels."""
STYLES = ("-", (0, (3, 1.5)), (0, (1, 1.5)), (0, (5, 1, 1, 1)))
"""How the components of one quantity are told apart."""


def is_polar(dataset: xarray.Dataset) -> bool:
    """Return whether a dataset is that of a run of the polar model, which it is if it names none."""
    return "model" not in json.loads(dataset.attrs.get("configuration", "{}"))


def panels(width: float, rows: int) -> tuple[Figure, Callable[[int, int], Any]]:
    """Return a figure with room for rows of three panels, and a function that adds one at (column, row)."""
    across = (width - _LEFT - _RIGHT - (COLUMNS - 1) * _GAP) / COLUMNS
    figure = blank(width, _BELOW + rows * (_HEIGHT + _ABOVE))

    def panel(column: int, row: int) -> Any:
        bottom = _BELOW + (rows - 1 - row) * (_HEIGHT + _ABOVE)
        ax = place(figure, _LEFT + column * (across + _GAP), bottom, across, _HEIGHT)
        ax.spines[["top", "right"]].set_visible(False)
        ax.yaxis.set_label_coords(-0.2, 0.5)
        return ax

    return figure, panel


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
    with setting(FONTS):
        figure, panel = panels(width, -(-len(names) // COLUMNS))
        for number, name in enumerate(names):
            row, column = divmod(number, COLUMNS)
            ax = panel(column, row)
            _over_time(ax, dataset[name], scales)
            if number + COLUMNS >= len(names):
                ax.set_xlabel(time_label(scales, float(dataset["time"].values[-1])), labelpad=1.0)
    return figure


def _over_time(ax: Any, item: xarray.DataArray, scales: Scales | None) -> None:
    """Draw a quantity over time, one line for each of its components."""
    unit = speed_unit(scales) if item.name in SPEEDS else PURE
    times, values = item[item.dims[0]].values, unit.factor * np.atleast_2d(item.values.T)
    labels = item[item.dims[1]].values if item.ndim == 2 else [None]
    for label, line, style in zip(labels, values, STYLES, strict=False):
        ax.plot(times, line, color=INK, linewidth=1.1, linestyle=style, label=label)
    if item.ndim == 2:
        ax.legend(**LEGEND)
    symbol = item.attrs["symbol"]
    name = mathtext(symbol) if symbol != "-" else str(item.name).replace("_", " ")
    ax.set_ylabel(name + unit.brackets)
    time_axis(ax, float(times[0]), float(times[-1]), scales)
