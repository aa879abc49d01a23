"""A plane of swept parameters: coloured cells, outlined and named regions, curves, keys."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import numpy.typing as npt
import scipy.ndimage
from matplotlib.collections import LineCollection
from matplotlib.colors import LinearSegmentedColormap, LogNorm, Normalize
from matplotlib.patches import Rectangle
from matplotlib.patheffects import withStroke
from matplotlib.ticker import FixedLocator, LogLocator, NullFormatter, NullLocator

from ..analysis.outcomes import REGIONS
from ..model.grid import Array
from ..model.units import PURE
from . import quantities, style
from .style import INK, LEGEND, QUIET, SHADE, ZONE
from .swept import Axis, Codes, Swept
from .thresholds import DISORDER, EXISTS, ROTATES, STABLE, STRIPES, TILT, TILTS, BorderCurve

# All go from light to dark, so that they can be read in grayscale and with any kind of colour vision.
SHARE = LinearSegmentedColormap.from_list(
    "share", ["#fbf8fd", "#dcc6f0", "#b78be0", "#9257c4", "#6a3394"], N=512
)
"""Colours of a share from 0 (nearly white) to 1 (dark purple)."""
SOME = LinearSegmentedColormap.from_list("some", SHARE(np.linspace(0.18, 1.0, 64)), N=512)
"""The same for shares above 0, so that the smallest are still visible on white."""
TIME = LinearSegmentedColormap.from_list(
    "time", ["#e6f6e6", "#9cd8a4", "#5cae69", "#2f7040", "#12331d"], N=512
)
"""Colours of times from short (pale green) to long (dark green)."""
NONE = ZONE
"""Cells in which none of the members is of the kind shown."""
DISORDERED = SHADE
"""Cells without an ordered member."""
_GREEN = "#1f5c2c"
STYLES: dict[str, tuple[str, Any]] = {
    DISORDER: (INK, (0, (1, 1.4))),
    TILT: (INK, (0, (4.5, 1.8))),
    STRIPES: (INK, (0, (6, 1.6, 1, 1.6))),
    STABLE: (INK, "-"),
    EXISTS: ("#87ec98", (0, (2.5, 2.5))),
    TILTS: (INK, (0, (1, 0.8))),
    ROTATES: (INK, (0, (8, 1.6, 1, 1.6, 1, 1.6))),
}
"""Colours and line styles of the curves of theory."""
FURTHER: tuple[Any, ...] = ("-", (0, (3, 1.2)), (0, (1, 1.2)), (0, (8, 2)))
"""Line styles, in turn, of other curves, which are dark green."""
MISSING = "//////"
"""Hatch of points that have not been computed."""
TYPE = style.TYPE | {"font.size": 9.0, "axes.labelsize": 10.0, "xtick.labelsize": 8.5, "ytick.labelsize": 8.5}
"""Matplotlib settings of figures of sweeps."""
KEY: dict[str, Any] = LEGEND | {"handlelength": 2.4, "bbox_to_anchor": (-0.025, 1.045)}
"""A legend of lines above their axes."""
_RASTER, _ENOUGH = 240, 8
_LETTER = 1.35
"""Mean width of a letter of the notes in millimetres."""


def cased(width: float = 2.2) -> list[Any]:
    """Return the effect that keeps ink readable on dark cells: a white rim."""
    return [withStroke(linewidth=width, foreground=ZONE)]


def prepare(ax: Any, x: Axis, y: Axis, roomy: bool = True) -> None:
    """Give axes the scales, limits, ticks and hatched background of a plane; missing points stay hatched.

    Small axes, which are not `roomy`, get fewer ticks.
    """
    ax.set(xscale=x.scale, yscale=y.scale)
    ax.set(xlim=x.edges[[0, -1]], ylim=y.edges[[0, -1]])
    tick(ax.xaxis, x, roomy)
    tick(ax.yaxis, y, roomy)
    ax.add_patch(
        Rectangle(
            (0, 0), 1, 1, transform=ax.transAxes, facecolor=ZONE, edgecolor=QUIET, hatch=MISSING, linewidth=0,
            zorder=0,
        )
    )  # fmt: skip


def tick(side: Any, axis: Axis, roomy: bool = True) -> None:
    """Put ticks on one side of axes: at the swept values if they are few, else at round ones."""
    if axis.values.size <= (6 if roomy else 3):
        side.set_major_locator(FixedLocator(list(axis.values)))
        side.set_minor_locator(NullLocator())
    elif axis.log:
        round_ticks(side, np.ptp(np.log10(axis.edges)) > (3.0 if roomy else 1.2))
    side.set_major_formatter(lambda value, _: f"{value:.3g}")
    side.set_minor_formatter(NullFormatter())


def label(side: Any, axis: Axis, labelpad: float, shown: bool = True) -> None:
    """Name one side of axes, unless it is not `shown`, and put its ticks in units if some are chosen."""
    if axis.kind:
        fixed = side.get_major_locator() if axis.values.size <= 6 else None
        unit = quantities.name(side, axis.symbol, axis.kind, labelpad=labelpad)
        if fixed is not None and unit is not PURE:
            side.set_major_locator(fixed)
            side.set_major_formatter(lambda value, _: f"{unit.factor * value:.3g}")
    else:
        side.set_label_text(axis.symbol)
        side.labelpad = labelpad
    if not shown:
        side.set_label_text("")


def told(axis: Axis, value: float) -> str:
    """Return a value on an axis in words."""
    return quantities.words(value, axis.kind, ".3g") if axis.kind else f"{value:.3g}"


def round_ticks(side: Any, wide: bool = False) -> None:
    """Put the ticks 1, 2, 5, 10, ... on a side with a logarithmic scale, or powers of ten if it is wide."""
    side.set_major_locator(LogLocator(subs=(1.0,) if wide else (1.0, 2.0, 5.0)))
    side.set_major_formatter(lambda value, _: f"{value:g}")
    side.set_minor_formatter(NullFormatter())


def rounded(low: Array, high: Array) -> tuple[float, float]:
    """Return the nearest of 1, 2, 5, 10, ... below all of `low` and above all of `high`, ignoring NaN.

    They are at least a factor of four apart.
    """
    ends = [values[np.isfinite(values) & (values > 0)] for values in (low, high)]
    if not ends[0].size or not ends[1].size:
        return 1.0, 10.0
    ladder = np.multiply.outer(10.0 ** np.arange(-12, 13), [1.0, 2.0, 5.0]).ravel()
    first = ladder[ladder <= ends[0].min()].max()
    return float(first), float(ladder[ladder >= max(ends[1].max(), 4.0 * first)].min())


def cells(
    ax: Any,
    x: Axis,
    y: Axis,
    values: Array,
    colours: LinearSegmentedColormap,
    norm: Normalize,
    shown: npt.NDArray[np.bool_] | None = None,
) -> Any:
    """Draw values (nx, ny) as cells around the swept values; NaN, and those not `shown`, stay empty."""
    drawn = np.ma.masked_invalid(values if shown is None else np.where(shown, values, np.nan))
    return ax.pcolormesh(x.edges, y.edges, drawn.T, cmap=colours, norm=norm, linewidth=0, zorder=1)


def plain(ax: Any, x: Axis, y: Axis, where: npt.NDArray[np.bool_], colour: str) -> None:
    """Fill the cells (nx, ny) `where` with one colour."""
    one = LinearSegmentedColormap.from_list("one", [colour, colour])
    cells(ax, x, y, np.where(where, 0.0, np.nan), one, Normalize(0, 1))


def borders(x: Axis, y: Axis, codes: Codes) -> list[Array]:
    """Return the borders (2, 2) between cells of different codes (nx, ny), as pairs of points.

    Borders with cells without a code (-1) are left out.
    """
    found = []
    for i, j in np.argwhere((codes[1:] != codes[:-1]) & (codes[1:] >= 0) & (codes[:-1] >= 0)):
        found.append(np.array([[x.edges[i + 1], y.edges[j]], [x.edges[i + 1], y.edges[j + 1]]]))
    for i, j in np.argwhere((codes[:, 1:] != codes[:, :-1]) & (codes[:, 1:] >= 0) & (codes[:, :-1] >= 0)):
        found.append(np.array([[x.edges[i], y.edges[j + 1]], [x.edges[i + 1], y.edges[j + 1]]]))
    return found


def outline(ax: Any, x: Axis, y: Axis, codes: Codes, width: float = 1.2) -> None:
    """Draw the borders between regions, `width` points wide."""
    pairs = borders(x, y, codes)
    for colour, wide in ((ZONE, 2.2 * width), (INK, width)):
        lines = LineCollection(pairs, colors=colour, linewidths=wide, zorder=3, capstyle="projecting")
        ax.add_collection(lines)


def label_regions(ax: Any, x: Axis, y: Axis, codes: Codes, curves: Sequence[BorderCurve] = ()) -> None:
    """Write each region's name where it has most room, away from curves if possible."""
    names = list(REGIONS)
    for code in np.unique(codes[codes >= 0]):
        name = names[code]
        if name == "mixed":
            continue
        place = roomiest(x, y, codes == code, curves, 1.0 + 0.45 * (len(name) - 1))
        ax.text(
            *place,
            name,
            ha="center",
            va="center",
            fontsize=11.0,
            weight="bold",
            path_effects=cased(2.6),
            zorder=6,
        )


