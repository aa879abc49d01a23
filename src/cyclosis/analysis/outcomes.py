"""What became of many members: counts, regions of the parameter space, times to order, separating ratios.

Regimes are codes, that is indices into `REGIMES`; -1 is a member that has not been computed, which
is counted nowhere here. The members of a parameter point are along the last dimension.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from ..model.grid import Array
from .regimes import REGIMES

Codes = npt.NDArray[np.integer]

REGIONS = {
    "D": "disorder",
    "U": "unidirectional",
    "C/U": "cyclosis or unidirectional",
    "C": "cyclosis",
    "M": "multistripe",
    "O": "circumferential",
    "T": "travelling",
    "?": "undecided",
    "mixed": "other mixtures",
}
"""Regions of the parameter space and what they mean; D, C/U and C are those of Woodhouse & Goldstein 2013."""

_PURE = dict(zip(("D", "U", "C", "M", "O", "T", "?"), REGIMES, strict=True))
_DISORDERED, _UNIDIRECTIONAL, _CYCLOSIS = (
    REGIMES.index(name) for name in ("disordered", "unidirectional", "cyclosis")
)


def tally(regime: Codes) -> npt.NDArray[np.int64]:
    """Return how many members of codes (..., members) are in each of `REGIMES`, shape (..., regimes)."""
    codes = np.asarray(regime)[..., None]
    return np.sum(codes == np.arange(len(REGIMES)), axis=-2, dtype=np.int64)


def share(counts: npt.NDArray[np.int64], name: str = "cyclosis") -> Array:
    """Return the share (...) of one regime in `tally` counts (..., regimes); NaN where nothing is counted."""
    total = counts.sum(axis=-1)
    found: Array = counts[..., REGIMES.index(name)] / np.where(total > 0, total, np.nan)
    return found


def regions(counts: npt.NDArray[np.int64]) -> npt.NDArray[np.int64]:
    """Return the region (...) of every parameter point as an index into `REGIONS`; -1 without members.

    A point is in C/U if at least one member became cyclosis and one unidirectional, whatever the others
    did; in D, U, C, M, O, T or ? if all members are in that one regime; else in `mixed`. So more members
    can only move a point from a pure region to a mixed one.
    """
    names = list(REGIONS)
    total = counts.sum(axis=-1)
    found = np.full(total.shape, names.index("mixed"), dtype=np.int64)
    for letter, regime in _PURE.items():
        found[counts[..., REGIMES.index(regime)] == total] = names.index(letter)
    both = (counts[..., _CYCLOSIS] > 0) & (counts[..., _UNIDIRECTIONAL] > 0)
    found[both] = names.index("C/U")
    found[total == 0] = -1
    return found


def time_to_order(regime: Codes, t_order: npt.ArrayLike, quantile: float = 0.5) -> Array:
    """Return a quantile (...), by default the median, of the times to order (..., members).

    Only members that are not disordered and have a time count: how long order takes if it arises.
    Times are dimensionless (R/U); NaN where no member has one.
    """
    times = np.array(np.broadcast_to(t_order, np.shape(regime)), dtype=np.float64)
    times[(np.asarray(regime) < 0) | (np.asarray(regime) == _DISORDERED) | ~np.isfinite(times)] = np.nan
    found = np.full(times.shape[:-1], np.nan)
    some = np.isfinite(times).any(axis=-1)
    found[some] = np.nanquantile(times[some], quantile, axis=-1)
    return found


class Separation(NamedTuple):
    """The threshold of a number above which an outcome is predicted, and how well.

    `threshold` is infinite if predicting the more common outcome for all is as good; `correct` is the
    share of members that it predicts, `guess` the share in the more common outcome.
    """

    threshold: float
    correct: float
    guess: float


def separation(values: npt.ArrayLike, outcome: npt.ArrayLike) -> Separation:
    """Return the threshold r of positive `values` (n,) such that value > r predicts `outcome` (n,) best.

    r maximises the number of members with (value > r) == outcome, among all r. Where that leaves a choice,
    r is in the gap between two neighbouring values that is widest on a logarithmic scale, at its
    geometric mean. Dimensionless.
    """
    x, y = np.asarray(values, dtype=np.float64), np.asarray(outcome, dtype=bool)
    order = np.argsort(x, kind="stable")
    x, y = x[order], y[order]
    # With the threshold before place k, False is predicted for those below it, True for the others.
    right = np.concatenate([[0], np.cumsum(~y)]) + np.concatenate([np.cumsum(y[::-1])[::-1], [0]])
    guess = max(int(y.sum()), int((~y).sum()))
    inner = np.flatnonzero(x[1:] > x[:-1]) + 1
    best = int(right[inner].max()) if inner.size else 0
    if best <= guess:
        return Separation(np.inf, guess / y.size, guess / y.size)
    places = inner[right[inner] == best]
    place = places[np.argmax(x[places] / x[places - 1])]
    return Separation(float(np.sqrt(x[place - 1] * x[place])), best / y.size, guess / y.size)
