"""Without alignment by the motors (α_u = 0) one stream remains, or two of unequal width last very long."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt
import xarray

from ..analysis.regimes import REGIMES
from ..analysis.zones import stripe_widths, zone_angles
from ..dynamics.simulate import simulate
from ..figures import quantities
from ..figures.story import Panel, cells, interval, reference, story
from ..figures.style import DOWN, INK, QUIET, UP
from ..model import initial
from ..model.grid import Array, CylinderGrid
from ..model.parameters import Parameters
from ..stability import elliptic_growth
from .experiment import AGREES, DOES_NOT, IN_PART, Experiment, Verdict
from .fronts import front, fronts
from .lab import Lab, frames
from .statistics import in_words, median_interval, proportion

if TYPE_CHECKING:
    from matplotlib.figure import Figure

# Computed

SETTLING, LONGEST = 10.0, 5000.0
"""Time after which zones of prepared stripes have relaxed, and the longest lifetime measured."""
UNIFORM = CylinderGrid(48, 8, 5.0)


def timed(alpha_p: float, share: float) -> tuple[float, float]:
    """Return the displacement of relaxed zones in widths, and how long stripes last, in units of 1/λ.

    The stripe that points down begins with a share of the circle. NaN where stripes outlast the run.
    """
    params = Parameters(alpha_p=alpha_p, alpha_u=0.0)
    start = fronts(params, UNIFORM, 2 * np.pi * share)
    run = simulate(params, UNIFORM, start, LONGEST, save_every=2.0, rtol=1e-4, steady_rate=1e-6)
    profiles = [state[1].mean(axis=1) for state in run.frames]
    times = np.asarray(run.times)
    first = int(np.argmax(times >= SETTLING))
    widths = stripe_widths(zone_angles(profiles[first]))
    if widths.size != 2:
        return np.nan, np.nan
    end = ending(times[first:], np.array([row.min() for row in profiles[first:]]))
    displaced = float(np.pi * (widths.max() - 0.5)) / front(params)[0]
    return displaced, (end - float(times[first])) * elliptic_growth(params)


def ending(times: npt.ArrayLike, least: npt.ArrayLike) -> float:
    """Return the time, between those given (n,), at which the least P_z (n,) rises through zero, or NaN."""
    t, low = np.asarray(times, dtype=np.float64), np.asarray(least, dtype=np.float64)
    if not (low > 0).any() or low[0] > 0:
        return np.nan
    k = int(np.argmax(low > 0))
    return float(t[k - 1] - low[k - 1] * (t[k] - t[k - 1]) / (low[k] - low[k - 1]))


def by_law(displaced: npt.ArrayLike) -> Array:
    """Return the lifetime, in units of 1/λ, of stripes whose zones are displaced (n,) by so many widths.

    The law of fronts, dδ/dt = λ (w/4) sinh(4δ/w), integrated from δ to infinity: ln coth(2δ/w).
    """
    return np.asarray(-np.log(np.tanh(2 * np.asarray(displaced))), dtype=np.float64)


ALPHA_P, QUICK_ALPHA_P = (0.1, 0.2, 0.4, 1.0), (0.1, 0.2, 1.0)
PAPER = 1.0
"""The paper's alpha_p, at which a cell with its motors is the control."""
LATE, QUICK_LATE = 300.0, 150.0
"""Time of observation: disorder has long become stripes, or one stream."""
UNEQUAL = 0.005
"""Difference of a stripe's width from a half above which stripes are unequal."""
STREAMING = 0.05
"""Peak speed above which a cell streams."""

MOST = 0.9
"""Share of all cells that should have one stream or unequal stripes."""

