"""Whether stopping the bundling arrests streaming: from disorder, in established and in fragmented cells."""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray

from ..analysis.regimes import REGIMES
from ..dynamics.protocol import Protocol
from ..dynamics.simulate import simulate
from ..figures import quantities
from ..figures.story import Panel, cells, interval, story
from ..figures.style import DOWN, INK, QUIET, SHADE, UP
from ..model import initial
from ..model.grid import Array, CylinderGrid
from ..model.parameters import Parameters
from ..model.system import flow
from ..stability.existence.crossings import existing_from
from ..stability.existence.equal import EqualStripes
from .experiment import AGREES, DOES_NOT, IN_PART, Experiment, Verdict
from .lab import Lab, frames
from .statistics import in_words, median_interval, proportion

if TYPE_CHECKING:
    from matplotlib.figure import Figure

# Computed

STREAMING = 0.05
"""Peak speed above which a cell streams; that of two stripes at the paper's parameters is 0.97."""
SHORT = CylinderGrid(48, 8, 5.0)
"""Stripes do not vary along the cell."""
SETTLING, LONGEST = 20.0, 2000.0
POINTS = 96
"""Points around the cell in theory."""
HALVINGS = 8
"""Halvings of the interval in which the least order that stripes need is sought."""


@cache
def established() -> Array:
    """Return two stripes (2, n_theta, n_z) as they stream with the paper's parameters."""
    run = simulate(Parameters(), SHORT, initial.stripes(SHORT), SETTLING, save_at=(SETTLING,), rtol=1e-3)
    return run.final_state


def left_over(alpha_p: float, alpha_u: float, keep: float = 1.0) -> float:
    """Return the final peak speed of established stripes whose order is multiplied by `keep`."""
    params = Parameters(alpha_p=alpha_p, alpha_u=alpha_u)
    start = keep * established()
    run = simulate(params, SHORT, start, LONGEST, save_every=LONGEST, rtol=1e-3, steady_rate=1e-6)
    return float(np.hypot(*flow(params, SHORT, run.final_state)).max())


def least_order(alpha_p: float, alpha_u: float) -> float:
    """Return the least factor by which the order of established stripes may be multiplied so that they last.

    1 where they do not last even with all of it.
    """
    low, high = 0.0, 1.0
    if left_over(alpha_p, alpha_u) < STREAMING:
        return high
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        if left_over(alpha_p, alpha_u, middle) < STREAMING:
            low = middle
        else:
            high = middle
    return 0.5 * (low + high)


def fold(alpha_p: float) -> float:
    """Return the least alpha_u with which two stripes exist, for alpha_p < d_r + d_s."""
    return existing_from(EqualStripes(Parameters(alpha_p=alpha_p), 2, POINTS)).alpha_u


def branch(alpha_p: float, most: float, count: int) -> Array:
    """Return alpha_u, first wave and peak speed (count, 3) along the branch of two stripes, through its fold.

    The branch runs from alpha_u = `most` on the stable side to small order on the other. The first wave is
    that of P_z.
    """
    problem = EqualStripes(Parameters(alpha_p=alpha_p), 2, POINTS)
    state = problem.full(most)
    wavenumber = np.fft.rfftfreq(POINTS, 1 / POINTS)
    rows = []
    for amplitude in np.linspace(problem.amplitude(state.P), 0.05, count):
        state = problem.at_amplitude(float(amplitude), state)
        force = np.fft.rfft(state.P**3) / (1 + problem.params.mu * wavenumber**2)
        speed = float(np.abs(np.fft.irfft(force, POINTS)).max())
        rows.append((state.alpha_u, float(amplitude), speed))
    return np.array(rows)


def first_wave(state: Array) -> float:
    """Return the amplitude of the wave of P_z once around the cell, of a state (2, n_theta, n_z)."""
    return float(2 * np.abs(np.fft.rfft(state[1].mean(axis=-1))[1]) / state.shape[1])


