"""Axes of quantities with a dimension: in the units of the cell that was chosen, else in R, U and R/U.

What is drawn stays dimensionless. Only the labels and the places of the ticks depend on the units.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.ticker import AutoLocator, FuncFormatter, Locator, LogLocator, NullLocator

from ..model.scales import Scales
from ..model.units import PURE, UNITS, Unit
from . import looks


def unit(kind: str, largest: float = 0.0, scales: Scales | None = None) -> Unit:
    """Return the unit of a kind of quantity, one of `UNITS`: of `scales`, else of those that are chosen."""
    return UNITS[kind](scales or looks.scales(), largest)


def words(value: float, kind: str, digits: str = ".4g", plain: str = "") -> str:
    """Return a number with its unit, or with `plain` if no units are chosen."""
    found = unit(kind, value)
    told = f"{value:{digits}} {plain}" if found is PURE else f"{found.factor * value:.3g} {found.name}"
    return told.rstrip()


def when(time: float) -> str:
    """Return a time as it stands above a picture.

    Example:
        >>> import cyclosis as cy
        >>> from cyclosis.figures import looks, quantities
        >>> quantities.when(30.0)
        '$t$ = 30'
        >>> with looks.chosen(scales=cy.Scales(500.0, 75.0)):
        ...     quantities.when(30.0)
        '$t$ = 3.33 min'
    """
    return f"$t$ = {words(time, 'time', 'g')}"


def name(side: Any, text: str, kind: str, plain: str = "", **how: Any) -> Unit:
    """Name the horizontal or vertical axis `side` of a quantity, put its ticks at round numbers of its unit.

    Without units the label is `text`, with `plain` behind a comma. The limits of the axis must be set before.
    Returns the unit.

    Example:
        >>> import cyclosis as cy
        >>> from cyclosis.figures import looks, quantities, style
        >>> ax = style.place(style.blank(80.0, 50.0), 10.0, 10.0, 60.0, 30.0)
        >>> _ = ax.set_xlim(0, 20)
        >>> with looks.chosen(scales=cy.Scales(500.0, 75.0)):
        ...     _ = quantities.name(ax.xaxis, "time", "time", "R/U")
        >>> ax.get_xlabel(), ax.get_xticks()[:2].round(2)
        ('time (min)', array([0.  , 4.5]))
    """
    first, last = side.get_view_interval()
    found = unit(kind, max(abs(first), abs(last)))
    if found is PURE:
        side.set_label_text(f"{text}, {plain}" if plain else text, **_pad(side, how))
        return found
    side.set_label_text(f"{text}{found.brackets}".strip(), **_pad(side, how))
    ticks(side, found)
    return found


def ticks(side: Any, unit: Unit) -> None:
    """Put the ticks of an axis at round numbers of a unit."""
    if unit is PURE:
        return
    if side.get_scale() == "log":
        first, last = side.get_view_interval()
        base: Locator = LogLocator(subs=(1.0,) if last > 1e3 * first else (1.0, 2.0, 5.0))
    else:
        base = AutoLocator()
    side.set_major_locator(_In(unit, base))
    side.set_major_formatter(FuncFormatter(lambda value, _: f"{unit.factor * value:.6g}"))
    side.set_minor_locator(NullLocator())


def _pad(side: Any, how: dict[str, Any]) -> dict[str, Any]:
    """Set the distance of a label from its axis, and return what else was said of it."""
    if "labelpad" in how:
        side.labelpad = how.pop("labelpad")
    return how


class _In(Locator):
    """Ticks of another locator at round numbers of a unit."""

    def __init__(self, unit: Unit, base: Locator) -> None:
        self.factor, self.base = unit.factor, base

    def set_axis(self, axis: Any) -> None:
        super().set_axis(axis)
        self.base.set_axis(axis)

    def __call__(self) -> Any:
        side: Any = self.axis
        return self.tick_values(*side.get_view_interval())

    def tick_values(self, vmin: float, vmax: float) -> Any:
        return np.asarray(self.base.tick_values(self.factor * vmin, self.factor * vmax)) / self.factor
