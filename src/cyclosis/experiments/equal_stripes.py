"""Two stripes, no more, of precisely equal width."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt
import xarray

from ..analysis.regimes import REGIMES
from ..analysis.zones import crossings, stripe_widths, zone_angles
from ..dynamics.simulate import simulate
from ..figures import quantities
from ..figures.story import Panel, cells, interval, story
from ..figures.style import DOWN, INK, LEGEND, QUIET, UP
from ..model import initial
from ..model.grid import Array, CylinderGrid
from ..model.parameters import Parameters
from ..stability.profiles.profile import cyclosis
from .experiment import AGREES, DOES_NOT, IN_PART, Experiment, Verdict
from .lab import Lab, frames
from .statistics import in_words, median_interval, proportion

if TYPE_CHECKING:
    from matplotlib.figure import Figure

# Computed

FLOWS = (0.05, 0.1, 0.25, 0.5, 1.0)
LENGTHS = {2.5: 48, 10.0: 96}
"""Lengths other than 5, which is in the sweep over flow alignment, and points along them: with 48 points half
of the runs at length 10 are underresolved."""
FOLLOWED = (0.1, 0.5)
"""Flow alignments at which the difference of widths is recorded over time."""
COURSE = (15.0, 20.0, 30.0, 40.0, 60.0, 80.0, 110.0, 150.0)
TIMES = (4.0, 12.0, 20.0, 35.0, 150.0)
T_END = 2000.0
EQUAL = 0.005
"""Difference of a stripe's width from a half that counts as zero."""
SURE = 0.9
"""Share of cells above which a regime counts as the certain one."""


def measure(lab: Lab) -> xarray.Dataset:
    """Return how each cell ended over flow alignment and length, and its widths on the way."""
    flows = (0.1, 0.5) if lab.quick else FLOWS
    lengths = {2.5: 48} if lab.quick else LENGTHS
    run = {"t_end": T_END, "rtol": 1e-3}
    over_flow = lab.sweep("flow", {"axes": {"alpha_u": {"values": list(flows)}}, "run": run})
    ends = {5.0: _end(over_flow.sel(alpha_u=0.5))}
    for length, n_z in lengths.items():
        tables = {"axes": {"length": {"values": [length]}}, "grid": {"n_theta": 48, "n_z": n_z}, "run": run}
        ends[length] = _end(lab.sweep(f"length-{length:g}", tables).isel(length=0))
    courses = np.array(
        lab.each("widths", course, [(alpha_u, seed) for alpha_u in FOLLOWED for seed in range(lab.seeds)])
    ).reshape(len(FOLLOWED), lab.seeds, len(COURSE))
    grid = CylinderGrid(48, 48, 5.0)
    cell = lab.story(Parameters(), grid, initial.disordered(grid, seed=1), TIMES[-1], TIMES, rtol=1e-3)
    found = frames(cell, TIMES)
    by_flow = [_end(over_flow.isel(alpha_u=k)) for k in range(len(flows))]
    by_length = [ends[length] for length in sorted(ends)]
    for name, listed in (("alpha_u", by_flow), ("cell_length", by_length)):
        for variable, values in zip(("ended", "stripes", "uneven"), zip(*listed, strict=True), strict=True):
            found[f"{variable}_over_{name}"] = (name, "seed"), np.stack(values)
    found = found.assign_coords(alpha_u=list(flows), cell_length=sorted(ends), followed=list(FOLLOWED))
    found["difference"] = ("followed", "seed", "course_time"), courses
    found["theory_rate"] = "followed", [relaxation(alpha_u) for alpha_u in FOLLOWED]
    return found.assign_coords(course_time=list(COURSE))


def _end(swept: xarray.Dataset) -> tuple[npt.NDArray[np.int8], npt.NDArray[np.int8], Array]:
    """Return regime, number of stripes and difference from a half of every seed's final state."""
    regime = np.asarray(swept["regime"].values, dtype=np.int8)
    width = np.asarray(swept["stripe_width"].values)
    striped = np.isin(regime, [REGIMES.index(name) for name in ("cyclosis", "multistripe")])
    stripes = np.where(striped, np.isfinite(width).sum(axis=-1), 0).astype(np.int8)
    return regime, stripes, np.where(stripes == 2, np.abs(width[:, 0] - 0.5), np.nan)