GRID = CylinderGrid(48, 48, 5.0)
PAPER, WEAK = 0.5, 0.2
"""The paper's alpha_u, and one that is too weak to sustain stripes without bundling."""
DRUG, END = 10.0, 210.0
NOISE = 0.02236
"""Standard deviation of the disorder of 1000 filaments per square, also added to established cells."""
WAYS = ("from disorder", "established", "fragmented")
"""The state of the cell; the last is an established cell whose cables the drug also breaks up."""

# The plane over which established stripes are integrated: below d_r + d_s, where two stripes end in a fold.
ALPHA_P, QUICK_ALPHA_P = np.linspace(0.0, 0.048, 13), np.linspace(0.0, 0.048, 3)
ALPHA_U, QUICK_ALPHA_U = np.linspace(0.02, 0.32, 16), np.linspace(0.04, 0.32, 5)
ORDER_ALPHA_U, QUICK_ORDER_ALPHA_U = (0.23, 0.25, 0.3, 0.4, 0.5, 0.7, 1.0), (0.25, 1.0)
"""Where the least order that lasts is sought."""
NEAREST = 0.03
"""Distance from the fold, over alpha_u there, below which a run may be too short to decide."""
RARE = 0.1
"""Share of cells, by the upper end of its interval, that may still stream where streaming is arrested."""

TIMES = (DRUG - 1, DRUG, DRUG + 30, END)
"""Of the frames: before, in the drug, on the way, and at the end."""
STEPS = [
    {"at": DRUG, "action": "change", "alpha_p": 0.0},
    {"at": DRUG, "action": "noise", "size": NOISE},
]
FRAGMENT = {"at": DRUG, "action": "fragment"}


def measure(lab: Lab) -> xarray.Dataset:
    """Return the outcomes of seeds in all three ways, the map of lasting stripes, and frames of cells."""
    strengths = {"alpha_u": {"values": [WEAK, PAPER]}}
    fresh = {"parameters": {"alpha_p": 0.0}, "axes": strengths, "run": {"finish": "certified", "rtol": 1e-3}}
    whole = {
        "initial": {"kind": "stripes"},
        "axes": strengths,
        "run": {"t_end": 0.5 * END if lab.quick else END, "finish": "t_end", "rtol": 1e-3},
    }
    swept = [
        lab.sweep("disorder", fresh),
        lab.sweep("established", whole | {"protocol": STEPS}),
        lab.sweep("fragmented", whole | {"protocol": [STEPS[0], FRAGMENT]}),
    ]
    found = _cells(lab)
    cyclosis = REGIMES.index("cyclosis")
    speed = np.stack([np.asarray(each["peak_speed"].values) for each in swept])
    two = np.stack([np.asarray(each["regime"].values) == cyclosis for each in swept])
    found["speed"] = ("way", "alpha_u", "seed"), speed.astype(np.float32)
    found["streams"] = ("way", "alpha_u", "seed"), two & (speed > STREAMING)
    bundling, flow = (QUICK_ALPHA_P, QUICK_ALPHA_U) if lab.quick else (ALPHA_P, ALPHA_U)
    points = [(float(alpha_p), float(alpha_u)) for alpha_p in bundling for alpha_u in flow]
    left = np.reshape(lab.each("map", left_over, points), (bundling.size, flow.size))
    found["left"] = ("map_alpha_p", "map_alpha_u"), left.astype(np.float32)
    found["fold"] = "map_alpha_p", lab.each("folds", fold, [(float(alpha_p),) for alpha_p in bundling])
    some = QUICK_ORDER_ALPHA_U if lab.quick else ORDER_ALPHA_U
    least = np.array(lab.each("least order", least_order, [(0.0, alpha_u) for alpha_u in some]))
    found["least_wave"] = "order_alpha_u", least * first_wave(established())
    found["branch"] = ("along", "of_branch"), branch(0.0, max(some), 60)
    return found.assign_coords(
        way=list(WAYS),
        alpha_u=[WEAK, PAPER],
        map_alpha_p=bundling,
        map_alpha_u=flow,
        order_alpha_u=list(some),
        of_branch=["alpha_u", "first wave", "peak speed"],
    )


