"""Local damage heals gradually to the former pattern; and what happens if bundling is inhibited."""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt
import scipy.integrate
import xarray

from ..analysis.zones import DISORDER, crossings
from ..dynamics.protocol import Protocol, Step, change, fragment
from ..dynamics.simulate import simulate
from ..dynamics.trajectory import Trajectory
from ..figures import quantities
from ..figures.frames import facing_zone
from ..figures.story import Panel, cells, interval, reference, story
from ..figures.style import DOWN, INK, UP
from ..model import initial, regions
from ..model.grid import Array, CylinderGrid
from ..model.parameters import Parameters
from ..model.regions import Mask
from ..model.system import flow
from .experiment import AGREES, DOES_NOT, IN_PART, Experiment, Verdict
from .lab import Lab, frames
from .recovery import rising
from .statistics import in_words, median_interval, proportion
from .survivors import wrapped

if TYPE_CHECKING:
    from matplotlib.figure import Figure

# Computed

GRID = CylinderGrid(48, 48, 5.0)
MIDDLE = 0.5 * GRID.length
SETTLING, BEGIN = 20.0, 1.0
"""Time for which stripes relax beforehand, and the time at which the cell is wounded."""
SINCE = np.concatenate([np.arange(0.0, 8.0, 0.25), np.arange(8.0, 20.0, 1.0), [20.0, 30.0, 45.0, 60.0]])
"""Times since the wound at which it is measured."""
HEALED = 0.9
"""Order inside, projected on that of a cell without the wound and relative to it, at which it is healed."""
DRUGS = ("none", "everywhere", "in the wound")
"""Where bundling is inhibited from the time of the wound."""
MEASURES = ("healed after", "fall", "coherence", "shift", "stripes", "order left")


@cache
def established() -> Array:
    """Return two stripes (2, n_theta, n_z) as they stream with the paper's parameters."""
    run = simulate(Parameters(), GRID, initial.stripes(GRID), SETTLING, save_at=(SETTLING,), rtol=1e-3)
    return run.final_state


def place(seed: int) -> float:
    """Return the angle of the wound of a seed, anywhere around the cell."""
    return float(np.random.default_rng((seed, 1)).uniform(0, 2 * np.pi))


def wounded(seed: int, radius: float, drug: str, theta: float | None = None) -> Trajectory:
    """Run an established cell with a wound of a radius, at its seed's angle unless `theta` is given."""
    disc = regions.disc(place(seed) if theta is None else theta, MIDDLE, radius)
    return _run([fragment(BEGIN, where=disc)], disc, drug, seed)


@cache
def _unwounded(drug: str, seed: int, radius: float) -> Trajectory:
    return _run([], regions.disc(place(seed), MIDDLE, radius), drug, seed)


def _run(steps: list[Step], disc: regions.Region, drug: str, seed: int) -> Trajectory:
    if drug == "everywhere":
        steps = [change(BEGIN, alpha_p=0.0), *steps]
    elif drug == "in the wound":
        steps = [change(BEGIN, alpha_p=0.0, where=disc), *steps]
    protocol = Protocol(*steps, seed=seed)
    times = [0.5 * BEGIN, *(BEGIN + SINCE)]
    return simulate(Parameters(), GRID, established(), times[-1], save_at=times, rtol=1e-3, protocol=protocol)


