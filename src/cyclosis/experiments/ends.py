"""Whether the paper's zero flux stands in for the ends of a cell: closed cells against the cylinder."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt
import xarray

from .. import models
from ..closed.grid import Array
from ..dynamics.simulate import simulate
from ..model.parameters import Parameters
from ..models.fields import flow
from . import closed_cells, closed_views, ends_growth
from .closed_cells import CAPSULE, PRINCIPAL, SHAPES, SPHEROID, End, closed_surface
from .ends_figure import SHOWN, draw
from .ends_growth import USUAL_K
from .ends_verdict import counts, decisive, kinds, verdict
from .experiment import Experiment
from .lab import Lab

RATES = ((0.1, 0.2, 0.3, 0.4, 0.5, 0.65, 0.8, 1.0), (0.0125, 0.025, 0.05, 0.1, 0.2, 0.35, 0.6, 1.0))
QUICK_RATES = ((0.5, 1.0), (0.025, 0.5))
"""Values of α_p and α_u."""
LATE, QUICK_LATE = 400.0, 120.0
MORE_SEEDS = 20
"""Seeds of cylinders, which are cheap, and of closed cells where ends of the first seeds are mixed."""
LINE = 0.5
"""The α_p of the line on which more shapes and forms of repulsion are compared, over α_u."""
ALONG, QUICK_ALONG = (0.0125, 0.025, 0.05, 0.1, 0.2), (0.025,)
OTHERS = (
    ("cylinder 2", PRINCIPAL),
    ("cylinder 7", PRINCIPAL),
    ("capsule 2", PRINCIPAL),
    ("capsule 10", PRINCIPAL),
    (CAPSULE, "polynomial"),
    (CAPSULE, "bounded"),
    (SPHEROID, "polynomial"),
    (SPHEROID, "bounded"),
)
QUICK_OTHERS = (("cylinder 7", PRINCIPAL), ("capsule 2", PRINCIPAL))
"""A cylinder of length 7 is as long as a capsule of 5 with its ends."""
FINE_CELLS = (
    (CAPSULE, 1.0, 0.5),
    (CAPSULE, 0.5, 0.05),
    (CAPSULE, 0.5, 0.025),
    (SPHEROID, 1.0, 0.5),
    (SPHEROID, 0.5, 0.025),
)
QUICK_FINE_CELLS = ((CAPSULE, 0.5, 0.025),)
FINE, QUICK_FINE = 24.0, 16.0
"""Cells that are computed again with a larger k_max."""


def view(shape: str, alpha_p: float, alpha_u: float, late: float) -> Array:
    """Return the picture of a cell from disorder at a time."""
    params = Parameters(alpha_p=alpha_p, alpha_u=alpha_u)
    grid: Any = closed_surface(shape, USUAL_K)
    begin = closed_cells.start(grid, 0)
    P = simulate(params, grid, begin, late, save_every=late, rtol=1e-3, model=models.closed).final_state
    return closed_views.seen(grid, P, flow(params, grid, P), closed_views.facing(grid, P))


def measure(lab: Lab) -> xarray.Dataset:
    """Return how cells of all shapes end, and the growth of perturbations of one stream from end to end."""
    rates = QUICK_RATES if lab.quick else RATES
    return xarray.merge([_plane(lab, rates), ends_growth.measured(lab, rates), _line(lab), _views(lab)])


def _batches(seeds: range) -> list[tuple[int, int]]:
    """Return first seeds and numbers of batches that fill lanes."""
    step = closed_cells.LANES
    return [(first, min(step, seeds.stop - first)) for first in range(seeds.start, seeds.stop, step)]


def _ends(lab: Lab, cells: list[tuple[Any, ...]], seeds: range) -> Array:
    """Return the `End` (cells, seeds, 5) of cells given as shape, repulsion, α_p, α_u and k_max."""
    late = QUICK_LATE if lab.quick else LATE
    batches = _batches(seeds)
    items = [(*cell, *batch, late) for cell in cells for batch in batches]
    rows = lab.each("ends", closed_cells.ends, items)
    each = len(batches)
    return np.array([np.concatenate(rows[k : k + each]) for k in range(0, len(rows), each)])


def _most(lab: Lab) -> int:
    return lab.seeds if lab.quick else max(lab.seeds, MORE_SEEDS)


def _table(lab: Lab, cells: list[tuple[Any, ...]]) -> npt.NDArray[np.float32]:
    """Return the `End` (cells, seeds, 5) of cells of one shape; NaN for seeds that are not computed.

    More seeds of a closed cell are computed only where the first ones do not all end alike.
    """
    most = _most(lab)
    first = most if cells[0][0].startswith("cylinder") else lab.seeds
    found = np.full((len(cells), most, len(End._fields)), np.nan, dtype=np.float32)
    found[:, :first] = _ends(lab, cells, range(first))
    ends = xarray.DataArray(
        found[:, :first], dims=("cell", "seed", "number"), coords={"number": list(End._fields)}
    )
    mixed = np.flatnonzero(counts(kinds(ends)).max(axis=-1) < first)
    if first < most and mixed.size:
        found[mixed, first:] = _ends(lab, [cells[k] for k in mixed], range(first, most))
    return found


def _plane(lab: Lab, rates: tuple[tuple[float, ...], tuple[float, ...]]) -> xarray.Dataset:
    """Return how cells end over both rates."""
    places = [(alpha_p, alpha_u) for alpha_p in rates[0] for alpha_u in rates[1]]
    found = np.stack(
        [
            _table(lab, [(shape, PRINCIPAL, *place, closed_cells.k_max(*place)) for place in places])
            for shape in SHAPES
        ]
    )
    whole = found.reshape(len(SHAPES), len(rates[0]), len(rates[1]), *found.shape[2:])
    dims = ("shape", "alpha_p", "alpha_u", "seed", "number")
    coords = {"shape": list(SHAPES), "alpha_p": list(rates[0]), "alpha_u": list(rates[1])}
    return xarray.Dataset({"end": (dims, whole)}, coords | {"number": list(End._fields)})


def _line(lab: Lab) -> xarray.Dataset:
    """Return how other cells end along a line, and some of the plane with a larger k_max."""
    others, along = (QUICK_OTHERS, QUICK_ALONG) if lab.quick else (OTHERS, ALONG)
    line = np.stack(
        [
            _table(lab, [(*other, LINE, alpha_u, closed_cells.k_max(LINE, alpha_u)) for alpha_u in along])
            for other in others
        ]
    )
    cells, k_max = (QUICK_FINE_CELLS, QUICK_FINE) if lab.quick else (FINE_CELLS, FINE)
    fine = _ends(lab, [(shape, PRINCIPAL, *place, k_max) for shape, *place in cells], range(lab.seeds))
    return xarray.Dataset(
        {
            "line": (("other", "line_alpha_u", "line_seed", "number"), line),
            "fine": (("point", "fine_seed", "number"), fine.astype(np.float32)),
        },
        {
            "other": [f"{shape}, {repulsion}" for shape, repulsion in others],
            "line_alpha_u": list(along),
            "point_shape": ("point", [cell[0] for cell in cells]),
            "point_alpha_p": ("point", [cell[1] for cell in cells]),
            "point_alpha_u": ("point", [cell[2] for cell in cells]),
            "point_k_max": ("point", [k_max] * len(cells)),
        },
    )


def _views(lab: Lab) -> xarray.Dataset:
    late = QUICK_LATE if lab.quick else LATE
    seen = np.array(lab.each("views", view, [(*cell, late) for cell in SHOWN])).astype(np.float32)
    return xarray.Dataset(
        {"picture": (("frame", "field", "across", "up"), seen)}, {"field": list(closed_views.FIELDS)}
    )


EXPERIMENT = Experiment(
    name="ends",
    headline="Zero net flux stands in for the ends of a cell.",
    claim="The ends of a cell must be acknowledged, either by modelling their geometry or, as the paper "
    "does, qualitatively, by the constraint of zero net flux along a periodic cylinder.",
    source="Model (hydrodynamics)",
    method="The model is integrated from disorder to t = 400 on closed surfaces, on which flux through every "
    "circle around the cell vanishes by itself: a capsule of length 5 between rounded ends and a spheroid "
    "three times as long as wide, whose ends are pointed, and on the paper's cylinder, with one density of "
    "filaments, over a plane of rates (10 seeds; 20 on the cylinder, and where seeds end differently). Ends "
    "differ where Fisher's exact test, corrected for all kinds, shapes and places, is below 0.05, or Mann "
    "and Whitney's for the shares of places at which seeds have two streams, where cylinders have either. "
    "Other lengths and forms of repulsion are compared at α_p = 0.5. Growth of perturbations of one stream "
    "from end to end is that of its linearised equation, taken apart by terms. The constraint is good in "
    "part if ends differ, but at half at most of the places where all cylinders have two streams.",
    seeds=10,
    quick_seeds=2,
    measure=measure,
    verdict=verdict,
    decisive=decisive,
    draw=draw,
)