def _cells(lab: Lab) -> xarray.Dataset:
    """Return frames of an established cell, of a fragmented one, and of one with weak flow, in the drug."""
    ways = ((PAPER, STEPS, (0, 3)), (WEAK, STEPS, (2, 3)), (PAPER, [STEPS[0], FRAGMENT], (1, 3)))
    found = []
    for alpha_u, steps, shown in ways:
        times = [TIMES[k] for k in shown]
        protocol = Protocol.from_tables(steps, seed=1)
        params, start = Parameters(alpha_u=alpha_u), initial.stripes(GRID)
        found.append(frames(lab.story(params, GRID, start, END, times, protocol, rtol=1e-3), times))
    return xarray.concat(found, "frame", combine_attrs="override", data_vars="minimal")


def misplaced(data: xarray.Dataset) -> tuple[int, int]:
    """Return how many points of the map are on the wrong side of the fold, of how many not next to it."""
    edge = np.asarray(data["fold"].values)[:, None]
    flow = np.asarray(data["map_alpha_u"].values)[None]
    lasts = np.asarray(data["left"].values) > STREAMING
    clear = np.abs(flow - edge) > NEAREST * edge
    return int(np.sum(clear & (lasts != (flow > edge)))), int(clear.sum())


def _streaming(data: xarray.Dataset, way: str, alpha_u: float) -> tuple[float, float, float]:
    """Return the share of cells, with its interval, that stream."""
    streams = np.asarray(data["streams"].sel(way=way, alpha_u=alpha_u).values)
    return proportion(int(streams.sum()), streams.size)


# Judged


def verdict(data: xarray.Dataset) -> Verdict:
    """Judge: with the paper's alpha_u the drug arrests streaming in all three states of the cell."""
    share = {way: _streaming(data, way, PAPER) for way in WAYS}
    arrested = [way for way in WAYS if share[way][2] < RARE or share[way][0] == 0]
    before = float(np.hypot(*np.asarray(data["u"].values[0], dtype=np.float64)).max())
    text = (
        f"without bundling, cells stream in {in_words(share['from disorder'])} of cases from disorder, "
        f"{in_words(share['fragmented'])} if established cables are fragmented too, and "
        f"{in_words(share['established'])} if they are left"
    )
    if "established" not in arrested:
        speed = median_interval(np.asarray(data["speed"].sel(way="established", alpha_u=PAPER).values))
        text += f", at {100 * speed[0] / before:.1f} % of their speed"
        text = "the drug alone does not stop an established cell: " + text
    wrong, total = misplaced(data)
    text += (
        f"; at α_u = {WEAK:g}, {in_words(_streaming(data, 'established', WEAK))} stream on. Stripes without "
        f"bundling exist above the fold at α_u = {float(data['fold'].values[0]):.4f}; {total - wrong} of "
        f"{total} points of the map lie on its right side"
    )
    outcome = AGREES if len(arrested) == len(WAYS) else IN_PART if arrested else DOES_NOT
    return Verdict(outcome, text)


def decisive(data: xarray.Dataset) -> str:
    """Return the share of established cells that keep streaming under the drug."""
    return f"{in_words(_streaming(data, 'established', PAPER))} of established cells keep streaming"


# Drawn