def healing(seed: int, radius: float, drug: str) -> Array:
    """Return `MEASURES` of a wound, then its order projected on that of a control cell, over `SINCE`.

    Without the drug the unwounded control does not change; otherwise it is simulated too, so that the result
    does not include the effect of the drug alone.
    """
    run = wounded(seed, radius, drug)
    inside = regions.disc(place(seed), MIDDLE, radius).mask(GRID)
    states = np.stack([run.frames[k] for k in _looked_at(run)])
    if drug == "none":
        control = np.broadcast_to(established(), states.shape)
    else:
        # If the drug is everywhere, the control is the same for all seeds and sizes.
        same = _unwounded(drug, *((0, 1.0) if drug == "everywhere" else (seed, radius)))
        control = np.stack([same.frames[k] for k in _looked_at(same)])
    along = np.sum(states * control, axis=1)[:, inside].mean(axis=1)
    usual = np.sum(control**2, axis=1)[:, inside].mean(axis=1)
    own = np.sum(states**2, axis=1)[:, inside].mean(axis=1)
    course = along / usual
    shift = wrapped(rising(states[-1, 1].mean(axis=1)) - rising(control[-1, 1].mean(axis=1)))
    two = striped(states[-1])
    fall = float(np.max(np.maximum.accumulate(course) - course))
    half = int(np.argmax(own >= 0.25 * usual)) if (own >= 0.25 * usual).any() else -1
    coherence = float(along[half] / np.sqrt(own[half] * usual[half]))
    measured = (healed_after(SINCE, course), fall, coherence, float(shift), float(two), float(course[-1]))
    return np.array([*measured, *course])


def striped(state: Array) -> bool:
    """Return whether a state is ordered and every circle around the cell is crossed by two zones."""
    return bool(np.all(crossings(state) == 2) and np.sqrt(np.mean(np.sum(state**2, axis=0))) >= DISORDER)


def _looked_at(run: Trajectory) -> npt.NDArray[np.int64]:
    return np.searchsorted(run.times, BEGIN + SINCE - 1e-6)


def healed_after(times: npt.ArrayLike, course: npt.ArrayLike) -> float:
    """Return the time from which a course (n,) stays at least `HEALED`, by interpolation; NaN if never."""
    t, order = np.asarray(times, dtype=np.float64), np.asarray(course, dtype=np.float64)
    low = np.flatnonzero(order < HEALED)
    if low.size == 0:
        return float(t[0])
    k = int(low[-1])
    if k + 1 == t.size:
        return np.nan
    return float(t[k] + (HEALED - order[k]) * (t[k + 1] - t[k]) / (order[k + 1] - order[k]))


def by_old_flow(radius: float, seeds: int) -> float:
    """Return the median time, over the positions of seeds, in which the former flow would heal wounds.

    Each point inside evolves by itself, without diffusion: dP/dt = -d_r P + (1 - P²)(α_p P + α_u u) from
    P = 0, with the flow u that the cell has without a wound.
    """
    params, state = Parameters(), established()
    u, old = flow(params, GRID, state)[1].mean(axis=1), state[1].mean(axis=1)

    def rate(t: float, P: Array) -> Array:
        return np.asarray(-params.d_r * P + (1 - P**2) * (params.alpha_p * P + params.alpha_u * u))

    P = scipy.integrate.solve_ivp(
        rate, (0.0, SINCE[-1]), np.zeros(GRID.n_theta), t_eval=SINCE, rtol=1e-6, atol=1e-9
    ).y
    times = []
    for seed in range(seeds):
        weight = regions.disc(place(seed), MIDDLE, radius).mask(GRID).sum(axis=1)
        times.append(healed_after(SINCE, (weight * old) @ P / (weight @ old**2)))
    return float(np.median(times))


RADII = {
    "none": (0.3, 0.6, 1.0, 1.5, 2.0, 2.5, 3.0, 3.4),
    "everywhere": (0.6, 1.5, 2.5, 3.0, 3.4),
    "in the wound": (0.6, 1.5),
}
"""Sizes of wounds, by where bundling is inhibited."""
QUICK_RADII = {"none": (0.6, 1.5, 3.0), "everywhere": (0.6, 3.4), "in the wound": (0.6,)}
LOCAL = 0.5
"""Share of the surface up to which damage is local."""
SAME = 0.1
"""Radians by which zones may move in a pattern that counts as the same."""
GRADUAL = 0.02
"""How much order inside may decrease in between."""
MOST = 0.9
"""Share of local wounds of every size that must heal in this way."""
BAND = (0.05, 0.5, 0.95)
"""Quantiles over seeds of the courses that are kept."""
COURSES = (0.6, 1.5, 3.0)
"""Sizes whose courses are drawn if they are measured."""
TOLD, LARGE = 1.5, 3.0
"""Size of the wound that is drawn, and of the large one at the end of the figure."""
TOLD_SINCE = (0.0, 1.0, 2.0, 60.0)


