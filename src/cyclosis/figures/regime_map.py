"""Regimes over two parameters from theory alone: which states are stable where."""

from __future__ import annotations

from collections.abc import Collection, Iterable
from typing import Any

import matplotlib
import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from ..model.doors import door
from ..model.errors import number
from ..stability.regime_map import RegimeMap
from . import plane
from .looks import setting
from .style import INK, LEGEND, QUIET, SHADE, WIDTH, ZONE, blank, place
from .swept import Axis, Codes, axis
from .thresholds import BorderCurve, given, thresholds

__all__ = [
    "COLOURS",
    "LETTERS",
    "MEANINGS",
    "NONE",
    "colour",
    "regime_map",
    "regions",
]


def __dir__() -> list[str]:
    return sorted(__all__)


LETTERS = {
    "disordered": "D",
    "unidirectional": "U",
    "uneven": "E",
    "cyclosis": "C",
    "tilted": "T",
    "circumferential": "O",
}
"""Letters of the states; a point is named by the letters of all states that are stable there."""
MEANINGS = {
    "D": "disorder",
    "U": "unidirectional",
    "E": "uneven order",
    "C": "cyclosis",
    "T": "tilted stripes that rotate",
    "O": "circumferential",
}
NONE = "-"
COLOURS = {
    NONE: ZONE,
    "D": SHADE,
    "U": "#87ec98",
    "C": "#74399f",
    "E": "#3fa7a0",
    "T": "#e9b949",
    "O": "#2b5232",
    "C/U": "#b78be0",
    "C/D": "#a48fb5",
    "C/O": "#4f4a6b",
    "T/O": "#a38f3d",
    "U/O": "#5aa866",
    "C/T": "#b0795f",
}
"""Colours of sets of stable states; the colour of any other set is the mean of those of its members."""
# Places in millimetres.
_LEFT, _RIGHT, _BELOW, _SIDE, _ABOVE = 14.0, 4.0, 10.0, 108.0, 5.0


@door
def regime_map(
    found: RegimeMap,
    curves: Iterable[Any] = (),
    log: Collection[str] | None = None,
    theory: bool = True,
    width: float = WIDTH,
) -> Figure:
    """Return the figure of stable states over two parameters, every point a cell coloured by them.

    Letters name the sets: where two states are stable, the initial state decides. With `theory` lines are the
    thresholds of `thresholds` over the same axes; then `curves`, further (name, x, y). `log` names the axes
    on logarithmic scales; by default it depends on the spread of values. Dimensionless; `width` in mm.

    Example:
        >>> import cyclosis as cy
        >>> from cyclosis.figures import style
        >>> from cyclosis.figures.regime_map import regime_map
        >>> axes = ("alpha_p", [0.01, 0.02]), ("alpha_u", [0.0, 0.01])
        >>> found = cy.stability.regime_map(cy.Parameters(), *axes)
        >>> style.save(regime_map(found, theory=False), "map.png").name
        'map.png'
    """
    width = number("width", width, 100.0, 1000.0, "choose a width in millimetres")
    names = None if log is None else set(log)
    x, y = (
        axis(name, values, None if names is None else name in names)
        for name, values in ((found.x_name, found.x), (found.y_name, found.y))
    )
    codes, sets = regions(found)
    lines = [*(thresholds(found.params, (x, y)) if theory else []), *given(curves)]
    with setting(plane.TYPE):
        below, above = _BELOW, plane.head(lines) + _ABOVE
        side = min(_SIDE, width - _LEFT - _RIGHT - 40.0)
        figure = blank(width, below + side + above)
        ax = place(figure, _LEFT, below, side, side)
        plane.prepare(ax, x, y)
        for code, name in enumerate(sets):
            plane.plain(ax, x, y, codes == code, colour(name))
        plane.outline(ax, x, y, codes, 0.9)
        handles = plane.draw_curves(ax, lines)
        _name(ax, x, y, codes, sets, lines)
        ax.set_xlabel(x.symbol, labelpad=1.0)
        ax.set_ylabel(y.symbol, labelpad=2.0)
        if handles:
            ax.add_artist(ax.legend(handles=handles, **plane.KEY))
        _key(figure, _LEFT + side + 4.0, below, width - _LEFT - side - 6.0, side, sets)
    return figure


def regions(found: RegimeMap) -> tuple[Codes, list[str]]:
    """Return codes (columns, rows) of the sets of stable states, and the sets' names, such as "C/U"."""
    names: list[str] = []
    codes = np.zeros(found.stable.shape[1:], dtype=np.int64)
    for i, j in np.ndindex(*codes.shape):
        letters = [LETTERS[n] for n, there in zip(found.names, found.stable[:, i, j], strict=True) if there]
        name = "/".join(sorted(letters, key="CTUDOE".index)) or NONE
        if name not in names:
            names.append(name)
        codes[i, j] = names.index(name)
    return codes, names


def colour(name: str) -> Any:
    """Return the colour of a set of stable states."""
    if name in COLOURS:
        return COLOURS[name]
    parts = [matplotlib.colors.to_rgb(COLOURS[letter]) for letter in name.split("/")]
    return tuple(np.mean(parts, axis=0))


def _name(ax: Any, x: Axis, y: Axis, codes: Codes, sets: list[str], lines: list[BorderCurve]) -> None:
    for code, name in enumerate(sets):
        if np.sum(codes == code) < 0.008 * codes.size:
            continue
        spot = plane.roomiest(x, y, codes == code, lines, 1.0 + 0.45 * (len(name) - 1))
        ax.text(
            *spot, name, ha="center", va="center", fontsize=11.0, weight="bold",
            path_effects=plane.cased(2.6), zorder=6,
        )  # fmt: skip


def _key(figure: Figure, left: float, below: float, across: float, high: float, sets: list[str]) -> None:
    ax = place(figure, left, below, across, high)
    ax.set_axis_off()
    ordered = sorted(sets, key=lambda name: (name.count("/"), name))
    patches = [
        Patch(facecolor=colour(name), edgecolor=INK, linewidth=0.5, label=_words(name)) for name in ordered
    ]
    ax.legend(
        handles=patches,
        **LEGEND | {"loc": "upper left", "bbox_to_anchor": (0.0, 1.02), "ncols": 1, "markerscale": 1.0},
        title="stable states",
        alignment="left",
    )
    ax.text(0.02, 0.0, "Sets: the initial\nstate decides.", fontsize=8.5, color=QUIET, va="bottom")


def _words(name: str) -> str:
    if name == NONE:
        return "none of these"
    return f"{name}  {MEANINGS[name]}" if name in MEANINGS else name
