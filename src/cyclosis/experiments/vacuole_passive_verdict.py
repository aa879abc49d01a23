"""How cells with and without the drag of the vacuole are compared, and the verdict in words."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
import scipy.stats
import xarray

from ..model.grid import Array
from ..models.coupled import USUAL
from .experiment import AGREES, DOES_NOT, IN_PART, Verdict

KINDS = ("disorder", "one stream", "two stripes", "tilted stripes", "around the axis", "other")
VALUES = np.linspace(0.025, 1.0, 20)
"""The values of α_p and α_u in Figure 5."""
SAME = 0.05
"""Relative change up to which speeds and thresholds count as the same."""
SURE = 0.05
"""Level of the tests whether ends change, together over all kinds and places."""
COMPARED = ("peak_speed", "break_up", "alpha_u_widths", "fold")


def _paired(data: xarray.Dataset, beta: float) -> tuple[Array, Array]:
    """Return the kinds of ends (places, seeds) without drag, and with a drag β."""
    ends = np.asarray(data["kind"].transpose("beta", "place", "seed").values)
    return ends[0], ends[int(np.argmin(np.abs(data["beta"].values - beta)))]


def changes(data: xarray.Dataset, beta: float) -> tuple[Array, float]:
    """Return the number of seeds that end otherwise with a drag β than without, at each place (places,).

    Also the number of all that would if every seed were replaced by another one, without any drag.
    """
    none, with_drag = _paired(data, beta)
    seeds = none.shape[1]
    counts = np.stack([(none == k).sum(axis=1) for k in range(len(KINDS))])
    pairs = seeds**2 - (counts**2).sum(axis=0)
    return (none != with_drag).sum(axis=1), float(pairs.sum() / max(seeds - 1, 1))


def beyond_seeds(data: xarray.Dataset, beta: float) -> npt.NDArray[np.bool_]:
    """Return at which places (places,) ends change with a drag β by more than chance.

    If the drag only disturbed cells as another seed does, as many would gain an end as lose it: the exact
    test of McNemar, for every kind at every place, at the level `SURE` divided by their number (Bonferroni).
    """
    none, with_drag = _paired(data, beta)
    found = np.zeros(none.shape[0], dtype=bool)
    for k in range(len(KINDS)):
        gained = ((none != k) & (with_drag == k)).sum(axis=1)
        lost = ((none == k) & (with_drag != k)).sum(axis=1)
        for place, (up, down) in enumerate(zip(gained, lost, strict=True)):
            found[place] |= mcnemar(up, down) < SURE / (len(KINDS) * none.shape[0])
    return found


def mcnemar(up: int, down: int) -> float:
    """Return the p-value of so many changes one way and the other, if both are as likely."""
    return float(scipy.stats.binomtest(int(up), int(up + down)).pvalue) if up + down else 1.0


def merged(data: xarray.Dataset, beta: float) -> tuple[int, int]:
    """Return how many cells, at all places, have one stream instead of two with a drag β, and the reverse."""
    none, with_drag = _paired(data, beta)
    two = [(each == 2) | (each == 3) for each in (none, with_drag)]
    return int((two[0] & (with_drag == 1)).sum()), int((two[1] & (none == 1)).sum())


def ratios(data: xarray.Dataset, beta: float) -> dict[str, float]:
    """Return speed and thresholds in `COMPARED` with a drag β, relative to those without."""
    at, none = (data.sel(curve=x, method="nearest") for x in (beta, 0.0))
    return {name: float(at[name] / none[name]) for name in COMPARED}


def altered(data: xarray.Dataset, beta: float) -> bool:
    """Return whether a drag β changes ends beyond what seeds give, or a number by more than `SAME`."""
    ends = beyond_seeds(data, beta).any() or mcnemar(*merged(data, beta)) < SURE
    return bool(ends) or any(abs(ratio - 1) > SAME for ratio in ratios(data, beta).values())


def tilted_places(data: xarray.Dataset) -> dict[float, int]:
    """Return at how many places of Figure 5, at the α_u of the borders, stripes tilt by theory, by β."""
    border = np.asarray(data["edge"].values)
    counts = (VALUES[:, None] >= border[:, None, :]).sum(axis=(1, 2))
    return {float(beta): int(n) for beta, n in zip(data["edge_beta"].values, counts, strict=True)}


def as_predicted(data: xarray.Dataset) -> tuple[int, int]:
    """Return how many cells with two stripes are tilted or upright as theory says, and of how many."""
    ends = np.asarray(data["kind"].transpose("beta", "place", "seed").values)
    says = np.where(data["theory_tilt"].transpose("beta", "place").values > 0, 3, 2)[..., None]
    striped = (ends == 2) | (ends == 3)
    return int((striped & (ends == says)).sum()), int(striped.sum())


def _ends_in_words(data: xarray.Dataset, beta: float) -> str:
    changed, redrawn = changes(data, beta)
    total = data.sizes["place"] * data.sizes["seed"]
    sure = int(beyond_seeds(data, beta).sum())
    where = f"beyond chance at {sure} of {changed.size} places" if sure else "nowhere beyond chance"
    return f"{int(changed.sum())} of {total} at β = {beta:g} ({where}; other seeds: {redrawn:.0f})"


def _merged_in_words(data: xarray.Dataset, beta: float) -> str:
    one, two = merged(data, beta)
    p = mcnemar(one, two)
    return f"{one} and {two} at β = {beta:g} (p = {p:.2g})"


def verdict(data: xarray.Dataset) -> Verdict:
    """Judge: whether a drag of the vacuole changes ends beyond what seeds give, speeds or thresholds."""
    beta = [float(x) for x in data["beta"].values]
    most = beta[-1]
    usual, last = ratios(data, USUAL), ratios(data, most)
    grown = data["grown"]
    off = float(abs(grown.sel(way="measured") / grown.sel(way="theory") - 1).isel(what=[0, 1, 2]).max())
    leaning = grown.sel(what="tilt")
    tilts = float(abs(leaning.sel(way="measured") - leaning.sel(way="theory")).max())
    figure_4, corner = (float(x) for x in data["tilting_drag"].values)
    ends = ", ".join(_ends_in_words(data, x) for x in beta[1:])
    right, striped = as_predicted(data)
    places = ", ".join(f"{n} at β = {x:g}" for x, n in tilted_places(data).items())
    shift = ", ".join(_merged_in_words(data, x) for x in beta[1:])
    searched = VALUES.size * data.sizes["edge_alpha_u"]
    text = (
        f"order grows from disorder above α_p = {float(grown.sel(what='order', way='theory')[0]):g} whatever "
        f"the drag β, one stream breaks up at an α_u {last['break_up']:.3f} times as large at β = {most:g} "
        f"(measured thresholds differ by {off:.0e} at most). Two stripes stream at {usual['peak_speed']:.3f} "
        f"of their speed at β = {USUAL:g} (a thin layer) and {last['peak_speed']:.3f} at {most:g}, where the "
        f"vacuole takes {100 * float(data['share'].sel(curve=most, method='nearest')):.0f} % of the power, "
        f"keep equal widths above an α_u {last['alpha_u_widths']:.3f} times as large, and last without "
        f"bundling above one {last['fold']:.3f} times as large. But flow around the axis has no drag, since "
        f"the vacuole turns with the wall, while streams slow down, and stripes tilt and turn about the axis "
        f"from β = {corner:.4f} at α_p = α_u = 1 and from {figure_4:.4f} in Figure 4 (rates measured "
        f"within {tilts:.0e}), by theory at {places} of {searched} places of Figure 5; "
        f"{right} of {striped} cells with stripes are as theory says. With the same seed cells end "
        f"otherwise in {ends}; two streams become one, and one becomes two, in {shift}"
    )
    if altered(data, USUAL):
        return Verdict(DOES_NOT, text)
    return Verdict(IN_PART if altered(data, most) else AGREES, text)


def decisive(data: xarray.Dataset) -> str:
    """Return the drag from which on stripes of Figure 5 tilt."""
    corner = float(data["tilting_drag"].sel(cell="corner"))
    return f"{corner:.4f} is the drag β from which stripes of Figure 5 tilt (a thin layer has {USUAL:g})"
