"""Whether alignment by shear straightens the curved zones between the streams."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt
import scipy.stats
import xarray

from ..analysis.zones import crossings
from ..dynamics.simulate import simulate
from ..figures import quantities
from ..figures.story import Panel, cells, interval, reference, story
from ..figures.style import DOWN, LEGEND, QUIET, UP
from ..model import initial
from ..model.definitions import TERM_NAMES
from ..model.grid import Array, CylinderGrid
from ..model.parameters import Parameters
from ..stability import cyclosis
from .experiment import AGREES, DOES_NOT, IN_PART, Experiment, Verdict
from .lab import Lab, frames
from .statistics import in_words, median_interval, proportion

if TYPE_CHECKING:
    from matplotlib.figure import Figure

# Computed

GRID = CylinderGrid(48, 48, 5.0)
EPSILON = 0.1
"""The paper's ε, at which zones grow from disorder before it is changed."""
FIRST, LAST = 6.0, 60.0
"""Times between which the state is checked for two stripes, once per unit of time."""
FOLLOWED = 80.0
"""How long bent zones are integrated."""
EVERY = 1.0
TIMES = tuple(float(time) for time in np.arange(0.0, FOLLOWED + EVERY / 2, EVERY))
LEVELS = (0.5, 0.1)
"""Shares of its first value at which a bend is timed."""
WITHOUT = tuple(name for name in TERM_NAMES if name != "shear")
"""Terms of the equation less alignment by shear."""


def zone_lines(grid: CylinderGrid, P: Array) -> Array | None:
    """Return the angles (2, n_z) of the two zones along the cell, without jumps at 2π, rising zone first.

    None unless every circle is crossed by exactly two, and both close on themselves along the cell.
    """
    if not np.all(crossings(P) == 2):
        return None
    up = P[1] > 0
    following = np.roll(up, -1, axis=0)
    lines = []
    along = np.arange(grid.n_z)
    for crossing in (~up & following, up & ~following):
        at = np.argmax(crossing, axis=0)
        here, there = P[1][at, along], P[1][(at + 1) % grid.n_theta, along]
        line = np.unwrap((at + here / (here - there)) * 2 * np.pi / grid.n_theta)
        if abs(line[-1] - line[0]) > np.pi:
            return None
        lines.append(line)
    return np.array(lines)


def bend(grid: CylinderGrid, P: Array) -> float:
    """Return the rms deviation, in radians, of zones from straight lines; NaN unless there are two."""
    lines = zone_lines(grid, P)
    return np.nan if lines is None else float(np.sqrt(np.mean(np.var(lines, axis=1))))


