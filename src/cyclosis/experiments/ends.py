"""Whether the paper's zero flux stands in for the ends of a cell: closed cells against the cylinder."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt
import xarray

from .. import models, stability
from ..closed.grid import Array, ClosedGrid
from ..dynamics.simulate import simulate
from ..model.errors import InputError
from ..model.filaments import TERMS
from ..model.parameters import Parameters
from ..models.fields import flow
from . import closed_cells, closed_views
from .closed_cells import End, surface
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
ALONG, QUICK_ALONG = (0.0125, 0.025, 0.05, 0.1, 0.2), (0.025,)
OTHERS = (
    *(("cylinder 2", PRINCIPAL), ("cylinder 7", PRINCIPAL), ("cylinder 10", PRINCIPAL)),
    *(("capsule 2", PRINCIPAL), ("capsule 10", PRINCIPAL)),
    *((CAPSULE, "polynomial"), (CAPSULE, "bounded")),
    *((SPHEROID, "polynomial"), (SPHEROID, "bounded")),
)
QUICK_OTHERS = (("cylinder 7", PRINCIPAL), ("capsule 2", PRINCIPAL))
"""A cylinder of length 7 is as long as a capsule of 5 with its ends."""
FINE_POINTS, FINE = ((1.0, 0.5), (0.5, 0.05), (0.5, 0.025)), 24.0
"""Points at which capsules are computed again with a larger k_max."""
EPSILON = (0.0, 0.01, 0.02, 0.03, 0.04, 0.05, 0.075, 0.1, 0.15, 0.2)
QUICK_EPSILON = (0.0, 0.05, 0.1)
WEAK = (0.0, 0.025)
"""Values of α_u at which growth is computed over ε."""
WITHOUT = ("", "advection", "shear")
"""What is left out where growth is computed over ε."""
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
    params, grid = Parameters(alpha_p=alpha_p, alpha_u=alpha_u, epsilon=epsilon), surface(shape, k)
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
    params, grid = Parameters(alpha_p=alpha_p, alpha_u=alpha_u), surface(shape, 16.0)
    assert isinstance(grid, ClosedGrid)
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
    params, grid = Parameters(alpha_p=alpha_p, alpha_u=alpha_u), surface(shape, 16.0)
    assert isinstance(grid, ClosedGrid)
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
    items: list[tuple[Any, ...]] = [
        (shape, PRINCIPAL, alpha_p, alpha_u, usual, "", closed_cells.k_max(alpha_p, alpha_u))
        for shape in SHAPES[1:]
        for alpha_p in rates[0]
        for alpha_u in rates[1]
    ]
    plane = np.reshape(lab.kept("growth", growth, items), (2, len(rates[0]), len(rates[1]), len(WAVES)))
    epsilon = QUICK_EPSILON if lab.quick else EPSILON
    items = [
        (CAPSULE, PRINCIPAL, LINE, alpha_u, value, without, 16.0)
        for without in WITHOUT
        for alpha_u in WEAK
        for value in epsilon
    ]
    over = np.reshape(lab.kept("growth", growth, items), (len(WITHOUT), len(WEAK), len(epsilon), len(WAVES)))
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
