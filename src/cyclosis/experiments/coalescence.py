"""Without flow fronts between opposite streams merge; above a threshold flow keeps them apart."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt
import xarray

from ..analysis.regimes import REGIMES
from ..figures import quantities
from ..figures.story import Panel, cells, interval, story
from ..figures.style import DOWN, INK, LEGEND, QUIET, SHADE, UP
from ..model.grid import Array, CylinderGrid
from ..model.parameters import Parameters
from ..stability import threshold, unequal_branch
from .experiment import AGREES, DOES_NOT, IN_PART, Experiment, Verdict
from .fronts import END, WEAK, closing, creep, fate, front, fronts, growth, life
from .lab import Lab, frames
from .statistics import in_words, proportion

if TYPE_CHECKING:
    from matplotlib.figure import Figure

# Computed

BUNDLING = (0.1, 0.2, 0.5, 1.0)
DISTANCES = (3.0, 3.5, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0, 10.0)
"""Initial distances of two fronts, in widths of a front."""
FAR, CLOSE = 4.0, 0.05
"""Distance beyond which fronts should obey the law, and their greatest relative deviation from it."""
NEAR = (0.5, 0.8, 1.25, 2.0)
"""Multiples of the threshold at which a small difference of widths is timed."""
MULTIPLES = (0.0, 0.5, 0.9, 1.2, 2.0, 3.0, 5.0, 10.0, 20.0)
NARROW = (0.08, 0.12, 0.16, 0.2, 0.25, 0.3, 0.35, 0.4, 0.44, 0.48)
"""Initial widths, in turns, of the narrow stripe."""
FLOWS = (0.0, 0.3, 3.0, 10.0, 20.0, 30.0, 100.0)
SHOWN = 0.34
"""Width of the narrow stripe of the cells that are drawn; times and multiple of the threshold follow."""
TIMES, STRONG = (0.0, 20.0, 250.0), 10.0
LASTING = 0.4
"""Width of the stripe whose lifetime at the paper's α_p is reported."""


def measure(lab: Lab) -> xarray.Dataset:
    """Return the speed of fronts, where flow stops them, and the fates of unequal stripes and of disorder."""
    quick = lab.quick
    flows = (0.0, 3.0, 30.0) if quick else FLOWS
    multiples, widths = ((0.0, 0.5, 2.0, 10.0), NARROW[1::2]) if quick else (MULTIPLES, NARROW)
    distances = DISTANCES[:4] if quick else DISTANCES
    critical = threshold(Parameters(alpha_p=WEAK))
    pairs = [(alpha_p, far) for alpha_p in BUNDLING for far in distances]
    crept = np.array(lab.each("creep", creep, pairs)).reshape(len(BUNDLING), len(distances), 3)
    starts = [(times * critical, width) for times in multiples for width in widths]
    fates = np.array(lab.each("fate", fate, starts)).reshape(len(multiples), len(widths), 2)
    slopes = lab.each("growth", growth, [(times * critical,) for times in NEAR])
    tables = {
        "parameters": {"alpha_p": WEAK},
        "axes": {"alpha_u": {"values": [times * critical for times in flows]}},
        "run": {"t_end": END, "rtol": 1e-3},
    }
    swept = lab.sweep("disorder", tables)
    branch = unequal_branch(Parameters(alpha_p=WEAK))
    striped = branch.width > 0
    found = _pictures(lab, critical).assign_coords(
        alpha_p=list(BUNDLING), near=list(NEAR), multiple=list(multiples), flow=list(flows)
    )
    for k, name in enumerate(("distance", "speed", "law")):
        found[name] = ("alpha_p", "pair"), crept[..., k]
    for k, name in enumerate(("first_width", "last_width")):
        found[name] = ("multiple", "start"), fates[..., k]
    found["growth"] = "near", slopes
    found["saddle_multiple"] = "saddle", branch.alpha_u[striped] / critical
    found["saddle_width"] = "saddle", branch.width[striped]
    found["ended"] = ("flow", "seed"), np.asarray(swept["regime"].values, dtype=np.int8)
    return found.assign_attrs(threshold=critical, life=life(1.0, LASTING))


