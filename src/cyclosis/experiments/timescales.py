"""Whether a vesicle walks off before it turns its filament, and turns it before it lets go."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import xarray

from ..figures.story import Panel, reference, story
from ..figures.style import DOWN, INK, LEGEND, QUIET, SHADE, UP
from ..model.grid import Array
from .experiment import AGREES, DOES_NOT, IN_PART, Experiment, Verdict
from .lab import Lab
from .motor_times import READINGS, Estimate, estimate, restriction
from .statistics import in_words, proportion

if TYPE_CHECKING:
    from matplotlib.figure import Figure

RANGES = {
    # Between these values, equally often on a logarithmic scale. Length, speed and dwell time about those of
    # the paper; the rest is our choice: from water to a crowded cytoplasm, organelles, and ε from 1 to 0.01.
    "filament_um": (3.0, 30.0),
    "speed_um_per_s": (30.0, 100.0),
    "dwell_s": (1.0, 30.0),
    "viscosity_Pa_s": (0.001, 0.1),
    "temperature_K": (283.0, 303.0),
    "vesicle_um": (0.2, 2.0),
    "crowding": (1.0, 100.0),
    "strain_per_s": (0.2, 20.0),
}
TIMES = ("procession_s", "vesicle_s", "strain_s", "heat_s", "detachment_s")
FACTORS = np.geomspace(1.0, 30.0, 30)
SOME, MUCH = 3.0, 10.0
"""Factors between successive times that "shorter" and "much shorter" ask for."""
MOST = 0.5
COLOURS = dict(zip(READINGS, (UP, DOWN, INK), strict=True))


def measure(lab: Lab) -> xarray.Dataset:
    """Return the times at values drawn from `RANGES`, one set a seed, and those at the paper's values."""
    drawn = {name: sampled(name, lab.seeds) for name in RANGES}
    found, paper = estimate(**drawn), estimate()
    data = xarray.Dataset(
        {name: ("seed", values.astype(np.float32), {"units": "see name"}) for name, values in drawn.items()}
    )
    for name in TIMES:
        data[name] = "seed", getattr(found, name).astype(np.float32), {"units": "s"}
        data[f"paper_{name}"] = (), float(getattr(paper, name)), {"units": "s"}
    return data


def sampled(name: str, count: int) -> Array:
    """Return a number of values (n,) of one of `RANGES`; the first of them are the same for every number."""
    low, high = RANGES[name]
    stream = np.random.default_rng(np.random.SeedSequence(0, spawn_key=(list(RANGES).index(name),)))
    return np.asarray(low * (high / low) ** stream.random(count))


def times(data: xarray.Dataset, prefix: str = "") -> Estimate:
    """Return the `Estimate` that a dataset holds: of all draws, or with "paper_" at the paper's values."""
    return Estimate(*(np.asarray(data[prefix + name].values, dtype=np.float64) for name in TIMES))


def shares(found: Estimate, reading: str, factor: float) -> tuple[float, float, float]:
    """Return the share of draws whose times follow one another by a factor, with its interval."""
    good = found.margin(reading) > factor
    return proportion(int(good.sum()), int(good.size))


def verdict(data: xarray.Dataset) -> Verdict:
    """Judge: the order holds at the paper's values and at most others, and by a factor of ten."""
    found, paper = times(data), times(data, "paper_")
    ordered, some, much = (shares(found, "vesicle", factor) for factor in (1.0, SOME, MUCH))
    margin, best = float(paper.margin()), float(paper.best_margin())
    fails_first = np.mean(found.vesicle_s < found.procession_s)
    fails_last = np.mean(found.vesicle_s > found.detachment_s)
    other = [in_words(shares(found, reading, 1.0)) for reading in READINGS[1:]]
    held = restriction(data["filament_um"].values, data["vesicle_um"].values, 1.0)
    free = proportion(int(np.sum(held < 1)), int(held.size))
    p, r, d = (float(one) for one in (paper.procession_s, paper.vesicle_s, paper.detachment_s))
    text = (
        f"at the paper's values τ_p, τ_r, τ_d = {p:.2f}, {r:.2f}, {d:.2f} s: in order, by a factor of "
        f"{margin:.1f}, which no τ_r could make more than {best:.1f}; two factors of {MUCH:g} need τ_d above "
        f"{MUCH**2 * p:.0f} s; of {held.size} draws from plausible ranges the order holds in "
        f"{in_words(ordered)}, by factors of {SOME:g} in {in_words(some)}, of {MUCH:g} in {in_words(much)}; "
        f"{100 * fails_first:.1f} % turn before they walk off, {100 * fails_last:.1f} % let go before they "
        f"turn; without restriction {in_words(free)} would turn first; turned by strain the order holds in "
        f"{other[0]}, by heat in {other[1]}"
    )
    if margin <= 1:
        text = text.replace(": in order, by a factor of", ": not in order, the smaller ratio is")
    if margin <= 1 or ordered[1] <= MOST:
        return Verdict(DOES_NOT, text)
    return Verdict(AGREES if margin > MUCH and much[1] > MOST else IN_PART, text)


