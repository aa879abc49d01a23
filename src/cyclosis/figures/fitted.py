"""The figure of a fit: parameters with their intervals, and the combinations that are known or not."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import matplotlib
import numpy as np
from matplotlib.figure import Figure

from ..fitting.result import Fit
from ..model.doors import door
from ..model.errors import InputError, number
from . import looks, quantities
from .looks import setting
from .style import DOWN, INK, QUIET, TYPE, UP, WIDTH, blank, place

if TYPE_CHECKING:
    import xarray

__all__ = [
    "SYMBOLS",
    "fitted",
]


def __dir__() -> list[str]:
    return sorted(__all__)


_LEFT, _RIGHT, _BELOW, _ABOVE, _GAP, _ROW = 14.0, 6.0, 13.0, 9.0, 30.0, 7.5
SYMBOLS = {
    **{"alpha_p": r"$\alpha_p$", "alpha_u": r"$\alpha_u$", "epsilon": r"$\epsilon$", "kappa": r"$\kappa$"},
    **{"d_s": "$d^{(s)}$", "d_r": "$d^{(r)}$", "mu": r"$\mu$", "U": "$U$"},
}


@door
def fitted(found: Fit, width: float = WIDTH) -> Figure:
    """Return the figure of a fit, of `width` millimetres: intervals relative to the estimates, and bars.

    Left, the 95 % interval of each parameter with its value; what is not known has a broken line. Right, the
    combinations of logarithms from the best known (stiff) to the least known (sloppy), each with its
    standard deviation. All are dimensionless. A profile has its fit with a band below.

    Example:
        >>> import numpy as np
        >>> import xarray
        >>> import cyclosis as cy
        >>> from cyclosis.figures import fitted
        >>> state = cy.stability.cyclosis(cy.Parameters(), n_theta=64)
        >>> u = np.stack([0 * state.u, state.u])[:, :, None]
        >>> places = {"theta": state.theta, "z": [0.0]}
        >>> data = xarray.Dataset({"u": (("component", "theta", "z"), u)}, places)
        >>> figure = fitted.fitted(cy.fit(data, method="profile"))
        >>> len(figure.axes)
        3
    """
    if not isinstance(found, Fit):
        raise InputError("found", found, "a fit", "make it by cyclosis.fit")
    width = number("width", width, 100.0, 1000.0, "choose a width in millimetres")
    profile = found.predict() if found.method == "profile" and found._predict is not None else None
    below = 0.0 if profile is None else 62.0
    rows = max(len(found.estimate), len(found.identifiable), 1)
    high = _ROW * rows
    with looks.chosen(scales=found.scales), setting(TYPE):
        figure = blank(width, below + _BELOW + high + _ABOVE)
        across = (width - _LEFT - _RIGHT - _GAP) / 2
        _intervals(place(figure, _LEFT, below + _BELOW, across, high), found)
        _directions(place(figure, _LEFT + across + _GAP, below + _BELOW, across, high), found)
        if profile is not None:
            _profile(place(figure, _LEFT, _BELOW, width - _LEFT - _RIGHT, below - _BELOW - 4), profile)
        return figure


def _intervals(ax: Any, found: Fit) -> None:
    names = list(found.estimate)
    wide = [0.05]
    for k, name in enumerate(names):
        value, (low, high) = found.estimate[name], found.interval[name]
        if np.isnan(value):
            ax.axhline(k, color=QUIET, linewidth=0.8, linestyle=(0, (2, 3)))
            label = "not known"
        else:
            ax.plot(
                [low / value - 1, high / value - 1], [k, k], color=UP, linewidth=2.4, solid_capstyle="butt"
            )
            ax.plot(0, k, "o", color=INK, markersize=3.5)
            wide += [1 - low / value, high / value - 1]
            label = f"{value:.4g}" + found.in_units(name).replace("  ", "\n").replace(" at this friction", "")
        ax.annotate(
            label, (1, k), (4, 0), ("axes fraction", "data"), "offset points", va="center",
            fontsize=9.0 if found.scales is None else 7.5, linespacing=0.95,
        )  # fmt: skip
    limit = 1.15 * min(max(wide), 2.0)
    ax.set_xlim(-limit, limit)
    ax.xaxis.set_major_formatter(lambda x, _: f"{100 * x:+.3g} %".replace("+0 %", "0"))
    ax.xaxis.set_major_locator(matplotlib.ticker.MaxNLocator(4))
    ax.set_yticks(range(len(names)), [SYMBOLS[name] for name in names])
    ax.set_ylim(len(names) - 0.4, -0.6)
    ax.axvline(0.0, color=QUIET, linewidth=0.6, zorder=0)
    ax.set_xlabel("95 % interval, relative", labelpad=2.0)


def _directions(ax: Any, found: Fit) -> None:
    names = [name for name in found.estimate if any(name in d.shares for d in found.identifiable)]
    for k, direction in enumerate(found.identifiable):
        for j, name in enumerate(names):
            share = direction.shares.get(name, 0.0)
            ax.bar(j, -0.42 * share, 0.7, k, color=UP if share > 0 else DOWN, linewidth=0)
        ax.axhline(k, color=QUIET, linewidth=0.4, zorder=0)
        size = direction.deviation
        text = "not at all" if not size < 10 else f"{100 * size:.2g} %"
        ax.annotate(
            text,
            (0, k),
            (-4, 0),
            ("axes fraction", "data"),
            "offset points",
            ha="right",
            va="center",
            fontsize=9.0,
        )
    ax.set_yticks([])
    ax.set_xticks(range(len(names)), [SYMBOLS[name] for name in names])
    ax.set_xlim(-0.6, max(len(names), 1) - 0.4)
    ax.set_ylim(max(len(found.identifiable), 1) - 0.4, -0.6)
    ax.set_title("stiff to sloppy: combinations of logarithms", fontsize=9.0, pad=3.0, loc="left")
    if not found.identifiable:
        ax.annotate("nothing can be told", (0.5, 0.5), xycoords="axes fraction", ha="center", va="center")


def _profile(ax: Any, profile: xarray.Dataset) -> None:
    theta = profile["theta"].values
    u, band = profile["u"].values, 1.96 * profile["u_deviation"].values
    ax.fill_between(theta, u - band, u + band, color=UP, alpha=0.3, linewidth=0)
    ax.plot(theta, profile["measured_u"].values, ".", color=INK, markersize=3.0)
    ax.plot(theta, u, color=UP, linewidth=1.2)
    ax.axhline(0.0, color=QUIET, linewidth=0.6, zorder=0)
    ax.set_xlabel("θ (radians)", labelpad=1.0)
    quantities.name(ax.yaxis, "$u_z$", "speed")
