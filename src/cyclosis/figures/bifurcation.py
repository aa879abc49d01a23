"""Bifurcation diagrams: states over a parameter, stable and unstable, and the points at which they meet."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from ..model.doors import door
from ..model.errors import InputError, choice, number
from ..model.grid import Array
from ..stability.branches.branch import MEASURES, Branch
from ..stability.branches.diagram import label
from . import quantities
from .looks import setting
from .style import DOWN, INK, LEGEND, QUIET, TYPE, UP, WIDTH, ZONE, blank, place
from .swept import axis

__all__ = [
    "COLOURS",
    "MARKS",
    "SYMBOLS",
    "bifurcation",
]


def __dir__() -> list[str]:
    return sorted(__all__)


COLOURS = (UP, "#d29a1f", DOWN, "#2f6fb0", "#a8443c", INK)
"""Colours of branches, in turn."""
MARKS = {"fold": "^", "branch point": "o", "Hopf point": "D"}
"""Marks of special points of states that are uniform along the cell; marks of waves along it are open."""
SYMBOLS = {
    "max_P": r"$\max\,|\mathbf{P}|$",
    "max_u": r"$\max\,|\mathbf{u}|$",
    "mean_P_theta": r"$\langle P_\theta\rangle$",
    "mean_P_z": r"$\langle P_z\rangle$",
    "rms_P": r"$\langle|\mathbf{P}|^2\rangle^{1/2}$",
    "rms_u": r"$\langle|\mathbf{u}|^2\rangle^{1/2}$",
    "drift": "drift about the axis",
}
"""Labels of the quantities that may be drawn."""
SPEEDS = ("max_u", "rms_u", "drift")
"""Those that are speeds."""
# Places in millimetres.
_LEFT, _RIGHT, _BELOW, _ABOVE, _GAP, _HIGH, _ROW = 16.0, 4.0, 10.0, 5.0, 19.0, 58.0, 4.8


@door
def bifurcation(
    branches: Sequence[Branch],
    measures: Sequence[str] = ("max_P", "mean_P_theta"),
    log: bool = False,
    width: float = WIDTH,
) -> Figure:
    """Return the figure of branches over their common parameter, a panel for each measure.

    Thick lines are stable to all perturbations, including waves along the cell; thin dashed ones are not.
    Marks are folds, branch points and Hopf points; those of waves along the cell are open. `measures` are
    keys of `Branch.measures`, or "drift". Dimensionless; `width` in millimetres. Raises `InputError` for
    other measures, for branches over different parameters, and for a logarithmic scale that reaches 0.

    Example:
        >>> import cyclosis as cy
        >>> from cyclosis.figures.bifurcation import bifurcation
        >>> state = cy.stability.cyclosis(cy.Parameters(kappa=0.5), n_theta=64)
        >>> branch = cy.stability.continue_branch(state, "kappa", (0.45, 0.5), length=None, longest=0.1)
        >>> figure = bifurcation([branch], measures=["max_P", "mean_P_theta"])
        >>> len(figure.axes)
        2
    """
    chosen = [choice("measure", measure, MEASURES) for measure in measures]
    names = {branch.name for branch in branches}
    if not chosen:
        raise InputError("measures", [], "at least one of " + ", ".join(MEASURES), "name what to draw")
    if len(names) != 1:
        raise InputError("branches", sorted(names), "over one parameter", "draw them separately")
    lowest = min(float(branch.parameter.min()) for branch in branches)
    if log and lowest <= 0:
        raise InputError(names.pop(), lowest, "above 0 on a logarithmic scale", "raise its bound")
    width = number("width", width, 60.0, 1000.0, "choose a width in millimetres")
    words = _named(branches)
    with setting(TYPE):
        rows = -(-(len(words) + 2 + len(MARKS)) // 5)
        figure = blank(width, _BELOW + _HIGH + _ABOVE + rows * _ROW)
        across = (width - _LEFT - _RIGHT - (len(chosen) - 1) * _GAP) / len(chosen)
        for k, measure in enumerate(chosen):
            ax = place(figure, _LEFT + k * (across + _GAP), _BELOW, across, _HIGH)
            _panel(ax, branches, measure, log)
        figure.axes[0].legend(
            handles=_key(branches, words), **LEGEND | {"ncols": 5, "bbox_to_anchor": (-0.06, 1.0)}
        )
        return figure


def _named(branches: Sequence[Branch]) -> list[str]:
    names = [label(branch) for branch in branches]
    return [
        name if name not in names[:k] else f"{name} ({names[:k].count(name) + 1})"
        for k, name in enumerate(names)
    ]


def _values(branch: Branch, measure: str) -> Array:
    return branch.drift if measure == "drift" else branch.measures[measure]


def _panel(ax: Any, branches: Sequence[Branch], measure: str, log: bool) -> None:
    if log:
        ax.set_xscale("log")
    for branch, colour in zip(branches, _colours(len(branches)), strict=True):
        x, y, stable = branch.parameter, _values(branch, measure), branch.stable
        ax.plot(x, y, color=colour, linewidth=0.8, linestyle=(0, (3, 1.5)), zorder=2)
        # A segment is stable if both its ends are; a special point at one end is neutral.
        ends = stable | np.isin(np.arange(x.size), [point.index for point in branch.points])
        both = ends[1:] & ends[:-1] & (stable[1:] | stable[:-1])
        for piece in np.flatnonzero(both):
            ax.plot(x[piece : piece + 2], y[piece : piece + 2], color=colour, linewidth=2.2, zorder=3)
        for point in branch.points:
            if point.kind in MARKS:
                ax.plot(
                    point.value,
                    y[point.index],
                    MARKS[point.kind],
                    color=INK,
                    markersize=4.0 if not point.axial_mode else 3.0,
                    markeredgewidth=0.7,
                    markerfacecolor=ZONE if point.axial_mode else INK,
                    zorder=4,
                    clip_on=False,
                )
    values = np.concatenate([branch.parameter for branch in branches])
    ax.set_xlim(values.min(), values.max())
    low, high = ax.get_ylim()
    if low <= 0 <= high:
        ax.axhline(0.0, color=QUIET, linewidth=0.5, zorder=0)
    ax.set_xlabel(axis(branches[0].name, np.sort(values)[[0, -1]], False).symbol, labelpad=1.0)
    if measure in SPEEDS:
        quantities.name(ax.yaxis, SYMBOLS[measure], "speed")
    else:
        ax.set_ylabel(SYMBOLS[measure])
    ax.spines[["top", "right"]].set_visible(False)


def _colours(count: int) -> list[str]:
    return [COLOURS[k % len(COLOURS)] for k in range(count)]


def _key(branches: Sequence[Branch], words: list[str]) -> list[Any]:
    lines = [
        Line2D([], [], color=colour, linewidth=2.2, label=name)
        for colour, name in zip(_colours(len(branches)), words, strict=True)
    ]
    lines.append(Line2D([], [], color=INK, linewidth=0.8, linestyle=(0, (3, 1.5)), label="unstable"))
    kinds = {point.kind for branch in branches for point in branch.points if not point.axial_mode}
    for kind, mark in MARKS.items():
        if kind in kinds:
            lines.append(Line2D([], [], color=INK, marker=mark, linestyle="", markersize=1.8, label=kind))
    if any(point.axial_mode for branch in branches for point in branch.points):
        lines.append(
            Line2D(
                [], [], color=INK, marker="o", linestyle="", markersize=1.6, markerfacecolor=ZONE,
                markeredgewidth=0.6, label="of waves along the cell",
            )
        )  # fmt: skip
    return lines