def draw(data: xarray.Dataset) -> Figure:
    """Draw the times, the share of draws whose times are in order by a factor, and the two ratios."""
    found, paper = times(data), times(data, "paper_")

    def scales(ax: Any) -> None:
        names = ("$\\tau_p$", "$\\tau_r$, vesicle", "$\\tau_r$, strain", "$\\tau_r$, heat", "$\\tau_d$")
        for k, row in enumerate(TIMES):
            low, high = np.quantile(getattr(found, row), [0.05, 0.95])
            colour = COLOURS.get(row.removesuffix("_s"), QUIET)
            ax.barh(-k, high - low, 0.55, left=low, color=colour, alpha=0.45, linewidth=0)
            ax.plot(float(getattr(paper, row)), -k, "D", color=INK, markersize=3.5, markeredgewidth=0)
        ax.set_xscale("log")
        ax.set_xlim(0.02, 2e4)
        ax.set_yticks([-k for k in range(5)], names)
        ax.tick_params(axis="y", length=0)
        ax.set_xlabel("seconds", labelpad=1.0)

    def share(ax: Any) -> None:
        for reading in READINGS:
            value, low, high = 100 * np.array([shares(found, reading, one) for one in FACTORS]).T
            ax.fill_between(FACTORS, low, high, color=COLOURS[reading], alpha=0.25, linewidth=0)
            ax.plot(FACTORS, value, color=COLOURS[reading], linewidth=1.2, label=reading)
        reference(ax, MUCH, "", upright=True)
        best = float(paper.best_margin())
        reference(ax, best, "the paper's window", upright=True)
        ax.set_xscale("log")
        ax.set_xticks([1, 3, 10, 30], ["1", "3", "10", "30"])
        ax.minorticks_off()
        ax.set_xlim(1, 30)
        ax.set_ylim(0, 100)
        ax.set_xlabel("factor between times", labelpad=1.0)
        ax.set_ylabel("in order, % of draws", labelpad=1.0)
        # A white ground, since the reference lines pass behind it.
        legend: dict[str, Any] = {
            "facecolor": "white",
            "edgecolor": "none",
            "framealpha": 1.0,
            "handlelength": 1.2,
        }
        ax.legend(fontsize=8.5, title="turned by", title_fontsize=8.5, loc="upper right", **legend)

    def ratios(ax: Any) -> None:
        shown = slice(0, 1500)
        x, y = found.vesicle_s / found.procession_s, found.detachment_s / found.vesicle_s
        ax.plot(x[shown], y[shown], "o", color=UP, markersize=1.6, alpha=0.5, markeredgewidth=0)
        ax.plot(
            float(paper.vesicle_s / paper.procession_s), float(paper.detachment_s / paper.vesicle_s),
            "D", color=INK, markersize=4.5, label="the paper's values",
        )  # fmt: skip
        ax.set_xscale("log")
        ax.set_yscale("log")
        low, high = ax.get_xlim(), ax.get_ylim()
        ax.fill_between([1, low[1]], 1, high[1], color=SHADE, alpha=0.6, linewidth=0, zorder=-2)
        ax.fill_between([MUCH, low[1]], MUCH, high[1], color=SHADE, linewidth=0, zorder=-1)
        ax.set_xlim(low)
        ax.set_ylim(high)
        ax.set_xlabel("$\\tau_r/\\tau_p$", labelpad=1.0)
        ax.set_ylabel("$\\tau_d/\\tau_r$", labelpad=1.0)
        ax.legend(**(LEGEND | {"fontsize": 8.5, "markerscale": 1.0}))

    return story([], [Panel(scales, 0.8), Panel(share), Panel(ratios)], str(verdict(data)))


EXPERIMENT = Experiment(
    name="timescales",
    claim="A vesicle walks along a filament in much less time than it takes to turn it, and turns it in much "
    "less than a stalled motor stays, so that alignment with the flow is robust.",
    source="Model (Figure 3)",
    method="The three times from length, speed and dwell time as in the paper (10 µm, 100 µm/s, 1 s), with "
    "τ_r from the drag of a vesicle against that of a restricted filament (ε = 0.1), from strain, or from "
    "heat; then at 5000 draws, uniform on logarithmic scales, from plausible ranges.",
    seeds=5000,
    quick_seeds=2000,
    measure=measure,
    verdict=verdict,
    draw=draw,
)
