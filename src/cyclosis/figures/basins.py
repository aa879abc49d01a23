"""Which initial states end in cyclosis: outcomes against the amplitudes next to the Fourier space origin."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt
from matplotlib.colors import LogNorm, Normalize
from matplotlib.figure import Figure
from matplotlib.ticker import NullFormatter

from ..analysis.outcomes import REGIONS, Separation, separation
from ..analysis.regimes import REGIMES
from ..analysis.wilson import wilson
from ..model.doors import door
from ..model.errors import InputError, number
from ..model.grid import Array
from ..model.units import scales_in, shown_in
from . import plane
from .looks import setting
from .style import INK, SHADE, WIDTH, blank, place
from .swept import Swept, grouped, swept

__all__ = [
    "MOST_BINS",
    "NUMBER",
    "Members",
    "Shares",
    "basins",
    "by_number",
    "by_ratio",
    "line_by_point",
    "members",
    "predicted",
    "states",
]


def __dir__() -> list[str]:
    return sorted(__all__)


NUMBER = "filaments_per_square"
MOST_BINS = 12
"""Largest number of bins of ratios."""
_BOTH = list(REGIONS).index("C/U")
_CYCLOSIS, _UNIDIRECTIONAL = (REGIMES.index(name) for name in ("cyclosis", "unidirectional"))
# Places in millimetres.
_LEFT, _AXIS, _GAP, _RIGHT, _ABOVE, _ROW, _KEY = 14.0, 12.0, 15.0, 4.0, 8.0, 19.0, 11.0


@dataclass(frozen=True, eq=False)
class Members:
    """The members (n,) of the points in C/U that became cyclosis or unidirectional.

    `k0` is |<P_z>| of the initial state and `m1` the amplitude of its wave m = 1, q = 0 of P_z, both
    positive; `cyclosis` says which became cyclosis; `point` is the index of the parameter point among all
    points in C/U, `seed` that of the seed.
    """

    k0: Array
    m1: Array
    cyclosis: npt.NDArray[np.bool_]
    point: npt.NDArray[np.int64]
    seed: npt.NDArray[np.int64]

    @property
    def ratio(self) -> Array:
        """m1 / |k0|."""
        return self.m1 / self.k0


class Shares(NamedTuple):
    """Shares (n,) of cyclosis at `at` (n,), and the ends `low` and `high` of their 95 % intervals."""

    at: Array
    share: Array
    low: Array
    high: Array


@door
def basins(
    dataset: Any,
    select: Mapping[str, float] | None = None,
    log: Collection[str] | None = None,
    width: float = WIDTH,
) -> Figure:
    """Return the figure of the basins of cyclosis and of the unidirectional state within region C/U.

    All points of the sweep `dataset` at which some members became cyclosis and others unidirectional are
    combined; members in other regimes are left out.

    * Every initial state at its |<P_z>| (the mode k = 0) and its amplitude of P_z in the mode m = 1,
      q = 0; its colour is the percentage of the parameter points at which it became cyclosis. The line
      m1 = r |k0| is the one that predicts most outcomes (`cyclosis.analysis.outcomes.separation`).
    * The share of cyclosis against the ratio m1/|k0|, in bins of equally many members, and that line.
    * Over two axes: the ratio r of the line of each parameter point alone; grey where no line helps.
    * Where `filaments_per_square` is an axis: the share of cyclosis against it.

    A sentence says how many outcomes are predicted by the line, by the lines of the points, and by always
    naming the commoner outcome. Bars are Wilson's 95 % intervals. Since all parameter points use the same
    seeds, a seed counts as one trial, however many points it has.

    `select` and `log` are as in `phase_diagram`, `width` is in millimetres; all quantities are dimensionless.
    Raises `InputError` for anything but a sweep with initial_k0 and initial_m1, for more than two axes
    besides `filaments_per_square`, and where no point is in C/U.

    Example:
        >>> import cyclosis as cy
        >>> from cyclosis.figures.basins import basins
        >>> from cyclosis.sweep.store.block import compute
        >>> from cyclosis.sweep.store.store import Store
        >>> tables = {"parameters": {"d_s": 0.1, "alpha_u": 0.1}, "grid": {"n_theta": 16, "n_z": 16}}
        >>> axes = {"alpha_p": {"values": [0.5]}}  # where the initial state decides
        >>> sweep = cy.Sweep.from_tables(tables | {"axes": axes, "ensemble": {"seeds": 8}})
        >>> path = Store.create("basins", sweep).write(0, compute(sweep, 0))
        >>> data = cy.open_sweep("basins")
        >>> sorted({cy.REGIMES[code] for code in data["regime"].values.flat})
        ['cyclosis', 'unidirectional']
        >>> basins(data).get_size_inches().round(1)
        array([7.1, 3. ])
    """
    sweep = swept(dataset, select, log, beside=(NUMBER,))
    found = members(sweep)
    width = number("width", width, 140.0, 1000.0, "choose a width in millimetres")
    with shown_in(scales_in(dataset)), setting(plane.TYPE):
        return _drawn(sweep, found, width)


def members(sweep: Swept) -> Members:
    """Return the `Members` of a sweep. Raises `InputError` where there are none."""
    k0, m1 = np.abs(sweep.variable("initial_k0")), sweep.variable("initial_m1")
    shape = sweep.regime.shape
    seeds = np.broadcast_to(np.arange(shape[-1]) % sweep.dataset.sizes["seed"], shape)
    points = np.cumsum((sweep.regions == _BOTH).ravel()).reshape(sweep.regions.shape) - 1
    decided = np.isin(sweep.regime, (_CYCLOSIS, _UNIDIRECTIONAL)) & (sweep.regions == _BOTH)[..., None]
    # Without noise the amplitudes are zero, which a logarithmic scale cannot show.
    taken = decided & (k0 > 0) & (m1 > 0) & np.isfinite(k0 * m1)
    if not taken.any():
        rule = "those of a sweep with points at which both cyclosis and the unidirectional state occur"
        raise InputError("the regimes", sweep.present, rule, "choose other points, or more seeds")
    points = np.broadcast_to(points[..., None], shape)
    return Members(k0[taken], m1[taken], sweep.regime[taken] == _CYCLOSIS, points[taken], seeds[taken])


def states(found: Members) -> tuple[Array, Array, Array]:
    """Return k0, m1 and the share of cyclosis (n,) of every initial state, over all points that have it."""
    pairs = np.stack([found.k0, found.m1], axis=1)
    rounded = np.array([[float(f"{value:.10e}") for value in pair] for pair in pairs])
    places, which, count = np.unique(rounded, axis=0, return_inverse=True, return_counts=True)
    share = np.bincount(which.ravel(), weights=found.cyclosis) / count
    return places[:, 0], places[:, 1], share


def by_ratio(found: Members) -> Shares:
    """Return the share of cyclosis against m1/|k0|, in bins with equally many members.

    There is a bin for every ten seeds, but at most `MOST_BINS`; a bin is at the geometric mean of its ratios.
    Every seed in a bin counts as one trial.
    """
    count = min(max(np.unique(found.seed).size // 10, 1), MOST_BINS)
    edges = np.quantile(found.ratio, np.linspace(0, 1, count + 1))
    which = np.clip(np.searchsorted(edges, found.ratio, side="right") - 1, 0, count - 1)
    bins = np.unique(which)
    at = np.array([np.exp(np.mean(np.log(found.ratio[which == k]))) for k in bins])
    share = np.array([np.mean(found.cyclosis[which == k]) for k in bins])
    trials = np.array([np.unique(found.seed[which == k]).size for k in bins])
    return Shares(at, share, *wilson(share * trials, trials))


def by_number(sweep: Swept) -> Shares:
    """Return the share of cyclosis against `filaments_per_square`, over the points in C/U.

    The share is that of all members there, in any regime; every seed counts as one trial.
    """
    values = np.asarray(sweep.dataset[NUMBER].values, dtype=np.float64)
    seeds = sweep.dataset.sizes["seed"]
    regime = sweep.regime.reshape(*sweep.regions.shape, values.size, seeds)[sweep.regions == _BOTH]
    there = regime >= 0
    trials = there.any(axis=0).sum(axis=-1)
    total = there.sum(axis=(0, 2))
    share = np.sum(regime == _CYCLOSIS, axis=(0, 2)) / np.where(total > 0, total, np.nan)
    order = np.argsort(values)
    low, high = wilson(np.nan_to_num(share) * trials, trials)
    return Shares(values[order], share[order], low[order], high[order])


def line_by_point(found: Members) -> dict[int, Separation]:
    """Return the `Separation` by m1/|k0| of each parameter point in C/U alone, by its index among them."""
    return {
        int(k): separation(found.ratio[found.point == k], found.cyclosis[found.point == k])
        for k in np.unique(found.point)
    }


def predicted(lines: Mapping[int, Separation], found: Members) -> float:
    """Return the share of members whose outcome the line of their parameter point predicts."""
    right = sum(line.correct * np.sum(found.point == k) for k, line in lines.items())
    return float(right / found.point.size)


def _drawn(sweep: Swept, found: Members, width: float) -> Figure:
    lines = line_by_point(found)
    over_axes = len(sweep.axes) == 2 and len(lines) > 1
    count = 2 + over_axes + (NUMBER in sweep.dataset.dims)
    columns = 3 if count == 3 else 2
    rows = -(-count // columns)
    across = (width - _LEFT - _RIGHT - (columns - 1) * _GAP) / columns
    high = across if columns == 3 else 0.72 * across
    sentences = _sentences(lines, found, width)
    below = _AXIS + 4.0 * len(sentences)
    figure = blank(width, below + rows * high + (rows - 1) * _ROW + _ABOVE)
    boxes = iter(
        (_LEFT + column * (across + _GAP), below + (rows - 1 - row) * (high + _ROW))
        for row in range(rows)
        for column in range(columns)
    )
    _scatter(place(figure, *next(boxes), across, high), found)
    _ratios(place(figure, *next(boxes), across, high), found)
    if over_axes:
        left, bottom = next(boxes)
        ax = place(figure, left, bottom, across - _KEY, high)
        _lines(ax, place(figure, left + across - _KEY + 2.0, bottom, 2.6, high), sweep, lines)
    if NUMBER in sweep.dataset.dims:
        _numbers(place(figure, *next(boxes), across, high), by_number(sweep))
    up = figure.get_size_inches()[1] * 25.4
    for k, text in enumerate(reversed(sentences)):
        figure.text(4.0 / width, (2.0 + 4.0 * k) / up, text, ha="left", va="bottom", fontsize=8.5)
    return figure


def _sentences(lines: Mapping[int, Separation], found: Members, width: float) -> list[str]:
    """Return, in one line or two, how many outcomes the lines predict."""
    one = separation(found.ratio, found.cyclosis)
    each = f", by a line for each point {100 * predicted(lines, found):.0f} %" if len(lines) > 1 else ""
    runs = f"{grouped(found.point.size)} runs at {len(lines)} point{'s' * (len(lines) > 1)} in C/U"
    shares = (
        f"outcomes predicted: by the line {100 * one.correct:.0f} %{each}, "
        f"by always naming the commoner {100 * one.guess:.0f} %"
    )
    return [f"{runs}; {shares}"] if width >= 160 else [runs, shares]


def _scatter(ax: Any, found: Members) -> None:
    k0, m1, share = states(found)
    line = separation(found.ratio, found.cyclosis)
    ax.set(xscale="log", yscale="log", xlim=_decades(k0), ylim=_decades(m1))
    if np.isfinite(line.threshold):
        ends = np.array(ax.get_xlim())
        ax.plot(ends, line.threshold * ends, color=INK, linewidth=1.0, zorder=1 if k0.size < 200 else 3)
        ax.set_title(f"$m_1$ = {line.threshold:.2g} $k_0$", loc="left", pad=4.0, fontsize=9.0)
    ax.scatter(
        k0, m1, s=float(np.clip(1500 / k0.size, 2.5, 20.0)), c=100 * share, cmap=plane.SHARE,
        norm=Normalize(0.0, 100.0), edgecolors=INK, linewidths=0.6 if k0.size < 200 else 0.25, zorder=2,
    )  # fmt: skip
    for side in (ax.xaxis, ax.yaxis):
        side.set_minor_formatter(NullFormatter())
    ax.set_xlabel(r"$k_0$, initial $|\langle P_z\rangle|$", labelpad=1.0)
    ax.set_ylabel("$m_1$, initial wave $m = 1$", labelpad=1.0)
    ax.spines[["top", "right"]].set_visible(False)


def _decades(values: Array) -> tuple[float, float]:
    """Return limits around positive values on a logarithmic scale, more than a decade apart."""
    low, high = np.log10(values.min()), np.log10(values.max())
    room = max(0.06 * (high - low) + 0.05, 0.5 * (1.2 - high + low))
    return float(10 ** (low - room)), float(10 ** (high + room))


def _bars(ax: Any, shares: Shares) -> None:
    some = np.isfinite(shares.share)
    at, share, low, high = (100 * column[some] if k else column[some] for k, column in enumerate(shares))
    ax.set(xscale="log", ylim=(-5, 105), yticks=[0, 50, 100])
    ax.fill_between(at, low, high, color=SHADE, linewidth=0, alpha=0.7, zorder=1)
    ax.vlines(at, low, high, color=INK, linewidth=0.8, zorder=2)
    ax.plot(at, share, color=INK, linewidth=0.6, zorder=2)
    ax.scatter(
        at, share, s=13.0, c=share, cmap=plane.SHARE, norm=Normalize(0.0, 100.0), edgecolors=INK,
        linewidths=0.6, zorder=3, clip_on=False,
    )  # fmt: skip
    ax.set_ylabel("% cyclosis", labelpad=1.0)
    ax.spines[["top", "right"]].set_visible(False)


def _ratios(ax: Any, found: Members) -> None:
    line = separation(found.ratio, found.cyclosis)
    _bars(ax, by_ratio(found))
    ax.set_xlim(_decades(found.ratio))
    plane.round_ticks(ax.xaxis, wide=True)
    if np.isfinite(line.threshold):
        ax.axvline(line.threshold, color=INK, linewidth=1.0, zorder=1.5)
    ax.set_xlabel("$m_1 / k_0$", labelpad=1.0)


def _numbers(ax: Any, shares: Shares) -> None:
    _bars(ax, shares)
    ax.set_xlim(_decades(shares.at))
    ax.set_xlabel("$N$, filaments per grid square", labelpad=1.0)


def _lines(ax: Any, bar: Any, sweep: Swept, lines: Mapping[int, Separation]) -> None:
    x, y = sweep.axes
    where = np.argwhere(sweep.regions == _BOTH)
    ratio = np.full(sweep.regions.shape, np.nan)
    for k, line in lines.items():
        ratio[tuple(where[k])] = line.threshold if np.isfinite(line.threshold) else np.nan
    finite = ratio[np.isfinite(ratio)]
    low = float(finite.min()) if finite.size else 1.0
    norm = LogNorm(low, max(float(finite.max()), 1.01 * low) if finite.size else 10.0)
    plane.prepare(ax, x, y)
    plane.plain(ax, x, y, sweep.trials > 0, plane.NONE)
    plane.plain(ax, x, y, sweep.regions == _BOTH, plane.DISORDERED)
    plane.key(bar, plane.cells(ax, x, y, ratio, plane.TIME, norm), "$m_1 / k_0$")
    plane.outline(ax, x, y, sweep.regions, 0.9)
    first, last = where.min(axis=0), where.max(axis=0)
    for side, name, k in ((x, "xlim", 0), (y, "ylim", 1)):
        ends = [max(first[k] - 1, 0), min(last[k] + 2, side.values.size)]
        ax.set(**{name: side.edges[ends]})
    ax.set_title("point by point", loc="left", pad=4.0, fontsize=9.0)
    plane.label(ax.xaxis, x, 1.0)
    plane.label(ax.yaxis, y, 2.0)
