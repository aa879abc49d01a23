"""What files store of a kinetic run besides its quantities: moments, P, the flow, nematic order, zones."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from ...contract.model import Coordinate, Problem, Stored
from ...model.grid import CylinderGrid
from ...model.parameters import Parameters
from .. import polar_stored
from ..on_polar import flow_of_states
from ..polar_stored import PLANE
from .angular import MODES, Moments, order

_POLAR = {item.name: item for item in polar_stored.STORED}
STORED = (
    Stored("moments", ("part", "moment", "theta", "z"), "moments of the density of filament angles"),
    _POLAR["P"],
    _POLAR["u"],
    Stored("Q", PLANE, "nematic order of the filaments, (Re, Im) of m_2/c"),
    Stored("c", ("theta", "z"), "concentration of filaments"),
    *(_POLAR[name] for name in ("zone_count", "zone_angle", "stripe_width")),
)
"""What is stored of every frame."""


def coordinates(grid: CylinderGrid, shape: tuple[int, ...] | None = None) -> dict[str, Coordinate]:
    """Return the coordinates of what is stored on a grid, for states of a shape."""
    count = MODES + 1 if shape is None else shape[0]
    return {
        "part": Coordinate(np.array(["real", "imaginary"], dtype=object), "part of a complex number"),
        "moment": Coordinate(np.arange(count), "number n of the moment"),
        **polar_stored.coordinates(grid),
    }


def derive(problem: Problem) -> Callable[[Parameters, Moments], dict[str, Any]]:
    """Return a function that gives what follows from a state; the flow without any ramp."""
    flow = flow_of_states(problem)

    def of_state(params: Parameters, m: Moments) -> dict[str, Any]:
        P, c = order(m), m[0].real
        nematic = m[2] / c
        return {
            "P": P,
            "u": flow(params, m),
            "Q": np.stack([nematic.real, nematic.imag]),
            "c": c,
            **polar_stored.zones(P),
        }

    return of_state
