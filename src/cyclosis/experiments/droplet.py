"""Whether droplets of cytoplasm begin to circulate by themselves: the model on a sphere."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
import numpy.typing as npt
import scipy.stats
import xarray

from .. import closed, models, stability
from ..closed.grid import Array, ClosedGrid
from ..closed.shapes import Sphere
from ..dynamics.simulate import simulate
from ..figures import quantities
from ..figures.story import Panel, reference, story
from ..figures.style import INK, QUIET, UP
from ..models.fields import flow
from . import closed_views
from .droplet_theory import USUAL, Circulation, Sphere1D, least_size, of_size
from .experiment import AGREES, DOES_NOT, IN_PART, Experiment, Verdict
from .lab import Lab
from .statistics import in_words, median_interval, proportion

if TYPE_CHECKING:
    from matplotlib.figure import Figure

# Computed

K_MAX, FINE = 16.0, 24.0
LATE, QUICK_LATE, FRAMES = 100.0, 60.0, 200
FINE_SEEDS, QUICK_FINE_SEEDS = 5, 1
SIZES, QUICK_SIZES = (0.15, 0.2, 0.3, 0.5, 0.75, 1.0, 1.5), (0.15, 0.5, 1.0)
"""Radii of droplets, in the radius R of the cell; parameters are in units of R."""
SIZE_SEEDS, QUICK_SIZE_SEEDS = 3, 1
CURVE = tuple(np.round(np.geomspace(0.1, 4.0, 41), 4))
WAVES = (0, 1, 2, 3, 4)
"""Azimuthal modes whose growth upon steady states is computed."""
SHOWN = (0, 3, 5, 9)
"""Seeds that are drawn."""
CIRCULATES = 1


class End(NamedTuple):
    """How a droplet ends.

    Whether it circulates, order, root mean square and peak speed, its circulation 3/2 <x × u>, its rate of
    change, when order and circulation reached half of what they are in the end, and 3/2 <x × P> of disorder.
    """

    circulates: float
    order: float
    speed: float
    peak: float
    x: float
    y: float
    z: float
    rate: float
    ordered: float
    began: float
    first_x: float
    first_y: float
    first_z: float


def course(size: float, k: float, seed: int, late: float) -> Array:
    """Return the `End` of a droplet from disorder, then order and |circulation| over time."""
    params = of_size(size)
    grid: Any = ClosedGrid(Sphere(), k)
    begin = closed.disordered(grid, filaments_per_square=1000 * size**2, seed=seed)
    run = simulate(params, grid, begin, late, save_every=late / FRAMES, rtol=1e-4, model=models.closed)
    order, around, speed = [], [], np.zeros(grid.shape)
    for P in run.frames:
        u = flow(params, grid, P)
        order.append(float(np.sqrt(grid.mean(np.sum(P**2, axis=0)))))
        around.append(turning(grid, u))
        speed = np.hypot(*u)
    found = models.closed.regime(models.closed.problem(params, grid), run.final_state)  # type: ignore[misc]
    size_of = np.linalg.norm(around, axis=1)
    halves = [since_half(run.times, np.array(values)) for values in (order, size_of)]
    sizes = [order[-1], float(np.sqrt(grid.mean(speed**2))), float(speed.max())]
    vectors = around[-1], turning(grid, begin)
    end = [found.name == "circulation", *sizes, *vectors[0], found.rate, *halves, *vectors[1]]
    return np.concatenate([np.array(end, dtype=np.float64), order, size_of])


def turning(grid: ClosedGrid, field: Array) -> Array:
    """Return 3/2 <x × v> (3,) of a vector field v (2, n_theta, n_s): for a rotation, its angular velocity."""
    in_space = grid.e_theta * field[0] + grid.e_s * field[1]
    return np.asarray(1.5 * grid.mean(np.cross(grid.xyz, in_space, axis=0)))


def since_half(times: npt.ArrayLike, values: Array) -> float:
    """Return when values first reach half of the last, by straight lines between times."""
    at = int(np.argmax(values >= 0.5 * values[-1]))
    if at == 0:
        return float(np.asarray(times)[0])
    two = slice(at - 1, at + 1)
    return float(np.interp(0.5 * values[-1], values[two], np.asarray(times)[two]))


def view(seed: int, late: float) -> Array:
    """Return the picture of a droplet at a time."""
    grid: Any = ClosedGrid(Sphere(), K_MAX)
    begin = closed.disordered(grid, seed=seed)
    run = simulate(USUAL, grid, begin, late, save_every=late, rtol=1e-3, model=models.closed)
    P = run.final_state
    return closed_views.seen(grid, P, flow(USUAL, grid, P), 0.0, upright=True)


def leading(state: str, m: int) -> float:
    """Return the largest growth rate of waves m upon a steady state: "circulation" or "source to sink"."""
    grid = ClosedGrid(Sphere(), FINE)
    if state == "circulation":
        solver = Sphere1D()
        P, _ = solver.steady(USUAL)
        around = solver.modes(P) @ solver.at(grid.z)
        field = np.stack([around * np.ones(grid.shape), np.zeros(grid.shape)])
    else:
        field = stability.source_to_sink(USUAL, grid).P
    return float(stability.azimuthal_rates(USUAL, grid, field, m)[0].real)


def measure(lab: Lab) -> xarray.Dataset:
    """Return how droplets end, over seeds, with a larger k_max, and over their size; and theory."""
    late = QUICK_LATE if lab.quick else LATE
    fine_seeds = QUICK_FINE_SEEDS if lab.quick else FINE_SEEDS
    sizes, size_seeds = (QUICK_SIZES, QUICK_SIZE_SEEDS) if lab.quick else (SIZES, SIZE_SEEDS)
    n = len(End._fields)
    rows = np.array(lab.each("seeds", course, [(1.0, K_MAX, seed, late) for seed in range(lab.seeds)]))
    fine = np.array(lab.each("fine", course, [(1.0, FINE, seed, late) for seed in range(fine_seeds)]))
    items = [
        (size, max(K_MAX, K_MAX * size), seed, late / min(size, 1.0))  # times are in units of the radius
        for size in sizes
        for seed in range(size_seeds)
    ]
    sized = np.array(lab.each("sizes", course, items)).reshape(len(sizes), size_seeds, -1)
    views = np.array(lab.each("views", view, [(seed, late) for seed in SHOWN]))
    states = ("circulation", "source to sink")
    rates = lab.each("growth", leading, [(state, m) for state in states for m in WAVES])
    solver = Sphere1D()
    curve = [(size, *solver.numbers(of_size(float(size)))) for size in CURVE]
    over = rows[:, n:].reshape(lab.seeds, 2, -1)
    return xarray.Dataset(
        {
            "end": (("seed", "number"), rows[:, :n]),
            "over_time": (("seed", "quantity", "time"), over.astype(np.float32)),
            "fine": (("fine_seed", "number"), fine[:, :n]),
            "sized": (("size", "size_seed", "number"), sized[..., :n]),
            "curve": (("curve_size", "theory"), np.array(curve)[:, 1:]),
            "theory": ("theory", np.array(solver.numbers(USUAL))),
            "growth": (("state", "m"), np.reshape(rates, (2, -1))),
            "least_size": least_size(USUAL),
            "picture": (("frame", "field", "across", "up"), views.astype(np.float32)),
        },
        {
            "number": list(End._fields),
            "quantity": ["order", "circulation"],
            "time": np.linspace(0.0, late, FRAMES + 1),
            "size": list(sizes),
            "curve_size": list(CURVE),
            "theory_name": ("theory", list(Circulation._fields)),
            "state": list(states),
            "m": list(WAVES),
            "field": list(closed_views.FIELDS),
        },
    )


# Judged

SURE = 0.05
"""Level of the tests that axes have no preferred direction; there are two."""
ONE = 1e-3
"""Relative spread of order and speed up to which ends are one state."""
SETTLED = 1e-3


def axes(ends: xarray.DataArray, first: bool = False) -> Array:
    """Return the axes of `End`s (seed, number) that circulate, unit vectors (n, 3), to the left about them.

    With `first`, the axes of the disorder that they began with.
    """
    end = ends.values[ends.sel(number="circulates").values == CIRCULATES]
    names = ("first_x", "first_y", "first_z") if first else ("x", "y", "z")
    vector = end[:, [End._fields.index(name) for name in names]]
    return np.asarray(vector / np.linalg.norm(vector, axis=1, keepdims=True))


def remembered(ends: xarray.DataArray) -> Array:
    """Return the angles (n,), in degrees, between axes in the end and those of disorder."""
    both = np.sum(axes(ends) * axes(ends, first=True), axis=1)
    return np.asarray(np.degrees(np.arccos(np.clip(both, -1.0, 1.0))))


def uniform(axis: Array) -> tuple[float, float]:
    """Return p-values that unit vectors (n, 3) have no preferred direction.

    Rayleigh's test on the sphere, 3 n R² against chi squared of 3 degrees, R the length of their mean; and
    that of Kolmogorov and Smirnov that z is uniform (Mardia & Jupp, Directional Statistics, 2000, 10.4).
    """
    n = len(axis)
    mean = float(np.sum(axis.mean(axis=0) ** 2))
    z = scipy.stats.kstest(axis[:, 2], scipy.stats.uniform(-1, 2).cdf)
    return float(scipy.stats.chi2.sf(3 * n * mean, 3)), float(z.pvalue)


def numbers(ends: xarray.DataArray) -> Array:
    """Return order, speed and circulation (3, ...) of `End`s (..., number)."""
    circulation = np.linalg.norm([ends.sel(number=name).values for name in "xyz"], axis=0)
    return np.array([ends.sel(number="order").values, ends.sel(number="speed").values, circulation])


def spread(data: xarray.Dataset) -> float:
    """Return the largest relative difference of order, speed and circulation between seeds."""
    found = numbers(data["end"])
    return float(np.max(np.ptp(found, axis=1) / np.abs(found).mean(axis=1)))


def off_theory(data: xarray.Dataset, which: str) -> float:
    """Return the largest relative difference of order, speed and circulation from theory."""
    found = numbers(data[which])
    return float(np.max(np.abs(found / data["theory"].values[:3, None] - 1)))


def verdict(data: xarray.Dataset) -> Verdict:
    """Judge: droplets begin to circulate, at one steady rate, about an axis that nothing has chosen."""
    end = data["end"]
    around = end.sel(number="circulates").values == CIRCULATES
    share = proportion(int(around.sum()), around.size)
    steady = bool((end.sel(number="rate").values < SETTLED).all())
    order, speed, circulation, peak = (float(x) for x in data["theory"].values)
    rayleigh, flat = uniform(axes(data["end"]))
    began = median_interval(end.sel(number="began").values)
    ordered = median_interval(end.sel(number="ordered").values)
    fine = axes(data["fine"])
    turned = float(abs(axes(data["end"])[: len(fine)] - fine).max())
    angle = median_interval(remembered(end))
    growth = data["growth"]
    still = float(growth.sel(state="circulation").max())
    others = growth.sel(state="source to sink")
    least = float(data["least_size"])
    text = (
        f"{in_words(share)} of {around.size} droplets circulate about an axis in the end, with one order and "
        f"speed within {spread(data):.0e}: order {order:.4f}, speed {speed:.4f} root mean square and "
        f"{peak:.3f} at most, 3/2 <x × u> {circulation:.4f} by theory, met within "
        f"{off_theory(data, 'end'):.0e}, and {off_theory(data, 'fine'):.0e} at k_max {FINE:g}, where the "
        f"same seeds have the same axes within {turned:.0e}. Axes have no preferred direction (Rayleigh "
        f"p = {rayleigh:.2f}, z uniform p = {flat:.2f}), and lie {_time(angle)}° from that of the disorder "
        f"at first. Order is half there at t = {_time(ordered)}, circulation at {_time(began)}. Circulation "
        f"is stable (the largest growth rate is {still:.0e}, that of a turn of the axis, m up to "
        f"{WAVES[-1]}), and filaments from a source to a sink are not: a swirl grows at "
        f"{float(others.sel(m=0)):.3f} and a displaced sink at "
        f"{float(others.sel(m=1)):.3f}. With a cell's properties droplets smaller than {least:.2f} R "
        f"have no order ({_small(data)}), and larger ones circulate, ever faster "
        f"({_sizes(data)})"
    )
    if share[0] < 0.5:
        return Verdict(DOES_NOT, text)
    good = share[0] > 0.95 and steady and spread(data) < ONE and min(rayleigh, flat) > SURE / 2
    return Verdict(AGREES if good else IN_PART, text)


def _time(interval: tuple[float, float, float]) -> str:
    middle, *ends = interval
    return f"{middle:.2f}" + (f" ({ends[0]:.2f} to {ends[1]:.2f})" if np.isfinite(ends[0]) else "")


def _small(data: xarray.Dataset) -> str:
    small = data["sized"].sel(size=data["size"] < data["least_size"], number="order").values
    return f"at most {small.max():.0e} of it at the end in {small.size} smaller droplets"


def _sizes(data: xarray.Dataset) -> str:
    known = data["sized"].sel(size=data["size"] > data["least_size"], number="speed").median("size_seed")
    return ", ".join(f"{float(v):.3f} at {float(x):g} R" for x, v in zip(known["size"], known, strict=True))


def decisive(data: xarray.Dataset) -> str:
    """Return the share of droplets that circulate."""
    around = data["end"].sel(number="circulates").values == CIRCULATES
    return f"{in_words(proportion(int(around.sum()), around.size))} of droplets begin to circulate"


# Drawn


def draw(data: xarray.Dataset) -> Figure:
    """Draw four droplets, how circulation begins, where axes point, and speed over size."""
    shown = [
        closed_views.drawn(f"seed {seed}", picture)
        for seed, picture in zip(SHOWN, data["picture"].values, strict=True)
    ]
    time = data["time"].values

    def begins(ax: Any) -> None:
        for name, colour, label in (("order", QUIET, "order"), ("circulation", UP, "3/2 |<x × u>|")):
            low, middle, high = np.quantile(data["over_time"].sel(quantity=name).values, [0, 0.5, 1], axis=0)
            ax.fill_between(time, low, high, color=colour, alpha=0.3, linewidth=0)
            ax.plot(time, middle, color=colour, linewidth=1.2, label=label)
        ax.set_xlim(0, min(40.0, time[-1]))
        ax.set_ylim(0, 1.2)
        quantities.name(ax.xaxis, "time", "time", labelpad=1.0)
        ax.legend(fontsize=8, frameon=False, loc="lower right", borderpad=0)

    def point(ax: Any) -> None:
        axis = axes(data["end"])
        longitude = np.degrees(np.arctan2(axis[:, 1], axis[:, 0]))
        ax.plot(longitude, axis[:, 2], "o", color=INK, markersize=3.6, clip_on=False)
        ax.set(xlim=(-180, 180), ylim=(-1, 1), xticks=[-180, 0, 180], yticks=[-1, 0, 1])
        ax.set_xlabel("longitude of the axis, degrees", labelpad=1.0)
        ax.set_ylabel("its z component", labelpad=1.0)

    def sizes(ax: Any) -> None:
        for name, colour in (("order", QUIET), ("speed", UP)):
            index = Circulation._fields.index(name)
            ax.plot(
                data["curve_size"], data["curve"].values[:, index], color=colour, linewidth=1.2, label=name
            )
            for k in range(data.sizes["size_seed"]):
                ends = data["sized"].isel(size_seed=k).sel(number=name)
                ax.plot(data["size"], ends, "o", color=colour, markersize=3.2)
        reference(ax, float(data["least_size"]), f"{float(data['least_size']):.2f}", upright=True)
        ax.set_xscale("log")
        ax.set(ylim=(-0.03, 1.05), xticks=[0.1, 0.3, 1.0, 3.0], xticklabels=["0.1", "0.3", "1", "3"])
        ax.minorticks_off()
        quantities.name(ax.xaxis, "radius", "length", "R", labelpad=1.0)
        ax.legend(fontsize=8, frameon=False, loc="lower right", borderpad=0)

    return story(shown, [Panel(begins), Panel(point), Panel(sizes)], str(verdict(data)))


EXPERIMENT = Experiment(
    name="droplet",
    headline="Droplets of cytoplasm begin to circulate by themselves.",
    claim="Cytoplasmic droplets forcibly extracted from Chara cells can begin spontaneously circulating at a "
    "steady rate, likely because they organise themselves.",
    source="Introduction (Yotsuyanagi 1953; Kamiya 1959; Woodhouse & Goldstein 2012)",
    method="The model is integrated from disorder to t = 100 on a sphere of the cell's radius R, at Figure "
    "4's parameters. There is no repulsion by curvature there. Steady circulation is also found by Newton's "
    "method in one dimension, and the growth of perturbations of it, and of filaments from a source to a "
    "sink, by linearising. Three droplets each of 0.15 to 1.5 R have the same properties in physical units. "
    "Droplets do as claimed if more than 95 % circulate, all are steady, order and speed differ by less than "
    "0.001, and the axes pass two tests for a preferred direction.",
    seeds=40,
    quick_seeds=4,
    measure=measure,
    verdict=verdict,
    decisive=decisive,
    draw=draw,
)
