"""From disorder to streamlets to cyclosis, and whether the flow comes back in starts and stops."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import scipy.stats
import xarray

from ..figures.story import Panel, cells, reference, story
from ..figures.style import DOWN, INK, QUIET, UP
from ..model import initial
from ..model.grid import Array
from ..model.parameters import Parameters
from .experiment import AGREES, DOES_NOT, IN_PART, Experiment, Verdict
from .lab import Lab, frames
from .statistics import in_words, median_interval, proportion
from .streamlets import COURSES, EARLY, GRID, MOST, TIMES, course, expected_size, reached, since

if TYPE_CHECKING:
    from matplotlib.figure import Figure

SHOWN, PICTURES = 3, (1.0, 5.0, 8.0, 20.0, 100.0)
"""Seed of the cell that is drawn, and when."""
HALF = 0.5
"""Share of its final value at which local order, or the pattern around the cell, is said to be there."""
USUAL = 0.9
"""Share of cells, by the lower end of its interval, from which on something is what cells do."""
SALTATORY = 0.5
"""Share of the surface at which flow must stop and go on at least twice to be called saltatory."""
BAND = (0.05, 0.95)


def measure(lab: Lab) -> xarray.Dataset:
    """Return courses of order, speed, size and shape of domains, and how steadily flow runs, by seed."""
    followed = lab.each("course", course, [(seed,) for seed in range(lab.seeds)])
    courses, turns, places = (np.stack([one[k] for one in followed]) for k in range(3))
    told = lab.story(
        Parameters(), GRID, initial.disordered(GRID, seed=SHOWN), PICTURES[-1], PICTURES, rtol=1e-3
    )
    found = frames(told, PICTURES).assign_coords(time=np.array(TIMES), period=["early", "late"])
    for k, name in enumerate(COURSES):
        found[name] = ("seed", "time"), courses[:, k].astype(np.float32)
    found["reversals"] = ("seed", "period"), turns
    found["places"] = ("seed", "stops"), places
    for name in (*COURSES, "reversals", "places"):
        found[name].attrs["units"] = "1"
    return found.assign_attrs(d_s=Parameters().d_s)


def moments(data: xarray.Dataset) -> dict[str, Array]:
    """Return, by seed, when `local` order, the `whole` pattern and two `stripes` are there.

    With the `size` of domains and their `elongation` when local order is there; NaN for what never came.
    """
    time = np.asarray(data["time"].values)
    values = {name: np.asarray(data[name].values, dtype=np.float64) for name in COURSES}
    order, whole = values["order"], values["global_order"]
    # The pattern around the cell of one that became unidirectional is noise: only cyclosis is timed.
    stripes = np.array([since(time, row > 0) for row in values["stripes"]])
    local = np.array([reached(time, row, HALF * row[-1]) for row in order])
    all_over = np.array([reached(time, row, HALF * row[-1]) for row in whole])
    at = {
        name: np.array([np.interp(one, time, row) for one, row in zip(local, values[name], strict=True)])
        for name in ("domain_size", "elongation")
    }
    return {
        "local": local,
        "whole": np.where(np.isnan(stripes), np.nan, all_over),
        "stripes": stripes,
        "size": at["domain_size"],
        "elongation": at["elongation"],
    }


def verdict(data: xarray.Dataset) -> Verdict:
    """Judge: order is local before it is global, ends as two stripes, and flow stops and goes on the way."""
    when = moments(data)
    became = np.isfinite(when["stripes"])
    first = became & (when["local"] < when["whole"]) & (when["local"] < when["stripes"])
    shares = [proportion(int(count.sum()), count.size) for count in (became, first)]
    if not became.any():
        return Verdict(DOES_NOT, f"two stripes came of {in_words(shares[0])} of {became.size} cells")
    local, whole, stripes, size, shape = (
        median_interval(when[name][became]) for name in ("local", "whole", "stripes", "size", "elongation")
    )
    theory = float(expected_size(Parameters(d_s=float(data.attrs["d_s"])), local[0]))
    places = np.asarray(data["places"].values)
    once, twice = (median_interval(places[:, k:].sum(axis=1)) for k in (1, 2))
    turns = np.asarray(data["reversals"].values)
    early, late = (median_interval(turns[:, k]) for k in (0, 1))
    test = scipy.stats.wilcoxon(turns[:, 0], turns[:, 1], alternative="greater").pvalue
    text = (
        f"{in_words(shares[0])} of {became.size} cells became two stripes, {in_words(shares[1])} after local "
        f"order; that is half there at t = {_said(local)}, in domains {_said(size)} R wide (linear theory: "
        f"{theory:.2f}) and {_said(shape)} times as long, the wave around the cell at {_said(whole)}, two "
        f"whole stripes at {_said(stripes)}; visible flow reverses at {_percent(early)} of places per R/U "
        f"before t = {EARLY:g} and {_percent(late)} after (Wilcoxon p = {test:.1g}), but stops and restarts "
        f"at {_percent(once)} of them only, repeatedly at {_percent(twice)}: it is not saltatory"
    )
    if twice[1] > SALTATORY:
        text = text.replace(" only, repeatedly", ", repeatedly").replace("is not saltatory", "is saltatory")
    if min(shares[0][1], shares[1][1]) <= USUAL:
        return Verdict(IN_PART if shares[1][1] > 0.5 else DOES_NOT, text)
    return Verdict(AGREES if twice[1] > SALTATORY else IN_PART, text)


def _said(value: tuple[float, float, float]) -> str:
    return "{:.2f} ({:.2f} to {:.2f})".format(*value)


def _percent(value: tuple[float, float, float]) -> str:
    return "{:.2f} % ({:.2f} to {:.2f} %)".format(*(100 * one for one in value))


def draw(data: xarray.Dataset) -> Figure:
    """Draw a cell becoming ordered, order near and far, the size of domains, and how often flow stops."""
    time = np.asarray(data["time"].values)
    shown = time <= 40

    def band(ax: Any, name: str, colour: str, label: str) -> None:
        values = np.asarray(data[name].values)[:, shown]
        low, high = np.quantile(values, BAND, axis=0)
        ax.fill_between(time[shown], low, high, color=colour, alpha=0.2, linewidth=0)
        ax.plot(time[shown], np.median(values, axis=0), color=colour, linewidth=1.2, label=label)

    def order(ax: Any) -> None:
        band(ax, "order", INK, "local order")
        band(ax, "global_order", UP, "wave around")
        band(ax, "speed", DOWN, "flow speed")
        ax.set_xlim(0, 40)
        ax.set_ylim(0, 1)
        ax.set_xlabel("time, $R/U$", labelpad=1.0)
        ax.set_ylabel("root mean square", labelpad=1.0)
        ax.legend(frameon=False, fontsize=8.5, loc="lower right", handlelength=1.2)

    def sizes(ax: Any) -> None:
        band(ax, "domain_size", UP, "measured")
        law = expected_size(Parameters(d_s=float(data.attrs["d_s"])), time)
        below = law < 0.93 * np.pi
        ax.plot(
            time[below],
            law[below],
            color=QUIET,
            linewidth=1.0,
            linestyle=(0, (4, 2)),
            label="$4\\,(d_s t)^{1/2}$",
        )
        reference(ax, np.pi, "two stripes, π")
        local = median_interval(moments(data)["local"])[0]
        reference(ax, local, "local order", upright=True)
        ax.set_xlim(0, 40)
        ax.set_ylim(0, 4.2)
        ax.set_xlabel("time, $R/U$", labelpad=1.0)
        ax.set_ylabel("width of domains, $R$", labelpad=1.0)
        ax.legend(frameon=False, fontsize=8.5, loc="lower right", handlelength=1.4)

    def stopping(ax: Any) -> None:
        places = 100 * np.asarray(data["places"].values)
        count = np.arange(MOST + 1)
        for k in count:
            value, low, high = median_interval(places[:, k])
            ax.bar(k, value, 0.7, color=UP)
            if np.isfinite([low, high]).all():
                ax.vlines(k, low, high, color=INK, linewidth=1.2)
            top = max(value, high) if np.isfinite(high) else value
            ax.text(k, top + 2, f"{value:.1f}", fontsize=8.5, ha="center")
        ax.set_xticks(count, [*map(str, count[:-1]), f"{MOST}+"])
        ax.set_ylim(0, 108)
        ax.set_xlabel("stops of visible flow at a place", labelpad=1.0)
        ax.set_ylabel("% of the surface", labelpad=1.0)

    titles = [f"$t$ = {value:g}" for value in data["frame_time"].values]
    return story(cells(data, titles), [Panel(order), Panel(sizes), Panel(stopping)], str(verdict(data)))


EXPERIMENT = Experiment(
    name="emergence",
    claim="Order begins in small patches, streamlets, and spreads until two streams fill the cell; on the "
    "way streaming is disordered and saltatory.",
    source="Introduction (Foissner & Wasteneys 2000), Time Progression and Figure 4",
    method="Disordered cells are followed to t = 100 at Figure 4's parameters: local order, the wave around "
    "the cell, speed, the width of domains (area over length of zones), and at every place how often flow "
    "of more than a tenth of the final speed reverses, or stops (below a twentieth) and goes on.",
    seeds=200,
    quick_seeds=8,
    measure=measure,
    verdict=verdict,
    draw=draw,
)
