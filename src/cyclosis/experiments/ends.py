"""Whether the paper's zero flux stands in for the ends of a cell: closed cells against the cylinder."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt
import scipy.stats
import xarray
from matplotlib.colors import ListedColormap

from .. import models, stability
from ..closed.grid import Array, ClosedGrid
from ..dynamics.simulate import simulate
from ..figures.regime_maps import COLOURS as REGIME_COLOURS
from ..figures.story import Panel, reference, story
from ..figures.style import DOWN, INK, QUIET, UP
from ..model.errors import InputError
from ..model.filaments import TERMS
from ..model.parameters import Parameters
from ..models.closed.states import REGIMES
from ..models.fields import flow
from . import closed_cells, closed_views
from .closed_cells import End, closed_surface
from .experiment import AGREES, DOES_NOT, IN_PART, Experiment, Verdict
from .lab import Lab

if TYPE_CHECKING:
    from matplotlib.figure import Figure

# Computed

PRINCIPAL = "principal"
CYLINDER, CAPSULE, SPHEROID = SHAPES = ("cylinder 5", "capsule 5", "spheroid 3")
RATES = ((0.1, 0.2, 0.3, 0.4, 0.5, 0.65, 0.8, 1.0), (0.0125, 0.025, 0.05, 0.1, 0.2, 0.35, 0.6, 1.0))
QUICK_RATES = ((0.5, 1.0), (0.025, 0.5))
"""Values of α_p and α_u."""
LATE, QUICK_LATE = 400.0, 120.0
CYLINDER_SEEDS = 20
"""Seeds of cylinders, which are cheap."""
LINE = 0.5
"""The α_p of the line on which more shapes and forms of repulsion are compared, over α_u."""
ALONG, QUICK_ALONG = (0.025,), (0.025,)
OTHERS = (
    ("cylinder 2", PRINCIPAL),
    ("cylinder 7", PRINCIPAL),
    (CAPSULE, "bounded"),
    (SPHEROID, "bounded"),
)
QUICK_OTHERS = (("cylinder 7", PRINCIPAL), ("capsule 2", PRINCIPAL))
"""A cylinder of length 7 is as long as a capsule of 5 with its ends."""
FINE_POINTS, FINE = ((0.5, 0.025),), 20.0
"""Points at which capsules are computed again with a larger k_max."""
EPSILON = (0.0, 0.02, 0.04, 0.05, 0.075, 0.1, 0.15, 0.2)
QUICK_EPSILON = (0.0, 0.05, 0.1)
WEAK = (0.0, 0.025)
"""Values of α_u at which growth is computed over ε."""
WITHOUT = ("", "advection", "shear")
"""What is left out where growth is computed over ε, at the first of these."""
GROWN = (0.1, 0.2, 0.5, 1.0)
"""Values of α_p at which growth is computed over both rates."""
USUAL_K = 16.0
"""The k_max at which growth is computed."""
WAVES = ("swirl", "displaced", "second")
"""Perturbations of one stream from end to end: order around the axis (m = 0), and the first two of m = 1."""
PUSHED = ((CAPSULE, 0.5, 0.0), (CAPSULE, 0.5, 0.025), (SPHEROID, 0.5, 0.025))
"""Cells in which growth is taken apart."""
PARTS = ("rate", "push", *(term.name for term in TERMS))
SHOWN = ((CAPSULE, 1.0, 0.5), (CAPSULE, 0.5, 0.025), (SPHEROID, 1.0, 0.5), (SPHEROID, 0.5, 0.025))
"""Cells that are drawn."""
SMALL = 1e-5


def growth(
    shape: str, repulsion: str, alpha_p: float, alpha_u: float, epsilon: float, without: str, k: float
) -> tuple[float, float, float]:
    """Return the growth rates of `WAVES` upon one stream from end to end; NaN where there is none.

    The second and third are the two largest of m = 1; each comes twice, in two directions.
    """
    params, grid = Parameters(alpha_p=alpha_p, alpha_u=alpha_u, epsilon=epsilon), closed_surface(shape, k)
    try:
        state = stability.source_to_sink(params, grid, repulsion)
    except InputError:
        return np.nan, np.nan, np.nan
    terms = [term.name for term in TERMS if term.name != without]
    zero, one = (stability.azimuthal_rates(params, grid, state.P, m, terms, repulsion).real for m in (0, 1))
    return float(zero[0]), float(one[0]), float(one[2])


def pushed(shape: str, alpha_p: float, alpha_u: float, rank: int) -> Array:
    """Return the `PARTS` of the growth of a wave m = 1: its rate, how its flow pushes its defect, and terms.

    The push is u·X/|X|², with u the flow over the pole and X the displacement of the defect there: about it
    P = c x, so that δP = -c X.
    """
    params = Parameters(alpha_p=alpha_p, alpha_u=alpha_u)
    grid: Any = closed_surface(shape, USUAL_K)
    state = stability.source_to_sink(params, grid).P
    found = stability.azimuthal_mode(params, grid, state, 1, rank)
    two = [flow(params, grid, state + sign * SMALL * found.P) for sign in (1, -1)]
    at_poles = [_at_pole(grid, state, found.P, (two[0] - two[1]) / (2 * SMALL), pole) for pole in (0, -1)]
    push = max(at_poles)[1]
    return np.array([found.rate.real, push, *(found.parts[term.name] for term in TERMS)])


def _at_pole(grid: ClosedGrid, P: Array, change: Array, u: Array, pole: int) -> tuple[float, float]:
    """Return how far a perturbation displaces the defect at a pole, and its push."""
    outwards = grid.e_s[:, :, pole] * (1 if pole == 0 else -1)
    along, driven = (
        (grid.e_theta[:, :, pole] * f[0, :, pole] + grid.e_s[:, :, pole] * f[1, :, pole]).mean(axis=1)
        for f in (change, u)
    )
    about = np.sum((grid.e_s * P[1])[:, :, pole] * outwards, axis=0).mean() / grid.r[pole]
    X = -along / about
    return float(np.linalg.norm(X)), float(driven @ X / (X @ X))


def view(shape: str, alpha_p: float, alpha_u: float, late: float) -> Array:
    """Return the picture of a cell from disorder at a time."""
    params = Parameters(alpha_p=alpha_p, alpha_u=alpha_u)
    grid: Any = closed_surface(shape, USUAL_K)
    begin = closed_cells.start(grid, 0)
    P = simulate(params, grid, begin, late, save_every=late, rtol=1e-3, model=models.closed).final_state
    return closed_views.seen(grid, P, flow(params, grid, P), closed_views.facing(grid, P))


def measure(lab: Lab) -> xarray.Dataset:
    """Return how cells of all shapes end, and the growth of perturbations of one stream from end to end."""
    return xarray.merge([_plane(lab), _growth(lab), _line(lab), _views(lab)])


def _batches(seeds: range) -> list[tuple[int, int]]:
    """Return first seeds and numbers of batches that fill lanes."""
    step = closed_cells.LANES
    return [(first, min(step, seeds.stop - first)) for first in range(seeds.start, seeds.stop, step)]


def _ends(lab: Lab, cells: list[tuple[Any, ...]], seeds: range) -> Array:
    """Return the `End` (cells, seeds, 5) of cells given as shape, repulsion, α_p, α_u and k_max."""
    late = QUICK_LATE if lab.quick else LATE
    batches = _batches(seeds)
    items = [(*cell, *batch, late) for cell in cells for batch in batches]
    rows = lab.kept("ends", closed_cells.ends, items)
    each = len(batches)
    return np.array([np.concatenate(rows[k : k + each]) for k in range(0, len(rows), each)])


def _plane(lab: Lab) -> xarray.Dataset:
    """Return how cells end over both rates."""
    rates = QUICK_RATES if lab.quick else RATES
    places = [(alpha_p, alpha_u) for alpha_p in rates[0] for alpha_u in rates[1]]
    seeds = _seeds(lab)
    most = max(seeds(shape).stop for shape in SHAPES)
    found = np.full((len(SHAPES), len(places), most, len(End._fields)), np.nan, dtype=np.float32)
    for k, shape in enumerate(SHAPES):
        cells = [(shape, PRINCIPAL, *place, closed_cells.k_max(*place)) for place in places]
        found[k, :, : seeds(shape).stop] = _ends(lab, cells, seeds(shape))
    whole = found.reshape(len(SHAPES), len(rates[0]), len(rates[1]), most, -1)
    dims = ("shape", "alpha_p", "alpha_u", "seed", "number")
    coords = {"shape": list(SHAPES), "alpha_p": list(rates[0]), "alpha_u": list(rates[1])}
    return xarray.Dataset({"end": (dims, whole)}, coords | {"number": list(End._fields)})


def _seeds(lab: Lab) -> Callable[[str], range]:
    many = lab.seeds if lab.quick else max(lab.seeds, CYLINDER_SEEDS)
    return lambda shape: range(many if shape.startswith("cylinder") else lab.seeds)


def _line(lab: Lab) -> xarray.Dataset:
    """Return how other cells end along a line, and capsules with a larger k_max."""
    others, along = (QUICK_OTHERS, QUICK_ALONG) if lab.quick else (OTHERS, ALONG)
    seeds = _seeds(lab)
    most = max(seeds(shape).stop for shape, _ in others)
    line = np.full((len(others), len(along), most, len(End._fields)), np.nan, dtype=np.float32)
    for k, (shape, repulsion) in enumerate(others):
        cells = [(shape, repulsion, LINE, alpha_u, closed_cells.k_max(LINE, alpha_u)) for alpha_u in along]
        line[k, :, : seeds(shape).stop] = _ends(lab, cells, seeds(shape))
    points, k_max = (FINE_POINTS[:1], 16.0) if lab.quick else (FINE_POINTS, FINE)
    fine = _ends(lab, [(CAPSULE, PRINCIPAL, *point, k_max) for point in points], range(lab.seeds))
    return xarray.Dataset(
        {
            "line": (("other", "line_alpha_u", "line_seed", "number"), line),
            "fine": (("point", "fine_seed", "number"), fine.astype(np.float32)),
        },
        {
            "other": [f"{shape}, {repulsion}" for shape, repulsion in others],
            "line_alpha_u": list(along),
            "point_alpha_p": ("point", [point[0] for point in points]),
            "point_alpha_u": ("point", [point[1] for point in points]),
        },
    )


def _growth(lab: Lab) -> xarray.Dataset:
    """Return growth rates of perturbations of order from end to end over both rates, and over ε."""
    rates = QUICK_RATES if lab.quick else RATES
    usual = float(Parameters().epsilon)
    grown = [alpha_p for alpha_p in rates[0] if alpha_p in GROWN]
    items: list[tuple[Any, ...]] = [
        (shape, PRINCIPAL, alpha_p, alpha_u, usual, "", USUAL_K)
        for shape in SHAPES[1:]
        for alpha_p in grown
        for alpha_u in rates[1]
    ]
    plane = np.full((2, len(rates[0]), len(rates[1]), len(WAVES)), np.nan)
    chosen = [rates[0].index(alpha_p) for alpha_p in grown]
    rows = lab.kept("growth", growth, items)
    plane[:, chosen] = np.reshape(rows, (2, len(grown), len(rates[1]), len(WAVES)))
    epsilon = QUICK_EPSILON if lab.quick else EPSILON
    over = np.full((len(WITHOUT), len(WEAK), len(epsilon), len(WAVES)), np.nan)
    known = [place for place in np.ndindex(over.shape[:3]) if place[0] == 0 or place[1] == 0]
    items = [(CAPSULE, PRINCIPAL, LINE, WEAK[j], epsilon[k], WITHOUT[i], USUAL_K) for i, j, k in known]
    for place, row in zip(known, lab.kept("growth", growth, items), strict=True):
        over[place] = row
    items = [(*cell, rank) for cell in PUSHED for rank in (0, 2)]
    parts = np.reshape(lab.kept("parts", pushed, items), (len(PUSHED), 2, len(PARTS)))
    return xarray.Dataset(
        {
            "growth": (("closed", "alpha_p", "alpha_u", "wave"), plane),
            "over_epsilon": (("without", "weak_alpha_u", "epsilon", "wave"), over),
            "parts": (("pushed", "defect", "part"), parts),
        },
        {
            "closed": list(SHAPES[1:]),
            "wave": list(WAVES),
            "without": [name or "nothing" for name in WITHOUT],
            "weak_alpha_u": list(WEAK),
            "epsilon": list(epsilon),
            "pushed": [f"{shape}, {alpha_p:g}, {alpha_u:g}" for shape, alpha_p, alpha_u in PUSHED],
            "defect": list(WAVES[1:]),
            "part": list(PARTS),
        },
    )


def _views(lab: Lab) -> xarray.Dataset:
    late = QUICK_LATE if lab.quick else LATE
    seen = np.array(lab.kept("views", view, [(*cell, late) for cell in SHOWN])).astype(np.float32)
    return xarray.Dataset(
        {"picture": (("frame", "field", "across", "up"), seen)}, {"field": list(closed_views.FIELDS)}
    )


# Judged

KINDS = ("one stream", "two streams", "other")
SURE = 0.05
"""Level of the tests whether ends differ, together over all kinds, shapes and places."""
SETTLED = 1e-3
"""Relative rate of change up to which an end is settled."""
NONE = -1


def kinds(ends: xarray.DataArray) -> npt.NDArray[np.int64]:
    """Return the numbers in `KINDS` of `End`s (..., number), shape (...); `NONE` where there are none."""
    regime = ends.sel(number="regime").values
    one, two = (regime == REGIMES.index(name) for name in ("source-to-sink", "cyclosis"))
    return np.where(np.isnan(regime), NONE, np.select([one, two], [0, 1], 2))


def counts(found: npt.NDArray[np.int64]) -> npt.NDArray[np.int64]:
    """Return how many of kinds (..., seed) are of each, (..., kind)."""
    return np.stack([(found == kind).sum(axis=-1) for kind in range(len(KINDS))], axis=-1)


def differs(data: xarray.Dataset, shape: str) -> npt.NDArray[np.bool_]:
    """Return where over both rates a shape's ends differ from the cylinder's by more than chance.

    Fisher's exact test for every kind, at the level `SURE` divided by the number of kinds, closed shapes and
    places (Bonferroni).
    """
    number = counts(kinds(data["end"].transpose("shape", "alpha_p", "alpha_u", "seed", "number")))
    ours, theirs = (number[list(data["shape"].values).index(each)] for each in (shape, CYLINDER))
    level = SURE / (len(KINDS) * (number.shape[0] - 1) * number.shape[1] * number.shape[2])
    p = np.array(
        [[fisher(*pair) for pair in zip(*row, strict=True)] for row in zip(ours, theirs, strict=True)]
    )
    return np.asarray(p < level)


def fisher(ours: npt.NDArray[np.int64], theirs: npt.NDArray[np.int64]) -> float:
    """Return the least p-value, over kinds, that counts of two shapes (kind,) have one share of it."""
    tables = [
        [[ours[kind], ours.sum() - ours[kind]], [theirs[kind], theirs.sum() - theirs[kind]]]
        for kind in range(len(KINDS))
    ]
    return min(float(scipy.stats.fisher_exact(table).pvalue) for table in tables)


def regions(data: xarray.Dataset) -> dict[str, npt.NDArray[np.bool_]]:
    """Return where over both rates all cylinders have two streams, "C", and where some have, "C/U"."""
    number = counts(kinds(data["end"].sel(shape=CYLINDER).transpose("alpha_p", "alpha_u", "seed", "number")))
    two, whole = number[..., 1], number.sum(axis=-1)
    return {"C": two == whole, "C/U": (two > 0) & (two < whole)}


def overall(data: xarray.Dataset, shape: str) -> float:
    """Return the p-value that seeds of a shape have two streams as often as those of the cylinder, in "C/U".

    Each seed is one value, the share of places where it ends so: a seed begins alike at all places. Mann and
    Whitney's test. 1 where there is no such place.
    """
    where = regions(data)["C/U"]
    if not where.any():
        return 1.0
    shares = []
    for each in (shape, CYLINDER):
        found = kinds(data["end"].sel(shape=each).transpose("alpha_p", "alpha_u", "seed", "number"))[where]
        shares.append((found == 1).mean(axis=0)[(found != NONE).all(axis=0)])
    return float(scipy.stats.mannwhitneyu(*shares).pvalue)


def share(data: xarray.Dataset, shape: str, where: npt.NDArray[np.bool_], kind: int) -> tuple[int, int]:
    """Return how many cells of a shape at some places are of a kind, and of how many."""
    found = counts(kinds(data["end"].sel(shape=shape).transpose("alpha_p", "alpha_u", "seed", "number")))
    return int(found[where][:, kind].sum()), int(found[where].sum())


def unsettled(data: xarray.Dataset, shape: str) -> int:
    """Return how many cells of a shape still change at the end."""
    return int((data["end"].sel(shape=shape, number="rate").values > SETTLED).sum())


def transient(data: xarray.Dataset, shape: str) -> tuple[int, int]:
    """Return how many cells that end with one stream are unstable, and of how many, where growth is known."""
    found = kinds(data["end"].sel(shape=shape).transpose("alpha_p", "alpha_u", "seed", "number"))
    rate = data["growth"].sel(closed=shape).transpose("alpha_p", "alpha_u", "wave").max("wave").values
    one = (found == 0).sum(axis=-1)
    return int(one[rate > 0].sum()), int(one[np.isfinite(rate)].sum())


def onset(data: xarray.Dataset, alpha_u: float) -> float:
    """Return the ε above which one stream is unstable on the capsule, by a straight line; NaN if none."""
    rate = data["over_epsilon"].sel(without="nothing", wave="displaced").sel(weak_alpha_u=alpha_u).values
    epsilon = data["epsilon"].values
    at = int(np.argmax(rate > 0))
    if rate[at] <= 0 or at == 0:
        return np.nan
    low, high = rate[at - 1], rate[at]
    return float(epsilon[at - 1] - low * (epsilon[at] - epsilon[at - 1]) / (high - low))


def _line_in_words(data: xarray.Dataset, alpha_u: float) -> str:
    """Return the share of two streams at one place of the line, for every shape and repulsion."""
    line = data["line"].transpose("other", "line_alpha_u", "line_seed", "number")
    found = kinds(line.sel(line_alpha_u=alpha_u))
    words = [
        f"{int((row == 1).sum())} of {int((row != NONE).sum())} ({name.replace(', principal', '')})"
        for name, row in zip(data["other"].values, found, strict=True)
    ]
    return ", ".join(words)


def _stable(data: xarray.Dataset, shape: str) -> tuple[int, int]:
    """Return at how many places one stream is stable on a closed shape, and of how many."""
    rate = data["growth"].sel(closed=shape).max("wave", skipna=False).values
    return int((rate < 0).sum()), int(np.isfinite(rate).sum())


def _pushed_in_words(data: xarray.Dataset) -> str:
    sink, source, other = (
        data["parts"].sel(pushed=name, defect=which).to_series()
        for name, which in (
            ("capsule 5, 0.5, 0", "displaced"),
            ("capsule 5, 0.5, 0", "second"),
            ("spheroid 3, 0.5, 0.025", "displaced"),
        )
    )
    rest = sink["rate"] - sink["advection"] - sink["shear"]
    return (
        f"a displaced sink has more filaments behind it, which point after it, than before it, so that flow "
        f"over the pole follows it, at {sink['push']:.2f} of its displacement, and carries it on: at "
        f"(0.5, 0) it grows at {sink['rate']:.4f}, {sink['advection']:.4f} of it by advection, "
        f"{sink['shear']:.4f} by shear, {rest:.4f} by all else. A source is pushed back "
        f"({source['push']:.2f}, {source['rate']:.4f}). In pointed ends repulsion, "
        f"{other['repulsion']:.2f}, holds a sink against a push of {other['push']:.2f}"
    )


def _fine_in_words(data: xarray.Dataset) -> str:
    found = kinds(data["fine"].transpose("point", "fine_seed", "number"))
    places = zip(data["point_alpha_p"].values, data["point_alpha_u"].values, found, strict=True)
    return ", ".join(f"{(row == 1).sum()} of {row.size} at ({p:g}, {u:g})" for p, u, row in places)


def verdict(data: xarray.Dataset) -> Verdict:
    """Judge: whether closed cells end as the cylinder does, at least where that always has two streams."""
    apart = {shape: differs(data, shape) for shape in SHAPES[1:]}
    where = regions(data)
    both = apart[CAPSULE] | apart[SPHEROID]

    def of(shape: str, region: str, kind: int) -> str:
        return "{} of {}".format(*share(data, shape, where[region], kind))

    middle = float(data["line_alpha_u"].values[np.argmin(np.abs(data["line_alpha_u"].values - 0.025))])
    total = {shape: share(data, shape, np.ones_like(both), 1)[1] for shape in SHAPES}
    p = {shape: overall(data, shape) for shape in SHAPES[1:]}
    late = ", ".join(f"{unsettled(data, shape)} of {total[shape]} {shape.split()[0]}s" for shape in SHAPES)
    lasting = {shape: _stable(data, shape) for shape in SHAPES[1:]}
    passing = "{} of {} capsules and {} of {} spheroids".format(
        *transient(data, CAPSULE), *transient(data, SPHEROID)
    )
    text = (
        f"where all cylinders have two streams ({int(where['C'].sum())} places) so have "
        f"{of(CAPSULE, 'C', 1)} capsules and {of(SPHEROID, 'C', 1)} spheroids. Where cylinders have either "
        f"({int(where['C/U'].sum())} places) {of(CYLINDER, 'C/U', 1)} of them, but {of(CAPSULE, 'C/U', 1)} "
        f"capsules and {of(SPHEROID, 'C/U', 1)} spheroids have two; {of(SPHEROID, 'C/U', 0)} spheroids have "
        f"one stream and {of(SPHEROID, 'C/U', 2)} another end (p = {p[CAPSULE]:.0e} and "
        f"{p[SPHEROID]:.0e}, seed by seed). Capsules differ beyond chance at "
        f"{int(apart[CAPSULE].sum())} and spheroids at {int(apart[SPHEROID].sum())} of {both.size} places, "
        f"{int((both & where['C']).sum())} of them where all cylinders have two streams. Still changing at "
        f"the end: {late}. One stream, from source to sink without flow, is stable at "
        f"{lasting[CAPSULE][0]} of {lasting[CAPSULE][1]} places on the capsule and {lasting[SPHEROID][0]} of "
        f"{lasting[SPHEROID][1]} on the spheroid, and unstable in {passing} that have it. On the capsule it "
        f"is unstable above ε = {onset(data, 0.0):.3f} at (0.5, 0): {_pushed_in_words(data)}. At "
        f"(0.5, {middle:g}) two streams are in {_line_in_words(data, middle)}. At k_max {FINE:g} capsules "
        f"have them in {_fine_in_words(data)}"
    )
    if not both.any() and min(p.values()) > SURE / len(p):
        return Verdict(AGREES, text)
    certain = both[where["C"]]
    return Verdict(IN_PART if certain.mean() <= 0.5 else DOES_NOT, text)


def decisive(data: xarray.Dataset) -> str:
    """Return the shares of two streams where cylinders have one or two."""
    mixed = regions(data)["C/U"]
    capsule, spheroid, cylinder = (
        "{} of {}".format(*share(data, shape, mixed, 1)) for shape in (CAPSULE, SPHEROID, CYLINDER)
    )
    return f"{capsule} capsules and {spheroid} spheroids get two streams where {cylinder} cylinders do"


# Drawn

COLOURS = (*(REGIME_COLOURS[name][0] for name in ("unidirectional", "cyclosis")), QUIET)
DEEP = 20
"""Stripes of a place in a map: the least common multiple of numbers of seeds."""


def draw(data: xarray.Dataset) -> Figure:
    """Draw four closed cells, the ends of every shape over both rates, and growth over ε."""
    titles = [f"{shape.split()[0]}, ({alpha_p:g}, {alpha_u:g})" for shape, alpha_p, alpha_u in SHOWN]
    shown = [
        closed_views.drawn(title, picture)
        for title, picture in zip(titles, data["picture"].values, strict=True)
    ]

    def plane(shape: str) -> Callable[[Any], None]:
        def drawn(ax: Any) -> None:
            found = kinds(data["end"].sel(shape=shape).transpose("alpha_u", "alpha_p", "seed", "number"))
            rows, columns = found.shape[:2]
            stripes = np.array([[_stripes(place) for place in row] for row in found]).reshape(rows, -1)
            ax.imshow(
                np.ma.masked_equal(stripes, NONE), cmap=ListedColormap(COLOURS), vmin=-0.5, vmax=2.5,
                extent=(0, columns, 0, rows), origin="lower", aspect="auto", interpolation="nearest",
            )  # fmt: skip
            ax.set(xticks=np.arange(columns + 1), yticks=np.arange(rows + 1))
            ax.grid(color="white", linewidth=1.0)
            ax.tick_params(length=0, labelbottom=False, labelleft=False)
            for axis, name in ((ax.xaxis, "alpha_p"), (ax.yaxis, "alpha_u")):
                values = data[name].values
                named = [0, len(values) // 2, len(values) - 1] if len(values) > 3 else range(len(values))
                for k in named:
                    at, text = k + 0.5, f"{values[k]:g}"
                    if axis is ax.xaxis:
                        ax.text(at, -0.15, text, ha="center", va="top", fontsize=8)
                    else:
                        ax.text(-0.1, at, text, ha="right", va="center", fontsize=8)
            ax.spines[:].set_visible(False)
            if shape != CYLINDER:
                for i, j in np.argwhere(differs(data, shape)):
                    ax.plot(i + 0.5, j + 0.5, "o", color=INK, markersize=2.2)
            ax.set_title(shape.split()[0], fontsize=9.0, pad=13.0)
            if shape == CAPSULE:
                for kind, colour in zip(KINDS, COLOURS, strict=True):
                    ax.plot([], [], "s", color=colour, markersize=5.0, label=kind)
                ax.legend(
                    fontsize=8.0, frameon=False, loc="lower center", bbox_to_anchor=(0.5, 0.98), ncols=3,
                    borderpad=0, handletextpad=0, columnspacing=0.8,
                )  # fmt: skip
            ax.set_xlabel("α$_p$", labelpad=9.0)
            ax.set_ylabel("α$_u$", labelpad=15.0)

        return drawn

    def grows(ax: Any) -> None:
        rate = data["over_epsilon"].sel(wave="displaced")
        lines = (
            ("nothing", UP, "-", "all terms"),
            ("advection", DOWN, "--", "no advection"),
            ("shear", INK, ":", "no shear"),
        )
        for name, colour, dashes, label in lines:
            values = rate.sel(without=name).isel(weak_alpha_u=0)
            ax.plot(data["epsilon"], values, color=colour, linestyle=dashes, linewidth=1.2, label=label)
        ax.axhline(0.0, color=INK, linewidth=0.5)
        if np.isfinite(at := onset(data, 0.0)):
            reference(ax, at, f"{at:.3f}", upright=True)
        ax.set_xlim(0, float(data["epsilon"][-1]))
        ax.set_xlabel("ε", labelpad=1.0)
        ax.set_ylabel("growth, displaced sink", labelpad=1.0)
        ax.legend(fontsize=7.5, frameon=False, loc="upper left", borderpad=0, handlelength=1.6)

    panels = [*(Panel(plane(shape)) for shape in SHAPES), Panel(grows, 1.25)]
    return story(shown, panels, str(verdict(data)), width=200.0)


def _stripes(place: npt.NDArray[np.int64]) -> npt.NDArray[np.int64]:
    """Return kinds of one place in order, `DEEP` of them in their shares; `NONE` where none is known."""
    known = np.sort(place[place != NONE])
    if not known.size:
        return np.full(DEEP, NONE)
    return np.asarray(known[(np.arange(DEEP) * known.size) // DEEP])


EXPERIMENT = Experiment(
    name="ends",
    headline="Zero net flux stands in for the ends of a cell.",
    claim="The ends of a cell must be acknowledged, either by modelling their geometry or, as the paper "
    "does, qualitatively, by the constraint of zero net flux along a periodic cylinder.",
    source="Model (hydrodynamics)",
    method="The model is integrated from disorder to t = 400 on closed surfaces, on which flux through every "
    "circle around the cell vanishes by itself: a capsule of length 5 between rounded ends and a spheroid "
    "three times as long as wide, whose ends are pointed, and on the paper's cylinder, with one density of "
    "filaments, over a plane of rates (10 seeds, 20 of the cylinder). Ends differ where Fisher's exact test, "
    "corrected for all kinds, shapes and places, is below 0.05, or Mann and Whitney's for the shares of "
    "places at which seeds have two streams, where cylinders have either. Other lengths and forms of "
    "repulsion are followed at α_p = 0.5. Growth of perturbations of one stream from end to end is that of "
    "its linearised equation, taken apart by terms. The constraint is good in part if ends differ, but at "
    "half at most of the places where all cylinders have two streams.",
    seeds=10,
    quick_seeds=2,
    measure=measure,
    verdict=verdict,
    decisive=decisive,
    draw=draw,
)
