"""Streaming returns with its old handedness, and in its old place, only if some bundles survive."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray

from ..dynamics.protocol import Protocol
from ..figures import quantities
from ..figures.story import Panel, cells, interval, reference, story
from ..figures.style import DOWN, INK, QUIET, UP
from ..model import initial
from ..model.grid import Array, CylinderGrid
from ..model.parameters import Parameters
from .experiment import AGREES, DOES_NOT, IN_PART, Experiment, Verdict
from .lab import Lab, frames
from .statistics import circular, in_words, proportion
from .survivors import effect, shifts, within

if TYPE_CHECKING:
    from matplotlib.figure import Figure

# Computed

GRID = CylinderGrid(48, 48, 5.0)
FILAMENTS = 1000
"""Filaments in every square of the grid, as in the paper."""
ALL = FILAMENTS * GRID.n_theta * GRID.n_z
ARREST, WASHED, END, QUICK_END = 5.0, 25.0, 125.0, 75.0
TIMES = (ARREST - 1, ARREST, WASHED, WASHED + 12, END)

# Shares are those of filaments that keep their old direction: the mean of |P|.
THINNED = (0.0, 1e-4, 2e-4, 4e-4, 7e-4, 1.2e-3, 2e-3, 5e-3)
"""Shares that survive spread over both stripes, each filament with the same probability."""
QUICK_THINNED = (0.0, 4e-4, 5e-3)
SQUARES = (0.0, 0.3, 0.6, 1.0, 2.0, 4.0, 12.0, 48.0)
"""Squares of the grid that survive in one cable within the upward stripe; 48 are the whole cable."""
QUICK_SQUARES = (0.0, 1.0, 12.0)
TOLD, TURNED = 12.0, 2.6
"""Squares in the figure, and about how far the zone of the cell without survivors has turned, in radians."""
SPREAD_WAVE, CABLE_WAVE = 0.5 * np.pi, 2.0
"""The wave once around the cell over the mean of |P|: for a sine, and for a cable at the sine's maximum."""

CHANCE_LEVEL = 0.01
"""Level of significance of the tests that positions are random."""
MOST = 0.9
"""Share of cells that must keep their handedness with most survivors; its interval must exclude chance."""
NEAR = np.pi / 6
"""Distance about the axis within which a place is the old one."""


def measure(lab: Lab) -> xarray.Dataset:
    """Return how far the zones of every cell are from their old place, and the frames of two cells."""
    shares = np.array(QUICK_THINNED if lab.quick else THINNED)
    squares = QUICK_SQUARES if lab.quick else SQUARES
    spread = lab.sweep(
        "thinned",
        {
            "initial": {"kind": "stripes", "filaments_per_square": FILAMENTS},
            "axes": {"magnitude": {"values": list(SPREAD_WAVE * shares)}},
            "run": {"t_end": 1000.0, "finish": "certified", "rtol": 1e-3},
        },
    )
    cable = _with_cables(lab, squares)
    found = _cells(lab, cable[0])
    found["thinned_shift"] = ("thinned", "seed"), shifts(spread).astype(np.float32)
    found["cable_shift"] = ("cable", "seed"), cable.astype(np.float32)
    return found.assign_coords(thinned=shares, cable=np.array(squares) * FILAMENTS / ALL)


def _with_cables(lab: Lab, squares: Sequence[float]) -> Array:
    """Return how far zones move (squares, seed), for increasing squares: none, part of one, whole ones."""
    none, part, whole = (
        [number for number in squares if low <= number < high]
        for low, high in ((0.0, 1e-9), (1e-9, 1.0), (1.0, np.inf))
    )
    kinds = [
        ("none", none, "alpha_u", [0.5]),
        ("part", part, "protocol.survivors.keep", part),
        ("whole", whole, "protocol.cut.where.z1", [_end(number) for number in whole]),
    ]
    tables = {
        "initial": {"kind": "stripes"},
        "run": {"t_end": QUICK_END if lab.quick else END, "finish": "t_end", "rtol": 1e-3},
    }
    swept = [
        tables | {"axes": {axis: {"values": values}}, "protocol": steps(those[0], swept=True)}
        for _, those, axis, values in kinds
        if those
    ]
    labels = [f"cable-{label}" for label, those, *_ in kinds if those]
    return np.concatenate([shifts(lab.sweep(*each)) for each in zip(labels, swept, strict=True)])


def _end(squares: float) -> float:
    """Return where along z a piece of so many squares of the cable ends."""
    z = GRID.length / GRID.n_z
    return float(min(np.ceil(squares) * z - 0.5 * z, GRID.length - 1e-6))


