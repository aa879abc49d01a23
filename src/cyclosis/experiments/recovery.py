"""After arrest streaming recovers, with the indifferent zone in a new place."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import xarray

from ..analysis.regimes import REGIMES
from ..dynamics.protocol import Protocol
from ..figures import quantities
from ..figures.story import Panel, cells, reference, story
from ..figures.style import UP
from ..model import initial
from ..model.grid import Array, CylinderGrid
from ..model.parameters import Parameters
from .experiment import AGREES, DOES_NOT, IN_PART, Experiment, Verdict
from .lab import Lab, frames
from .statistics import circular, in_words, proportion

if TYPE_CHECKING:
    from matplotlib.figure import Figure

# Computed

ARREST, WASHED, END = 20.0, 40.0, 400.0
"""Times at which the drug is given, is washed out, and the cell is measured."""
TIMES = (ARREST - 1, WASHED, WASHED + 8, WASHED + 25, END)
STEPS = [
    # Cytochalasin and oryzalin: bundling stops and the cables fall apart.
    {"at": ARREST, "action": "change", "alpha_p": 0.0},
    {"at": ARREST, "action": "fragment"},
    {"at": WASHED, "action": "wash_out"},
]
LEVEL = 0.01
"""Level of significance of the tests of uniformity."""
EQUAL = 0.005
"""Difference of a stripe's width from a half that counts as zero."""


def measure(lab: Lab) -> xarray.Dataset:
    """Return the zone of every recovered cell, its stripes, and the frames of one."""
    tables = {
        "initial": {"kind": "stripes"},
        "axes": {"alpha_u": {"values": [0.5]}},
        "run": {"t_end": END, "finish": "t_end", "rtol": 1e-3},
        "protocol": STEPS,
    }
    swept = lab.sweep("recovered", tables).isel(alpha_u=0)
    profile = np.asarray(swept["profile"].sel(component="z").values)
    regime = np.asarray(swept["regime"].values)
    back = regime == REGIMES.index("cyclosis")
    shift = np.where(back, [rising(one) for one in profile], np.nan)
    width = np.where(back, np.asarray(swept["stripe_width"].values)[:, 0], np.nan)
    grid = CylinderGrid(48, 48, 5.0)
    run = lab.story(
        Parameters(),
        grid,
        initial.stripes(grid),
        END,
        TIMES,
        Protocol.from_tables(STEPS, seed=1),
        rtol=1e-3,
    )
    found = frames(run, TIMES)
    found["recovered"] = "seed", back
    found["zone_shift"] = "seed", shift
    found["width"] = "seed", width
    return found


def rising(profile: Array) -> float:
    """Return the angle, in radians, at which an axial mean P_z (n_theta,) of two stripes turns upward.

    From the phase of its first wave, which that angle leads by a quarter turn.
    """
    wave = np.fft.rfft(profile)[1]
    return float(np.mod(-np.angle(wave) - 0.5 * np.pi, 2 * np.pi))


# Judged


def verdict(data: xarray.Dataset) -> Verdict:
    """Judge: the pattern returns, its position is uniformly random, and stripes are equal."""
    back = np.asarray(data["recovered"].values, dtype=bool)
    share = proportion(int(back.sum()), back.size)
    shift, width = (np.asarray(data[name].values)[back] for name in ("zone_shift", "width"))
    if shift.size < 2:
        return Verdict(DOES_NOT, f"streaming returned in {in_words(share)} of {back.size} cells")
    test = circular(shift)
    worst = float(np.abs(width - 0.5).max())
    uniform = min(test.rayleigh, test.kuiper) > LEVEL
    equal = worst < EQUAL
    text = (
        f"cyclosis returned in {in_words(share)} of {back.size} cells; its shift about the axis is"
        f"{'' if uniform else ' not'} uniform (Rayleigh p = {test.rayleigh:.2f}, Kuiper {test.kuiper:.2f}), "
        f"and widths differ from a half by at most {worst:.1e}"
    )
    good = share[0] > 0.5 and uniform and equal
    return Verdict(AGREES if good and share[1] > 0.9 else IN_PART if good else DOES_NOT, text)


def decisive(data: xarray.Dataset) -> str:
    """Return the share of cells in which cyclosis returned."""
    back = np.asarray(data["recovered"].values, dtype=bool)
    return f"{in_words(proportion(int(back.sum()), back.size))} of cells return to cyclosis"


# Drawn


def draw(data: xarray.Dataset) -> Figure:
    """Draw a cell through arrest and recovery, where zones returned, and how wide stripes are."""
    titles = [quantities.when(time) for time in data["frame_time"].values]
    titles[0] += ", before"
    titles[1] += ", washed out"
    back = np.asarray(data["recovered"].values, dtype=bool)
    shift, width = (np.asarray(data[name].values)[back] for name in ("zone_shift", "width"))

    def places(ax: Any) -> None:
        bins = np.linspace(0, 2 * np.pi, 13)
        ax.hist(shift, bins, color=UP, edgecolor="white", linewidth=0.5)
        expected = shift.size / 12
        reference(ax, expected, "uniform")
        ax.set_xlim(0, 2 * np.pi)
        ax.set_xticks([0, np.pi, 2 * np.pi], ["0", "π", "2π"])
        ax.set_xlabel("shift of the zone, radians", labelpad=1.0)
        ax.set_ylabel("cells")

    def widths(ax: Any) -> None:
        ax.hist(width, np.linspace(0.49, 0.51, 21), color=UP, edgecolor="white", linewidth=0.5)
        ax.set_xlabel("width of the upward stripe, turns", labelpad=1.0)
        ax.set_ylabel("cells")

    return story(cells(data, titles), [Panel(places), Panel(widths)], str(verdict(data)))


EXPERIMENT = Experiment(
    name="recovery",
    headline="Once the drug is washed out cyclosis returns, with its zones in a new place.",
    claim="After the cables have been disorganised and the drug is washed out, cyclosis re-establishes "
    "itself with two equal stripes, and the indifferent zone is found in a new position.",
    source="Introduction (Foissner & Wasteneys 2000, 2007) and Figure 2",
    method="In cells with two stripes bundling is set to zero and all filaments are fragmented at t = 20. "
    "The drug is washed out at t = 40. At t = 400 the zone's shift about the axis is tested for uniformity "
    "(Rayleigh, Kuiper).",
    seeds=256,
    quick_seeds=16,
    measure=measure,
    verdict=verdict,
    decisive=decisive,
    draw=draw,
)
