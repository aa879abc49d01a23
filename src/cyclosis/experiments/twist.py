"""The helical twist of the streaming pattern: whether a tilted direction of repulsion produces it."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray

from ..analysis.diagnostics import diagnose
from ..analysis.zones import indifferent_zones
from ..dynamics.simulate import simulate
from ..figures import quantities
from ..figures.story import Cell, Panel, interval, story
from ..figures.style import DOWN, INK, LEGEND, QUIET, UP
from ..model import initial
from ..model.grid import Array, CylinderGrid, interpolate
from ..model.parameters import Parameters
from ..model.system import flow
from ..stability import cyclosis, steady_state
from .experiment import AGREES, DOES_NOT, IN_PART, Experiment, Verdict
from .lab import Lab
from .statistics import in_words, median_interval, proportion

if TYPE_CHECKING:
    from matplotlib.figure import Figure

# Computed


def wound(grid: CylinderGrid, turns: int, magnitude: float = 0.8) -> Array:
    """Return two stripes that wind about the axis `turns` times to the left, with filaments along them."""
    angle = np.arctan(2 * np.pi * turns / grid.length)
    phase = grid.theta[:, None] + 2 * np.pi * turns * grid.z[None, :] / grid.length
    return magnitude * np.stack([-np.sin(angle) * np.sin(phase), np.cos(angle) * np.sin(phase)])


def winding(zones: Iterable[tuple[int, int]]) -> float:
    """Return how often two zones wind to the left along the cell, from their windings.

    NaN unless there are just two, with the same winding, that run along the cell. Closed loops do not count.
    """
    open_ones = [turns for turns in zones if turns != (0, 0)]
    if len(open_ones) != 2 or any(abs(along) != 1 for _, along in open_ones):
        return float("nan")
    first, second = (-around * along for around, along in open_ones)
    return float(first) if first == second else float("nan")


def filament_tilt(P: Array) -> float:
    """Return the angle to the left of the axis, in radians, of the principal direction of P (2, ...)."""
    across, along, mixed = np.mean(P[0] ** 2), np.mean(P[1] ** 2), np.mean(P[0] * P[1])
    return float(0.5 * np.arctan2(-2 * mixed, along - across))


def leaning(tilt: float) -> float:
    """Return the theoretical tilt of the filaments in the steady state with straight zones."""
    grid = CylinderGrid(48, 8, 5.0)
    return filament_tilt(steady_state(Parameters(repulsion_angle=tilt), grid, wound(grid, 0)).state)


def speed_along(tilt: float) -> float:
    """Return the theoretical peak speed of stripes along the easy direction of a tilted d.

    They are those of d = e_theta on a circumference of 2π cos(tilt), the length of a cut at right angles to
    them; lengths in d_s and μ are therefore measured in units of cos(tilt).
    """
    narrower, params = np.cos(tilt) ** 2, Parameters()
    params = params.replace(d_s=params.d_s / narrower, mu=params.mu / narrower)
    return float(np.abs(cyclosis(params).u).max())


TILT = 0.4
"""Angle of d from the circumference, in radians, of cells of several lengths."""
PITCH = float(2 * np.pi / np.tan(TILT))
"""Length over which stripes along the easy direction, at right angles to that d, wind just once."""
LENGTHS = {5.0: 48, 10.0: 96, PITCH: 128}
"""Lengths of cells, and points along them, with nearly the same spacing."""
TILTS = (0.2, 0.3, TILT)
"""Tilts of d in cells of the paper's length."""
HELICES = (0.2, 0.3, 0.4, 0.5, 0.6)
END = 250.0
TIMES = (10.0, 30.0, END)
LIKELY = 0.05
"""Share of cells above which a twist counts as produced by the model."""
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
    # Newton's method on the whole cell would take longest in the quick form.
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
    """Return the same for a prepared helix along the easy direction, with noise, in a cell of one pitch.

    It winds once along the cell, so that it needs as many points along the cell as around it.
    """
    params = Parameters(repulsion_angle=tilt)
    grid = CylinderGrid(48, 48, float(2 * np.pi / np.tan(tilt)))
    state = initial.with_noise(wound(grid, 1), grid, filaments_per_square=4000, seed=1)
    run = simulate(params, grid, state, 2 * END, save_at=(2 * END,), rtol=1e-3)
    return _numbers(params, grid, run.final_state)


def _numbers(params: Parameters, grid: CylinderGrid, P: Array) -> tuple[float, float, float]:
    speed = float(diagnose(params, grid, P)["peak_speed"])
    return winding(zone.winding for zone in indifferent_zones(grid, P)), filament_tilt(P), speed


# Judged


def verdict(data: xarray.Dataset) -> Verdict:
    """Judge: twist may be left out if no cell produces it; in part if only cells longer than usual do."""
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


def decisive(data: xarray.Dataset) -> str:
    """Return the largest share of cells that become helical."""
    tilted = np.asarray(data["tilt"].values) == TILT
    helical, length = (data["winding"].values > 0)[tilted], data["cell_length"].values[tilted]
    most = int(np.argmax(helical.mean(axis=1)))
    share = proportion(int(helical[most].sum()), helical[most].size)
    return f"{in_words(share)} of cells of length {length[most]:.3g} become helical"


# Drawn


def draw(data: xarray.Dataset) -> Figure:
    """Draw a short and a long cell, how often zones wind, how far filaments tilt, and speeds."""
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
        quantities.name(ax.yaxis, "peak speed", "speed", labelpad=1.0)
        ax.legend(**(LEGEND | {"markerscale": 1.2, "fontsize": 8.5, "columnspacing": 0.6}))

    P, u = (np.asarray(data[name].values, dtype=np.float64) for name in ("P", "u"))
    times, across = data["frame_time"].values, data["shown_length"].values
    shown = [
        Cell(f"length {across[k]:.3g}, {quantities.when(times[k])}", P[k], u[k], float(across[k]))
        for k in range(times.size)
    ]
    return story(shown, [Panel(lengths), Panel(tilts), Panel(speeds)], str(verdict(data)), same_view=False)


def _middle(values: Array) -> tuple[float, float, float]:
    """Return the median of values and its interval, of zero length where there are too few values."""
    middle, low, high = median_interval(values[np.isfinite(values)])
    return (middle, low, high) if np.isfinite(low) and np.isfinite(high) else (middle, middle, middle)


EXPERIMENT = Experiment(
    name="twist",
    headline="The pattern's helical twist can be left out of the model.",
    claim="The pattern's helical twist can be left out of the model: young cells show none, and it comes "
    "later, by twisting growth.",
    source="Model, and Figure 1",
    method="d is tilted from the circumference by up to 0.4, and cells of 5 to 15 radii grow from disorder "
    "to t = 250. Measured are how often zones wind about the axis and how far filaments lean. Helices of "
    "one pitch are prepared and disturbed, and their speed is compared with theory.",
    seeds=200,
    quick_seeds=4,
    measure=measure,
    verdict=verdict,
    decisive=decisive,
    draw=draw,
)