def roomiest(
    x: Axis, y: Axis, inside: npt.NDArray[np.bool_], curves: Sequence[BorderCurve], stretch: float
) -> tuple[float, float]:
    """Return the point (x, y) of the largest part of the cells (nx, ny) `inside` with most room around it.

    Room is that of an ellipse `stretch` times wider than high, which no curve should cross; if curves
    leave too little room, they are ignored.
    """
    parts, count = scipy.ndimage.label(inside)
    across, up = (axis.between(_RASTER + 1) for axis in (x, y))
    middles = [0.5 * (line[1:] + line[:-1]) for line in (across, up)]
    which = [
        np.clip(np.searchsorted(axis.edges, middle) - 1, 0, axis.values.size - 1)
        for axis, middle in zip((x, y), middles, strict=True)
    ]
    raster = parts[np.ix_(*which)]
    sizes = np.bincount(raster.ravel(), minlength=count + 1)
    raster = raster == 1 + int(np.argmax(sizes[1:]))
    free = raster.copy()
    for curve in curves:
        places = [np.searchsorted(line, at) - 1 for line, at in zip((across, up), curve[1:], strict=True)]
        on = np.isfinite(curve.x) & np.isfinite(curve.y)
        for place in places:
            on &= (place >= 0) & (place < _RASTER)
        free[places[0][on], places[1][on]] = False
    room = _room(free, stretch)
    if room.max() < _ENOUGH:
        room = _room(raster, stretch)
    # Of nearly equal places, choose the one nearest to the middle of the part.
    best = np.argwhere(room >= 0.97 * room.max())
    i, j = best[np.argmin(np.sum((best - np.argwhere(raster).mean(axis=0)) ** 2, axis=1))]
    return float(middles[0][i]), float(middles[1][j])