def measure(lab: Lab) -> xarray.Dataset:
    """Return the outcome of every wound, the courses of order inside, and frames of two cells."""
    sizes = QUICK_RADII if lab.quick else RADII
    cases = [(drug, radius) for drug in DRUGS for radius in sizes[drug]]
    items = [(seed, radius, drug) for drug, radius in cases for seed in range(lab.seeds)]
    rows = np.array(lab.each("wounds", healing, items)).reshape(len(cases), lab.seeds, -1)
    measured, course = rows[..., : len(MEASURES)], rows[..., len(MEASURES) :]
    radius = np.array([case[1] for case in cases])
    moved = measured[cases.index(("none", LARGE)), :, MEASURES.index("shift")]
    found = _cells(int(np.argmax(np.abs(moved))))
    found["measured"] = ("case", "seed", "measure"), measured.astype(np.float32)
    found["course"] = ("case", "quantile", "since"), np.quantile(course, BAND, axis=1).swapaxes(0, 1)
    found["by_old_flow"] = "case", [by_old_flow(each, min(lab.seeds, 50)) for each in radius]
    share = [float(regions.disc(0.0, MIDDLE, each).mask(GRID).mean()) for each in radius]
    return found.assign_coords(
        drug=("case", [case[0] for case in cases]),
        radius=("case", radius),
        share=("case", share),
        measure=list(MEASURES),
        quantile=list(BAND),
        since=SINCE,
    )


def _cells(displaced: int) -> xarray.Dataset:
    """Return frames of a cell with a wound, and the end of the one whose large wound displaced the zone most.

    The wound faces the viewer: it is on the side on which the last cell shows a zone.
    """
    last = wounded(displaced, LARGE, "none")
    end = frames(last, [BEGIN + SINCE[-1]])
    run = wounded(1, TOLD, "none", float(np.mod(facing_zone(last.final_state), 2 * np.pi)))
    course = frames(run, [0.5 * BEGIN, *(BEGIN + since for since in TOLD_SINCE)])
    return xarray.concat([course, end], "frame", combine_attrs="override", data_vars="minimal")


def of(data: xarray.Dataset, drug: str, name: str) -> Array:
    """Return a measure (case, seed) of the wounds with a drug, in double precision."""
    chosen = np.asarray(data["drug"].values) == drug
    values = np.asarray(data["measured"].sel(measure=name).values, dtype=np.float64)
    return np.asarray(values[chosen])


def along(data: xarray.Dataset, drug: str, name: str) -> Array:
    """Return a coordinate, or another number per case (case,), of the wounds with a drug."""
    return np.asarray(data[name].values)[np.asarray(data["drug"].values) == drug]


def same(data: xarray.Dataset, drug: str) -> Mask:
    """Return which wounds (case, seed) have healed to the former pattern."""
    healed = np.isfinite(of(data, drug, "healed after"))
    stripes, still = of(data, drug, "stripes") > 0, np.abs(of(data, drug, "shift")) < SAME
    return np.asarray(healed & stripes & still, dtype=np.bool_)


def _shares(good: Mask) -> list[tuple[float, float, float]]:
    return [proportion(int(row.sum()), row.size) for row in good]


# Judged


