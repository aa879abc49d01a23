"""Closed cells and cylinders of one density of filaments, followed from disorder to their ends."""

from __future__ import annotations

from functools import cache, partial
from typing import Any, NamedTuple

import numpy as np

from .. import closed, models
from ..closed.grid import Array, ClosedGrid
from ..closed.shapes import Capsule, Sphere, Spheroid
from ..contract.model import Model
from ..ensemble import EnsembleSettings, Member, follow
from ..model import initial
from ..model.grid import CylinderGrid
from ..model.parameters import Parameters
from ..models.closed.states import REGIMES
from ..models.fields import flow

PRINCIPAL = "principal"
CYLINDER, CAPSULE, SPHEROID = SHAPES = ("cylinder 5", "capsule 5", "spheroid 3")
"""The shapes, in words, and the form of repulsion that are compared over both rates."""
LANES = 10
"""Seeds that are followed at once."""
SAME = {"unidirectional": "source-to-sink", "circumferential": "swirl"}
"""What regimes of the cylinder are called on a closed cell."""
ACROSS = 5.0
"""k_max times width of a zone."""


class End(NamedTuple):
    """How a cell ends.

    Its regime, a number in `REGIMES`, relative rate of change, order, root mean square speed, and the time
    since which it has looked so.
    """

    regime: float
    rate: float
    order: float
    speed: float
    since: float


def k_max(alpha_p: float, alpha_u: float) -> float:
    """Return a k_max that resolves zones between streams: 16, or 20, which is enough to tell regimes."""
    usual = Parameters()
    drive = alpha_p + 0.25 * alpha_u - float(usual.d_r)
    needed = ACROSS * np.sqrt(max(drive, 0.0) / (2 * float(usual.d_s)))
    return 16.0 if needed < 16.5 else 20.0


@cache
def closed_surface(shape: str, k: float) -> ClosedGrid:
    """Return the grid of a closed shape in words: "capsule 5", "spheroid 3" or "sphere"."""
    kind, *size = shape.split()
    made: dict[str, Any] = {"capsule": Capsule, "spheroid": Spheroid, "sphere": Sphere}
    return ClosedGrid(made[kind](*map(float, size)), k)


def surface(shape: str, k: float) -> ClosedGrid | CylinderGrid:
    """Return the grid of a shape in words, also "cylinder 5"."""
    kind, size = shape.split()
    if kind != "cylinder":
        return closed_surface(shape, k)
    return CylinderGrid(48, max(48, 2 * round(5 * float(size))), float(size))


def model_of(shape: str, repulsion: str) -> Model:
    """Return the model of a shape in words."""
    return models.polar if shape.startswith("cylinder") else models.closed_model(repulsion)


def start(grid: ClosedGrid | CylinderGrid, seed: int) -> Array:
    """Return disorder of the paper's density of filaments on any grid."""
    if isinstance(grid, ClosedGrid):
        return closed.disordered(grid, seed=seed)
    return initial.disordered(grid, seed=seed, noise_grid=(64, round(64 * grid.length / 5.0)))


def ends(
    shape: str, repulsion: str, alpha_p: float, alpha_u: float, k: float, first: int, count: int, late: float
) -> Array:
    """Return the `End` (count, 5) of cells from disorder at a time `late`, of seeds from `first` on."""
    grid, model = surface(shape, k), model_of(shape, repulsion)
    params = Parameters(alpha_p=alpha_p, alpha_u=alpha_u)
    seeds = range(first, first + count)
    members = [Member(params, grid, partial(start, grid, seed), model=model) for seed in seeds]
    how = EnsembleSettings(t_end=late, finish="t_end", rtol=1e-3, lanes=min(LANES, count))
    return np.array([_end(model, params, grid, outcome) for outcome in follow(members, how)])


def _end(model: Model, params: Parameters, grid: Any, outcome: Any) -> End:
    assert model.regime is not None
    found = model.regime(model.problem(params, grid), outcome.state)
    regime = REGIMES.index(SAME.get(found.name, found.name))
    square = np.sum(flow(params, grid, outcome.state) ** 2, axis=0)
    speed = np.sqrt(grid.mean(square) if isinstance(grid, ClosedGrid) else square.mean())
    return End(regime, found.rate, found.order, float(speed), outcome.t_order)
