"""Cells from one radius to two hundred long: order forms at the same rate in all, straight zones do not."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
import numpy.typing as npt
import xarray

from ..analysis.diagnostics import diagnose
from ..analysis.zones import crossings
from ..dynamics.simulate import simulate
from ..figures import quantities
from ..figures.story import Cell, Panel, interval, story
from ..figures.style import DOWN, INK, QUIET, UP, polarity_rgb
from ..model import initial
from ..model.errors import InputError
from ..model.grid import Array, CylinderGrid, interpolate
from ..model.parameters import Parameters
from ..model.system import flow
from ..stability import cyclosis
from .experiment import AGREES, DOES_NOT, IN_PART, Experiment, Verdict
from .lab import Lab
from .statistics import in_words, median_interval, proportion

if TYPE_CHECKING:
    from matplotlib.figure import Figure

# Computed

PARAMS = Parameters(alpha_p=1.0, alpha_u=0.5)
POINTS = 9.6
"""Grid points per radius along the axis: those of 48 points in a cell of length 5."""
POINTS_OF_THEORY = 96
"""Points around the axis on which the neutral rotation is neutral to 1e-8, below all rates here."""
UNFELT = 1e-4
"""Slope below which zones are straight to the accuracy of steps and grid."""


def grid_of(length: float) -> CylinderGrid:
    """Return the grid of a cell, as fine along the axis at every length."""
    return CylinderGrid(48, 2 * int(np.ceil(0.5 * POINTS * length)), length)


class ZoneCourse(NamedTuple):
    """One cell at given times.

    `paired` is the share of circles with two zones (times,), `slope` the root mean square slope of the
    pattern (times,), `winding` its turns along the cell (times,), `tail` the spectral tail at the end.
    """

    paired: Array
    slope: Array
    winding: Array
    tail: float


def follow(length: float, seed: int, times: tuple[float, ...]) -> ZoneCourse:
    """Return the `ZoneCourse` of a disordered cell at increasing `times`, the last of which ends it."""
    grid = grid_of(length)
    states = _followed(grid, seed, times)
    paired = np.array([two_zones(P) for P in states])
    slopes = np.array([slope(P, length) for P in states])
    tail = float(diagnose(PARAMS, grid, states[-1])["spectral_tail"])
    windings = np.rint([_turns(P).sum() / (2 * np.pi) for P in states])
    return ZoneCourse(paired, slopes, windings, tail)


def picture(
    length: float, seed: int, times: tuple[float, ...], shape: tuple[int, int]
) -> tuple[Array, Array]:
    """Return P and u (times, 2, *shape) of the cell that `follow` integrates, on a grid of another shape."""
    grid = grid_of(length)
    states = _followed(grid, seed, times)
    flows = [flow(PARAMS, grid, P) for P in states]
    return np.array([interpolate(P, shape) for P in states]), np.array([interpolate(u, shape) for u in flows])


def _followed(grid: CylinderGrid, seed: int, times: tuple[float, ...]) -> list[Array]:
    state = initial.disordered(grid, seed=seed)
    run = simulate(PARAMS, grid, state, times[-1], save_at=times, rtol=1e-3)
    if run.status not in ("completed", "steady"):
        raise InputError("the run", run.status, "completed", "take more points a radius")
    return [run.frames[k] for k in range(len(run.times) - len(times), len(run.times))]


def two_zones(P: Array) -> float:
    """Return the share of circles z = const on which P_z of P (2, n_theta, n_z) changes sign twice."""
    return float(np.mean(crossings(P) == 2))


def _turns(P: Array) -> Array:
    """Return by how much the pattern turns from each circle to the next (n_z,), in radians."""
    wave = np.fft.fft(P[1], axis=0)[1]
    return np.angle(np.roll(wave, -1) * np.conj(wave))


def slope(P: Array, length: float) -> float:
    """Return the root mean square of dφ/dz, φ(z) the angle about the axis of the pattern at z."""
    return float(np.sqrt(np.mean(_turns(P) ** 2))) * P.shape[2] / length


def first_for_good(paired: npt.ArrayLike, times: npt.ArrayLike) -> float:
    """Return the first of `times` (n,) after which all circles keep two zones, NaN if there is none."""
    good = np.asarray(paired) >= 1.0
    since = int(np.argmin(good[::-1])) if not good.all() else good.size
    return float(np.asarray(times)[good.size - since]) if since > 0 else np.nan


def decay(slopes: npt.ArrayLike, times: npt.ArrayLike) -> float:
    """Return the decay rate of slopes (n,) over the later half of `times`; NaN if they are below `UNFELT`."""
    y, t = np.asarray(slopes), np.asarray(times)
    late = (t >= 0.5 * t[-1]) & (y > UNFELT)
    return float(-np.polyfit(t[late], np.log(y[late]), 1)[0]) if late.sum() > 2 else np.nan


def straightening(length: float) -> float:
    """Return the theoretical decay rate of the longest wave of two stripes along a cell."""
    modes = cyclosis(PARAMS, POINTS_OF_THEORY).spectrum(1, axial_mode=1, length=length)
    return float(-modes.eigenvalues[0].real)


LENGTHS = {1.0: 1.0, 2.0: 1.0, 5.0: 1.0, 10.0: 1.0, 20.0: 1.0, 50.0: 0.16, 100.0: 0.08, 200.0: 0.04}
"""Lengths, and the share of the seeds that is simulated: the cost of a cell is proportional to its length."""
QUICK_LENGTHS = {2.0: 1.0, 5.0: 1.0, 20.0: 1.0}
END, QUICK_END, STEP = 150.0, 60.0, 2.5
STRIP, QUICK_STRIP = 100.0, 20.0
"""Length of the cell that is shown unwrapped; its times and grid follow."""
STRIP_TIMES, STRIP_GRID = (10.0, 30.0), (24, 240)
SHOWN = (2.0, 5.0, 20.0)
MEASURED = ("since", "winding", "half_way", "tail", "rate")
"""Time since which there are two stripes, turns at the end and at half-time, spectral tail, decay rate."""
MOST = 0.5
"""Share of cells of every length that should reach two stripes, and straight ones."""
STRAIGHT = 0.05
"""Slope, in radians per radius, below which zones are straight: three degrees."""
DECAYING = (5.0, 10.0)
"""Lengths at which the decay of bends is measured: by half-time only the longest wave remains, resolved."""


def measure(lab: Lab) -> xarray.Dataset:
    """Return the course of every cell by length, theory, and pictures of some."""
    lengths = QUICK_LENGTHS if lab.quick else LENGTHS
    end = QUICK_END if lab.quick else END
    times = tuple(np.arange(STEP, end + STEP / 2, STEP))
    counts = [max(2, round(share * lab.seeds)) for share in lengths.values()]
    items = [
        (length, seed, times) for length, count in zip(lengths, counts, strict=True) for seed in range(count)
    ]
    # The longest first, so that no worker starts one of them last.
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
    """Return the shares of cells with two stripes throughout, with straight ones, and with wound ones."""
    two = np.isfinite(data["since"].values)
    wound = np.abs(np.nan_to_num(data["winding"].values)) > 0
    straight = two & ~wound & (data["slope"].isel(time=-1).values < STRAIGHT)
    return {
        "two stripes": _shares(data, two),
        "straight": _shares(data, straight),
        "wound": _shares(data, two & wound),
    }


# Judged


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


def decisive(data: xarray.Dataset) -> str:
    """Return the share of cells with straight zones, at the first length at which most have none."""
    straight, length = _states(data)["straight"], data["length"].values
    bent = straight[:, 2] < MOST
    k = int(np.argmax(bent)) if bent.any() else int(np.argmin(straight[:, 0]))
    return f"{in_words(tuple(straight[k]))} of cells of {length[k]:g} radii have straight stripes"


# Drawn


def draw(data: xarray.Dataset) -> Figure:
    """Draw cells of several lengths, one long cell unwrapped, when stripes form, and how straight."""
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
            ax.text(0, bottom + 1.03, quantities.when(time), fontsize=8.0, va="bottom")
        ax.set_ylim(0, len(rows) * (1 + gap) - 0.05)
        ax.set_xlim(0, data.attrs["strip_length"])
        ax.set_yticks([])
        ax.spines["left"].set_visible(False)
        ax.set_ylabel("around the axis", labelpad=3.0)
        quantities.name(ax.xaxis, "along the axis", "length", "radii", labelpad=1.0)

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
        quantities.name(ax.yaxis, "time", "time", labelpad=1.0)
        ax.legend(loc="upper left", fontsize=8.0, frameon=False, handlelength=1.3, borderpad=0)

    def straight(ax: Any) -> None:
        for (name, share), colour in zip(_states(data).items(), (UP, DOWN, INK), strict=True):
            interval(ax, length, 100 * share[:, 0], 100 * share[:, 1], 100 * share[:, 2], colour, name)
        ax.set_ylim(-3, 103)
        ax.set_ylabel(f"cells at {quantities.when(float(data.attrs['end']))}, %", labelpad=1.0)
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
        quantities.name(ax.xaxis, "time", "time", labelpad=1.0)
        ax.set_ylabel("slope of zones", labelpad=1.0)

    def _lengths(ax: Any) -> None:
        ax.set_xscale("log")
        _ticks(ax, length.tolist())
        quantities.name(ax.xaxis, "length", "length", "radii", labelpad=1.0)

    def _ticks(ax: Any, values: Sequence[float]) -> None:
        ax.set_xticks(values, [f"{one:g}" for one in values], fontsize=8.0)
        ax.set_xticks([], minor=True)

    panels = [Panel(strips, 1.3), Panel(soon), Panel(straight), Panel(bends)]
    return story(shown, panels, str(verdict(data)), same_view=False, width=240.0)


EXPERIMENT = Experiment(
    name="cell-shape",
    headline="Self-organisation does not depend on the length of the cell.",
    claim="Self-organisation is a general mechanism, not bound to the five radii of the young cell that is "
    "modelled; mature internodes are up to two hundred radii long.",
    source="Introduction (size of internodes); Results (choice of length); Discussion (generality)",
    method="Disordered cells of 1 to 200 radii, on 9.6 points a radius, are integrated to t = 150 (fewer of "
    "the long ones: 32, 16 and 8 of 200 seeds at 50, 100 and 200 radii). Measured are the time when all "
    "circles around the cell have two zones, how steep zones are, and how often the pattern winds about the "
    "axis. The decay of bends is compared with the theory of two stripes.",
    seeds=200,
    quick_seeds=6,
    measure=measure,
    verdict=verdict,
    decisive=decisive,
    draw=draw,
)