def verdict(data: xarray.Dataset) -> Verdict:
    """Judge: local wounds heal, to the same pattern, and order inside grows without decreasing again."""
    share = along(data, "none", "share")
    local = share <= LOCAL
    back, after = same(data, "none"), of(data, "none", "healed after")
    gradual = of(data, "none", "fall") < GRADUAL
    heal, rise = _shares(back[local]), _shares((back & gradual)[local])
    worst = min(heal)
    times = [_healed(row) for row in after[local]]
    coherent = median_interval(of(data, "none", "coherence")[local].ravel())
    text = (
        f"wounds of {100 * share[local][0]:.0f} to {100 * share[local][-1]:.0f} % of the surface heal to the "
        f"same pattern in at least {in_words(worst)} of {back.shape[1]} cells, the smallest after "
        f"{times[0]} R/U and the largest after {times[-1]}; when half of the order is back it lies along the "
        f"old one to {coherent[0]:.2f} ({coherent[1]:.2f} to {coherent[2]:.2f})"
    )
    if not local.all():
        k = int(np.argmin(back.mean(axis=1)))
        text += f". Of wounds of {100 * share[k]:.0f} % {in_words(_shares(back)[k])} do"
        moved = np.abs(of(data, "none", "shift"))[k][~back[k] & (of(data, "none", "stripes")[k] > 0)]
        if moved.size:
            text += f", and zones of the others end up {np.median(moved):.2f} radians from their place"
    text += "." + _inhibited(data)
    good = [value > MOST and low > 0.5 for value, low, _ in heal]
    steady = [value > MOST and low > 0.5 for value, low, _ in rise]
    return Verdict(AGREES if all(steady) else IN_PART if all(good) or any(steady) else DOES_NOT, text)


def decisive(data: xarray.Dataset) -> str:
    """Return the smallest share of cells in which local wounds heal."""
    share = along(data, "none", "share")
    local = share <= LOCAL
    worst = min(_shares(same(data, "none")[local]))
    return f"{in_words(worst)} of wounds of up to {100 * share[local][-1]:.0f} % of the surface heal"


def _healed(after: Array) -> str:
    """Return in words the median of times, which are infinite for wounds that never heal."""
    value, low, high = median_interval(np.nan_to_num(after, nan=np.inf))
    return f"{value:.1f} ({low:.1f} to {high:.1f})"


def _inhibited(data: xarray.Dataset) -> str:
    """Return in words how wounds heal while bundling is inhibited."""
    after, stripes = of(data, "everywhere", "healed after"), of(data, "everywhere", "stripes") > 0
    share = along(data, "everywhere", "share")
    small = proportion(int(np.isfinite(after[0]).sum()), after[0].size)
    last = proportion(int(stripes[-1].sum()), stripes[-1].size)
    inside = of(data, "in the wound", "healed after")[0]
    nearby = proportion(int(np.isfinite(inside).sum()), inside.size)
    return (
        f" Without bundling {in_words(small)} of those of {100 * share[0]:.0f} % heal, after "
        f"{_healed(after[0])}, {in_words(nearby)} if only the wound lacks it, after {_healed(inside)}; "
        f"streaming survives a wound of {100 * share[-1]:.0f} % in {in_words(last)}"
    )


# Drawn


