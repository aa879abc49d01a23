"""Filaments that lose or change their preferred direction turn around the axis, in all or part of a cell."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import xarray

from ..analysis.regimes import DOMINANT, REGIMES
from ..dynamics.protocol import Protocol, change
from ..dynamics.simulate import simulate
from ..dynamics.trajectory import Trajectory
from ..figures import quantities
from ..figures.story import Panel, cells, interval, reference, story
from ..figures.style import DOWN, INK, LEGEND, UP
from ..model import initial, regions
from ..model.grid import Array, CylinderGrid
from ..model.parameters import Parameters
from ..stability import orders, tilt_threshold
from .experiment import AGREES, DOES_NOT, IN_PART, Experiment, Verdict
from .lab import Lab, frames
from .statistics import in_words, proportion

if TYPE_CHECKING:
    from matplotlib.figure import Figure

# Computed

TREATMENTS = {"lost": {"kappa": 0.0}, "turned": {"repulsion_angle": 0.5 * np.pi}}
"""What happens to the cue: no direction is avoided any more, or the direction along the cell is."""
NOISE = 4000.0
TREATED, END = 20.0, 150.0
"""Times at which a band of an established cell is treated, and the run ends."""
BETWEEN, SMALL = (2.0, 12.0), 1e-4
"""Times between which a small tilt is timed, and its size."""
GRID = CylinderGrid(48, 48, 5.0)


def cell(treatment: str, length: float, times: tuple[float, ...]) -> xarray.Dataset:
    """Return the frames at some times of a cell in which a band of a length is treated."""
    return frames(treated(treatment, length, 1, times), times)


def band(treatment: str, length: float, seed: int) -> tuple[float, float]:
    """Return the share of order that runs around the axis in a treated band of a length, and outside it."""
    mask = where(length).mask(GRID)
    last = treated(treatment, length, seed, (END,)).frames[-1]
    return around(last, mask), around(last, ~mask)


def where(length: float) -> regions.Region:
    """Return the band of a length in the middle of the cell."""
    return regions.band("z", 0.5 * (GRID.length - length), 0.5 * (GRID.length + length))


def treated(treatment: str, length: float, seed: int, times: tuple[float, ...]) -> Trajectory:
    """Return the run of an established cell in which a band is treated."""
    protocol = Protocol(change(at=TREATED, where=where(length), **TREATMENTS[treatment]))
    start = initial.with_noise(initial.stripes(GRID), GRID, NOISE, seed)
    return simulate(Parameters(), GRID, start, END, save_at=times, protocol=protocol, rtol=1e-3)


def around(state: Array, mask: regions.Mask) -> float:
    """Return the share of <|P|²> in P_theta of a state (2, n_theta, n_z) where a mask is true."""
    square = state[:, mask] ** 2
    return float(square[0].sum() / square.sum())


def tilt_growth(alpha_u: float) -> float:
    """Return the growth rate of a small uniform tilt of unidirectional order."""
    params = Parameters(alpha_u=alpha_u)
    grid = CylinderGrid(8, 8, 5.0)
    state = initial.unidirectional(grid, orders(params, "unidirectional")[0])
    state[0] = SMALL
    run = simulate(params, grid, state, BETWEEN[1], save_at=BETWEEN, rtol=1e-8)
    first, last = (float(run.frames[k][0].mean()) for k in (-2, -1))
    return float(np.log(last / first) / (BETWEEN[1] - BETWEEN[0]))


NAMES = {"lost": "cue lost, κ = 0", "turned": "cue turned, d = e$_z$"}
COLOURS = {"lost": UP, "turned": DOWN}
NOISY = {"magnitude": 0.9, "filaments_per_square": NOISE}
STARTS = {"established": {"kind": "stripes"} | NOISY, "disorder": {"kind": "disordered"}}
LATE = 400.0
"""Time at which a run stops if its end is not certain by then."""

TIMES = (TREATED - 1, TREATED + 35, END)
HALF = 2.5
"""Length of the band, half of the cell's, in which probabilities are measured."""
LENGTHS, QUICK_LENGTHS = (0.5, 1.0, 1.5, 2.0, 2.5, 3.25, 4.0, 4.5), (1.0, 2.5)
BAND_SEEDS = 3
"""Seeds of bands of other lengths; they differ in the third digit."""

TIPPED, TIPPED_LATE = (0.45, 0.8), 300.0
"""Values of alpha_u on either side of the tilt threshold of unidirectional order, and when runs there end."""
GROWING = (0.2, 0.35, 0.45, 0.55, 0.65, 0.8)
"""Values of alpha_u at which a small tilt is timed."""


