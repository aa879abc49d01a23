"""What files and sweeps store of the polar model besides its quantities."""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache
from typing import Any

import jax
import numpy as np

from ..analysis.zones import stripe_widths, zones_of
from ..contract.members import Variable
from ..contract.model import Coordinate, Problem, Stored
from ..model.grid import Array, CylinderGrid
from ..model.parameters import Parameters
from ..model.precision import double
from ..model.system import flow_spectrum
from ..model.system import system as system_of

ZONES = 16
"""Slots for indifferent zones; if there are more, they are counted but not listed."""
PLANE = ("component", "theta", "z")
_NAN = float("nan")

STORED = (
    Stored("P", PLANE, "order vector of the filaments"),
    Stored("u", PLANE, "flow velocity of the cytoplasm"),
    Stored(
        "zone_count",
        (),
        "number of sign changes of the axial mean of P_z around the cell; 0 where there are no stripes",
        "int64",
    ),
    Stored(
        "zone_angle",
        ("zone",),
        "angles at which the axial mean of P_z changes sign, in radians",
        "float64",
    ),
    Stored(
        "stripe_width",
        ("zone",),
        "width of the stripe after each zone as a fraction of the circumference",
        "float64",
    ),
)
"""What is stored of every frame."""

MEMBER_VARIABLES = (
    Variable("order", (), "float64", _NAN, "root mean square of the final order vector"),
    Variable("peak_speed", (), "float64", _NAN, "largest flow speed of the final state"),
    Variable("mean_P", ("component",), "float64", _NAN, "mean of the final order vector"),
    Variable(
        "zone_count",
        (),
        "int16",
        -1,
        "number of sign changes of the final axial mean of P_z around the cell",
    ),
    Variable(
        "zone_angle",
        ("zone",),
        "float64",
        _NAN,
        "angles at which the final axial mean of P_z changes sign, in radians",
    ),
    Variable(
        "stripe_width",
        ("zone",),
        "float64",
        _NAN,
        "width of the stripe after each zone as a fraction of the circumference",
    ),
    Variable("profile", ("component", "theta"), "float64", _NAN, "axial mean of the final order vector"),
    Variable("initial_k0", (), "float64", _NAN, "mean of P_z in the initial state"),
    Variable(
        "initial_m1",
        (),
        "float64",
        _NAN,
        "amplitude of the wave of P_z once around the cell (m = 1, q = 0) in the initial state",
    ),
)
"""What a sweep stores of every member, everything dimensionless."""


def coordinates(grid: CylinderGrid, shape: tuple[int, ...] | None = None) -> dict[str, Coordinate]:
    """Return the coordinates of what is stored on a grid."""
    return {
        "component": Coordinate(np.array(["theta", "z"], dtype=object), "vector component"),
        "theta": Coordinate(grid.theta, "angle around the axis in radians"),
        "z": Coordinate(grid.z, "position along the axis in radii"),
        "zone": Coordinate(np.arange(ZONES), "indifferent zones, by increasing angle"),
    }


def derive(problem: Problem) -> Callable[[Parameters, Array], dict[str, Any]]:
    """Return a function that gives the flow of a state and its zones; the flow ignores ramps."""
    return derived(lambda params: system_of(params, problem.grid, dealias=problem.dealias))


def derived(make: Callable[[Parameters], Any]) -> Callable[[Parameters, Array], dict[str, Any]]:
    """Return a function that gives the flow of a state and its zones, with `make` for the system."""
    made = last_made(make)

    def of_state(params: Parameters, P: Array) -> dict[str, Any]:
        with double():
            system, placed = made(params)
            flow = flow_spectrum(placed, system.spectrum(P))
        return {"u": system.state(flow), **zones(P)}

    return of_state


def last_made(make: Callable[[Parameters], Any]) -> Callable[[Parameters], tuple[Any, Any]]:
    """Return a function that makes the system of parameters, also on the device, and keeps the last one."""

    @lru_cache(maxsize=1)
    def made(params: Parameters) -> tuple[Any, Any]:
        system = make(params)
        return system, jax.device_put(system)

    return made


def zones(P: Array) -> dict[str, Any]:
    """Return what is stored of the zones of a state (2, n_theta, n_z), by name."""
    angles, widths, count = listed_zones(P)
    return {"zone_count": count, "zone_angle": angles, "stripe_width": widths}


def member_row(member: Any, outcome: Any) -> dict[str, Any]:
    """Return what a sweep stores of a member and its outcome, without the quantities, by name."""
    start = member.state()[1].mean(axis=1)
    return {
        **zones(outcome.state),
        "profile": outcome.profile,
        "initial_k0": start.mean(),
        "initial_m1": amplitude(start),
    }


def amplitude(profile: Array) -> float:
    """Return the amplitude of the first harmonic of a periodic profile (n_theta,): a of a cos(theta - b)."""
    return 2.0 * float(abs(np.fft.rfft(profile, norm="forward")[1]))


def listed_zones(state: Array) -> tuple[Array, Array, int]:
    """Return the zone angles and stripe widths of a state (2, n_theta, n_z), and the number of zones.

    Both are padded with NaN to the length `ZONES`; the zones are those of `cyclosis.regime`.
    """
    angles = zones_of(state)
    listed = angles if angles.size <= ZONES else np.empty(0)
    padding = np.full(ZONES - listed.size, np.nan)
    return np.append(listed, padding), np.append(stripe_widths(listed), padding), angles.size
