"""The helical twist of the streaming pattern: whether a tilted repulsive direction makes it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import xarray

from ..analysis.diagnostics import diagnose
from ..analysis.zones import indifferent_zones
from ..dynamics.simulate import simulate
from ..figures.story import Cell, Panel, interval, story
from ..figures.style import DOWN, INK, LEGEND, QUIET, UP
from ..model import initial
from ..model.grid import Array, CylinderGrid, interpolate
from ..model.parameters import Parameters
from ..model.system import flow
from .experiment import AGREES, DOES_NOT, IN_PART, Experiment, Verdict
from .helices import filament_tilt, leaning, speed_along, winding, wound
from .lab import Lab
from .statistics import in_words, median_interval, proportion

if TYPE_CHECKING:
    from matplotlib.figure import Figure

TILT = 0.4
"""Angle of d from the circumference, in radians, of cells of several lengths."""
PITCH = float(2 * np.pi / np.tan(TILT))
"""Length on which stripes along the easy direction, at right angles to that d, go round just once."""
LENGTHS = {5.0: 48, 10.0: 96, PITCH: 128}
"""Lengths of cells, and points along them: as fine in all."""
TILTS = (0.2, 0.3, TILT)
"""Tilts of d in cells of the paper's length."""
HELICES = (0.2, 0.3, 0.4, 0.5, 0.6)
END = 250.0
TIMES = (10.0, 30.0, END)
LIKELY = 0.05
"""Share of cells from which on a twist counts as one that the model makes."""
WINDING, FILAMENTS, SPEED = range(3)


def measure(lab: Lab) -> xarray.Dataset:
    """Return how often zones wind, how far filaments tilt, and prepared helices; and frames of two cells."""
    tilts = (TILT,) if lab.quick else TILTS
    lengths = dict(list(LENGTHS.items())[:2]) if lab.quick else LENGTHS
    longest = max(lengths)
    cases = [(tilt, 5.0) for tilt in tilts if tilt != TILT] + [(TILT, length) for length in lengths]
    # The control: no tilt, in the longest cell.
    cases.append((0.0, longest))
    items = [(tilt, length, seed) for tilt, length in cases for seed in range(lab.seeds)]
    grown = np.array(lab.each("grown", grow, items)).reshape(len(cases), lab.seeds, 3)
    helices = HELICES[2:3] if lab.quick else HELICES
    prepared = np.array(lab.each("helices", helix, [(tilt,) for tilt in helices]))
    found = xarray.Dataset(
        {
            "tilt": ("case", [tilt for tilt, _ in cases]),
            "cell_length": ("case", [length for _, length in cases]),
            "winding": (("case", "seed"), grown[..., WINDING]),
            "filaments": (("case", "seed"), grown[..., FILAMENTS]),
            "peak_speed": (("case", "seed"), grown[..., SPEED]),
            "helix_tilt": ("helix", np.array(helices)),
            "helix_winding": ("helix", prepared[:, WINDING]),
            "helix_filaments": ("helix", prepared[:, FILAMENTS]),
            "helix_speed": ("helix", prepared[:, SPEED]),
            "helix_theory": ("helix", [speed_along(tilt) for tilt in helices]),
        }
    )
    of_pitch = np.flatnonzero((found["tilt"].values == TILT) & (found["cell_length"].values == longest))[0]
    helical = np.flatnonzero(found["winding"].values[of_pitch] == 1)
    seed = int(helical[0]) if helical.size else 0
    short, long = lab.each("frames", pictures, [(5.0, 0, (END,)), (longest, seed, TIMES)])
    found["lean_tilt"] = "lean", list(tilts)
    # Newton's method on the whole cell is what takes longest in the quick form.
    found["lean_theory"] = "lean", [np.nan if lab.quick else leaning(tilt) for tilt in tilts]
    dims = ("frame", "component", "theta", "z")
    for k, name in enumerate(("P", "u")):
        found[name] = dims, np.concatenate([short[k], long[k]]).astype(np.float32)
    found["shown_length"] = "frame", [5.0] + [longest] * len(TIMES)
    return found.assign_coords(frame_time=("frame", [END, *TIMES]))