def measure(lab: Lab) -> xarray.Dataset:
    """Return how cells end by treatment and start, bands, tilts, and the frames of three cells."""
    found = _cells(lab)
    run = {"t_end": LATE, "finish": "certified", "rtol": 1e-3}
    regime, mean = [], []
    for treatment, values in TREATMENTS.items():
        axes = {name: {"values": [value]} for name, value in values.items()}
        for start, table in STARTS.items():
            swept = lab.sweep(f"{treatment}-{start}", {"initial": table, "axes": axes, "run": run})
            swept = swept.isel(dict.fromkeys(axes, 0))
            regime.append(np.asarray(swept["regime"].values))
            mean.append(np.asarray(swept["mean_P"].sel(component="theta").values))
    shape, dims = (len(TREATMENTS), len(STARTS), lab.seeds), ("treatment", "start", "seed")
    found["regime"] = dims, np.reshape(regime, shape)
    found["mean_P_theta"] = dims, np.reshape(mean, shape).astype(np.float32)
    items = [(treatment, HALF, seed) for treatment in TREATMENTS for seed in range(lab.seeds)]
    half = np.reshape(lab.each("half", band, items), (len(TREATMENTS), lab.seeds, 2))
    found["half_around"] = ("treatment", "seed", "where"), half.astype(np.float32)
    lengths, seeds = (QUICK_LENGTHS, 1) if lab.quick else (LENGTHS, BAND_SEEDS)
    items = [(name, length, seed) for name in TREATMENTS for length in lengths for seed in range(seeds)]
    bands = np.reshape(lab.each("bands", band, items), (len(TREATMENTS), len(lengths), seeds, 2))
    found["around"] = ("treatment", "length", "band_seed", "where"), bands
    tipped = lab.sweep(
        "tipped",
        {
            "initial": {"kind": "unidirectional"} | NOISY,
            "axes": {"alpha_u": {"values": list(TIPPED)}},
            "run": run | {"t_end": TIPPED_LATE},
        },
    )
    found["tipped_regime"] = ("alpha_u", "seed"), np.asarray(tipped["regime"].values)
    found["growth"] = "growing_alpha_u", lab.each("tilts", tilt_growth, [(value,) for value in GROWING])
    usual = Parameters()
    found["theory_order"] = orders(usual.replace(kappa=0.0), "circumferential")[0]
    found["theory_slope"] = orders(usual, "unidirectional")[0] ** 2
    found["theory_tilt"] = tilt_threshold(usual)
    return found.assign_coords(
        treatment=list(TREATMENTS),
        start=list(STARTS),
        where=["inside", "outside"],
        length=list(lengths),
        alpha_u=list(TIPPED),
        growing_alpha_u=list(GROWING),
    )


def _cells(lab: Lab) -> xarray.Dataset:
    """Return the frames of a cell that loses its cue, and of two in which a band is treated."""
    shown = [("lost", GRID.length, TIMES), ("lost", HALF, (END,)), ("turned", HALF, (END,))]
    found = lab.each("cells", cell, shown)
    return xarray.concat(found, "frame", combine_attrs="override", data_vars="minimal")


def turned(data: xarray.Dataset, treatment: str, start: str) -> tuple[float, float, float]:
    """Return the share of cells, with its interval, that stream around the axis in one direction."""
    at = data.sel(treatment=treatment, start=start)
    round_it = np.asarray(at["regime"].values) == REGIMES.index("circumferential")
    one_way = round_it & (np.abs(np.asarray(at["mean_P_theta"].values)) > 0.5)
    return proportion(int(one_way.sum()), one_way.size)


def turned_band(data: xarray.Dataset, treatment: str) -> tuple[float, float, float]:
    """Return the share of cells, with its interval, whose treated half has order around the axis."""
    inside = _half(data, treatment)
    return proportion(int((inside >= DOMINANT).sum()), inside.size)


def _half(data: xarray.Dataset, treatment: str) -> Array:
    found: Array = np.asarray(data["half_around"].sel(treatment=treatment, where="inside").values)
    return found


# Judged


def verdict(data: xarray.Dataset) -> Verdict:
    """Judge: cables turn around the axis where the cue is lost or turned, in whole cells and in a half."""
    whole = {name: [turned(data, name, start) for start in STARTS] for name in TREATMENTS}
    half = {name: turned_band(data, name) for name in TREATMENTS}
    inside = {name: 100 * np.median(_half(data, name)) for name in TREATMENTS}
    mean = float(np.median(np.abs(data["mean_P_theta"].sel(treatment="lost").values)))
    tipped = np.asarray(data["tipped_regime"].values)[-1]
    ends = [
        proportion(int((tipped == REGIMES.index(name)).sum()), tipped.size)
        for name in ("circumferential", "cyclosis")
    ]
    held = half["lost"][2] < 0.5 < half["turned"][1]
    neighbours = ": where a part lacks the cue its neighbours hold its cables, it needs a cue of its own"
    text = (
        f"with κ = 0 established cells come to stream around the axis in {in_words(whole['lost'][0])} of "
        f"{data.sizes['seed']}, disordered ones in {in_words(whole['lost'][1])} (|<P_θ>| = {mean:.4f}, "
        f"theory {float(data['theory_order']):.4f}), with d turned in {in_words(whole['turned'][0])} and "
        f"{in_words(whole['turned'][1])}. Half a cell treated alone turns around (80 % of its order) in "
        f"{in_words(half['turned'])} with d turned, {inside['turned']:.0f} % of the order, "
        f"{'but' if half['lost'][2] < 0.5 else 'and'} in {in_words(half['lost'])} with κ = 0, "
        f"{inside['lost']:.0f} %{neighbours if held else ''}. "
        f"Unidirectional order tips from α_u = {onset(data):.4f} on (theory "
        f"{float(data['theory_tilt']):.4f}), at {TIPPED[-1]:g} into cyclosis in {in_words(ends[1])}, around "
        f"the axis in {in_words(ends[0])}"
    )
    if whole["lost"][0][2] < 0.5 and whole["turned"][0][2] < 0.5:
        return Verdict(DOES_NOT, text)
    shares = [share for both in whole.values() for share in both] + list(half.values())
    return Verdict(AGREES if all(share[1] > 0.5 for share in shares) else IN_PART, text)


