"""What files and sweeps store of the polar model with a concentration, besides its quantities."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from ...contract.model import Coordinate, Problem, Stored
from ...model.grid import Array, CylinderGrid
from ...model.parameters import Parameters
from .. import polar_stored
from ..on_polar import flow_of_states

_POLAR = {item.name: item for item in polar_stored.STORED}
STORED = (
    Stored("state", ("unknown", "theta", "z"), "order vector and concentration of filaments"),
    _POLAR["P"],
    _POLAR["u"],
    Stored("concentration", ("theta", "z"), "concentration of filaments"),
    *(_POLAR[name] for name in ("zone_count", "zone_angle", "stripe_width")),
)
"""What is stored of every frame."""


def coordinates(grid: CylinderGrid, shape: tuple[int, ...] | None = None) -> dict[str, Coordinate]:
    """Return the coordinates of what is stored on a grid."""
    names = np.array(["P_theta", "P_z", "c"], dtype=object)
    return {
        "unknown": Coordinate(names, "what the equations determine"),
        **polar_stored.coordinates(grid),
    }


def derive(problem: Problem) -> Callable[[Parameters, Array], dict[str, Any]]:
    """Return a function that gives what follows from a state; the flow without any ramp."""
    flow = flow_of_states(problem)

    def of_state(params: Parameters, state: Array) -> dict[str, Any]:
        P, c = state[:2], state[2]
        return {"P": P, "u": flow(params, state), "concentration": c, **polar_stored.zones(P)}

    return of_state