def steps(squares: float, swept: bool = False) -> list[dict[str, Any]]:
    """Return the protocol for a cell in which so many squares of one cable survive.

    Below one square its filaments are thinned. If `swept`, the number that depends on squares is left out.
    """
    theta = np.pi / GRID.n_theta
    where = {"shape": "box", "theta0": 0.5 * np.pi - theta, "theta1": 0.5 * np.pi + theta, "z0": 0.0}
    if squares < 1 or not swept:
        where["z1"] = _end(squares)
    cut = {"name": "cut", "at": ARREST, "action": "fragment", "filaments_per_square": FILAMENTS}
    done: list[dict[str, Any]] = [{"at": ARREST, "action": "change", "alpha_p": 0.0}]
    done.append(cut | {"where": where | {"invert": True}} if squares else cut)
    if 0 < squares < 1:
        keep = {} if swept else {"keep": squares}
        at = {"name": "survivors", "at": ARREST}
        done.append(at | {"action": "depolymerise", "where": where} | keep)
    return [*done, {"at": WASHED, "action": "wash_out"}]


def _cells(lab: Lab, without: Array) -> xarray.Dataset:
    """Return frames of a cell in which a piece of cable survives, and of one without, whose pattern turned.

    The latter is the one whose zone is visible from the side of the cable.
    """
    other = int(np.nanargmin(np.abs(np.nan_to_num(without, nan=-np.inf) - TURNED)))
    shown = []
    for squares, seed, times in ((TOLD, 0, TIMES), (0.0, other, (END,))):
        protocol = Protocol.from_tables(steps(squares), seed=seed)
        run = lab.story(Parameters(), GRID, initial.stripes(GRID), END, times, protocol, rtol=1e-3)
        shown.append(frames(run, times))
    return xarray.concat(shown, "frame", combine_attrs="override", data_vars="minimal")


def expected(data: xarray.Dataset, kind: str, share: Array | None = None) -> Array:
    """Return the displacement a of the law of `survivors` at shares (n,), by default those measured."""
    wave = {"thinned": SPREAD_WAVE, "cable": CABLE_WAVE}[kind]
    shares = np.asarray(data[kind].values) if share is None else share
    return np.asarray(wave * shares * np.sqrt(ALL))


def counted(data: xarray.Dataset, kind: str, angle: float) -> tuple[Array, int]:
    """Return how many cells returned to within an angle of the old place, by share (n,), of how many each.

    Cells without two stripes have not returned.
    """
    shift = np.asarray(data[f"{kind}_shift"].values)
    return np.sum(np.abs(np.nan_to_num(shift, nan=np.inf)) < angle, axis=-1), shift.shape[-1]


def by_chance(data: xarray.Dataset, kind: str) -> tuple[float, float, float]:
    """Return the share of returned cells without survivors, with its interval, that have their handedness."""
    shift = np.asarray(data[f"{kind}_shift"].values)[0]
    back = shift[np.isfinite(shift)]
    kept = int(np.sum(np.abs(back) < 0.5 * np.pi))
    return proportion(kept, back.size) if back.size else (0.0, 0.0, 0.0)


# Judged


def verdict(data: xarray.Dataset) -> Verdict:
    """Judge: without survivors the place is random; with some, handedness is kept; and how many it takes."""
    random, kept, needed = [], [], []
    lost = {}
    for kind in ("thinned", "cable"):
        shift = np.asarray(data[f"{kind}_shift"].values)
        hand, total = counted(data, kind, 0.5 * np.pi)
        back = shift[0][np.isfinite(shift[0])]
        lost[kind] = int(np.isnan(shift).sum()), shift.size
        chance = by_chance(data, kind)
        test = circular(back) if back.size > 1 else None
        even = chance[1] <= 0.5 <= chance[2] and test is not None
        random.append(even and test is not None and min(test.rayleigh, test.kuiper) > CHANCE_LEVEL)
        most = proportion(int(hand[-1]), total)
        kept.append(most[0] > MOST and most[1] > 0.5)
        # The law concerns the phase of stripes: cells without stripes are left out, and counted separately.
        returned = np.isfinite(shift).sum(axis=-1)
        factor = effect(expected(data, kind)[1:], hand[1:], returned[1:])
        needed.append((chance, most, test, factor))
    (chance, most, test, spread), (cable_chance, cable_most, _, cable) = needed
    text = (
        f"without survivors {in_words(chance)} of {data.sizes['seed']} cells regain their handedness, and "
        f"{in_words(cable_chance)} after the drug"
    )
    if test is not None:
        text += f"; places are{'' if all(random) else ' not'} uniform (Kuiper p = {test.kuiper:.2f})"
    text += (
        f". With most survivors {in_words(most)} do (spread) and {in_words(cable_most)} (one cable); "
        f"of those with stripes 95 % need {_share(spread, SPREAD_WAVE)} of all filaments, or "
        f"{_share(cable, CABLE_WAVE)} in one cable: {_factor(spread)} and {_factor(cable)} times as "
        f"effective as the law of the square root says"
    )
    if any(count for count, _ in lost.values()):
        text += (
            f". No two stripes came back in {in_words(proportion(*lost['thinned']))} of cells (spread) and "
            f"{in_words(proportion(*lost['cable']))} (drug, one cable)"
        )
    good = AGREES if all(random) and all(kept) else IN_PART if any(random) and any(kept) else DOES_NOT
    return Verdict(good, text)


def decisive(data: xarray.Dataset) -> str:
    """Return the share of cells without survivors that regain their handedness."""
    return f"{in_words(by_chance(data, 'thinned'))} regain it without survivors"


