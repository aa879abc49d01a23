"""Without bundling a linear force would let streaming return; whether a cubic one lets it stop."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt
import scipy.stats
import xarray

from ..dynamics.protocol import Protocol, change, fragment
from ..dynamics.simulate import simulate
from ..figures import quantities
from ..figures.story import Panel, cells, interval, reference, story
from ..figures.style import DOWN, UP
from ..model import initial
from ..model.errors import InputError
from ..model.grid import Array, CylinderGrid
from ..model.parameters import Parameters
from ..stability import cyclosis, fold
from .experiment import AGREES, DOES_NOT, IN_PART, Experiment, Verdict
from .lab import Lab, frames
from .statistics import in_words, proportion

if TYPE_CHECKING:
    from matplotlib.figure import Figure

# Computed

GRID = CylinderGrid(48, 48, 5.0)
BETWEEN = (10.0, 30.0)
"""Times between which growth is measured: the other waves have decayed, and this one is still small."""


def wave_growth(exponent: float, alpha_u: float, seed: int) -> float:
    """Return the growth rate of the wave of P_z once around a disordered cell without bundling."""
    params = Parameters(alpha_p=0.0, alpha_u=alpha_u, force_exponent=exponent)
    state = initial.disordered(GRID, seed=seed)
    run = simulate(params, GRID, state, BETWEEN[1], save_at=BETWEEN, rtol=1e-5)
    first, last = (abs(np.fft.fft(run.frames[k][1].mean(axis=1))[1]) for k in (-2, -1))
    return float(np.log(last / first) / (BETWEEN[1] - BETWEEN[0]))


def stripe_speed(exponent: float, alpha_u: float) -> float:
    """Return the peak speed of steady stripes without bundling; NaN where there are none."""
    try:
        state = cyclosis(Parameters(alpha_p=0.0, alpha_u=alpha_u, force_exponent=exponent), 64)
    except InputError:
        return np.nan
    return float(np.abs(state.u).max())


def onsets(strength: npt.ArrayLike, rates: npt.ArrayLike) -> Array:
    """Return, for each seed, the strength at which the line through rates (n, seeds) crosses zero."""
    slope, at_zero = np.polyfit(np.asarray(strength), np.asarray(rates), 1)
    crossing: Array = -at_zero / slope
    return crossing


def mean_interval(values: npt.ArrayLike) -> tuple[float, float, float]:
    """Return the mean of values (n,), n >= 2, and the ends of its 95 % interval by Student's t."""
    x = np.asarray(values, dtype=np.float64)
    half = float(scipy.stats.t.ppf(0.975, x.size - 1) * x.std(ddof=1) / np.sqrt(x.size))
    return float(x.mean()), float(x.mean()) - half, float(x.mean()) + half


EXPONENTS = {"linear": 0.0, "cubic": 2.0}
STARTS = {
    "disorder": {"kind": "disordered"},
    # Established stripes, with the noise of as many filaments as leave |P| <= 1.
    "stripes": {"kind": "stripes", "magnitude": 0.9, "filaments_per_square": 4000.0},
}
ALPHA_U = (0.03, 0.045, 0.06, 0.1, 0.15, 0.2, 0.24, 0.3, 0.5)
QUICK_ALPHA_U = (0.04, 0.06, 0.2, 0.25, 0.5)
PAPER = 0.5
"""The paper's alpha_u, that of Figure 4."""
WEAK = (0.02, 0.04, 0.06, 0.08, 0.1, 0.12)
"""Values of alpha_u at which the growth of the wave once around the cell is measured."""
MOST_RATES = 24
"""Most seeds of which growth rates are measured; they differ in the fourth digit."""
STREAMING = 0.05
"""Peak speed above which a cell streams."""
ARREST, END = 60.0, 260.0
COLOURS = {"linear": DOWN, "cubic": UP}


