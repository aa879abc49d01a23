"""Where cyclosis exists and where it is stable: the threshold over decades, and how the two separate."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.figure import Figure

from ..model.doors import door
from ..model.errors import number
from ..stability.existence.boundaries import Limits
from ..stability.existence.onset import Neighbourhood
from .looks import setting
from .style import DOWN, INK, LEGEND, QUIET, TYPE, UP, WIDTH, blank, place
from .swept import axis

__all__ = [
    "limits",
]


def __dir__() -> list[str]:
    return sorted(__all__)


# Places in millimetres.
_LEFT, _RIGHT, _BELOW, _ABOVE, _GAP = 17.0, 4.0, 10.0, 9.0, 20.0
_HIGH, _RATIO, _BETWEEN = 52.0, 18.0, 5.0
_STRIPES = "#e6d8f3"


@door
def limits(found: Limits, near: Neighbourhood | None = None, width: float = WIDTH) -> Figure:
    """Return the figure of the α_u beyond which two stripes exist and are stable, over a parameter.

    Left, on a logarithmic scale: the threshold of stability, the fold below α_p = d_r + d_s, and the formula
    for fronts; below, the ratio of the threshold to that formula. Right, if `near` is given, the
    neighbourhood of α_p = d_r + d_s, where existence and stability separate. Dimensionless; `width` in mm.

    Example:
        >>> import cyclosis as cy
        >>> from cyclosis.figures import style
        >>> from cyclosis.figures.limits import limits
        >>> found = cy.stability.limits(cy.Parameters(), [0.08, 0.1, 0.12])
        >>> style.save(limits(found), "limits.png").name
        'limits.png'
    """
    width = number("width", width, 60.0, 1000.0, "choose a width in millimetres")
    with setting(TYPE):
        figure = blank(width, _BELOW + _RATIO + _BETWEEN + _HIGH + _ABOVE)
        across = width - _LEFT - _RIGHT if near is None else 0.5 * (width - _LEFT - _RIGHT - _GAP)
        upper = place(figure, _LEFT, _BELOW + _RATIO + _BETWEEN, across, _HIGH)
        lower = place(figure, _LEFT, _BELOW, across, _RATIO)
        _decades(upper, lower, found)
        figure.align_ylabels([upper, lower])
        if near is not None:
            high = _RATIO + _BETWEEN + _HIGH
            _onset(place(figure, _LEFT + across + _GAP, _BELOW, across, high), near)
        return figure


def _decades(upper: Any, lower: Any, found: Limits) -> None:
    x = found.values
    ends = found.exists > 0
    upper.set_yscale("log")
    upper.plot(x, found.front, color=DOWN, linewidth=3.2, alpha=0.45, label="front formula", zorder=1)
    upper.plot(x, found.stable, color=INK, linewidth=1.2, label="stable beyond", zorder=3)
    upper.plot(
        x[ends], found.exists[ends], color=UP, linewidth=2.4, linestyle=(0, (1, 0.9)), label="exists beyond"
    )
    with np.errstate(invalid="ignore"):
        ratio = found.stable / found.front
    lower.axhline(1.0, color=QUIET, linewidth=0.6)
    lower.plot(x, ratio, color=INK, linewidth=1.2)
    usable = ratio[np.isfinite(ratio)]
    if usable.size:
        lower.set_ylim(min(0.9, float(usable.min())) - 0.02, float(np.quantile(usable, 0.97)) + 0.05)
    for ax in (upper, lower):
        ax.set_xlim(x.min(), x.max())
        ax.spines[["top", "right"]].set_visible(False)
    upper.tick_params(labelbottom=False)
    upper.set_ylabel(r"$\alpha_u$")
    lower.set_ylabel("ratio")
    lower.set_xlabel(axis(found.name, x[[0, -1]], False).symbol, labelpad=1.0)
    upper.legend(**LEGEND)


def _onset(ax: Any, near: Neighbourhood) -> None:
    x, top = near.alpha_p, 1.08 * float(np.nanmax(near.stable))
    ends = near.exists > 0
    ax.fill_between(x, near.exists, near.stable, where=ends, color=_STRIPES, linewidth=0)
    # Beyond the pitchfork, at the last end of the branch, stripes exist for every α_u.
    beyond = np.flatnonzero(~ends | (np.arange(x.size) == np.sum(ends) - 1))
    ax.fill_between(x[beyond], 0, near.stable[beyond], color=_STRIPES, linewidth=0)
    ax.fill_between(x[ends], 0, near.exists[ends], color="#eceaef", linewidth=0)
    ax.plot(x, near.stable, color=INK, linewidth=1.2)
    # At d_r + d_s the fold has become a pitchfork, and the branch ends there.
    ax.plot(x[ends], near.exists[ends], color=UP, linewidth=2.0, linestyle=(0, (1, 0.9)))
    onset = float(near.values[ends].max()) if ends.any() else np.nan
    if np.isfinite(onset):
        ax.vlines(onset, 0, near.exists[ends][-1], color=UP, linewidth=0.8, linestyle=(0, (4, 2)))
        ax.plot(onset, near.exists[ends][-1], "o", color=UP, markersize=4.5, markeredgewidth=0, zorder=4)
        ax.annotate(
            "pitchfork", (onset, near.exists[ends][-1]), (6, 2), textcoords="offset points", fontsize=9.0
        )
    ax.plot(*near.corner, "s", color=INK, markersize=4.2, markeredgewidth=0, zorder=4)
    ax.annotate("corner", near.corner, (6, 5), textcoords="offset points", fontsize=9.0)
    ax.set(xlim=(x.min(), x.max()), ylim=(0, top))
    middle = 0.5 * (x.max() + onset) if np.isfinite(onset) else float(x.mean())
    ax.text(middle, 0.86 * top, "stable stripes", ha="center", fontsize=9.0)
    ax.text(middle, 0.25 * float(near.stable[-1]) + 0.01, "stripes, not stable", ha="center", fontsize=9.0)
    ax.text(0.5 * (x.min() + onset), 0.2 * top, "no stripes", ha="center", fontsize=9.0)
    ax.set_xlabel(axis("alpha_p", x[[0, -1]], False).symbol, labelpad=1.0)
    ax.set_ylabel(r"$\alpha_u$")