def pictures(length: float, seed: int, times: tuple[float, ...]) -> tuple[Array, Array]:
    """Return P and u, (times, 2, 48, 48) each, of a cell with tilted d at some times."""
    params, grid = Parameters(repulsion_angle=TILT), CylinderGrid(48, LENGTHS[length], length)
    state = initial.disordered(grid, seed=seed)
    run = simulate(params, grid, state, END, save_at=times, rtol=1e-3)
    small = grid.resized(48, 48)
    P = np.stack([interpolate(one, small.shape) for one in list(run.frames)[-len(times) :]])
    return P, np.stack([flow(params, small, one) for one in P])


def grow(tilt: float, length: float, seed: int) -> tuple[float, float, float]:
    """Return winding of the zones, tilt of the filaments and peak speed of a cell grown from disorder."""
    params, grid = Parameters(repulsion_angle=tilt), CylinderGrid(48, LENGTHS[length], length)
    state = initial.disordered(grid, seed=seed)
    run = simulate(params, grid, state, END, save_at=(END,), rtol=1e-3)
    return _numbers(params, grid, run.final_state)


def helix(tilt: float) -> tuple[float, float, float]:
    """Return the same of a prepared helix along the easy direction, with noise, in a cell of one pitch.

    It turns once along the cell, so that as many points resolve it along the cell as around it.
    """
    params = Parameters(repulsion_angle=tilt)
    grid = CylinderGrid(48, 48, float(2 * np.pi / np.tan(tilt)))
    state = initial.with_noise(wound(grid, 1), grid, filaments_per_square=4000, seed=1)
    run = simulate(params, grid, state, 2 * END, save_at=(2 * END,), rtol=1e-3)
    return _numbers(params, grid, run.final_state)


def _numbers(params: Parameters, grid: CylinderGrid, P: Array) -> tuple[float, float, float]:
    speed = float(diagnose(params, grid, P)["peak_speed"])
    return winding(zone.winding for zone in indifferent_zones(grid, P)), filament_tilt(P), speed


def verdict(data: xarray.Dataset) -> Verdict:
    """Judge: twist may be left out if no cell makes it; in part if only longer cells than the paper's do."""
    tilt, length, turns = (data[name].values for name in ("tilt", "cell_length", "winding"))
    helical = np.array([proportion(int(np.sum(row > 0)), row.size) for row in turns])
    tilted, paper = tilt > 0, (tilt > 0) & (length == 5)
    wanted = length * np.tan(tilt) / (2 * np.pi)
    words = ", ".join(
        f"{in_words((helical[k, 0], helical[k, 1], helical[k, 2]))} of cells of length {length[k]:.3g} "
        f"({wanted[k]:.2f} turns wanted)"
        for k in np.flatnonzero(tilt == TILT)
    )
    lean = [float(np.nanmedian(data["filaments"].values[k])) / tilt[k] for k in np.flatnonzero(paper)]
    expected = data["lean_theory"].values / data["lean_tilt"].values
    foreseen = f" (straight zones at rest: {np.mean(expected):.3f})" if np.isfinite(expected).all() else ""
    control = in_words(proportion(int(np.sum(np.abs(turns[~tilted]) > 0)), turns[~tilted].size))
    kept = data["helix_winding"].values == 1
    off = float(np.abs(data["helix_speed"].values / data["helix_theory"].values - 1).max())
    text = (
        f"with d tilted by {TILT:g} zones wind about the axis in {words}, and without tilt, either way, in "
        f"{control} of the longest; at length 5 filaments lean by {min(lean):.3f} to {max(lean):.3f} of the "
        f"tilt{foreseen}; of {kept.size} prepared helices of one pitch {int(kept.sum())} persist, at speeds "
        f"within {100 * off:.2g} % of theory"
    )
    if helical[paper, 0].max() > LIKELY:
        return Verdict(DOES_NOT, text)
    far = helical[tilted & ~paper, 0].max(initial=0.0) > LIKELY or kept.any()
    return Verdict(IN_PART if far else AGREES, text)