def measure(lab: Lab) -> xarray.Dataset:
    """Return growth rates, final speeds by force law and start, theory, and the frames of four cells."""
    found = _stories(lab)
    strengths = QUICK_ALPHA_U if lab.quick else ALPHA_U
    speeds = []
    for start, table in STARTS.items():
        swept = lab.sweep(
            start,
            {
                "parameters": {"alpha_p": 0.0},
                "initial": table,
                "axes": {
                    "force_exponent": {"values": list(EXPONENTS.values())},
                    "alpha_u": {"values": list(strengths)},
                },
                "run": {"t_end": 400.0, "finish": "certified", "rtol": 1e-3},
            },
        )
        speeds.append(np.asarray(swept["peak_speed"].values, dtype=np.float32))
    seeds = min(lab.seeds, MOST_RATES if not lab.quick else 2)
    items = [(law, weak, seed) for law in EXPONENTS.values() for weak in WEAK for seed in range(seeds)]
    rates = np.reshape(lab.each("rates", wave_growth, items), (len(EXPONENTS), len(WEAK), seeds))
    found["speed"] = ("start", "law", "alpha_u", "seed"), np.stack(speeds)
    found["growth"] = ("law", "weak_alpha_u", "grown_seed"), rates
    usual = Parameters(alpha_p=0.0)
    lowest = np.array([(usual.d_r + usual.d_s) * (1 + usual.mu), fold(usual)])
    # From the onset of stripes on, closer together where the curves are steep.
    curve = lowest[:, None] + np.linspace(0.03, 1, 6 if lab.quick else 24) ** 2 * (0.52 - lowest[:, None])
    theory = [
        [stripe_speed(law, float(strength)) for strength in row]
        for law, row in zip(EXPONENTS.values(), curve, strict=True)
    ]
    found["curve_alpha_u"] = ("law", "point"), curve
    found["theory_speed"] = ("law", "point"), np.array(theory)
    found["theory_onset"], found["theory_fold"] = lowest
    found["theory_slope"] = 1 / (1 + usual.mu)
    return found.assign_coords(
        start=list(STARTS),
        law=list(EXPONENTS),
        alpha_u=list(strengths),
        weak_alpha_u=list(WEAK),
    )


def _stories(lab: Lab) -> xarray.Dataset:
    """Return the frames of a streaming cell, before and long after bundling has been stopped."""
    end = 0.5 * END if lab.quick else END
    stop = change(at=ARREST, alpha_p=0.0)
    both = Protocol(stop, fragment(at=ARREST), seed=1)
    start = initial.stripes(GRID)
    shown = []
    for exponent, protocol, times in (
        (2.0, Protocol(stop), (ARREST - 1, end)),
        (2.0, both, (end,)),
        (0.0, both, (end,)),
    ):
        params = Parameters(force_exponent=exponent)
        run = lab.story(params, GRID, start, end, times, protocol, rtol=1e-3)
        shown.append(frames(run, times))
    return xarray.concat(shown, "frame", combine_attrs="override", data_vars="minimal")


def _streaming(data: xarray.Dataset, start: str, law: str) -> tuple[Array, npt.NDArray[np.bool_]]:
    """Return the strengths, and which cells (strength, seed) stream."""
    speed = data["speed"].sel(start=start, law=law)
    return np.asarray(data["alpha_u"].values), np.asarray(speed.values) > STREAMING


# Judged


def verdict(data: xarray.Dataset) -> Verdict:
    """Judge: without bundling a linear force restores streaming; a cubic one neither does nor keeps it."""
    strength, revived = _streaming(data, "disorder", "linear")
    at = int(np.argmin(np.abs(strength - PAPER)))
    onset = mean_interval(onsets(data["weak_alpha_u"].values, data["growth"].sel(law="linear").values))
    linear = proportion(int(revived[at].sum()), revived[at].size)
    again = _streaming(data, "disorder", "cubic")[1]
    cubic = proportion(int(again.sum()), again.size)
    kept = _streaming(data, "stripes", "cubic")[1]
    still = proportion(int(kept[at].sum()), kept[at].size)
    needed = linear[1] > 0.5 and onset[2] < PAPER
    text = (
        f"without bundling a linear force {'lets' if needed else 'does not let'} disorder stream from "
        f"α_u = {onset[0]:.5f} ({onset[1]:.5f} to {onset[2]:.5f}) on (theory: "
        f"{float(data['theory_onset']):.5f}; at {strength[at]:g} in {in_words(linear)} of cells), a cubic "
        f"one in {in_words(cubic)}; but stripes that are there already "
    )
    most = kept.mean(axis=1) > 0.5
    if still[2] < 0.5:
        text = text.replace("; but stripes that are there already ", "; stripes that are there die ")
        text += f"under it as well (at {strength[at]:g} streaming lasts in {in_words(still)})"
    else:
        below = strength[~most & (strength < strength[at])]
        lowest = strength[most].min() if most.any() else strength[at]
        where = f"between {below.max():g} and {lowest:g}" if below.size else f"{lowest:g}"
        text += (
            f"survive under it too, from an α_u {where} on (fold: {float(data['theory_fold']):.4f}), in "
            f"{in_words(still)} of cells at the paper's {strength[at]:g}: the cubic force alone stops only "
            "cells whose order the drug destroys as well"
        )
    if not needed or cubic[2] > 0.1:
        return Verdict(DOES_NOT, text)
    return Verdict(AGREES if still[2] < 0.5 else IN_PART, text)


