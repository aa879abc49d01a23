"""What files and sweeps store of the closed cell besides its quantities."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from ...closed.grid import Array, ClosedGrid
from ...closed.system import ClosedSystem, flow_vector
from ...contract.members import Variable
from ...contract.model import Coordinate, Geometry, Problem, Stored
from ...model.parameters import Parameters
from ...model.precision import double
from ...model.system import flow_spectrum
from ..polar_stored import last_made

PLANE = ("component", "theta", "s")
_NAN = float("nan")

STORED = (
    Stored("P", PLANE, "order vector of the filaments"),
    Stored("u", PLANE, "flow velocity of the cytoplasm"),
)
"""What is stored of every frame."""

MEMBER_VARIABLES = (
    Variable("order", (), "float64", _NAN, "root mean square of the final order vector"),
    Variable("peak_speed", (), "float64", _NAN, "largest flow speed of the final state"),
    Variable("rms_speed", (), "float64", _NAN, "root mean square flow speed of the final state"),
    Variable("mean_vector", ("axis",), "float64", _NAN, "mean of the final order vector in space"),
    Variable("circulation", ("axis",), "float64", _NAN, "circulation of the final flow, 3/2 <x × u>"),
)
"""What a sweep stores of every member, everything dimensionless."""


def coordinates(grid: ClosedGrid, shape: tuple[int, ...] | None = None) -> dict[str, Coordinate]:
    """Return the coordinates of what is stored on a grid."""
    return {
        "component": Coordinate(np.array(["theta", "s"], dtype=object), "vector component"),
        "axis": Coordinate(np.array(["x", "y", "z"], dtype=object), "direction in space; z is the axis"),
        "theta": Coordinate(grid.theta, "angle around the axis in radians"),
        "s": Coordinate(grid.s, "arc length from the south pole in radii"),
    }


def geometry(grid: ClosedGrid) -> dict[str, Geometry]:
    """Return where the points are, and their areas."""
    x, y, z = grid.xyz
    plane = ("theta", "s")
    return {
        "x": Geometry(plane, x, "position in space in radii"),
        "y": Geometry(plane, y, "position in space in radii"),
        "z": Geometry(plane, z, "height above the equatorial plane in radii"),
        "r": Geometry(("s",), grid.r, "distance from the axis in radii"),
        "area_weight": Geometry(plane, grid.weights, "area of the point in radii squared"),
    }


def derive(problem: Problem) -> Callable[[Parameters, Array], dict[str, Any]]:
    """Return a function that gives the flow of a state; the flow ignores ramps."""

    def make(params: Parameters) -> Any:
        return problem.model.system(problem.at(params), True)

    made = last_made(make)

    def of_state(params: Parameters, P: Array) -> dict[str, Any]:
        with double():
            system, placed = made(params)
            flow = flow_spectrum(placed, system.spectrum(P))
        return {"u": flow_vector(system.space, flow)}

    return of_state


def flow(system: ClosedSystem, modes: Any, time: Any) -> Array:
    """Return the flow (2, n_theta, n_s) that modes drive at a time."""
    return flow_vector(system.space, flow_spectrum(system, modes, time))