# Prepared stripes are timed where their lifetime is short and the grid resolves their zones well.
TIMED_ALPHA_P = (0.1, 0.12, 0.15)
SHARES, QUICK_SHARES = (0.25, 0.3, 0.34, 0.38, 0.41, 0.44, 0.46, 0.48), (0.3, 0.4)
LAW = (0.8, 1.25)
"""Ratio of measured to predicted lifetime that counts as agreement with the law of fronts."""
GRID = CylinderGrid(48, 48, 5.0)
OUTCOMES = ("unidirectional", "unequal stripes", "equal stripes", "other")


def measure(lab: Lab) -> xarray.Dataset:
    """Return the outcomes of cells, how long stripes lasted, and the frames of two cells."""
    strengths = QUICK_ALPHA_P if lab.quick else ALPHA_P
    late = QUICK_LATE if lab.quick else LATE
    run = {"t_end": late, "finish": "certified", "rtol": 1e-3}
    axes = {"alpha_p": {"values": list(strengths)}}
    swept = lab.sweep("inhibited", {"parameters": {"alpha_u": 0.0}, "axes": axes, "run": run})
    control = lab.sweep("control", {"axes": {"alpha_p": {"values": [PAPER]}}, "run": run}).isel(alpha_p=0)
    regime = np.asarray(swept["regime"].values)
    since = np.asarray(swept["t_order"].values)
    width = widest(np.asarray(swept["stripe_width"].values))
    outcome = outcomes(regime, since, width, late)
    found = _cells(lab, outcome[-1], width[-1], late)
    found["outcome"] = ("alpha_p", "seed"), outcome
    found["since"] = ("alpha_p", "seed"), since.astype(np.float32)
    found["width"] = ("alpha_p", "seed"), width.astype(np.float32)
    found["speed"] = ("alpha_p", "seed"), np.asarray(swept["peak_speed"].values, dtype=np.float32)
    found["control_regime"] = "seed", np.asarray(control["regime"].values)
    found["control_width"] = "seed", widest(np.asarray(control["stripe_width"].values)).astype(np.float32)
    shares = QUICK_SHARES if lab.quick else SHARES
    items = [(alpha_p, share) for alpha_p in TIMED_ALPHA_P for share in shares]
    lives = np.reshape(lab.each("lives", timed, items), (len(TIMED_ALPHA_P), len(shares), 2))
    found["displaced"] = ("timed_alpha_p", "prepared"), lives[..., 0]
    found["life"] = ("timed_alpha_p", "prepared"), lives[..., 1]
    rates = [elliptic_growth(Parameters(alpha_p=alpha_p)) for alpha_p in TIMED_ALPHA_P]
    found["growth"] = "timed_alpha_p", rates
    found.attrs["late"] = late
    return found.assign_coords(alpha_p=list(strengths), timed_alpha_p=list(TIMED_ALPHA_P))


def _cells(lab: Lab, outcome: Array, width: Array, late: float) -> xarray.Dataset:
    """Return the frames of a cell with its motors, of one that loses a stream, and of one that does not."""
    params = Parameters(alpha_u=0.0, alpha_p=PAPER)
    usual = Parameters(alpha_p=PAPER)
    before = lab.story(usual, GRID, initial.stripes(GRID), SETTLING, (SETTLING,), rtol=1e-3)
    loses = int(np.argmax(outcome == OUTCOMES.index("unidirectional")))
    kept = outcome == OUTCOMES.index("unequal stripes")
    keeps = int(np.argmax(np.where(kept, width, 0.0)))
    shown = [frames(before, (SETTLING,))]
    for seed, times in ((loses, (1.0, 20.0, late)), (keeps, (late,))):
        run = lab.story(params, GRID, initial.disordered(GRID, seed=seed), late, times, rtol=1e-3)
        shown.append(frames(run, times))
    return xarray.concat(shown, "frame", combine_attrs="override", data_vars="minimal")


def widest(widths: Array) -> Array:
    """Return the share of the circle that the wider of two stripes takes, of widths (..., zones)."""
    return np.maximum(widths[..., 0], widths[..., 1])