def decisive(data: xarray.Dataset) -> str:
    """Return the share of established cells that keep streaming without bundling under the cubic force."""
    strength, kept = _streaming(data, "stripes", "cubic")
    at = kept[int(np.argmin(np.abs(strength - PAPER)))]
    return f"{in_words(proportion(int(at.sum()), at.size))} of established cells keep streaming"


# Drawn


def draw(data: xarray.Dataset) -> Figure:
    """Draw a cell before and after, growth from disorder, which cells stream at the end, and how fast."""
    titles = ("before", "cubic force: unbundled", "unbundled and fragmented", "the same, linear force")
    onset, critical = float(data["theory_onset"]), float(data["theory_fold"])

    def rates(ax: Any) -> None:
        weak = np.asarray(data["weak_alpha_u"].values)
        reach = np.array([0.0, 1.08 * weak[-1]])
        slope = float(data["theory_slope"])
        for law, rise in (("linear", slope), ("cubic", 0.0)):
            ax.plot(reach, rise * reach - onset * slope, color=COLOURS[law], linewidth=0.8)
            each = np.asarray(data["growth"].sel(law=law).values)
            ends = np.array([mean_interval(row) for row in each]).T
            ax.vlines(weak, ends[1], ends[2], color=COLOURS[law])
            ax.plot(weak, ends[0], "o", color=COLOURS[law], markersize=3.6)
        ax.axhline(0.0, color="black", linewidth=0.5)
        reference(ax, onset, f"{onset:.4f}", upright=True)
        ax.set_xlim(0, reach[1])
        ax.set_xlabel("$α_u$", labelpad=1.0)
        quantities.name(ax.yaxis, "growth rate of one wave", "rate", labelpad=1.0)

    def shares(ax: Any) -> None:
        for law in EXPONENTS:
            for start, style in (("disorder", "-"), ("stripes", ":")):
                strength, streams = _streaming(data, start, law)
                ends = 100 * np.array([proportion(int(row.sum()), row.size) for row in streams]).T
                interval(ax, strength, ends[0], ends[1], ends[2], COLOURS[law], f"{law}, {start}")
                ax.lines[-1].set_linestyle(style)
                ax.lines[-1].set_markerfacecolor(COLOURS[law] if start == "disorder" else "white")
                ax.lines[-1].set_markeredgewidth(0.8)
        _strengths(ax)
        ax.set_ylim(-4, 104)
        ax.set_ylabel("cells that stream, %", labelpad=1.0)
        ax.legend(
            loc="center right", bbox_to_anchor=(1.06, 0.5), fontsize=7.5, frameon=False, handlelength=1.4
        )

    def speeds(ax: Any) -> None:
        for law in EXPONENTS:
            curve = data["curve_alpha_u"].sel(law=law)
            ax.plot(curve, data["theory_speed"].sel(law=law), color=COLOURS[law], linewidth=0.8)
            speed = data["speed"].sel(start="stripes", law=law).median("seed")
            ax.plot(data["alpha_u"], speed, "o", color=COLOURS[law], markersize=3.6, clip_on=False)
        _strengths(ax)
        ax.set_ylim(0, 1)
        quantities.name(ax.yaxis, "peak speed of stripes", "speed", labelpad=1.0)

    def _strengths(ax: Any) -> None:
        reference(ax, onset, f"{onset:.3f}", upright=True)
        reference(ax, critical, f"fold {critical:.3f}", upright=True)
        ax.set_xlim(0, 0.52)
        ax.set_xlabel("$α_u$", labelpad=1.0)

    return story(cells(data, titles), [Panel(rates), Panel(shares), Panel(speeds)], str(verdict(data)))


EXPERIMENT = Experiment(
    name="force-law",
    headline="Only a nonlinear motor force lets drugs against bundling stop streaming.",
    claim="The force of the motors must be nonlinear in the local order, since otherwise streaming would "
    "survive drugs that unbundle the filaments but leave the motors at work.",
    source="Model (forcing of the flow)",
    method="Bundling is zero throughout. Cells begin disordered or with two established stripes, with the "
    "force F = P or |P|²P, for α_u from 0.03 to 0.5, each integrated until its end is certain. Growth rates "
    "of one wave around the cell are measured in disordered cells between t = 10 and 30. Theory gives their "
    "zero, (d_r + d_s)(1 + μ), and the fold from which stripes exist.",
    seeds=200,
    quick_seeds=8,
    measure=measure,
    verdict=verdict,
    decisive=decisive,
    draw=draw,
)
