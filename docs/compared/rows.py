"""What a row of the table is, and what several rows use."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
import xarray

from cyclosis.analysis.regimes import REGIMES
from cyclosis.experiments.experiment import AGREES, DOES_NOT, IN_PART

Cells = dict[str, tuple[str, str]]
"""Verdict, or "" without one, and number, by the name of the model."""
KAPPA, D_R = 0.5, 0.025
"""The paper's repulsion and rotational diffusion."""
STRONG, THIN = 0.3, 0.007
"""The largest drag that was computed, and that of a thin layer."""
ONE, TWO = 2, 3
"""Outcomes of rings: one direction, two stripes."""
MOST, FEW, HALF = 0.9, 0.2, 0.5
"""Shares of cells from which on, or up to which, a claim holds of all, of none, or of most."""


class Row(NamedTuple):
    """A claim, where the paper makes it, the function of its cells, and that of the sentence about them."""

    title: str
    claim: str
    source: str
    cells: Callable[[Any], Cells]
    why: Callable[[Any], str]


def bears_out(told: Any, what: str) -> None:
    """Raise `ValueError` unless the data bear out what a sentence says."""
    if not told:
        raise ValueError(f"the data no longer say that {what}: the sentence in docs/compared is wrong")


def judged(good: Any, partly: Any = False) -> str:
    """Return the verdict on a claim that holds, holds in part, or does not."""
    return AGREES if good else IN_PART if partly else DOES_NOT


def of(count: Any, total: Any) -> str:
    """Return a share in words."""
    return f"{int(count)} of {int(total)}"


def onset(data: Any) -> tuple[float, float, float]:
    """Return the measured α_p above which order grows: polar, kinetic, and with the strongest drag."""
    grown = data["vacuole-passive"]["grown"].sel(what="order", way="measured")
    begin = data["closure"]["threshold"].sel(ratio=KAPPA / D_R, direction="theta", way="measured")
    return float(grown.sel(grown_beta=0.0)), float(begin), float(grown.sel(grown_beta=STRONG))


def ring_counts(data: Any) -> tuple[xarray.DataArray, xarray.DataArray]:
    """Return how many kinetic rings (alpha_p, alpha_u) above the onset have two stripes, and of how many."""
    rings = data["closure"]["ring"].sel(model="kinetic", number="outcome")
    above = rings.isel(alpha_p=np.flatnonzero(rings["alpha_p"].values > onset(data)[1]))
    return (above == TWO).sum("ring_seed"), above.notnull().sum("ring_seed")


def striped(data: xarray.Dataset) -> xarray.DataArray:
    """Return the widths, over zones, of members of a sweep that end with two stripes; others are NaN."""
    named = data["regime"].isin([REGIMES.index(name) for name in ("cyclosis", "travelling")])
    width = data["stripe_width"].where(named)
    return width.where(width.notnull().sum("zone") == 2)
