"""What a run leaves: coordinates, small variables, frames one by one, restart and attributes."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from ..analysis.diagnostics import QUANTITIES
from ..analysis.regimes import DISORDER
from ..analysis.zones import stripe_widths, zone_angles
from ..dynamics.trajectory import Trajectory
from ..model.grid import Array
from ..model.spectral import dtypes
from ..model.system import flow
from . import provenance

ZONES = 16
"""Slots for indifferent zones; where there are more they are counted, not listed."""

FIELDS = {
    "P": "order vector of the filaments",
    "u": "flow velocity of the cytoplasm",
}
ZONE_VARIABLES: dict[str, tuple[tuple[str, ...], str]] = {
    "zone_count": ((), "number of sign changes of the axial mean of P_z around the cell"),
    "zone_angle": (("zone",), "angles at which the axial mean of P_z changes sign, in radians"),
    "stripe_width": (("zone",), "width of the stripe after each zone as a fraction of the circumference"),
}
COORDINATES = {
    "time": "time in units of R/U",
    "record_time": "time of recorded quantities in units of R/U",
    "component": "vector component",
    "theta": "angle around the axis in radians",
    "z": "position along the axis in radii",
    "intervention_time": "time at which the protocol acted on the state, in units of R/U",
    "zone": "indifferent zones, by increasing angle",
    "term": "terms of the filament equation",
}
GROWING = ("time", "record_time", "intervention_time")
"""Dimensions along which the parts of a run are joined."""

INTERVENTIONS = {
    "P_before": "order vector just before the protocol acted on it",
    "P_after": "order vector just after the protocol acted on it",
}
INTERVENTION_DIMS = ("intervention_time", "component", "theta", "z")

FIELD_DIMS = ("time", "component", "theta", "z")


@dataclass
class Variable:
    """One array with its dimensions and attributes."""

    dims: tuple[str, ...]
    values: npt.NDArray[Any]
    attributes: dict[str, str]


@dataclass
class Contents:
    """A run, or a part of one, as it stands in a file.

    `frames` yields, for every time, the values of `FIELDS` and `ZONE_VARIABLES` by name; it can be
    consumed once. `restart` holds arrays by name.
    """

    coordinates: dict[str, npt.NDArray[Any]]
    variables: dict[str, Variable]
    frames: Iterator[dict[str, Any]]
    restart: dict[str, npt.NDArray[Any]]
    attributes: dict[str, Any]

    @property
    def dtype(self) -> npt.DTypeLike:
        """Type of the fields."""
        return dtypes(self.attributes["precision"])[0]


def of_trajectory(
    run: Trajectory, first_frame: int = 0, first_record: int = 0, first_intervention: int = 0
) -> Contents:
    """Return the contents of a trajectory from one frame, one record and one intervention on."""
    coordinates: dict[str, npt.NDArray[Any]] = {
        "time": run.times[first_frame:],
        "component": np.array(["theta", "z"], dtype=object),
        "theta": run.grid.theta,
        "z": run.grid.z,
        "zone": np.arange(ZONES),
        "term": np.array([term.name for term in run.terms], dtype=object),
    }
    apart = run.settings.record_every is not None
    if apart:
        coordinates["record_time"] = run.record_times[first_record:]
    variables = {}
    for item in QUANTITIES:
        if item.name in run.records:
            values = run.records[item.name][first_record:]
            dims = ("record_time" if apart else "time", *item.dims)
            variables[item.name] = Variable(dims, values, described(item.meaning) | {"symbol": item.symbol})
    if run.protocol:
        done = run.interventions[first_intervention:]
        coordinates["intervention_time"] = np.array([item.time for item in done])
        for name, states in (
            ("P_before", [item.before for item in done]),
            ("P_after", [item.after for item in done]),
        ):
            stacked = np.array(states).reshape(-1, 2, *run.grid.shape)
            variables[name] = Variable(INTERVENTION_DIMS, stacked, described(INTERVENTIONS[name]))
    for name, value in run.params.items():
        if isinstance(value, np.ndarray):
            variables[name] = Variable(("theta", "z"), value, described(f"parameter {name}"))
    restart = {name: _real(value) for name, value in run.restart.progress.items()}
    frames = (_frame(run, index) for index in range(first_frame, len(run.frames)))
    return Contents(coordinates, variables, frames, restart, provenance.attributes(run))


def described(meaning: str) -> dict[str, str]:
    """Return the attributes of a dimensionless variable."""
    return {"long_name": meaning, "units": "1"}


def _real(value: npt.NDArray[Any]) -> npt.NDArray[Any]:
    """Return complex numbers as pairs: NetCDF has no complex type."""
    return np.stack([value.real, value.imag]) if np.iscomplexobj(value) else value


def _frame(run: Trajectory, index: int) -> dict[str, Any]:
    P = run.frames[index]
    state = P.astype(np.float64)
    u = flow(run.params_at(float(run.times[index])), run.grid, state, run.settings.dealias).astype(P.dtype)
    angles, widths, count = listed_zones(state)
    return {"P": P, "u": u, "zone_count": count, "zone_angle": angles, "stripe_width": widths}


def listed_zones(state: Array) -> tuple[Array, Array, int]:
    """Return the zone angles and stripe widths of a state (2, n_theta, n_z), and the number of zones.

    Both are padded with NaN to the length `ZONES`; a disordered state has none.
    """
    order = np.sqrt(np.mean(np.sum(state**2, axis=0)))
    angles = zone_angles(state[1].mean(axis=1)) if order >= DISORDER else np.empty(0)
    listed = angles if angles.size <= ZONES else np.empty(0)
    padding = np.full(ZONES - listed.size, np.nan)
    return np.append(listed, padding), np.append(stripe_widths(listed), padding), angles.size
