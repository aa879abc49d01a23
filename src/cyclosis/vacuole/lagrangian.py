"""What the paths of tracers show: sections of Poincaré, times of residence, and stretching."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from ..display.shown import shown
from ..model.doors import door
from ..model.errors import InputError, choice, number
from ..model.grid import Array
from .flow import VacuoleFlow
from .points import checked_points
from .sampled import beginning, is_flow
from .tracers import USUAL_STEP, Carrier, Paths, cartesian_places
from .unsteady import UnsteadyFlow

APART = 1e-6
"""First distance of two tracers, in R; they are brought back to it after every interval."""


@shown
@dataclass(frozen=True, eq=False)
class Crossings:
    """Where tracers pass a cross-section: `xy` (crossings, 2), `tracer`, `t`, `forwards` (u_z > 0).

    Example:
        >>> import cyclosis as cy
        >>> grid = cy.CylinderGrid(16, 16)
        >>> flow = cy.vacuole.flow(grid, cy.flow(cy.Parameters(), grid, cy.initial.stripes(grid)))
        >>> paths = cy.vacuole.trace(flow, [[0.5, 1.5, 0.0]], t_end=30.0, order=3)
        >>> found = cy.vacuole.poincare(paths, z=2.5)
        >>> found.xy.shape[1], bool(found.forwards.all())
        (2, True)
    """

    xy: Array
    tracer: npt.NDArray[np.int64]
    t: Array
    forwards: npt.NDArray[np.bool_]


@door
def poincare(paths: Paths, z: float = 0.0) -> Crossings:
    """Return where paths cross the section at `z`, or a periodic image of it, in order of tracer and time.

    Between saved places the path is the cubic through the four nearest: save every step. Dimensionless.
    Raises `InputError` for fewer than four places.

    Example:
        >>> import cyclosis as cy
        >>> grid = cy.CylinderGrid(16, 16)
        >>> flow = cy.vacuole.flow(grid, cy.flow(cy.Parameters(), grid, cy.initial.stripes(grid)))
        >>> paths = cy.vacuole.trace(flow, [[0.0, 0.0, 0.0], [0.5, 1.5, 0.0]], t_end=20.0, order=3)
        >>> set(cy.vacuole.poincare(paths, z=1.0).tracer.tolist())  # the first stays on the axis, at rest
        {1}
    """
    _are_paths(paths, 4)
    where = number("z", z, -1e9, 1e9, "give a place along the cell, in R")
    turns = (paths.xyz[..., 2] - where) / paths.length
    before, after = np.floor(turns[:-1]), np.floor(turns[1:])
    tracer, row = np.nonzero((before != after).T)
    goal = np.maximum(before, after)[row, tracer] * paths.length + where
    first = np.clip(row - 1, 0, len(paths.t) - 4)
    chosen = first[:, None] + np.arange(4)
    times, places = paths.t[chosen], paths.xyz[chosen, tracer[:, None]]
    low, high = paths.t[row], paths.t[row + 1]
    forwards = after[row, tracer] > before[row, tracer]
    for _ in range(50):  # by bisection, to rounding
        middle = 0.5 * (low + high)
        beyond = (_cubic(times, places[..., 2:], middle)[:, 0] >= goal) == forwards
        low, high = np.where(beyond, low, middle), np.where(beyond, middle, high)
    return Crossings(_cubic(times, places[..., :2], high), tracer, high, forwards)


def _cubic(times: Array, places: Array, t: Array) -> Array:
    """Return the cubic through places (n, 4, d) at times (n, 4), at t (n,)."""
    out = np.zeros((t.size, places.shape[-1]))
    for k in range(4):
        others = np.delete(times, k, axis=1)
        weight = np.prod((t[:, None] - others) / (times[:, [k]] - others), axis=1)
        out += weight[:, None] * places[:, k]
    return out


@door
def residence_times(paths: Paths, region: Callable[[Array, Array, Array], npt.ArrayLike]) -> Array:
    """Return how long tracers stayed in a region, one time in R/U for every whole visit.

    `region` is a function of r, θ and z (arrays) that returns where they lie in it; z is within the period.
    Visits that had begun at the start or last at the end are left out. Times are multiples of the interval
    between saved places, and shorter visits are missed. Raises `InputError` for other results of `region`.

    Example: how long a tracer that moves with u_z takes to pass through a band of the cell.
        >>> import numpy as np
        >>> import cyclosis as cy
        >>> grid = cy.CylinderGrid(16, 16)
        >>> wall = np.stack([np.zeros((16, 16)), np.sin(grid.theta)[:, None] * np.ones(16)])
        >>> flow = cy.vacuole.flow(grid, wall)
        >>> paths = cy.vacuole.trace(flow, [[0.5, np.pi / 2, 0.0]], t_end=12.0, dt=0.1, order=3)
        >>> times = cy.vacuole.residence_times(paths, lambda r, theta, z: (z > 1.03) & (z < 2.03))
        >>> times.round(6)  # 1 R at half of the speed U
        array([2.])
    """
    _are_paths(paths, 2)
    r, theta, z = np.moveaxis(paths.cylindrical, -1, 0)
    inside = np.asarray(region(r, theta, z % paths.length))
    if inside.dtype != bool or inside.shape != r.shape:
        rule = f"a function of r, theta and z that returns booleans of shape {r.shape}"
        raise InputError("region", region, rule, "compare the arrays, and join conditions with &")
    change = np.diff(inside.astype(np.int8), axis=0)
    found = []
    for k in range(inside.shape[1]):
        enters, leaves = (paths.t[1:][change[:, k] == sign] for sign in (1, -1))
        if enters.size:
            leaves = leaves[leaves > enters[0]]
            found.append(leaves - enters[: leaves.size])
    return np.concatenate(found) if found else np.zeros(0)


@shown
@dataclass(frozen=True, eq=False)
class Stretching:
    """Stretching of small distances: `exponent` (times, n) = ln(|δ(t)|/|δ(0)|)/t in U/R, with its times `t`.

    In an integrable flow it falls as ln(t)/t; only where it stays away from 0 is the flow chaotic.

    Example:
        >>> import numpy as np
        >>> import cyclosis as cy
        >>> cy.vacuole.Stretching(t=np.array([10.0]), exponent=np.array([[0.1, 0.3]])).median
        array([0.2])
    """

    t: Array
    exponent: Array

    @property
    def median(self) -> Array:
        """The median over tracers at every time, shape (times,)."""
        return np.asarray(np.median(self.exponent, axis=1))


def _are_paths(paths: Any, least: int) -> None:
    if not isinstance(paths, Paths) or len(paths.t) < least:
        rule = f"paths with at least {least} saved places"
        raise InputError("paths", paths, rule, "make them with cyclosis.vacuole.trace, and save every step")


@door
def stretching(
    flow: VacuoleFlow | UnsteadyFlow,
    starts: npt.ArrayLike,
    t_end: float,
    every: float = 10.0,
    dt: float = USUAL_STEP,
    **settings: Any,
) -> Stretching:
    """Return the finite-time stretching exponents of tracers that begin at `starts` (n, 3), of (r, θ, z).

    Two tracers begin 1e-6 R apart, in a direction that is drawn for each. After each interval `every` (R/U)
    the second is brought back to that distance. Other `settings` are `order`, `refine` and `n_s` of `trace`.
    A run is followed from its first frame. Dimensionless; raises `InputError` for values out of range.

    Example: in a straight flow distances grow as t, so that the exponent falls.
        >>> import cyclosis as cy
        >>> grid = cy.CylinderGrid(16, 16)
        >>> flow = cy.vacuole.flow(grid, cy.flow(cy.Parameters(), grid, cy.initial.stripes(grid)))
        >>> found = cy.vacuole.stretching(flow, [[0.5, 1.0, 0.0]], t_end=200.0, every=50.0, order=3)
        >>> found.t, bool(found.exponent[-1, 0] < found.exponent[0, 0])
        (array([ 50., 100., 150., 200.]), True)
    """
    from ..model.precision import double

    is_flow(flow)
    places = checked_points(starts)
    first, end = beginning(flow, t_end)
    step = number("every", every, 1e-3, 1e6, "give the interval in R/U")
    for name in settings:
        choice("the setting", name, ("order", "refine", "n_s"))
    count = int(np.floor((end - first) / step + 1e-9))
    times: Array = np.asarray(first + step * np.arange(1, count + 1), dtype=np.float64)
    if not times.size:
        raise InputError("every", step, f"at most the duration {end - first:g}", "give a shorter interval")
    size, direction = len(places), np.random.default_rng(0).normal(size=(3, len(places)))
    longest = number("dt", dt, 1e-6, 1e3, "give a step in R/U")
    total: Array = np.zeros(size)
    rows, t = [], first
    with double():
        carrier = Carrier(flow, longest, **settings)
        at = cartesian_places(places)
        inward = np.where(np.sum(direction[:2] * at[:2], axis=0) > 0, -1.0, 1.0)
        apart = inward * direction * (APART / np.linalg.norm(direction, axis=0))
        for instant in times:
            both = carrier.carried(np.concatenate([at, at + apart], axis=1), t, float(instant))
            t, at, apart = float(instant), both[:, :size], both[:, size:] - both[:, :size]
            distance = np.linalg.norm(apart, axis=0)
            total += np.log(distance / APART)
            apart *= APART / distance
            rows.append(total / (t - first))
    return Stretching(times, np.array(rows, dtype=np.float64))
