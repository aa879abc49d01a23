"""Growth of perturbations of one stream from end to end, and what drives it."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray

from .. import stability
from ..closed.grid import Array, ClosedGrid
from ..model.errors import InputError
from ..model.filaments import TERMS
from ..model.parameters import Parameters
from ..models.fields import flow
from .closed_cells import CAPSULE, PRINCIPAL, SHAPES, SPHEROID, closed_surface
from .lab import Lab

ALPHA_P = 0.5
"""The α_p at which growth is computed over ε."""
EPSILON = (0.0, 0.02, 0.04, 0.05, 0.075, 0.1, 0.15, 0.2)
QUICK_EPSILON = (0.0, 0.05, 0.1)
WEAK = (0.0, 0.025)
"""Values of α_u at which growth is computed over ε."""
WITHOUT = ("", "advection", "shear")
"""What is left out where growth is computed over ε, at the first of these."""
USUAL_K = 16.0
"""The k_max at which growth is computed."""
WAVES = ("swirl", "displaced", "second")
"""Perturbations of one stream from end to end: order around the axis (m = 0), and the first two of m = 1."""
PUSHED = ((CAPSULE, 0.5, 0.0), (CAPSULE, 0.5, 0.025), (SPHEROID, 0.5, 0.025))
"""Cells in which growth is taken apart."""
PARTS = ("rate", "push", *(term.name for term in TERMS))
SMALL = 1e-5


def measured(lab: Lab, rates: tuple[tuple[float, ...], tuple[float, ...]]) -> xarray.Dataset:
    """Return growth rates of perturbations of order from end to end over both rates, and over ε."""
    usual = float(Parameters().epsilon)
    items: list[tuple[Any, ...]] = [
        (shape, PRINCIPAL, alpha_p, alpha_u, usual, "", USUAL_K)
        for shape in SHAPES[1:]
        for alpha_p in rates[0]
        for alpha_u in rates[1]
    ]
    plane = np.reshape(lab.each("growth", growth, items), (2, len(rates[0]), len(rates[1]), len(WAVES)))
    epsilon = QUICK_EPSILON if lab.quick else EPSILON
    over = np.full((len(WITHOUT), len(WEAK), len(epsilon), len(WAVES)), np.nan)
    known = [place for place in np.ndindex(over.shape[:3]) if place[0] == 0 or place[1] == 0]
    items = [(CAPSULE, PRINCIPAL, ALPHA_P, WEAK[j], epsilon[k], WITHOUT[i], USUAL_K) for i, j, k in known]
    for place, row in zip(known, lab.each("growth", growth, items), strict=True):
        over[place] = row
    items = [(*cell, rank) for cell in PUSHED for rank in (0, 2)]
    parts = np.reshape(lab.each("parts", pushed, items), (len(PUSHED), 2, len(PARTS)))
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