def _pictures(lab: Lab, critical: float) -> xarray.Dataset:
    """Return the frames of a cell whose fronts merge, and those of one whose fronts flow drives apart."""
    grid = CylinderGrid(48, 48, 5.0)
    runs = []
    for alpha_u, times in ((0.0, TIMES), (STRONG * critical, (TIMES[0], TIMES[-1]))):
        params = Parameters(alpha_p=WEAK, alpha_u=alpha_u)
        state = fronts(params, grid, 2 * np.pi * SHOWN)
        runs.append(frames(lab.story(params, grid, state, times[-1], times, rtol=1e-3), times))
    return xarray.concat(runs, "frame", data_vars="minimal", coords="minimal")


def crossing(multiple: Array, rate: Array) -> float:
    """Return where rates (n,), falling over multiples (n,), change sign, by interpolation; NaN if nowhere."""
    after = int(np.argmax(rate < 0))
    if after == 0:
        return float("nan")
    first, last = after - 1, after
    return float(
        multiple[first] + (multiple[last] - multiple[first]) * rate[first] / (rate[first] - rate[last])
    )


def foreseen(data: xarray.Dataset) -> npt.NDArray[np.bool_]:
    """Return for all fates (multiple, start) whether they are those that the saddle predicts.

    Below the threshold all merge; above it those whose narrow stripe is narrower than that of the saddle.
    """
    at, width = data["saddle_multiple"].values, data["saddle_width"].values
    edge = np.interp(data["multiple"].values, at, width, left=0.5, right=0.0)[:, None]
    return np.asarray((data["last_width"].values > 0) == (data["first_width"].values > edge))


# Judged


def verdict(data: xarray.Dataset) -> Verdict:
    """Judge: fronts obey the law, all merge without flow, and flow above the threshold stops them."""
    params = [Parameters(alpha_p=value, alpha_u=0.0) for value in data["alpha_p"].values]
    far = data["distance"].values > FAR * np.array([front(each)[0] for each in params])[:, None]
    speed, law = data["speed"].values[far], data["law"].values[far]
    miss = float(np.abs(speed / law - 1).max()) if speed.size else np.inf
    multiple, last = data["multiple"].values, data["last_width"].values
    merged = last == 0
    alone, below, above = merged[multiple == 0], merged[multiple < 1], merged[multiple > 1]
    zero = crossing(data["near"].values, data["growth"].values)
    stable = abs(zero - 1) < CLOSE
    counts = np.sum(data["ended"].values == REGIMES.index("cyclosis"), axis=1)
    shares = [proportion(int(count), data.sizes["seed"]) for count in counts]
    flow = data["flow"].values
    reported = {0, int(np.argmax(flow > 1)), flow.size - 1}
    from_disorder = ", ".join(f"{in_words(shares[k])} at {flow[k]:g}" for k in sorted(reported))
    critical, long = (float(data.attrs[name]) for name in ("threshold", "life"))
    text = (
        f"without flow {int(alone.sum())} of {alone.size} pairs of fronts merged, at speeds from "
        f"{speed.min():.0e} to {speed.max():.0e} within {100 * miss:.1f} % of the law; a difference of "
        f"widths stops growing at {zero:.3f} of the predicted threshold, α_u = {critical:.5f}; below it "
        f"{int(below.sum())} of {below.size} pairs merged, above it {int(above.sum())} of {above.size}, "
        f"narrower than the saddle ({int(foreseen(data).sum())} of {merged.size} fates as predicted); two "
        f"stripes from disorder, in multiples of it: {from_disorder}; at α_p = 1 a stripe of {LASTING:g} "
        f"turn would need {long:.0e} R/U to vanish without flow"
    )
    if not (alone.all() and stable) or above.all():
        return Verdict(DOES_NOT, text)
    return Verdict(AGREES if below.all() and miss < CLOSE else IN_PART, text)


def decisive(data: xarray.Dataset) -> str:
    """Return the flow from which equal stripes are stable, in units of the predicted threshold."""
    zero = crossing(data["near"].values, data["growth"].values)
    return f"{zero:.3f} times the predicted threshold makes stripes stable"


# Drawn