def draw(data: xarray.Dataset) -> Figure:
    """Draw a short and a long cell, how often zones wind, how far they and filaments tilt, and speeds."""
    tilt, length, turns = (data[name].values for name in ("tilt", "cell_length", "winding"))

    def lengths(ax: Any) -> None:
        at = np.flatnonzero(tilt == TILT)
        kinds = ((turns == 0, DOWN, "straight"), (turns > 0, UP, "helical"), (np.isnan(turns), INK, "else"))
        for chosen, colour, label in kinds:
            values = 100 * np.array([proportion(int(chosen[k].sum()), chosen.shape[1]) for k in at])
            interval(ax, length[at], values[:, 0], values[:, 1], values[:, 2], colour, label)
        ax.set_ylim(-4, 104)
        ax.set_xticks(length[at], [f"{value:.3g}" for value in length[at]])
        ax.set_xlabel(f"length, $d$ tilted by {TILT:g}", labelpad=1.0)
        ax.set_ylabel("cells, %", labelpad=1.0)
        ax.legend(**(LEGEND | {"markerscale": 1.2, "fontsize": 8.5, "columnspacing": 0.6}))

    def tilts(ax: Any) -> None:
        line = np.array([0.0, 0.65])
        ax.plot(line, line, color=QUIET, linewidth=0.9, linestyle=(0, (4, 2)), zorder=0, label="$d$")
        at = np.flatnonzero((tilt > 0) & (length == 5))
        at = at[np.argsort(tilt[at])]
        middle, low, high = np.array([_middle(data["filaments"].values[k]) for k in at]).T
        interval(ax, tilt[at], middle, low, high, UP, "length 5")
        ax.plot(data["lean_tilt"], data["lean_theory"], color=QUIET, linewidth=0.9, linestyle=":", zorder=0)
        ax.plot(data["helix_tilt"], data["helix_filaments"], "D", color=DOWN, markersize=3.4, label="helix")
        ax.set_xlabel("tilt of $d$", labelpad=1.0)
        ax.set_ylabel("tilt of filaments", labelpad=1.0)
        ax.legend(**(LEGEND | {"markerscale": 1.2, "fontsize": 8.5, "columnspacing": 0.6}))

    def speeds(ax: Any) -> None:
        line = np.linspace(0, 0.65, 14)
        curve = [speed_along(float(one)) for one in line]
        ax.plot(line, curve, color=QUIET, linewidth=0.9, linestyle=(0, (4, 2)), label="theory")
        ax.plot(data["helix_tilt"], data["helix_speed"], "D", color=DOWN, markersize=3.4, label="helix")
        at = np.flatnonzero((tilt > 0) & (length == 5))
        at = at[np.argsort(tilt[at])]
        middle, low, high = np.array([_middle(data["peak_speed"].values[k]) for k in at]).T
        interval(ax, tilt[at], middle, low, high, UP, "length 5")
        ax.set_xlabel("tilt of $d$", labelpad=1.0)
        ax.set_ylabel("peak speed", labelpad=1.0)
        ax.legend(**(LEGEND | {"markerscale": 1.2, "fontsize": 8.5, "columnspacing": 0.6}))

    P, u = (np.asarray(data[name].values, dtype=np.float64) for name in ("P", "u"))
    times, across = data["frame_time"].values, data["shown_length"].values
    shown = [
        Cell(f"length {across[k]:.3g}, $t$ = {times[k]:g}", P[k], u[k], float(across[k]))
        for k in range(times.size)
    ]
    return story(shown, [Panel(lengths), Panel(tilts), Panel(speeds)], str(verdict(data)), same_view=False)


def _middle(values: Array) -> tuple[float, float, float]:
    """Return the median of values and its interval, of no length where there are too few for one."""
    middle, low, high = median_interval(values[np.isfinite(values)])
    return (middle, low, high) if np.isfinite(low) and np.isfinite(high) else (middle, middle, middle)


EXPERIMENT = Experiment(
    name="twist",
    claim="The pattern's helical twist can be left out of the model: young cells show none, and it comes "
    "later, by twisting growth.",
    source="Model, and Figure 1",
    method="d is tilted from the circumference by up to 0.4, cells of 5 to 15 radii grow from disorder to "
    "t = 250, and it is counted how often zones wind about the axis and measured how far filaments lean. "
    "Helices of one pitch are prepared, disturbed, and their speed set against theory.",
    seeds=200,
    quick_seeds=4,
    measure=measure,
    verdict=verdict,
    draw=draw,
)