def draw(data: xarray.Dataset) -> Figure:
    """Draw a cell that heals, order inside over time, how long it takes, and the effect of bundling."""
    titles = ["before", *(f"wound, {quantities.when(since)}" for since in TOLD_SINCE)]
    titles[2:] = [title.removeprefix("wound, ") for title in titles[2:]]
    titles.append("after a large wound")

    def courses(ax: Any) -> None:
        since = np.asarray(data["since"].values)
        sizes = along(data, "none", "radius")
        chosen = [size for size in COURSES if size in sizes]
        for size, colour in zip(chosen, (UP, DOWN, INK), strict=False):
            low, middle, high = along(data, "none", "course")[int(np.flatnonzero(sizes == size)[0])]
            ax.fill_between(since, low, high, color=colour, alpha=0.2, linewidth=0)
            ax.plot(
                since,
                middle,
                color=colour,
                linewidth=1.1,
                label=f"radius {quantities.words(size, 'length', 'g')}",
            )
        ax.axhline(1.0, color=INK, linewidth=0.5, linestyle=":")
        ax.set_xlim(0, 12)
        ax.set_ylim(0, 1.05)
        quantities.name(ax.xaxis, "time since the wound", "time", "$R/U$", labelpad=1.0)
        ax.set_ylabel("order inside, along the old", labelpad=1.0)
        ax.legend(fontsize=8.0, frameon=False, loc="lower right", borderpad=0, handlelength=1.2)

    def lasting(ax: Any) -> None:
        for drug, colour, name in (("everywhere", DOWN, "no bundling"), ("none", UP, "with bundling")):
            after = np.nan_to_num(of(data, drug, "healed after"), nan=np.inf)
            each = np.array([median_interval(row) for row in after])
            shown = np.isfinite(each[:, 0])
            each[~np.isfinite(each)] = SINCE[-1]
            never = 100 * along(data, drug, "share")[~shown]
            ax.plot(never, np.full(never.size, SINCE[-1]), "^", color=colour, markersize=4.5, mfc="none")
            value, low, high = each[shown].T
            interval(ax, 100 * along(data, drug, "share")[shown], value, low, high, colour, name)
        flow_alone = along(data, "none", "by_old_flow")
        reference(ax, float(np.median(flow_alone)), "theory, old flow")
        ax.text(
            0.98,
            1.0,
            f"△ most not in {quantities.words(60.0, 'time', 'g')}",
            transform=ax.transAxes,
            fontsize=8.0,
            ha="right",
            va="bottom",
        )
        ax.set_yscale("log")
        ax.set_yticks([1, 2, 5, 10, 20, 50], ["1", "2", "5", "10", "20", "50"])
        ax.minorticks_off()
        ax.set_xlim(-3, 100)
        ax.set_ylim(0.7, 70)
        ax.set_xlabel("wound, % of the surface", labelpad=1.0)
        quantities.name(ax.yaxis, "healed after", "time", "$R/U$", labelpad=1.0)
        ax.legend(fontsize=8.0, frameon=False, loc="upper left", borderpad=0, handlelength=1.2)

    def kept(ax: Any) -> None:
        shown: tuple[tuple[Mask, str, str, str], ...] = (
            (same(data, "none"), "none", UP, "same pattern"),
            (of(data, "everywhere", "stripes") > 0, "everywhere", DOWN, "streams, no bundling"),
        )
        for good, drug, colour, name in shown:
            value, low, high = 100 * np.array(_shares(good)).T
            interval(ax, 100 * along(data, drug, "share"), value, low, high, colour, name)
        ax.set_xlim(-3, 100)
        ax.set_ylim(-3, 104)
        ax.set_xlabel("wound, % of the surface", labelpad=1.0)
        ax.set_ylabel("cells, %", labelpad=1.0)
        ax.legend(fontsize=8.0, frameon=False, loc="lower left", borderpad=0, handlelength=1.2)

    panels = [Panel(courses), Panel(lasting), Panel(kept)]
    return story(cells(data, titles), panels, str(verdict(data)))


EXPERIMENT = Experiment(
    name="wound",
    headline="Local damage heals gradually.",
    claim="Local damage of the actin network heals in a gradual, organised way; the network grows back.",
    source="Introduction (Foissner et al. 1996, Foissner & Wasteneys 1997)",
    method="In a streaming cell all filaments in a disc, anywhere around the cell, are fragmented to 1000 a "
    "square. The wound counts as healed once the order inside, along that of a cell without it, stays above "
    "90 %. The same is done with bundling inhibited from then on, everywhere or only inside. All cells are "
    "integrated for 60 R/U.",
    seeds=200,
    quick_seeds=6,
    measure=measure,
    verdict=verdict,
    decisive=decisive,
    draw=draw,
)