def course(alpha_u: float, seed: int) -> Array:
    """Return the difference of widths, see `difference`, of one cell at the times of `COURSE` (times,)."""
    grid = CylinderGrid(48, 48, 5.0)
    state = initial.disordered(grid, seed=seed)
    run = simulate(Parameters(alpha_u=alpha_u), grid, state, COURSE[-1], save_at=COURSE, rtol=1e-3)
    saved = np.asarray(run.times)
    return np.array([difference(run.frames[int(np.argmin(np.abs(saved - time)))]) for time in COURSE])


def difference(P: Array) -> float:
    """Return by how much either stripe of a state (2, n_theta, n_z) differs from half a turn, in turns.

    NaN unless every circle z = const is crossed by exactly two zones.
    """
    if not np.all(crossings(P) == 2):
        return float("nan")
    widths = stripe_widths(zone_angles(P[1].mean(axis=1)))
    return float(abs(widths[0] - 0.5)) if widths.size == 2 else float("nan")


def relaxation(alpha_u: float) -> float:
    """Return the rate at which a small difference of widths decays, in theory."""
    return float(-cyclosis(Parameters(alpha_u=alpha_u)).spectrum(2, components="z").eigenvalues[1].real)


def rates(times: Array, differences: Array) -> Array:
    """Return the decay rates (n,) of differences (seed, time): each cell's least squares slope.

    Over those times at which the difference is between 1e-7 and 0.05, if there are three: then the law is
    linear and rounding negligible.
    """
    out = []
    for values in differences:
        good = (values > 1e-7) & (values < 0.05)
        if good.sum() >= 3:
            out.append(-np.polyfit(times[good], np.log(values[good]), 1)[0])
    return np.array(out)


SYMBOLS = {"alpha_u": "α_u", "cell_length": "length"}
"""What is swept, and how it is written."""

# Judged


def verdict(data: xarray.Dataset) -> Verdict:
    """Judge: no pattern has any other number of stripes, they are equal, and every cell reaches them."""
    cyclic = REGIMES.index("cyclosis")
    striped, two, worst, rarely = 0, 0, 0.0, []
    for name, symbol in SYMBOLS.items():
        # Cells of length 5 are those of the sweep over flow at α_u = 0.5, where they are counted.
        own = data[name].values != (5.0 if name == "cell_length" else np.nan)
        stripes, uneven, ends = (
            np.asarray(data[f"{what}_over_{name}"].values)[own] for what in ("stripes", "uneven", "ended")
        )
        striped, two = striped + int((stripes > 0).sum()), two + int((stripes == 2).sum())
        worst = max(worst, float(np.nanmax(uneven, initial=0.0)))
        for value, ended in zip(data[name].values[own], ends, strict=True):
            share = proportion(int((ended == cyclic).sum()), ended.size)
            if share[0] < SURE:
                rarely.append(f"{in_words(share)} at {symbol} = {value:g}{_others(ended)}")
    if striped == 0:
        return Verdict(DOES_NOT, "no cell ended with stripes")
    only = proportion(two, striped)
    equal = worst < EQUAL
    text = (
        f"of {striped} final patterns {in_words(only)} have exactly two stripes, whose widths end within "
        f"{worst:.0e} of a half; {_pace(data)}"
    )
    if two < striped or not equal:
        return Verdict(IN_PART if only[0] > SURE and equal else DOES_NOT, text)
    if not rarely:
        return Verdict(AGREES, text + "; nearly every cell gets there, at all flows and lengths")
    return Verdict(IN_PART, f"{text}; but not every cell gets there: {', '.join(rarely)}")


def decisive(data: xarray.Dataset) -> str:
    """Return the smallest share of cells that become cyclosis, over all flows and lengths."""
    cyclic, found = REGIMES.index("cyclosis"), []
    for name, symbol in SYMBOLS.items():
        for value, ended in zip(data[name].values, data[f"ended_over_{name}"].values, strict=True):
            found.append((proportion(int((ended == cyclic).sum()), ended.size), f"{symbol} = {value:g}"))
    share, where = min(found)
    return f"{in_words(share)} of cells end with them at {where}"


def _others(ended: npt.NDArray[np.int8]) -> str:
    """Return in words how cells ended that are not in cyclosis."""
    other = [(int((ended == k).sum()), name) for k, name in enumerate(REGIMES) if name != "cyclosis"]
    return "".join(f", {count} of {ended.size} {name}" for count, name in other if count)


