"""How ends of closed cells and of cylinders are compared, and the verdict in words."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
import scipy.stats
import xarray

from ..models.closed.states import REGIMES
from .closed_cells import CAPSULE, CYLINDER, SHAPES, SPHEROID
from .experiment import AGREES, DOES_NOT, IN_PART, Verdict

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
    """Return how many cells of a shape at some places are of a kind, and of how many.

    Only of seeds that are computed at all places, so that each place has the same weight.
    """
    found = kinds(data["end"].sel(shape=shape).transpose("alpha_p", "alpha_u", "seed", "number"))
    number = counts(found[..., (found != NONE).all(axis=(0, 1))])
    return int(number[where][:, kind].sum()), int(number[where].sum())


def unsettled(data: xarray.Dataset, shape: str) -> tuple[int, int]:
    """Return how many cells of a shape still change at the end, and of how many."""
    rate = data["end"].sel(shape=shape, number="rate").values
    return int((rate > SETTLED).sum()), int(np.isfinite(rate).sum())


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


def _line_in_words(data: xarray.Dataset) -> str:
    """Return the share of two streams along the line, for every shape and repulsion."""
    found = counts(kinds(data["line"].transpose("other", "line_alpha_u", "line_seed", "number")))
    words = []
    for name, rows in zip(data["other"].values, found, strict=True):
        shares = [f"{row[1]} of {row.sum()}" for row in rows]
        told = (
            shares[0] + (" everywhere" if len(shares) > 1 else "")
            if len(set(shares)) == 1
            else ", ".join(shares)
        )
        words.append(f"{name.replace(', principal', '')}: {told}")
    return "; ".join(words)


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
        f"more filaments lie behind a displaced sink than ahead of it, and they point the way it has moved. "
        f"So the flow over the pole follows it, at {sink['push']:.2f} of its displacement, and carries it "
        f"further: at (0.5, 0) it grows at {sink['rate']:.4f}, of which advection gives "
        f"{sink['advection']:.4f}, shear {sink['shear']:.4f}, and all else {rest:.4f}. A source is pushed "
        f"back ({source['push']:.2f}, {source['rate']:.4f}). In pointed ends repulsion, "
        f"{other['repulsion']:.2f}, holds a sink against a push of {other['push']:.2f}"
    )


def _fine_in_words(data: xarray.Dataset) -> str:
    """Return how cells end that were computed again, with a larger k_max."""
    found = counts(kinds(data["fine"].transpose("point", "fine_seed", "number")))
    places = zip(
        *(data[f"point_{name}"].values for name in ("shape", "alpha_p", "alpha_u")), found, strict=True
    )
    return ", ".join(
        f"{row[1]} of {row.sum()} {shape.split()[0]}s at ({p:g}, {u:g})" for shape, p, u, row in places
    )


def verdict(data: xarray.Dataset) -> Verdict:
    """Judge: whether closed cells end as the cylinder does, at least where that always has two streams."""
    apart = {shape: differs(data, shape) for shape in SHAPES[1:]}
    where = regions(data)
    both = apart[CAPSULE] | apart[SPHEROID]

    def of(shape: str, region: str, kind: int) -> str:
        return "{} of {}".format(*share(data, shape, where[region], kind))

    along = ", ".join(f"{alpha_u:g}" for alpha_u in data["line_alpha_u"].values)
    p = {shape: overall(data, shape) for shape in SHAPES[1:]}
    late = ", ".join("{} of {} {}s".format(*unsettled(data, each), each.split()[0]) for each in SHAPES)
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
        f"is unstable above ε = {onset(data, 0.0):.3f} at (0.5, 0): {_pushed_in_words(data)}. "
        f"Cells with two streams at α_p = 0.5 and α_u = {along}: {_line_in_words(data)}. At k_max "
        f"{float(data['point_k_max'][0]):g}: {_fine_in_words(data)}"
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