def draw(data: xarray.Dataset) -> Figure:
    """Draw three cells in the drug, seeds by way, the map with its fold, and the order needed."""
    titles = (
        "before the drug",
        f"drug, {quantities.when(TIMES[3])}",
        f"weaker $α_u$, {quantities.when(TIMES[2])}",
        f"weaker $α_u$, {quantities.when(TIMES[3])}",
        "drug, and fragmented",
        f"the same, {quantities.when(TIMES[3])}",
    )

    def seeds(ax: Any) -> None:
        for alpha_u, colour, shift in ((WEAK, DOWN, -0.1), (PAPER, UP, 0.1)):
            streams = np.asarray(data["streams"].sel(alpha_u=alpha_u).values)
            each = [proportion(int(row.sum()), row.size) for row in streams]
            value, low, high = 100 * np.array(each).T
            at = np.arange(len(WAYS)) + shift
            ax.vlines(at, low, high, color=colour, linewidth=1.0)
            ax.plot(at, value, "o", color=colour, markersize=4.0, label=f"$α_u$ = {alpha_u:g}")
        ax.set_xticks(range(len(WAYS)), ["from\ndisorder", "estab-\nlished", "frag-\nmented"], fontsize=8.0)
        ax.set_xlim(-0.5, len(WAYS) - 0.5)
        ax.set_ylim(-4, 104)
        ax.set_ylabel("cells that stream, %", labelpad=1.0)
        ax.legend(fontsize=8.0, frameon=False, loc="center left", borderpad=0, handletextpad=0.2)

    def plane(ax: Any) -> None:
        lasts = np.asarray(data["left"].values) > STREAMING
        x, y = (np.asarray(data[name].values) for name in ("map_alpha_p", "map_alpha_u"))
        X, Y = np.meshgrid(x, y, indexing="ij")
        ax.plot(X[lasts], Y[lasts], "s", color=UP, markersize=3.2, label="stripes last")
        ax.plot(X[~lasts], Y[~lasts], "s", color=SHADE, markersize=3.2, label="vanish")
        ax.plot(x, data["fold"].values, color=INK, linewidth=1.2, label="fold, theory")
        ax.set_xlabel("bundling $α_p$", labelpad=1.0)
        ax.set_ylabel("$α_u$", labelpad=1.0)
        ax.set_ylim(0, 0.335)
        ax.legend(fontsize=8.0, frameon=False, loc="lower left", bbox_to_anchor=(-0.18, 0.98), ncols=3,
                  borderpad=0, handletextpad=0.1, columnspacing=0.6)  # fmt: skip

    def order(ax: Any) -> None:
        curve = np.asarray(data["branch"].values)
        bend = int(np.argmin(curve[:, 0]))
        shown = curve[:, 0] <= 1.001 * curve[0, 0]
        ax.plot(*curve[: bend + 1, :2].T, color=UP, linewidth=1.2, label="stable, theory")
        below = np.flatnonzero(shown & (np.arange(len(curve)) >= bend))
        ax.plot(*curve[below, :2].T, color=UP, linewidth=1.0, linestyle=(0, (3, 2)), label="unstable")
        x, y = np.asarray(data["order_alpha_u"].values), np.asarray(data["least_wave"].values)
        interval(ax, x, y, y, y, INK, "least that lasts")
        ax.lines[-1].set_linestyle("none")
        ax.axhline(0.0, color=QUIET, linewidth=0.8)
        ax.set_xlim(0.0, 1.02 * curve[0, 0])
        ax.set_ylim(-0.03, 1.3)
        ax.set_xlabel("$α_u$ at $α_p$ = 0", labelpad=1.0)
        ax.set_ylabel("wave around the cell", labelpad=1.0)
        ax.legend(fontsize=8.0, frameon=False, loc="center right", borderpad=0, handlelength=1.4,
                  bbox_to_anchor=(1.03, 0.58))  # fmt: skip

    return story(
        cells(data, titles), [Panel(seeds, 0.8), Panel(plane), Panel(order)], str(verdict(data)),
        same_view=False,
    )  # fmt: skip


EXPERIMENT = Experiment(
    name="cytochalasin",
    headline="A drug that stops bundling stops streaming.",
    claim="An agent that keeps filaments from bundling (α_p = 0) stops streaming; in the model that alone "
    "stands for the fragmentation of all cables.",
    source="Discussion, and Model (forcing of the flow)",
    method="Cells with α_p = 0 start from disorder and are integrated until their end is certain. In "
    "streaming cells α_p is set to zero, with noise of 1000 filaments a square added or with all filaments "
    "fragmented, for 200 R/U. Both are done at α_u = 0.2 and 0.5. Stripes are mapped over α_p below d_r + "
    "d_s and α_u near the fold of theory. The least order from which they last is found by bisection.",
    seeds=200,
    quick_seeds=6,
    measure=measure,
    verdict=verdict,
    decisive=decisive,
    draw=draw,
)