def _pace(data: xarray.Dataset) -> str:
    """Return in words how fast widths become equal."""
    times, words = np.asarray(data["course_time"].values), []
    for k, alpha_u in enumerate(data["followed"].values):
        middle, low, high = median_interval(rates(times, np.asarray(data["difference"].values)[k]))
        within = f" ({low:.4f} to {high:.4f})" if np.isfinite(low + high) else ""
        expected = float(data["theory_rate"].values[k])
        words.append(f"{middle:.4f}{within} at α_u = {alpha_u:g} (theory {expected:.4f})")
    return "a difference decays at the median rate " + " and ".join(words)


# Drawn


def draw(data: xarray.Dataset) -> Figure:
    """Draw a cell that orders, how cells ended over flow alignment and length, and how widths even out."""

    def ends(ax: Any, name: str) -> None:
        x, ended = np.asarray(data[name].values), np.asarray(data[f"ended_over_{name}"].values)
        for regime, colour, label in (("cyclosis", UP, "two stripes"), ("unidirectional", DOWN, "one way")):
            counts = np.sum(ended == REGIMES.index(regime), axis=1)
            share, low, high = 100 * np.array([proportion(int(n), ended.shape[1]) for n in counts]).T
            interval(ax, x, share, low, high, colour, label)
        stripes = np.asarray(data[f"stripes_over_{name}"].values)
        many = 100 * np.mean(stripes > 2, axis=1)
        ax.plot(x, many, "x", color=INK, markersize=3.4, markeredgewidth=0.8, label="more")
        ax.set_xscale("log")
        ax.set_xticks(x, [f"{value:g}" for value in x])
        ax.minorticks_off()
        ax.set_ylim(-4, 104)

    def over_flow(ax: Any) -> None:
        ends(ax, "alpha_u")
        ax.set_xlabel("flow alignment $\\alpha_u$, at length 5", labelpad=1.0)
        ax.set_ylabel("final states, %")
        ax.legend(**(LEGEND | {"markerscale": 1.2, "columnspacing": 0.7}))

    def over_length(ax: Any) -> None:
        ends(ax, "cell_length")
        ax.set_xlabel("length, at $\\alpha_u$ = 0.5", labelpad=1.0)
        ax.set_ylabel("final states, %", labelpad=1.0)

    def evening(ax: Any) -> None:
        times = np.asarray(data["course_time"].values)
        for k, colour in enumerate((DOWN, UP)):
            columns = [column[np.isfinite(column)] for column in data["difference"].values[k].T]
            value, low, high = np.array([median_interval(column) for column in columns]).T
            known = np.isfinite(low) & np.isfinite(high)
            low, high = np.where(known, low, value), np.where(known, high, value)
            shown = value > 0
            label = f"$\\alpha_u$ = {data['followed'].values[k]:g}"
            interval(ax, times[shown], value[shown], low[shown], high[shown], colour, label)
            if shown.any():
                last = np.flatnonzero(shown)[-1]
                line = value[last] * np.exp(-data["theory_rate"].values[k] * (times - times[last]))
                ax.plot(times, line, color=QUIET, linewidth=0.9, linestyle=(0, (4, 2)), zorder=0)
        ax.plot([], [], color=QUIET, linewidth=0.9, linestyle=(0, (4, 2)), label="theory")
        ax.set_yscale("log")
        ax.set_ylim(top=0.6)
        quantities.name(ax.xaxis, "time", "time", labelpad=1.0)
        ax.set_ylabel("|width − ½|, turns", labelpad=1.0)
        ax.legend(**(LEGEND | {"fontsize": 8.0, "markerscale": 1.2, "columnspacing": 0.6}))

    titles = [quantities.when(time) for time in data["frame_time"].values]
    panels = [Panel(over_flow, 1.0), Panel(over_length, 0.8), Panel(evening, 1.0)]
    return story(cells(data, titles), panels, str(verdict(data)))


EXPERIMENT = Experiment(
    name="equal-stripes",
    headline="Self-organisation gives two stripes of equal width.",
    claim="Self-organisation makes two stripes, no more, and of precisely the same width.",
    source="Introduction, and Figures 4 and 5",
    method="From disorder, at α_u from 0.05 to 1 and in cells 2.5 to 10 radii long, every seed is "
    "integrated until its end is certain, and stripes are counted and measured. At α_u = 0.1 and 0.5 widths "
    "are recorded to t = 150, and the rate at which they become equal is compared with the eigenvalue of "
    "theory.",
    seeds=200,
    quick_seeds=8,
    measure=measure,
    verdict=verdict,
    decisive=decisive,
    draw=draw,
)
