"""Cells from one radius to two hundred long: order comes alike everywhere, straight zones do not."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray

from ..figures.story import Cell, Panel, interval, story
from ..figures.style import DOWN, INK, QUIET, UP, polarity_rgb
from ..model.grid import Array
from .experiment import AGREES, DOES_NOT, IN_PART, Experiment, Verdict
from .lab import Lab
from .statistics import in_words, median_interval, proportion
from .zone_course import decay, first_for_good, follow, picture, straightening

if TYPE_CHECKING:
    from matplotlib.figure import Figure

LENGTHS = {1.0: 1.0, 2.0: 1.0, 5.0: 1.0, 10.0: 1.0, 20.0: 1.0, 50.0: 0.16, 100.0: 0.08, 200.0: 0.04}
"""Lengths, and the share of the seeds that is followed: a cell costs as much as it is long."""
QUICK_LENGTHS = {2.0: 1.0, 5.0: 1.0, 20.0: 1.0}
END, QUICK_END, STEP = 150.0, 60.0, 2.5
STRIP, QUICK_STRIP = 100.0, 20.0
"""Length of the cell that is shown unwrapped, at these times and on this grid."""
STRIP_TIMES, STRIP_GRID = (10.0, 30.0), (24, 240)
SHOWN = (2.0, 5.0, 20.0)
MEASURED = ("since", "winding", "half_way", "tail", "rate")
"""Time since which there are two stripes, turns of them at the end and half way there, and so on."""
MOST = 0.5
"""Share of cells of every length that should come to have two stripes, and straight ones."""
STRAIGHT = 0.05
"""Slope, in radians a radius, below which zones are straight: three degrees."""
DECAYING = (5.0, 10.0)
"""Lengths at which the decay of bends is measured: the longest wave is alone by half-time, and still felt."""


def measure(lab: Lab) -> xarray.Dataset:
    """Return the course of every cell by length, theory, and pictures of some."""
    lengths = QUICK_LENGTHS if lab.quick else LENGTHS
    end = QUICK_END if lab.quick else END
    times = tuple(np.arange(STEP, end + STEP / 2, STEP))
    counts = [max(2, round(share * lab.seeds)) for share in lengths.values()]
    items = [
        (length, seed, times) for length, count in zip(lengths, counts, strict=True) for seed in range(count)
    ]
    # The longest first, so that no worker is left with one of them at the end.
    courses = lab.each("courses", follow, items[::-1])[::-1]
    shape = (len(counts), max(counts))
    found = {name: np.full(shape, np.nan, dtype=np.float32) for name in MEASURED}
    slope = np.full((*shape, len(times)), np.nan, dtype=np.float32)
    place = [(k, seed) for k, count in enumerate(counts) for seed in range(count)]
    for at, course in zip(place, courses, strict=True):
        slope[at] = course.slope
        found["since"][at] = first_for_good(course.paired, times)
        found["half_way"][at], found["winding"][at] = course.winding[[len(times) // 2, -1]]
        found["tail"][at] = course.tail
        if course.winding[-1] == 0:
            found["rate"][at] = decay(course.slope, times)
    data = xarray.Dataset({name: (("length", "seed"), values) for name, values in found.items()})
    data["slope"] = ("length", "seed", "time"), slope
    data["theory_rate"] = "length", [straightening(length) for length in lengths]
    data = data.assign_coords(length=list(lengths), time=list(times), cells=("length", counts))
    return _pictures(lab, data, end)


def _pictures(lab: Lab, data: xarray.Dataset, end: float) -> xarray.Dataset:
    """Return the data with the final states of some cells, one of them wound if any is, and a long one."""
    wound = np.abs(data["winding"].sel(length=SHOWN[-1]).values) > 0
    chosen = [(length, 0) for length in SHOWN[:-1]]
    chosen += [(SHOWN[-1], int(np.argmax(~wound))), (SHOWN[-1], int(np.argmax(wound)))]
    strip = QUICK_STRIP if lab.quick else STRIP
    looks = (*STRIP_TIMES, end)
    items = [(length, seed, (end,), (48, 48)) for length, seed in chosen]
    seen = lab.each("pictures", picture, [*items, (strip, 0, looks, STRIP_GRID)])
    frame = ("frame", "component", "theta", "z")
    data["P"] = frame, np.array([P[-1] for P, _ in seen[:-1]], dtype=np.float32)
    data["u"] = frame, np.array([u[-1] for _, u in seen[:-1]], dtype=np.float32)
    data["frame_length"] = "frame", [length for length, _ in chosen]
    data["frame_winding"] = "frame", [float(data["winding"].sel(length=one)[seed]) for one, seed in chosen]
    data["strip"] = ("look", "strip_theta", "strip_z"), seen[-1][0][:, 1].astype(np.float32)
    return data.assign_coords(look=list(looks)).assign_attrs(strip_length=strip, end=end)


def _shares(data: xarray.Dataset, condition: Array) -> Array:
    """Return the share, with its interval, of cells (length, seed) that meet a condition, (length, 3)."""
    counts = np.asarray(data["cells"].values)
    return np.array(
        [proportion(int(row[:n].sum()), int(n)) for row, n in zip(condition, counts, strict=True)]
    )


def _states(data: xarray.Dataset) -> dict[str, Array]:
    """Return the shares of cells with two stripes all along, with straight ones, and with wound ones."""
    two = np.isfinite(data["since"].values)
    wound = np.abs(np.nan_to_num(data["winding"].values)) > 0
    straight = two & ~wound & (data["slope"].isel(time=-1).values < STRAIGHT)
    return {
        "two stripes": _shares(data, two),
        "straight": _shares(data, straight),
        "wound": _shares(data, two & wound),
    }


def verdict(data: xarray.Dataset) -> Verdict:
    """Judge: two stripes form along cells of every length, equally soon, and straight."""
    shares, length = _states(data), np.asarray(data["length"].values)
    since = [median_interval(row[np.isfinite(row)]) for row in data["since"].values]
    two, straight, wound = (shares[name] for name in ("two stripes", "straight", "wound"))
    last, most = len(length) - 1, int(np.argmax(wound[:, 1]))
    worst = int(np.argmin(two[:, 0]))
    ratios = [
        np.nanmedian(data["rate"].sel(length=one).values) / float(data["theory_rate"].sel(length=one))
        for one in DECAYING
        if one in length and np.isfinite(data["rate"].sel(length=one).values).any()
    ]
    text = (
        f"in cells {length[0]:g} to {length[last]:g} radii long two stripes run the whole length by "
        f"t = {float(data.attrs['end']):g} in {in_words(tuple(two[worst]))} of cells at least (fewest at "
        f"{length[worst]:g}), after "
        f"{since[0][0]:.0f} ({since[0][1]:.0f} to {since[0][2]:.0f}) in the shortest and "
        f"{since[last][0]:.0f} ({since[last][1]:.0f} to {since[last][2]:.0f}) in the longest"
    )
    if two[worst][2] < MOST:
        return Verdict(DOES_NOT, text)
    bent = straight[:, 2] < MOST
    if not bent.any():
        return Verdict(AGREES, f"{text}, and are straight in {in_words(tuple(straight[:, :].min(0)))}")
    first, life = int(np.argmax(bent)), 1 / data["theory_rate"].values
    text += (
        f". But their zones are straight by then in {in_words(tuple(straight[first]))} at {length[first]:g} "
        f"radii: bends take a time of {life[first]:.0f} there, "
        f"{life[last]:.0f} at {length[last]:g} (theory"
        + (f", of which measured rates are {min(ratios):.2f} to {max(ratios):.2f} times" if ratios else "")
        + ")"
    )
    early = np.abs(np.nan_to_num(data["half_way"].values)) > 0
    if wound[most][1] > 0.02 and early.any():
        same = early & (data["half_way"].values == data["winding"].values)
        stay = proportion(int(same.sum()), int(early.sum()))
        text += (
            f", and in {in_words(tuple(wound[most]))} of cells of {length[most]:g} radii the stripes wind "
            f"about the axis like those of a barber pole; of cells wound half way to then {in_words(stay)} "
            "still were, with as many turns"
        )
    text += f" (amplitude in the tail of the spectrum: {100 * np.nanmax(data['tail'].values):.1f} % at most)"
    return Verdict(IN_PART, text)


def draw(data: xarray.Dataset) -> Figure:
    """Draw cells of several lengths, one long cell unwrapped, how soon stripes come, and how straight."""
    length = np.asarray(data["length"].values)
    winding = np.asarray(data["frame_winding"].values)
    shown = [
        Cell(f"$ℓ$ = {one:g}" + (", wound" if turns else ""), P, u, float(one))
        for one, turns, P, u in zip(
            data["frame_length"].values, winding, data["P"].values, data["u"].values, strict=True
        )
    ]

    def strips(ax: Any) -> None:
        rows, gap = np.asarray(data["strip"].values), 0.3
        for k, (row, time) in enumerate(zip(rows, data["look"].values, strict=True)):
            bottom = (len(rows) - 1 - k) * (1 + gap)
            extent = (0, data.attrs["strip_length"], bottom, bottom + 1)
            ax.imshow(polarity_rgb(row), extent=extent, origin="lower", aspect="auto")
            ax.text(0, bottom + 1.03, f"$t$ = {time:g}", fontsize=8.0, va="bottom")
        ax.set_ylim(0, len(rows) * (1 + gap) - 0.05)
        ax.set_xlim(0, data.attrs["strip_length"])
        ax.set_yticks([])
        ax.spines["left"].set_visible(False)
        ax.set_ylabel("around the axis", labelpad=3.0)
        ax.set_xlabel("along the axis, radii", labelpad=1.0)

    def soon(ax: Any) -> None:
        since = np.array([median_interval(row[np.isfinite(row)]) for row in data["since"].values]).T
        interval(ax, length, since[0], since[1], since[2], UP, "two stripes")
        ax.plot(length, 1 / data["theory_rate"], color=DOWN, linewidth=0.9, label="straight, theory")
        kept = np.isin(length, DECAYING)
        rate = np.array([median_interval(row[np.isfinite(row)]) for row in data["rate"].values[kept]])
        if rate.size:
            ax.vlines(length[kept], 1 / rate[:, 2], 1 / rate[:, 1], color=DOWN)
            ax.plot(length[kept], 1 / rate[:, 0], "o", color=DOWN, markersize=3.4, label="measured")
        ax.set_yscale("log")
        _lengths(ax)
        ax.set_ylabel("time", labelpad=1.0)
        ax.legend(loc="upper left", fontsize=8.0, frameon=False, handlelength=1.3, borderpad=0)

    def straight(ax: Any) -> None:
        for (name, share), colour in zip(_states(data).items(), (UP, DOWN, INK), strict=True):
            interval(ax, length, 100 * share[:, 0], 100 * share[:, 1], 100 * share[:, 2], colour, name)
        ax.set_ylim(-3, 103)
        ax.set_ylabel(f"cells at $t$ = {float(data.attrs['end']):g}, %", labelpad=1.0)
        _lengths(ax)
        ax.legend(
            loc="lower left", bbox_to_anchor=(-0.08, 1.0), ncols=3, fontsize=8.0, frameon=False,
            handlelength=1.2, handletextpad=0.4, columnspacing=0.9, borderpad=0,
        )  # fmt: skip

    def bends(ax: Any) -> None:
        lowest, ends = 1e-3, {}
        shade = np.linspace(0.85, 0.0, len(length))
        for one, grey in zip(length, shade, strict=True):
            middle = np.asarray(data["slope"].sel(length=one).median("seed").values)
            ax.plot(data["time"], middle, color=(grey, 0.75 * grey, 0.9 * grey), linewidth=1.1)
            if middle[-1] > lowest:
                ends[one] = middle[-1]
            else:  # named where it leaves the axes
                seen = data["time"][int(np.sum(middle > lowest)) - 1]
                ax.text(seen, 1.3 * lowest, f"{one:g} ", fontsize=7.5, ha="right")
        height = 0.0
        for one, end in sorted(ends.items(), key=lambda item: item[1]):
            height = max(end, 1.5 * height)
            ax.text(1.03 * data["time"][-1], height, f"{one:g}", fontsize=7.5, va="center")
        ax.axhline(STRAIGHT, color=QUIET, linewidth=0.8, linestyle=(0, (4, 2)), zorder=0)
        ax.text(data["time"][0], STRAIGHT, "straight", fontsize=8.0, color=QUIET, va="bottom")
        ax.set_xscale("log")
        ax.set_yscale("log")
        _ticks(ax, [one for one in (3, 10, 30, 100) if one <= data["time"][-1]])
        ax.set_ylim(lowest, 10)
        ax.set_xlabel("time", labelpad=1.0)
        ax.set_ylabel("slope of zones", labelpad=1.0)

    def _lengths(ax: Any) -> None:
        ax.set_xscale("log")
        _ticks(ax, length.tolist())
        ax.set_xlabel("length, radii", labelpad=1.0)

    def _ticks(ax: Any, values: Sequence[float]) -> None:
        ax.set_xticks(values, [f"{one:g}" for one in values], fontsize=8.0)
        ax.set_xticks([], minor=True)

    panels = [Panel(strips, 1.3), Panel(soon), Panel(straight), Panel(bends)]
    return story(shown, panels, str(verdict(data)), same_view=False, width=240.0)


EXPERIMENT = Experiment(
    name="cell-shape",
    claim="Self-organisation is a general mechanism, not bound to the five radii of the young cell that is "
    "modelled; mature internodes are up to two hundred radii long.",
    source="Introduction (size of internodes); Results (choice of length); Discussion (generality)",
    method="Disordered cells of 1 to 200 radii, on 9.6 points a radius, are followed to t = 150 (fewer of "
    "the long ones: 32, 16 and 8 of 200 seeds at 50, 100 and 200 radii). Measured are when "
    "all circles around the cell have two zones, how steep zones are, and how often the pattern winds "
    "about the axis; the decay of bends is compared with the theory of two stripes.",
    seeds=200,
    quick_seeds=6,
    measure=measure,
    verdict=verdict,
    draw=draw,
)