def outcomes(regime: Array, since: Array, width: Array, late: float) -> Array:
    """Return the outcomes of cells at the time `late`, as numbers in `OUTCOMES`, from arrays of one shape.

    A cell whose stripes are certain to merge but only later than that has unequal stripes.
    """
    alone = regime == REGIMES.index("unidirectional")
    two = regime == REGIMES.index("cyclosis")
    lasting = (alone & (since > late)) | (two & (width - 0.5 > UNEQUAL))
    cases = [alone & (since <= late), lasting, two & (width - 0.5 <= UNEQUAL)]
    return np.select(cases, [0, 1, 2], 3).astype(np.int8)


def _ratios(data: xarray.Dataset) -> Array:
    """Return the lifetimes of all prepared stripes over those predicted by the law of fronts."""
    found = data["life"].values / by_law(data["displaced"].values)
    return np.asarray(found[np.isfinite(found)], dtype=np.float64)


def _peak(data: xarray.Dataset) -> float:
    """Return the largest speed in cells in which one stream is left."""
    speed = np.asarray(data["speed"].values)[np.asarray(data["outcome"].values) == 0]
    return float(speed.max()) if speed.size else 0.0


# Judged


def verdict(data: xarray.Dataset) -> Verdict:
    """Judge: cells have one stream, which flows, or unequal stripes that last; the control has equal ones."""
    outcome, late = np.asarray(data["outcome"].values), float(data.attrs["late"])
    alone, unequal = outcome == 0, outcome == 1
    expected = proportion(int((alone | unequal).sum()), outcome.size)
    lost, kept = (proportion(int(found[-1].sum()), found[-1].size) for found in (alone, unequal))
    two = np.asarray(data["control_regime"].values) == REGIMES.index("cyclosis")
    equal = two & (np.asarray(data["control_width"].values) - 0.5 <= UNEQUAL)
    usual = proportion(int(equal.sum()), equal.size)
    speed = _peak(data)
    widths = np.asarray(data["width"].values)[-1][unequal[-1]]
    wide = median_interval(widths[np.isfinite(widths)])
    ratio = median_interval(_ratios(data))
    strength = data["alpha_p"].values[-1]
    text = (
        f"of {outcome.shape[1]} cells without motors one stream is left in {in_words(lost)} at "
        f"t = {late:g} and α_p = {strength:g}, unequal stripes in {in_words(kept)}"
    )
    if np.isfinite(wide[1]):
        text += f" (the wider {wide[0]:.2f} of a turn in the median, {wide[1]:.2f} to {wide[2]:.2f})"
    text += (
        f"; with motors stripes are equal in {in_words(usual)}. Prepared unequal stripes live {ratio[0]:.2f} "
        f"({ratio[1]:.2f} to {ratio[2]:.2f}) times as long as fronts that attract each other should"
    )
    if expected[2] < MOST or usual[1] < 0.5:
        return Verdict(DOES_NOT, f"{text}; one or the other is found in {in_words(expected)} of all cells")
    if speed < STREAMING:
        text += (
            f". But where one stream is left nothing flows (peak speed at most {speed:.0e}): no net flux can "
            "pass the ends of the cell, so that order is unidirectional and streaming stops"
        )
    good = lost[0] > 0 and kept[0] > 0 and LAW[0] < ratio[0] < LAW[1] and speed >= STREAMING
    return Verdict(AGREES if good else IN_PART, text)


def decisive(data: xarray.Dataset) -> str:
    """Return the share of cells in which one stream is left, and whether it flows."""
    alone = np.asarray(data["outcome"].values) == 0
    share = proportion(int(alone[-1].sum()), alone[-1].size)
    return f"{in_words(share)} keep one stream, which {'stops' if _peak(data) < STREAMING else 'flows'}"


# Drawn