def bent(grid: CylinderGrid, size: float) -> Array:
    """Return two stripes whose zones undulate once along the cell, with an rms of `size` radians."""
    profile = cyclosis(Parameters(), 64).P
    spectrum = np.fft.rfft(profile, norm="forward")[: grid.n_theta // 2]
    shift = np.sqrt(2) * size * np.sin(2 * np.pi * grid.z / grid.length)
    phase = np.multiply.outer(grid.theta, np.ones(grid.n_z)) - shift
    waves = [2 * (one * np.exp(1j * m * phase)).real for m, one in enumerate(spectrum) if m > 0]
    state = np.zeros((2, *grid.shape))
    # A little weaker than steady, so that no point exceeds 1 where the grid is coarse.
    state[1] = 0.95 * np.sum(waves, axis=0)
    return state


def straightening(start: Array, epsilon: float, shear: bool) -> Array:
    """Return the bend (time,) at `TIMES` of a cell from a given state, with or without shear alignment."""
    terms = TERM_NAMES if shear else WITHOUT
    params = Parameters(epsilon=epsilon)
    run = simulate(params, GRID, start, FOLLOWED, save_at=TIMES, rtol=1e-3, terms=terms)
    return np.array([bend(GRID, one) for one in run.frames])


def prepared(size: float, shear: bool) -> Array:
    """Return the bend (time,) of prepared zones that begin with a bend of `size` radians."""
    return straightening(bent(GRID, size), EPSILON, shear)


def grown(seed: int) -> tuple[float, float, Array]:
    """Return when two stripes first form in a cell from disorder, how bent they are, and the state then.

    NaN and the last state where none have formed by `LAST`.
    """
    times = tuple(np.arange(FIRST, LAST + 1.0))
    run = simulate(Parameters(), GRID, initial.disordered(GRID, seed=seed), LAST, save_at=times, rtol=1e-3)
    for time, state in zip(times, list(run.frames)[-len(times) :], strict=True):
        size = bend(GRID, state)
        if np.isfinite(size):
            return float(time), size, np.asarray(state / max(1.0, float(np.hypot(*state).max())))
    return np.nan, np.nan, np.asarray(run.final_state)


def from_disorder(seed: int, epsilons: Sequence[float]) -> tuple[float, float, Array, Array]:
    """Grow bent zones at the paper's ε, then straighten copies of them at other ε, with shear and without.

    Returns when they first formed, their bend, the times (epsilon, shear, level) at which it has fallen to
    `LEVELS`, infinite if it does not in time, and its courses (shear, time) at the paper's ε; shear: with,
    without. At ε = 0 the two are the same.
    """
    when, size, state = grown(seed)
    times = np.full((len(epsilons), 2, len(LEVELS)), np.nan)
    courses = np.full((2, len(TIMES)), np.nan)
    if np.isfinite(when):
        for k, epsilon in enumerate(epsilons):
            for j, shear in enumerate((True, False)):
                if epsilon == 0 and not shear:
                    times[k, j] = times[k, 0]
                    continue
                row = straightening(state, epsilon, shear)
                times[k, j] = [fallen(TIMES, row, level) for level in LEVELS]
                if epsilon == EPSILON:
                    courses[j] = row
    return when, size, times, courses


def fallen(times: npt.ArrayLike, bends: npt.ArrayLike, level: float) -> float:
    """Return when a bend (n,) has fallen to a share of its first value, infinite if never.

    Interpolated exponentially between samples.
    """
    t, b = np.asarray(times, dtype=np.float64), np.asarray(bends, dtype=np.float64)
    below = b <= level * b[0]
    if not below.any():
        return np.inf
    k = int(np.argmax(below))
    if not np.isfinite(b[k - 1]):
        return float(t[k])
    passed = np.log(b[k - 1] / (level * b[0])) / np.log(b[k - 1] / b[k])
    return float(t[k - 1] + passed * (t[k] - t[k - 1]))


def late_rate(times: npt.ArrayLike, bends: npt.ArrayLike, since: float) -> float:
    """Return the decay rate of a bend (n,) from a time on, from a line through its logarithm."""
    t, b = np.asarray(times, dtype=np.float64), np.asarray(bends, dtype=np.float64)
    late = t >= since
    return -float(np.polyfit(t[late], np.log(b[late]), 1)[0])


SIZES = (0.03, 0.1, 0.2, 0.4, 0.6, 0.8, 1.0, 1.2, 1.4)
"""Bends, root mean square in radians, of prepared zones."""
EPSILONS = (0.0, EPSILON, 0.2, 0.4)
LATE = 65.0
"""Time from which prepared bends decay as their slowest mode."""
SMALL, STRONG = 0.3, 0.6
"""Bends below and above which zones from disorder are small and strong."""
LEVEL = 0.01
"""Level of significance."""
ENOUGH = 100
"""Number of cells above which an effect that is not observed counts as absent."""
SHOWN, PICTURES = 14, (0.0, 15.0, 30.0)
"""Seed of the cell that is drawn, and times since its two stripes formed."""
NAMES = ("with", "without")


def measure(lab: Lab) -> xarray.Dataset:
    """Return how prepared zones and zones from disorder straighten, with shear alignment and without."""
    sizes = SIZES[2::4] if lab.quick else SIZES
    epsilons = (0.0, EPSILON) if lab.quick else EPSILONS
    pairs = [(size, shear) for size in sizes for shear in (True, False)]
    courses = np.array(lab.each("prepared", prepared, pairs)).reshape(len(sizes), 2, len(TIMES))
    seeds = lab.each("disorder", from_disorder, [(seed, epsilons) for seed in range(lab.seeds)])
    state = lab.each("shown", grown, [(SHOWN,)])[0][2]
    runs = [
        lab.story(Parameters(), GRID, state, PICTURES[-1], PICTURES, terms=terms, rtol=1e-3)
        for terms in (TERM_NAMES, WITHOUT)
    ]
    shown = [frames(runs[0], PICTURES), frames(runs[1], PICTURES[1:])]
    found = xarray.concat(shown, "frame", data_vars="minimal", coords="minimal", compat="override")
    found = found.assign_coords(
        size=list(sizes), shear=list(NAMES), time=list(TIMES), epsilon=list(epsilons), level=list(LEVELS)
    )
    found["prepared"] = ("size", "shear", "time"), courses.astype(np.float32)
    found["stood"] = "seed", np.array([one[0] for one in seeds])
    found["bend"] = "seed", np.array([one[1] for one in seeds])
    found["fallen"] = ("seed", "epsilon", "shear", "level"), np.array([one[2] for one in seeds])
    found["grown"] = ("seed", "shear", "time"), np.array([one[3] for one in seeds]).astype(np.float32)
    # The slowest disturbance with one wave along the cell, from theory.
    slowest = [
        -cyclosis(Parameters(epsilon=one), 96).spectrum(1, axial_mode=1).eigenvalues[0].real
        for one in epsilons
    ]
    found["slowest"] = "epsilon", np.array(slowest)
    for name in ("prepared", "stood", "bend", "fallen", "grown", "slowest"):
        found[name].attrs["units"] = "1"
    return found


def gains(data: xarray.Dataset) -> tuple[Array, Array]:
    """Return the bends (n,) of zones from disorder, and by what share shear alignment speeds them up (n,).

    From the time to a tenth at the paper's ε: positive if the bend takes longer without.
    """
    times = np.asarray(data["fallen"].sel(epsilon=EPSILON, level=LEVELS[1]).values)
    size = np.asarray(data["bend"].values)
    fine = np.isfinite(times).all(axis=1) & np.isfinite(size)
    return size[fine], times[fine, 1] / times[fine, 0] - 1


def prepared_gains(data: xarray.Dataset) -> Array:
    """Return the same (size,) for prepared zones."""
    time = data["time"].values
    times = np.array([[fallen(time, row, LEVELS[1]) for row in pair] for pair in data["prepared"].values])
    return np.asarray(times[:, 1] / times[:, 0] - 1)


# Judged


def verdict(data: xarray.Dataset) -> Verdict:
    """Judge: zones from disorder, or strongly bent ones, straighten faster with shear, and none slower."""
    size, gain = gains(data)
    if size.size < 2:
        return Verdict(DOES_NOT, "no zones became straight in time")
    times = data["fallen"].sel(epsilon=EPSILON, level=LEVELS[1])
    stood = np.isfinite(data["bend"].values)
    alone = np.isfinite(times.sel(shear="without").values)[stood]
    straight = proportion(int(alone.sum()), int(alone.size))
    test = float(scipy.stats.wilcoxon(gain).pvalue)
    whole, small, strong = (
        median_interval(100 * gain[chosen]) for chosen in (size > 0, size < SMALL, size > STRONG)
    )
    late = [
        late_rate(data["time"].values, row, LATE)
        for row in np.asarray(data["prepared"].values[0], dtype=np.float64)
    ]
    theory = float(data["slowest"].sel(epsilon=EPSILON))
    at_zero = median_interval(data["fallen"].sel(epsilon=0.0, level=LEVELS[1], shear="with").values[stood])
    usual = median_interval(times.sel(shear="with").values[stood])
    helps = (whole[1] > 0 and test < LEVEL) or strong[1] > 0
    harms = late[0] < late[1] or small[2] < 0
    text = (
        f"without shear alignment zones of {in_words(straight)} of {alone.size} cells straighten as well, "
        f"to a tenth of their bend within {FOLLOWED:g} R/U; it takes {_said(whole)} longer (Wilcoxon p = "
        f"{test:.1g}), strong bends (rms above {STRONG:g}) {_said(strong)}, small ones (below {SMALL:g}) "
        f"{_said(small)}; the last of small bends decays at {late[0]:.4f} with it (theory {theory:.4f}) and "
        f"{late[1]:.4f} without; the time to a tenth is {usual[0]:.1f} ({usual[1]:.1f} to {usual[2]:.1f}) at "
        f"ε = {EPSILON:g}, and {at_zero[0]:.1f} ({at_zero[1]:.1f} to {at_zero[2]:.1f}) at ε = 0"
    )
    if not helps and (whole[0] <= 0 or size.size >= ENOUGH):
        return Verdict(DOES_NOT, text)
    if not helps:
        return Verdict(IN_PART, f"{text}; these are too few cells to be sure")
    if harms:
        return Verdict(IN_PART, f"{text}: shear alignment hastens strong bends and holds back small ones")
    return Verdict(AGREES, text)


def decisive(data: xarray.Dataset) -> str:
    """Return how much longer zones take to become straight without shear alignment."""
    return f"{_said(median_interval(100 * gains(data)[1]))} longer to straighten without it"


def _said(percent: tuple[float, float, float]) -> str:
    if not np.isfinite(percent).all():
        return f"{percent[0]:.1f} % (too few for an interval)"
    return "{:.1f} % ({:.1f} to {:.1f} %)".format(*percent)


# Drawn


def draw(data: xarray.Dataset) -> Figure:
    """Draw zones that straighten with shear alignment and without, by their bend, and over ε."""
    time = data["time"].values

    def courses(ax: Any) -> None:
        for size, style in ((data["size"].values[0], "-"), (data["size"].values[-1], (0, (2, 1)))):
            for name, colour in zip(NAMES, (UP, DOWN), strict=True):
                row = np.asarray(data["prepared"].sel(size=size, shear=name).values)
                label = f"{name}, {size:g}"
                ax.plot(time, row / row[0], color=colour, linestyle=style, linewidth=1.1, label=label)
        rate = float(data["slowest"].sel(epsilon=EPSILON))
        ax.plot(
            time, 0.05 * np.exp(-rate * time), color=QUIET, linewidth=0.8, linestyle=(0, (4, 2)), zorder=0
        )
        ax.text(2, 0.006, "slowest mode", color=QUIET, fontsize=8.0, va="top")
        ax.set_yscale("log")
        ax.set_xlim(0, time[-1])
        ax.set_ylim(1e-3, 1.2)
        quantities.name(ax.xaxis, "time", "time", "$R/U$", labelpad=1.0)
        ax.set_ylabel("prepared bend / first", labelpad=1.0)
        ax.legend(**(LEGEND | {"fontsize": 7.5, "ncols": 2, "columnspacing": 0.7, "labelspacing": 0.15}))

    def by_size(ax: Any) -> None:
        size, gain = gains(data)
        ax.plot(
            size, 100 * gain, "o", color=UP, markersize=2.2, alpha=0.6, markeredgewidth=0, label="disorder"
        )
        ax.plot(
            data["size"].values, 100 * prepared_gains(data), "-", color=DOWN, linewidth=1.2, label="prepared"
        )
        reference(ax, 0.0, "")
        ax.set_xlim(0, 1.05 * max(1.0, float(size.max(initial=0))))
        ax.set_xlabel("first bend (rms), radians", labelpad=1.0)
        ax.set_ylabel("longer without shear, %", labelpad=1.0)
        ax.legend(**(LEGEND | {"fontsize": 8.0, "markerscale": 1.2}))

    def over(ax: Any) -> None:
        for name, colour in zip(NAMES, (UP, DOWN), strict=True):
            rows = data["fallen"].sel(shear=name, level=LEVELS[1]).values[np.isfinite(data["bend"].values)]
            x = data["epsilon"].values
            value, low, high = np.minimum([median_interval(row) for row in rows.T], FOLLOWED).T
            interval(ax, x, value, np.maximum(low, 0), high, colour, name)
        reference(ax, FOLLOWED, "followed to")
        ax.set_ylim(0, 1.1 * FOLLOWED)
        ax.set_xlabel("$\\epsilon$", labelpad=1.0)
        quantities.name(ax.yaxis, "time to a tenth", "time", "$R/U$", labelpad=1.0)
        ax.legend(**(LEGEND | {"fontsize": 8.0, "markerscale": 1.2}))

    when = data["frame_time"].values
    told = [quantities.words(time, "time", "g") for time in when]
    titles = [f"bent, {quantities.when(when[0])}", *(f"with shear, {time}" for time in told[1:3])]
    titles += [f"without, {time}" for time in told[3:]]
    panels = [Panel(courses), Panel(by_size), Panel(over)]
    return story(cells(data, titles), panels, str(verdict(data)))


EXPERIMENT = Experiment(
    name="shear-straightening",
    headline="Alignment with shear straightens the zones between streams.",
    claim="Alignment of filaments with shear, though weak, smooths the curved zones between streams into "
    "straight lines.",
    source="Time Progression and Figure 4",
    method="Zones bent by 0.03 to 1.4 radians are prepared, and others grown from disorder until two "
    "stripes have formed. Copies of each are integrated for 80 R/U with and without the shear term, those "
    "from disorder also at ε = 0 to 0.4. Times to half and to a tenth of the first bend are paired by cell.",
    seeds=200,
    quick_seeds=6,
    measure=measure,
    verdict=verdict,
    decisive=decisive,
    draw=draw,
)
