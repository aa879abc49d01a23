"""From disorder to streamlets to cyclosis, and whether the flow starts and stops on the way."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt
import scipy.stats
import xarray

from ..analysis.zones import crossings, indifferent_zones
from ..dynamics.simulate import simulate
from ..figures import quantities
from ..figures.story import Panel, cells, reference, story
from ..figures.style import DOWN, INK, QUIET, UP
from ..model import initial
from ..model.grid import Array, CylinderGrid
from ..model.parameters import Parameters
from ..model.system import flow
from .experiment import AGREES, DOES_NOT, IN_PART, Experiment, Verdict
from .lab import Lab, frames
from .statistics import in_words, median_interval, proportion

if TYPE_CHECKING:
    from matplotlib.figure import Figure

# Computed

GRID = CylinderGrid(48, 48, 5.0)
TIMES = (*np.arange(0.0, 16.0, 0.5), *np.arange(16.0, 40.0, 1.0), *np.arange(40.0, 101.0, 5.0))
"""Times (R/U) at which a course is sampled."""
MOVING, STOPPED = 0.1, 0.05
"""Speeds, as shares of a cell's final root mean square, above which flow at a place moves and below which it
has stopped, as an observer could see it."""
EARLY = 20.0
"""Time that separates early from late: the two stripes have formed."""
COURSES = ("order", "global_order", "speed", "domain_size", "elongation", "stripes")
MOST = 4
"""Stops of this many or more are counted together."""


def course(seed: int) -> tuple[Array, Array, Array]:
    """Integrate a cell from disorder: courses (6, time), reversals early and late, and places by stops.

    Courses are those named in `COURSES`. Reversals (2,) are visible ones per place and time; places
    (`MOST` + 1,) the share of the surface at which visible flow stopped and resumed 0, 1, ... times.
    """
    params = Parameters()
    state = initial.disordered(GRID, seed=seed)
    run = simulate(params, GRID, state, TIMES[-1], save_at=TIMES, rtol=1e-3)
    P = np.stack(list(run.frames))
    u = np.stack([flow(params, GRID, one) for one in P])
    courses = np.array(
        [
            _size(P),
            [global_order(one) for one in P],
            _size(u),
            [domain_size(GRID, one) for one in P],
            [elongation(GRID, one) for one in P],
            [two_stripes(one) for one in P],
        ]
    )
    scale = courses[2, -1]
    times = np.array(TIMES)
    turned = reversals(u[:, 1] / scale)
    late = times > EARLY
    span = (EARLY, times[-1] - EARLY)
    turns = np.array([turned[~late].sum() / span[0], turned[late].sum() / span[1]])
    stopped = np.minimum(stops(np.hypot(u[:, 0], u[:, 1]) / scale), MOST)
    places = np.bincount(stopped.ravel(), minlength=MOST + 1) / stopped.size
    return courses, turns, places


def _size(v: Array) -> Array:
    return np.asarray(np.sqrt(np.mean(np.sum(v**2, axis=1), axis=(1, 2))))


def global_order(P: Array) -> float:
    """Return the root mean square of the wave of P_z (2, n_theta, n_z) that goes once around the cell."""
    around = np.fft.fft(P[1].mean(axis=1), norm="forward")
    return float(np.sqrt(2) * np.abs(around[1]))


def domain_size(grid: CylinderGrid, P: Array) -> float:
    """Return the mean width of patches of one polarity: area over the length of the lines between them.

    For two straight stripes it is π, the width of each; infinite if there is only one polarity.
    """
    length = sum(zone.arc_length for zone in indifferent_zones(grid, P))
    return 2 * np.pi * grid.length / length if length > 0 else np.inf


def expected_size(params: Parameters, time: npt.ArrayLike) -> Array:
    """Return the domain size of disorder that grows by the linear equation, 4 (d_s t)^½.

    Waves of P_z grow at a - d_s k², so that white noise becomes a normal field whose slope has 1/(4 d_s t)
    times its variance; by Rice's formula half the root of that is the length of its zeros per area.
    """
    return np.asarray(4 * np.sqrt(params.d_s * np.asarray(time, dtype=np.float64)))


def elongation(grid: CylinderGrid, P: Array) -> float:
    """Return the ratio of the lengths of patches along the cell and around it, from the slopes of P_z."""
    spectrum = np.abs(np.fft.fft2(P[1])) ** 2
    around = np.sum(grid.m[:, None] ** 2 * spectrum)
    along = np.sum(grid.q[None, :] ** 2 * spectrum)
    # Straight stripes have no length: ratios above a hundred count as a hundred.
    return float(np.sqrt(around / max(along, 1e-4 * around, 1e-300)))


def two_stripes(P: Array) -> bool:
    """Return whether every circle around the cell is crossed by exactly two zones."""
    return bool(np.all(crossings(P) == 2))


def reversals(v: Array) -> Array:
    """Return for each time the share of places whose velocity v (time, n_theta, n_z) has visibly reversed.

    That is, exceeds `MOVING` in the direction opposite to that in which it last did.
    """
    last = np.zeros(v.shape[1:])
    out = np.zeros(len(v))
    for k, now in enumerate(v):
        sign = np.where(np.abs(now) > MOVING, np.sign(now), 0.0)
        out[k] = np.mean(sign * last < 0)
        last = np.where(sign != 0, sign, last)
    return out


def stops(speed: Array) -> Array:
    """Return how often speed (time, n_theta, n_z) fell below `STOPPED` and rose above `MOVING` again."""
    started = np.zeros(speed.shape[1:], dtype=bool)
    halted = np.zeros_like(started)
    count = np.zeros(speed.shape[1:], dtype=int)
    for now in speed:
        again = halted & (now > MOVING)
        count += again
        started |= now > MOVING
        halted = (halted & ~again) | (started & (now < STOPPED))
    return count


def reached(times: npt.ArrayLike, values: npt.ArrayLike, level: float) -> float:
    """Return the first time at which a course (n,) reaches a level, linear between samples; NaN if never."""
    t, x = np.asarray(times, dtype=np.float64), np.asarray(values, dtype=np.float64)
    above = x >= level
    if not above.any():
        return np.nan
    k = int(np.argmax(above))
    if k == 0:
        return float(t[0])
    return float(t[k - 1] + (level - x[k - 1]) * (t[k] - t[k - 1]) / (x[k] - x[k - 1]))


def since(times: npt.ArrayLike, holds: npt.ArrayLike) -> float:
    """Return the first of `times` (n,) from which `holds` (n,) is true to the end; NaN if it ends false."""
    true = np.asarray(holds, dtype=bool)
    if not true[-1]:
        return np.nan
    return float(np.asarray(times)[true.size - int(np.argmin(np.append(true[::-1], False)))])


SHOWN, PICTURES = 3, (1.0, 5.0, 8.0, 20.0, 100.0)
"""Seed of the cell that is drawn, and when."""
HALF = 0.5
"""Share of its final value at which local order, or the pattern around the cell, counts as established."""
USUAL = 0.9
"""Share of cells, by the lower end of its interval, above which something counts as usual."""
SALTATORY = 0.5
"""Share of the surface at which flow must stop and resume at least twice to be called saltatory."""
BAND = (0.05, 0.95)


def measure(lab: Lab) -> xarray.Dataset:
    """Return courses of order, speed, size and shape of domains, and the steadiness of flow, by seed."""
    followed = lab.each("course", course, [(seed,) for seed in range(lab.seeds)])
    courses, turns, places = (np.stack([one[k] for one in followed]) for k in range(3))
    run = lab.story(
        Parameters(), GRID, initial.disordered(GRID, seed=SHOWN), PICTURES[-1], PICTURES, rtol=1e-3
    )
    found = frames(run, PICTURES).assign_coords(time=np.array(TIMES), period=["early", "late"])
    for k, name in enumerate(COURSES):
        found[name] = ("seed", "time"), courses[:, k].astype(np.float32)
    found["reversals"] = ("seed", "period"), turns
    found["places"] = ("seed", "stops"), places
    for name in (*COURSES, "reversals", "places"):
        found[name].attrs["units"] = "1"
    return found.assign_attrs(d_s=Parameters().d_s)


def moments(data: xarray.Dataset) -> dict[str, Array]:
    """Return, by seed, when `local` order, the `whole` pattern and two `stripes` are established.

    With the `size` of domains and their `elongation` when local order is; NaN for what never was.
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