def _room(free: npt.NDArray[np.bool_], stretch: float) -> Array:
    padded = np.pad(free, 1)
    distance = scipy.ndimage.distance_transform_edt(padded, sampling=(1 / stretch, 1.0))
    return np.asarray(distance, dtype=np.float64)[1:-1, 1:-1]


def draw_curves(ax: Any, curves: Sequence[BorderCurve]) -> list[Any]:
    """Draw curves, each in its own style, and return their lines for a legend."""
    lines: list[Any] = []
    for curve in curves:
        others = sum(before.name not in STYLES for before in curves[: len(lines)])
        known = curve.name in STYLES
        colour, line = STYLES.get(curve.name, (_GREEN, FURTHER[others % len(FURTHER)]))
        (drawn,) = ax.plot(
            curve.x,
            curve.y,
            color=colour,
            linewidth=1.2 if known else 1.4,
            linestyle=line,
            label=curve.name,
            # Where both limits of stripes coincide, the second is dashed on top of the first.
            path_effects=None if curve.name == EXISTS else cased(2.6),
            zorder=4,
        )
        lines.append(drawn)
    return lines


def head(curves: Sequence[BorderCurve]) -> float:
    """Return the height in millimetres of the legend of curves above their axes."""
    return 3.0 + 4.8 * -(-len(curves) // KEY["ncols"])


def key(ax: Any, mappable: Any, title: str) -> None:
    """Draw the colours of cells into narrow upright axes, with a title above."""
    bar = ax.figure.colorbar(mappable, cax=ax)
    bar.outline.set_linewidth(0.6)
    if isinstance(mappable.norm, LogNorm):
        low, high = mappable.get_clim()
        round_ticks(ax.yaxis, high > 1e3 * low)
    ax.minorticks_off()
    ax.set_title(title, pad=5.0, fontsize=9.0, loc="left")


def strip(ax: Any, axis: Axis, codes: Codes) -> None:
    """Draw the regions (n,) along one axis into low axes: a named box for each stretch of one region."""
    ax.set(xscale=axis.scale, xlim=axis.edges[[0, -1]], ylim=(0, 1))
    ax.set_axis_off()
    names = list(REGIONS)
    starts = np.flatnonzero(np.diff(codes, prepend=-2))
    first, last = (np.log(axis.edges) if axis.log else axis.edges)[[0, -1]]
    for start, end in zip(starts, [*starts[1:], codes.size], strict=True):
        left, right = axis.edges[start], axis.edges[end]
        name = names[codes[start]] if codes[start] >= 0 else ""
        ground = {"D": DISORDERED}.get(name, ZONE)
        ax.add_patch(
            Rectangle(
                (left, 0), right - left, 1, facecolor=ground, edgecolor=INK, linewidth=0.8, clip_on=False,
                hatch=None if name else MISSING,
            )
        )  # fmt: skip
        ends = np.log([left, right]) if axis.log else np.array([left, right])
        fits = (ends[1] - ends[0]) / (last - first) > 0.012 * (1 + len(name))
        if fits and name != "mixed":
            middle = np.exp(ends.mean()) if axis.log else ends.mean()
            ax.text(middle, 0.46, name, ha="center", va="center", fontsize=9.0, weight="bold")


def _notes(sweep: Swept, width: float) -> list[str]:
    """Return lines that explain the names of the regions and give the number of runs."""
    names = list(REGIONS)
    lines = [""]
    for code in np.unique(sweep.regions[sweep.regions >= 0]):
        meaning = f"{names[code].replace('mixed', 'unnamed')}  {REGIONS[names[code]]}"
        if len(lines[-1] + meaning) * _LETTER > width - 8.0:
            lines.append("")
        lines[-1] += ("       " if lines[-1] else "") + meaning
    if len(lines[-1] + sweep.summary) * _LETTER > width - 15.0:
        lines.append("")
    return lines


def foot(sweep: Swept, width: float) -> float:
    """Return the height in millimetres of the `notes` below a figure of `width` millimetres."""
    return 2.0 + 4.0 * len(_notes(sweep, width))


def notes(figure: Any, sweep: Swept) -> None:
    """Explain the names of a figure's regions below it, and give the number of runs."""
    across, up = figure.get_size_inches() * 25.4
    lines = _notes(sweep, across)
    style = {"va": "bottom", "fontsize": 8.5}
    bold = {name: f"$\\bf{{{name}}}$" for name in REGIONS if name != "mixed"}
    for k, line in enumerate(reversed(lines)):
        words = [
            "  ".join(bold.get(word, word) for word in item.split("  ")) for item in line.split("       ")
        ]
        figure.text(4.0 / across, (2.0 + 4.0 * k) / up, "       ".join(words), ha="left", **style)
    figure.text(1 - 3.0 / across, 2.0 / up, sweep.summary, ha="right", **style)