def decisive(data: xarray.Dataset) -> str:
    """Return the share of cells in which half a cell that has lost the cue turns."""
    return f"{in_words(turned_band(data, 'lost'))} of half cells turn when the cue is lost there"


def onset(data: xarray.Dataset) -> float:
    """Return the alpha_u at which the growth rate of a tilt, on a straight line, is zero."""
    slope, start = np.polyfit(data["growing_alpha_u"].values, data["growth"].values, 1)
    return float(-start / slope)


# Drawn


def draw(data: xarray.Dataset) -> Figure:
    """Draw three cells, the shares of cells that turn, how a band depends on its length, and the tilt."""
    titles = (
        "before",
        f"κ = 0, {TIMES[1] - TREATED:g} later",
        "κ = 0, late",
        "κ = 0 in a half",
        "d turned in a half",
    )

    def shares(ax: Any) -> None:
        row = 0
        for name in TREATMENTS:
            rows = [(start, turned(data, name, start)) for start in STARTS]
            for text, share in [*rows, ("half of a cell", turned_band(data, name))]:
                value, low, high = (100 * x for x in share)
                ax.hlines(row, low, high, color=COLOURS[name], linewidth=1.4)
                ax.plot(value, row, "o", color=COLOURS[name], markersize=4, clip_on=False)
                side = "right" if value > 50 else "left"
                ax.text(value, row - 0.22, text, fontsize=8, ha=side, va="bottom", color=COLOURS[name])
                row += 1
        ax.set_ylim(5.4, -0.8)
        ax.set_xlim(-3, 103)
        ax.set_yticks([])
        ax.spines["left"].set_visible(False)
        ax.set_xlabel("cells that turn around the axis, %", labelpad=1.0)

    def lengths(ax: Any) -> None:
        x = np.asarray(data["length"].values)
        for name in TREATMENTS:
            for side, style in (("inside", "-"), ("outside", ":")):
                each = 100 * np.asarray(data["around"].sel(treatment=name, where=side).values)
                middle, low, high = np.median(each, axis=1), each.min(axis=1), each.max(axis=1)
                interval(ax, x, middle, low, high, COLOURS[name], NAMES[name] if side == "inside" else "")
                ax.lines[-1].set_linestyle(style)
                ax.lines[-1].set_markerfacecolor("white" if side == "outside" else COLOURS[name])
                ax.lines[-1].set_markeredgewidth(0.8)
        reference(ax, 100 * DOMINANT, "", upright=False)
        ax.set_ylim(-3, 103)
        ax.set_xlim(0, 5)
        quantities.name(ax.xaxis, "length of the treated band", "length", "radii", labelpad=1.0)
        ax.set_ylabel("order around the axis, %", labelpad=1.0)
        ax.legend(**LEGEND | {"fontsize": 8.0, "markerscale": 1.0})

    def tilt(ax: Any) -> None:
        x = np.array([0.15, 0.85])
        theory = float(data["theory_tilt"])
        ax.plot(x, float(data["theory_slope"]) * (x - theory), color=INK, linewidth=0.8)
        ax.plot(data["growing_alpha_u"], data["growth"], "o", color=INK, markersize=3.6)
        ax.axhline(0.0, color=INK, linewidth=0.5)
        reference(ax, theory, f"κ/P$_0^2$ = {theory:.3f}", upright=True)
        ax.set_xlim(*x)
        ax.set_xlabel("$α_u$", labelpad=1.0)
        quantities.name(ax.yaxis, "growth rate of a tilt", "rate", labelpad=1.0)

    return story(cells(data, titles), [Panel(shares), Panel(lengths), Panel(tilt)], str(verdict(data)))


EXPERIMENT = Experiment(
    name="circumferential",
    headline="Cables whose cue is lost or turned run around the axis, also in parts of a cell.",
    claim="Cables that have lost the cue for their direction, or are given another, turn from the length of "
    "the cell to its circumference and run around the axis, in whole cells (Vallisneria) and "
    "in parts (Lilium).",
    source="Discussion (Masuda et al. 1991, Foissner et al. 2002) and Figure S4",
    method="In established and in disordered cells κ is set to 0, or d is turned from e_θ to e_z at κ = "
    "0.5, and each is integrated until its end is certain. In established cells the same is done to a band, "
    "and order around the axis is measured inside and outside. The growth of a small tilt of unidirectional "
    "order is timed.",
    seeds=200,
    quick_seeds=5,
    measure=measure,
    verdict=verdict,
    decisive=decisive,
    draw=draw,
)