def draw(data: xarray.Dataset) -> Figure:
    """Draw the cells, their outcomes over alpha_p, how long stripes last, and the law of fronts."""
    late = float(data.attrs["late"])
    titles = (
        "with motors",
        "motors and order gone: $t$ = 1",
        "$t$ = 20",
        quantities.when(late),
        f"another cell, {quantities.when(late)}",
    )
    strengths = np.asarray(data["alpha_p"].values)
    outcome = np.asarray(data["outcome"].values)

    def shares(ax: Any) -> None:
        for number, colour in ((0, UP), (1, DOWN)):
            each = [proportion(int((row == number).sum()), row.size) for row in outcome]
            value, low, high = 100 * np.array(each).T
            interval(ax, strengths, value, low, high, colour)
        for x, side, name, colour in ((0, "left", "one stream", UP), (1, "right", "unequal stripes", DOWN)):
            ax.text(x, 1.02, name, color=colour, transform=ax.transAxes, ha=side, fontsize=9)
        ax.set_xscale("log")
        ax.set_xticks(strengths, [f"{value:g}" for value in strengths])
        ax.minorticks_off()
        ax.set_ylim(-3, 103)
        ax.set_xlabel("bundling $α_p$", labelpad=1.0)
        ax.set_ylabel(f"cells at {quantities.when(late)}, %", labelpad=1.0)

    def widths(ax: Any) -> None:
        width = np.asarray(data["width"].values)[-1]
        shown = width[np.isfinite(width) & (outcome[-1] == 1)]
        ax.hist(shown, np.linspace(0.5, 0.85, 15), color=DOWN, edgecolor="white", linewidth=0.5)
        reference(ax, float(np.nanmedian(data["control_width"])), "with motors", upright=True)
        ax.set_xlim(0.48, 0.85)
        ax.set_xlabel(f"wider stripe, turns ($α_p$ = {strengths[-1]:g})", labelpad=1.0)
        ax.yaxis.get_major_locator().set_params(integer=True)
        ax.set_ylabel("cells", labelpad=1.0)

    def lives(ax: Any) -> None:
        x = np.linspace(0.03, 1.35, 200)
        ax.plot(x, by_law(x), color=QUIET, linewidth=0.9, linestyle=(0, (4, 2)), label="fronts")
        for k, mark in zip(range(data.sizes["timed_alpha_p"]), "os^", strict=False):
            at = data.isel(timed_alpha_p=k)
            label = f"$α_p$ = {float(at['timed_alpha_p']):g}, 1/λ = {1 / float(at['growth']):.0f}"
            ax.plot(at["displaced"], at["life"], mark, color=INK, markersize=3.4, mfc="none", label=label)
        ax.set_yscale("log")
        ax.set_xlim(0, 1.35)
        ax.set_xlabel("displacement of zones, δ/w", labelpad=1.0)
        quantities.name(ax.yaxis, "life of stripes, 1/λ", "time", labelpad=1.0)
        ax.legend(fontsize=7.5, frameon=False, borderpad=0, loc="lower left", handlelength=1.4)

    return story(cells(data, titles), [Panel(shares), Panel(widths), Panel(lives)], str(verdict(data)))


EXPERIMENT = Experiment(
    name="myosin-inhibition",
    headline="Without motors one stream remains, or two of unequal width.",
    claim="With myosin kept from walking on actin (α_u ≈ 0), and the network disorganised, one stream should "
    "come out of the bundling, or at least a metastable cyclosis whose two streams differ in width.",
    source="Discussion",
    method="Disordered cells with α_u = 0 and α_p from 0.1 to 1 are integrated until their end is certain "
    "or to t = 300, with a control at α_u = 0.5. Two stripes prepared with unequal widths at α_p = 0.1, "
    "0.12 and 0.15 are timed until one is gone, and compared with the law of fronts, ln coth(2δ/w)/λ, with "
    "exact λ.",
    seeds=200,
    quick_seeds=10,
    measure=measure,
    verdict=verdict,
    decisive=decisive,
    draw=draw,
)