def draw(data: xarray.Dataset) -> Figure:
    """Draw fronts that merge and fronts held apart, their speed, the fate of pairs, and that of disorder."""

    def speeds(ax: Any) -> None:
        for k, (value, marker) in enumerate(zip(data["alpha_p"].values, "osD^", strict=False)):
            params = Parameters(alpha_p=float(value), alpha_u=0.0)
            w, _ = front(params)
            unit = w * (params.alpha_p - params.d_r)
            x, y = data["distance"].values[k] / w, data["speed"].values[k] / unit
            line = np.linspace(2.5, min(10.5, 0.97 * np.pi / w), 60)
            law = [closing(params, w * one) / unit for one in line]
            ax.plot(line, law, color=QUIET, linewidth=0.9, linestyle=(0, (4, 2)), zorder=0)
            colour, face = (UP, DOWN, INK, UP)[k], "white" if k == 3 else None
            ax.plot(x, y, marker, color=colour, markerfacecolor=face, markersize=3.2, label=f"{value:g}")
        ax.plot([], [], color=QUIET, linewidth=0.9, linestyle=(0, (4, 2)), label="law")
        ax.set_yscale("log")
        ax.set_xlabel("distance / $w$, at $\\alpha_u$ = 0", labelpad=1.0)
        ax.set_ylabel("closing speed / $aw$", labelpad=1.0)
        ax.legend(title="$\\alpha_p$", frameon=False, fontsize=8.0, title_fontsize=8.0, handlelength=1.2)

    def fates(ax: Any) -> None:
        x = np.repeat(_placed(data["multiple"].values)[:, None], data.sizes["start"], axis=1)
        first, merged = data["first_width"].values, data["last_width"].values == 0
        seen = first > 0
        ax.plot(x[seen & merged], first[seen & merged], "x", color=INK, markersize=3.4, label="merge")
        ax.plot(x[seen & ~merged], first[seen & ~merged], "o", color=UP, markersize=3.4, label="even out")
        ax.plot(data["saddle_multiple"].values, data["saddle_width"].values, color=QUIET, label="saddle")
        _multiples(ax, data["multiple"].values)
        ax.set_ylim(0, 0.52)
        ax.set_ylabel("narrow stripe, turns", labelpad=1.0)
        ax.legend(**(LEGEND | {"fontsize": 8.0, "markerscale": 1.2, "columnspacing": 0.6}))

    def seeds(ax: Any) -> None:
        counts = np.sum(data["ended"].values == REGIMES.index("cyclosis"), axis=1)
        share, low, high = 100 * np.array([proportion(int(n), data.sizes["seed"]) for n in counts]).T
        interval(ax, _placed(data["flow"].values), share, low, high, UP)
        _multiples(ax, data["flow"].values)
        ax.set_ylim(-4, 104)
        ax.set_ylabel("two stripes from disorder, %", labelpad=1.0)

    times = data["frame_time"].values
    titles = ["no flow, $t$ = 0", *(f"no flow, {quantities.when(time)}" for time in times[1:3])]
    titles += ["flow, $t$ = 0", f"flow, {quantities.when(times[4])}"]
    panels = [Panel(speeds), Panel(fates), Panel(seeds)]
    return story(cells(data, titles), panels, str(verdict(data)))


NOTHING = 0.1
"""Place of no flow on a logarithmic axis of multiples of the threshold."""


def _placed(multiples: npt.ArrayLike) -> Array:
    """Return multiples of the threshold with 0 moved onto the logarithmic axis."""
    return np.maximum(np.asarray(multiples, dtype=np.float64), NOTHING)


def _multiples(ax: Any, shown: Array) -> None:
    top = 1.6 * float(np.max(shown))
    ax.axvspan(0.6 * NOTHING, 1.0, color=SHADE, alpha=0.5, linewidth=0, zorder=-1)
    ax.set_xscale("log")
    ax.set_xlim(0.6 * NOTHING, top)
    ticks = [value for value in (1.0, 10.0, 100.0) if value < top]
    ax.set_xticks([NOTHING, *ticks], ["0", *(f"{value:g}" for value in ticks)])
    ax.minorticks_off()
    ax.set_xlabel("$\\alpha_u$ / threshold, at $\\alpha_p$ = 0.1", labelpad=1.0)


EXPERIMENT = Experiment(
    name="coalescence",
    headline="Without flow opposite streams merge; weak flow makes two stripes stable.",
    claim="Without alignment by flow, fronts between opposite streams always merge in the end; above a small "
    "threshold flow makes two stripes stable.",
    source="Flow-Stabilized Pattern Formation",
    method="Stripes of unequal widths are prepared and integrated. Closing speeds at α_p = 0.1 to 1 without "
    "flow are compared with the law of fronts. At α_p = 0.1 are measured the rate at which a small "
    "difference of widths grows at 0.5 to 2 times the threshold, the fate of narrow stripes, and the end of "
    "disordered cells.",
    seeds=200,
    quick_seeds=16,
    measure=measure,
    verdict=verdict,
    decisive=decisive,
    draw=draw,
)