def _stopping(data: xarray.Dataset, least: int) -> tuple[float, float, float]:
    """Return the share of the surface, with its interval, at which flow stops at least so often."""
    places = np.asarray(data["places"].values)
    return median_interval(places[:, least:].sum(axis=1))


# Judged


def verdict(data: xarray.Dataset) -> Verdict:
    """Judge: order is local before it is global, ends as two stripes, and flow is saltatory on the way."""
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
    once, twice = (_stopping(data, k) for k in (1, 2))
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


def decisive(data: xarray.Dataset) -> str:
    """Return the share of the surface at which flow is saltatory."""
    return f"{_percent(_stopping(data, 2))} of the surface stops and restarts repeatedly"


def _said(value: tuple[float, float, float]) -> str:
    return "{:.2f} ({:.2f} to {:.2f})".format(*value)


def _percent(value: tuple[float, float, float]) -> str:
    return "{:.2f} % ({:.2f} to {:.2f} %)".format(*(100 * one for one in value))


# Drawn


def draw(data: xarray.Dataset) -> Figure:
    """Draw a cell becoming ordered, local and global order, the size of domains, and how often flow stops."""
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
        quantities.name(ax.xaxis, "time", "time", "$R/U$", labelpad=1.0)
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
        quantities.name(ax.xaxis, "time", "time", "$R/U$", labelpad=1.0)
        quantities.name(ax.yaxis, "width of domains", "length", "$R$", labelpad=1.0)
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

    titles = [quantities.when(value) for value in data["frame_time"].values]
    return story(cells(data, titles), [Panel(order), Panel(sizes), Panel(stopping)], str(verdict(data)))


EXPERIMENT = Experiment(
    name="emergence",
    headline="Streams grow from small patches, by way of saltatory flow.",
    claim="Order begins in small patches, streamlets, and spreads until two streams fill the cell; on the "
    "way streaming is disordered and saltatory.",
    source="Introduction (Foissner & Wasteneys 2000), Time Progression and Figure 4",
    method="Disordered cells are integrated to t = 100 at Figure 4's parameters. Measured are local order, "
    "the wave around the cell, speed, the width of domains (area over length of zones), and how often flow "
    "at each place reverses (above a tenth of the final speed), or stops (below a twentieth) and restarts.",
    seeds=200,
    quick_seeds=8,
    measure=measure,
    verdict=verdict,
    decisive=decisive,
    draw=draw,
)
