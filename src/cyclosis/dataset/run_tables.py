"""A run as plain tables: recorded quantities, zones and profiles, a row for each time and place."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from ..model.errors import InputError, choice
from ..model.units import scales_in

if TYPE_CHECKING:
    import xarray

    from ..model.scales import Scales

Table = dict[str, npt.NDArray[Any]]
"""Columns of equal length by name."""
UNITS = {
    **dict.fromkeys(("time", "record_time"), "s"),
    **dict.fromkeys(("peak_speed", "rms_speed", "net_flux", "u_theta", "u_z", "u_s"), "um_per_s"),
    **dict.fromkeys(("rate_of_change", "circulation_x", "circulation_y", "circulation_z"), "per_s"),
    **dict.fromkeys(("s", "r", "z"), "um"),
}
"""Physical units of columns, where they have one, as their names end."""
PROFILED = ("P", "u", "c", "concentration")
"""Fields whose means are in the table of profiles."""


def run_table(dataset: xarray.Dataset, name: str = "records") -> Table:
    """Return a table of a run's dataset: its columns, arrays of equal length, by name, dimensionless.

    `records` has a row for each recorded time, and a column for each quantity, or each component of one.
    `zones` has a row for each indifferent zone of each frame: its angle in radians, and the width of the
    stripe after it as a fraction of the circumference; a closed cell has no such table. `profiles` has the
    means of P and u, and of the concentration where there is one, in each frame: along the cylinder at each
    angle theta, or around a closed cell at each arc length s. `about` has the configuration, the outcome and
    the origin of the run, a row for each. Of a dataset with scales (see `with_scales`) there are further
    columns in micrometres and seconds, which their names say. Raises `InputError` for other names.

    Example:
        >>> import cyclosis as cy
        >>> from cyclosis.dataset import run_table
        >>> params, grid = cy.Parameters(), cy.CylinderGrid(16, 16)
        >>> data = cy.simulate(params, grid, cy.initial.stripes(grid), t_end=2.0).to_dataset()
        >>> table = run_table(data, "records")
        >>> table["time"], table["order"].round(2), table["mean_P_z"].round(2) + 0.0
        (array([0., 1., 2.]), array([0.64, 0.84, 0.9 ]), array([0., 0., 0.]))
        >>> run_table(data, "zones")["zone_angle"].size, list(run_table(data, "profiles"))
        (6, ['time', 'theta', 'P_theta', 'P_z', 'u_theta', 'u_z'])
    """
    made = TABLES[choice("table", name, tuple(TABLES))](dataset)
    if not made:
        known = ", ".join(each for each in TABLES if each != name)
        raise InputError("table", name, f"one of {known} for a run without zones", "choose one of these")
    return in_units(made, scales_in(dataset))


def run_tables(dataset: xarray.Dataset) -> dict[str, Table]:
    """Return all tables that a run has, by name."""
    found = {name: in_units(make(dataset), scales_in(dataset)) for name, make in TABLES.items()}
    return {name: table for name, table in found.items() if table}


def in_units(table: Table, scales: Scales | None) -> Table:
    """Return a table with a column in micrometres or seconds after each one that has such a unit."""
    if scales is None:
        return table
    factors = factors_of(scales)
    out: Table = {}
    for name, column in table.items():
        out[name] = column
        unit = UNITS.get(name)
        if name == "stripe_width":  # a fraction of the circumference
            out["stripe_width_um"] = column * (2 * np.pi * scales.radius_um)
        elif unit is not None:
            out[f"{name}_{unit}"] = column * factors[unit]
    return out


def factors_of(scales: Scales) -> dict[str, float]:
    """Return what the units of columns, by the ends of their names, are in dimensionless numbers."""
    return {
        "s": scales.time_s,
        "um": scales.radius_um,
        "um_per_s": scales.speed_um_per_s,
        "per_s": 1 / scales.time_s,
    }


def _records(dataset: xarray.Dataset) -> Table:
    along = "record_time" if "record_time" in dataset.dims else "time"
    table: Table = {along: dataset[along].values}
    for name, item in dataset.data_vars.items():
        if "symbol" not in item.attrs or item.dims[0] != along or item.ndim > 2:
            continue
        if item.ndim == 1:
            table[str(name)] = item.values
            continue
        for label, column in zip(dataset[item.dims[1]].values, item.values.T, strict=True):
            table[f"{name}_{label}"] = column
    return table


def _zones(dataset: xarray.Dataset) -> Table:
    if "zone_angle" not in dataset:
        return {}
    angle, width = dataset["zone_angle"].values, dataset["stripe_width"].values
    frame, zone = np.nonzero(np.isfinite(angle))
    return {
        "time": dataset["time"].values[frame],
        "zone": zone,
        "zone_angle": angle[frame, zone],
        "stripe_width": width[frame, zone],
    }


def _profiles(dataset: xarray.Dataset) -> Table:
    closed = "s" in dataset["P"].dims
    kept, lost = ("s", "theta") if closed else ("theta", "z")
    times, places = dataset["time"].values, dataset[kept].values
    table: Table = {"time": np.repeat(times, places.size), kept: np.tile(places, times.size)}
    for name in ("r", "z") if closed else ():
        values = dataset[name].values
        table[name] = np.tile(values if values.ndim == 1 else values[0], times.size)
    for name in PROFILED:
        item = dataset.get(name)
        if item is None or not {"time", kept, lost} <= set(item.dims):  # a record may have the same name
            continue
        # Frame by frame: the fields of a long run may be larger than the memory.
        means = [item.isel(time=k).mean(lost).values for k in range(times.size)]
        shape = (times.size, *(item.sizes[dim] for dim in item.dims[1:] if dim != lost))
        stacked = np.reshape(means, shape)
        if item.ndim == 3:
            table[name] = stacked.ravel()
            continue
        for index, label in enumerate(dataset["component"].values):
            table[f"{name}_{label}"] = stacked[:, index].ravel()
    return table


def _about(dataset: xarray.Dataset) -> Table:
    attributes = dict(dataset.attrs)
    told = [
        *_flat("outcome", json.loads(attributes.pop("outcome", "{}"))),
        *_flat("", json.loads(attributes.pop("configuration", "{}"))),
        *_flat("versions", json.loads(attributes.pop("versions", "{}"))),
        *_flat("", attributes),
    ]
    names, values = zip(*told, strict=True) if told else ((), ())
    return {"name": np.array(names, dtype=object), "value": np.array(values, dtype=object)}


def _flat(before: str, given: dict[str, Any]) -> Iterator[tuple[str, str]]:
    """Yield the names and values of nested tables, with names like parameters.alpha_p."""
    for key, value in given.items():
        name = f"{before}.{key}" if before else key
        if isinstance(value, dict):
            yield from _flat(name, value)
        else:
            yield (
                name,
                value if isinstance(value, str) else as_json(value),
            )


def as_json(value: Any) -> str:
    """Return a value as JSON; numbers of NumPy are plain ones."""
    return json.dumps(value, default=lambda number: number.item())


TABLES: dict[str, Callable[[xarray.Dataset], Table]] = {
    "records": _records,
    "zones": _zones,
    "profiles": _profiles,
    "about": _about,
}
"""All tables of a run, by name."""


def as_text(table: Table) -> Iterator[str]:
    """Yield a table as lines of comma-separated values, the names of the columns first.

    Numbers have all their digits; an empty field is one that is not a number, or no text.
    """
    yield ",".join(map(_quoted, table)) + "\n"
    for row in zip(*(column.tolist() for column in table.values()), strict=True):
        yield ",".join("" if value != value else _quoted(value) for value in row) + "\n"


def _quoted(value: Any) -> str:
    if not isinstance(value, str):
        return repr(value)
    quotes = any(mark in value for mark in ',"\r\n')
    return '"' + value.replace('"', '""') + '"' if quotes else value
