"""Growth rates of small waves about the uniform states, over their wavenumber."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from functools import partial
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from ..model.doors import door
from ..model.errors import InputError, choice, number
from ..model.grid import Array
from ..model.parameters import Parameters
from ..models.kinetic.angular import MODES
from ..stability.kinetic import dispersion as kinetic
from ..stability.kinetic.torques import with_torques
from ..stability.uniform.dispersion import growth_rates
from ..stability.uniform.uniform import BASES, orders
from . import quantities
from .looks import setting
from .style import DOWN, INK, LEGEND, QUIET, TYPE, UP, WIDTH, blank, place

__all__ = [
    "DIRECTIONS",
    "TITLES",
    "dispersion",
    "kinetic",
    "kinetic_dispersion",
]


def __dir__() -> list[str]:
    return sorted(__all__)


DIRECTIONS: tuple[tuple[str, tuple[float, float], str, Any], ...] = (
    ("around the axis", (1.0, 0.0), UP, "-"),
    ("along the cell", (0.0, 1.0), DOWN, "-"),
    ("at 45°", (np.sqrt(0.5), np.sqrt(0.5)), INK, (0, (4, 1.5))),
)
"""Directions of waves: name, unit vector (m, q)/k, colour and style."""
TITLES = {
    "disorder": "about disorder",
    "unidirectional": "about order along the cell",
    "circumferential": "about order around the axis",
    "nematic": "about nematic disorder",
    "z": "about order along the cell",
    "theta": "about order around the axis",
}
POINTS, KINETIC_POINTS = 400, 80
"""Wavenumbers of each line; those of the kinetic model need the eigenvalues of a large matrix each."""
Rates = Callable[[Any, Any], Any]
"""The two leading growth rates (waves, 2) of waves (m, q)."""
# Places in millimetres.
_LEFT, _RIGHT, _BELOW, _ABOVE, _GAP, _UPPER, _LOWER, _BETWEEN = 17.0, 3.0, 10.0, 13.0, 11.0, 48.0, 20.0, 5.0


@door
def dispersion(
    params: Parameters,
    bases: Iterable[str] = BASES,
    length: float = 5.0,
    largest: float = 6.0,
    width: float = WIDTH,
) -> Figure:
    """Return the figure of growth rates σ(k) and frequencies about uniform states, a column for each.

    Above, the real parts of both growth rates of waves in three directions, the weaker one thin; below, the
    frequency -Im σ of the stronger one. Lines are every wavenumber up to `largest`, full dots the waves that
    fit a cell of the given `length`, open dots the perturbation that is uniform (k = 0), which drives no
    pressure and is not the limit of waves. All is dimensionless; `width` is in millimetres. Raises
    `InputError` as `growth_rates`; a column whose state does not exist says so.

    Example:
        >>> import cyclosis as cy
        >>> from cyclosis.figures import style
        >>> from cyclosis.figures.dispersion import dispersion
        >>> style.save(dispersion(cy.Parameters(alpha_p=0.5)), "dispersion.png").name
        'dispersion.png'
    """
    length, largest, width = _checked(length, largest, width)
    columns = {
        base: partial(growth_rates, params, base) if orders(params, base).size else None
        for base in _chosen(bases, BASES)
    }
    return _figure(columns, length, largest, width, POINTS)


@door
def kinetic_dispersion(
    params: Parameters,
    bases: Iterable[str] = kinetic.BASES,
    length: float = 5.0,
    largest: float = 6.0,
    modes: int = MODES,
    torques: str = "literal",
    width: float = WIDTH,
) -> Figure:
    """Return the same figure for the kinetic model, with `modes` angular moments and `torques` by name.

    A column for each of the uniform states "nematic", "z" and "theta". Raises `InputError` as
    `cyclosis.kinetic.dispersion`; a column whose state does not exist says so.

    Example:
        >>> import cyclosis as cy
        >>> from cyclosis.figures import style
        >>> from cyclosis.figures.dispersion import kinetic_dispersion
        >>> figure = kinetic_dispersion(cy.Parameters(d_r=0.1), ["nematic"], modes=24)
        >>> style.save(figure, "kinetic.png").name
        'kinetic.png'
    """
    length, largest, width = _checked(length, largest, width)
    scaled = with_torques(params, torques)
    there = kinetic.existing(scaled)
    columns: dict[str, Rates | None] = {}
    for base in _chosen(bases, kinetic.BASES):
        state = kinetic.base_state(scaled, base, modes) if base in there else None
        columns[base] = None if state is None else partial(_kinetic_rates, scaled, state)
    return _figure(columns, length, largest, width, KINETIC_POINTS)


def _kinetic_rates(scaled: Parameters, state: Any, m: Any, q: Any) -> Any:
    waves = np.broadcast_arrays(m, q)
    rates = kinetic.leading_rates(scaled, state, *(axis.ravel() for axis in waves))
    return rates.reshape(*waves[0].shape, -1)


def _checked(length: float, largest: float, width: float) -> tuple[float, float, float]:
    return (
        number("length", length, 1e-6, 1e4, "the default is 5"),
        number("largest", largest, 0.1, 1e3, "the default is 6"),
        number("width", width, 60.0, 1000.0, "choose a width in millimetres"),
    )


def _chosen(bases: Iterable[str], allowed: tuple[str, ...]) -> list[str]:
    chosen = list(bases)
    if not chosen:
        raise InputError("bases", chosen, "at least one of " + ", ".join(allowed), "name a state")
    return [choice("base", base, allowed) for base in chosen]


def _figure(
    columns: Mapping[str, Rates | None], length: float, largest: float, width: float, points: int
) -> Figure:
    """Draw the growth rates of each state, or say that there is none."""
    across = (width - _LEFT - _RIGHT - (len(columns) - 1) * _GAP) / len(columns)
    rows: dict[str, list[Any]] = {"growth rate": [], "frequency": []}
    with setting(TYPE):
        figure = blank(width, _BELOW + _LOWER + _BETWEEN + _UPPER + _ABOVE)
        for k, (base, rates) in enumerate(columns.items()):
            left = _LEFT + k * (across + _GAP)
            lower = place(figure, left, _BELOW, across, _LOWER)
            upper = place(figure, left, _BELOW + _LOWER + _BETWEEN, across, _UPPER)
            upper.set_title(TITLES[base], loc="left", fontsize=9.5, pad=3.0)
            _column(upper, lower, rates, length, largest, points)
            rows["growth rate"].append(upper)
            rows["frequency"].append(lower)
            if k == 0:
                upper.legend(handles=_key(), **LEGEND | {"bbox_to_anchor": (-0.04, 1.09), "ncols": 5})
        for text, panels in rows.items():  # one unit in a row
            unit = quantities.unit("rate", max(abs(end) for ax in panels for end in ax.get_ylim()))
            panels[0].set_ylabel(f"{text}{unit.brackets}")
            for ax in panels:
                if ax.lines[1:]:
                    quantities.ticks(ax.yaxis, unit)
        figure.align_ylabels([row[0] for row in rows.values()])
    return figure


def _column(upper: Any, lower: Any, growth: Rates | None, length: float, largest: float, points: int) -> None:
    for ax in (upper, lower):
        ax.axhline(0.0, color=QUIET, linewidth=0.6)
        ax.set_xlim(-0.03 * largest, largest)
        ax.spines[["top", "right"]].set_visible(False)
    upper.tick_params(labelbottom=False)
    quantities.ticks(upper.xaxis, quantities.name(lower.xaxis, "wavenumber $k$", "wavenumber", labelpad=1.0))
    if growth is None:
        for ax in (upper, lower):
            ax.set_yticks([])
        upper.text(0.5, 0.6, "no such state", transform=upper.transAxes, ha="center", color=QUIET)
        return
    k = np.linspace(1e-6, largest, points)
    for _, (around, along), colour, line in DIRECTIONS:
        rates = growth(around * k, along * k)
        upper.plot(k, rates[:, 0].real, color=colour, linestyle=line, linewidth=1.1)
        upper.plot(k, rates[:, 1].real, color=colour, linestyle=line, linewidth=0.4)
        lower.plot(k, -rates[:, 0].imag, color=colour, linestyle=line, linewidth=1.1)
    whole = np.arange(1.0, largest + 1e-9)
    fitting = 2 * np.pi / length * np.arange(1.0, largest * length / (2 * np.pi) + 1e-9)
    for m, q, colour in ((whole, 0.0 * whole, UP), (0.0 * fitting, fitting, DOWN)):
        rates = growth(m, q)[:, 0]
        for ax, values in ((upper, rates.real), (lower, -rates.imag)):
            ax.plot(m + q, values, "o", color=colour, markersize=3.0, markeredgewidth=0, zorder=3)
    uniform = growth(np.zeros(1), np.zeros(1))[0]
    upper.plot([0, 0], uniform.real, "o", color=INK, markersize=3.4, markerfacecolor="white", clip_on=False)
    upper.set_ylim(*_limits(np.concatenate([line.get_ydata() for line in upper.lines[1:]])))
    span = max(float(np.abs(np.concatenate([line.get_ydata() for line in lower.lines])).max()), 0.1)
    lower.set_ylim(-1.15 * span, 1.15 * span)


def _limits(values: Array) -> tuple[float, float]:
    low, high = float(np.min(values)), float(np.max(values))
    room = 0.07 * max(high - low, 1e-3)
    return low - room, max(high, 0.0) + room


def _key() -> list[Any]:
    lines = [Line2D([], [], color=c, linestyle=s, linewidth=1.1, label=n) for n, _, c, s in DIRECTIONS]
    dot: dict[str, Any] = {
        "color": INK,
        "linestyle": "",
        "marker": "o",
        "markersize": 1.4,
        "markeredgewidth": 0.6,
    }
    lines.append(Line2D([], [], label="waves that fit", **dot))
    lines.append(Line2D([], [], label="uniform", markerfacecolor="white", **dot))
    return lines