def _share(factor: tuple[float, float, float], wave: float) -> str:
    """Return in words the share of filaments with which 95 % of cells with stripes keep their handedness."""
    value, low, high = (1.645 / (wave * np.sqrt(ALL)) / max(r, 1e-9) for r in factor)
    return f"{100 * value:.3f} % ({100 * high:.3f} to {100 * low:.3f} %)"


def _factor(factor: tuple[float, float, float]) -> str:
    return f"{factor[0]:.2f} ({factor[1]:.2f} to {factor[2]:.2f})"


# Drawn


def draw(data: xarray.Dataset) -> Figure:
    """Draw a cell in which a piece of cable survives, one without, and the results of all seeds by share."""
    times = np.asarray(data["frame_time"].values)
    titles = [quantities.when(time) for time in times]
    for k, name in ((0, ", before"), (1, ", fragmented"), (2, ", washed out")):
        titles[k] += name
    titles[-2], titles[-1] = (
        f"{quantities.when(times[-2])}, as before",
        f"no survivors, {quantities.when(times[-1])}",
    )

    def kept(ax: Any, angle: float, chance: str, label: str) -> None:
        x = np.geomspace(8e-5, 6e-3, 200)
        for kind, colour, name in (("cable", UP, "in one cable"), ("thinned", DOWN, "spread evenly")):
            ax.plot(
                100 * x, 100 * within(angle, expected(data, kind, x)), color=colour, lw=0.9, ls=(0, (4, 2))
            )
            hand, total = counted(data, kind, angle)
            share = np.asarray(data[kind].values)
            shown = share < x[-1]
            value, low, high = 100 * np.array([proportion(int(n), total) for n in hand[shown]]).T
            place = np.where(share[shown] > 0, 100 * share[shown], 4e-3 * (1.12 if kind == "cable" else 1))
            interval(ax, place[1:], value[1:], low[1:], high[1:], colour, name)
            interval(ax, place[:1], value[:1], low[:1], high[:1], colour)
        reference(ax, 100 * angle / np.pi, chance)
        ax.set_xscale("log")
        ax.set_xlim(3e-3, 0.7)
        ax.set_xticks([4.2e-3, 0.01, 0.1, 0.5], ["none", "0.01", "0.1", "0.5"])
        ax.minorticks_off()
        ax.set_ylim(-3, 104)
        ax.set_xlabel("filaments that survive, %", labelpad=1.0)
        ax.set_ylabel(label, labelpad=1.0)

    def handed(ax: Any) -> None:
        kept(ax, 0.5 * np.pi, "chance", "handedness kept, % of cells")
        ax.plot([], [], color=QUIET, lw=0.9, ls=(0, (4, 2)), label="theory")
        ax.legend(fontsize=8.0, frameon=False, loc="lower right", borderpad=0, handlelength=1.4)

    def placed(ax: Any) -> None:
        kept(ax, NEAR, "chance", "zone within 30° of its place, %")

    def places(ax: Any) -> None:
        bins = np.linspace(-np.pi, np.pi, 13)
        some = int(np.argmin(np.abs(np.asarray(data["thinned"].values) - 1.2e-3)))
        for k, colour, fill in ((some, DOWN, True), (0, INK, False)):
            shift = np.asarray(data["thinned_shift"].values)[k]
            share = 100 * float(data["thinned"].values[k])
            style: dict[str, Any] = {"color": colour, "edgecolor": "white", "linewidth": 0.5}
            if not fill:
                style = {"histtype": "step", "edgecolor": colour, "linewidth": 1.2}
            name = f"{share:.2g} % survive" if share else "none"
            ax.hist(shift[np.isfinite(shift)], bins, label=name, **style)
        ax.set_xticks([-np.pi, 0, np.pi], ["−π", "0", "π"])
        ax.set_xlim(-np.pi, np.pi)
        ax.set_xlabel("shift of the zone, radians", labelpad=1.0)
        ax.set_ylabel("cells", labelpad=1.0)
        ax.legend(fontsize=8.0, frameon=False, loc="upper left", borderpad=0, handlelength=1.2)

    return story(cells(data, titles), [Panel(handed), Panel(placed), Panel(places)], str(verdict(data)))


EXPERIMENT = Experiment(
    name="surviving-seeds",
    headline="Cells keep their old handedness only if some bundles survive.",
    claim="After their bundles have been broken up, cells stream again with the old handedness, and in the "
    "old place, only if some bundles outlived the treatment.",
    source="Introduction (Ryu et al. 1995, on Vallisneria)",
    method="Two stripes are thinned to 0 to 0.5 % of their filaments amid 1000 disordered ones a square, "
    "and integrated until their end is certain. Or, with bundling stopped for 20 R/U, everything is "
    "fragmented except a piece of one cable, 0 to 2 % of the filaments, and cells are inspected 100 R/U "
    "later. The zone's shift is compared with a law in which survivors compete with the square root of all "
    "filaments.",
    seeds=200,
    quick_seeds=12,
    measure=measure,
    verdict=verdict,
    decisive=decisive,
    draw=draw,
)
