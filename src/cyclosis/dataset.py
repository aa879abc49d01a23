"""Trajectory <-> xarray <-> NetCDF: one description of the variables serves both.

Variables: `P` and `u` (time, component, theta, z), the recorded quantities of
`cyclosis.diagnostics.QUANTITIES` (over `time` if recorded where fields are saved, else over
`record_time`), and at every saved field the angles of the indifferent zones and the stripes' widths
(time, zone; NaN where there are fewer). Everything is dimensionless, unit "1".
"""

from __future__ import annotations

import json
import os
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import h5netcdf
import h5py
import numpy as np
import numpy.typing as npt
import xarray

from . import provenance
from .analysis.diagnostics import QUANTITIES
from .analysis.regimes import DISORDER
from .analysis.zones import stripe_widths, zone_angles
from .dynamics.trajectory import Status, Trajectory
from .model.errors import InputError
from .model.grid import Array
from .model.system import flow

ZONES = 16
"""Slots for indifferent zones; more zones than this are counted, not listed."""

_FIELDS = {
    "P": "order vector of the filaments",
    "u": "flow velocity of the cytoplasm",
}
_ZONE_VARIABLES = {
    "zone_count": ((), "number of sign changes of the axial mean of P_z around the cell"),
    "zone_angle": (("zone",), "angles at which the axial mean of P_z changes sign, in radians"),
    "stripe_width": (("zone",), "width of the stripe after each zone as a fraction of the circumference"),
}
_COORDINATES = {
    "time": "time in units of R/U",
    "record_time": "time of recorded quantities in units of R/U",
    "component": "vector component",
    "theta": "angle around the axis in radians",
    "z": "position along the axis in radii",
    "zone": "indifferent zones, by increasing angle",
    "term": "terms of the filament equation",
}


def to_dataset(run: Trajectory) -> xarray.Dataset:
    """Return a trajectory as an `xarray.Dataset` in memory, with fields at every saved time."""
    data: dict[str, Any] = {}
    for name, dims, values, attributes in _small_variables(run):
        data[name] = (dims, values, attributes)
    frames = list(_frames(run))
    for name in ("P", "u"):
        stacked = np.array([frame[name] for frame in frames]).reshape(-1, 2, *run.grid.shape)
        data[name] = (("time", "component", "theta", "z"), stacked, _attributes(_FIELDS[name]))
    for name, (dims, meaning) in _ZONE_VARIABLES.items():
        data[name] = (("time", *dims), np.array([frame[name] for frame in frames]), _attributes(meaning))
    coords = {n: ((n,), v, _attributes(_COORDINATES[n])) for n, v in _coordinates(run).items()}
    return xarray.Dataset(data, coords, provenance.attributes(run))


def write(run: Trajectory, path: str | os.PathLike[str], force: bool = False) -> Path:
    """Write a trajectory to a NetCDF file, frame by frame, and return its path.

    The file appears whole or not at all: it is written under a temporary name beside its place, synced
    and renamed. Raises `InputError` if `path` exists and `force` is not given, or cannot be written.
    """
    target = Path(path)
    check_writable(target, force)
    partial = _temporary(target)
    try:
        with h5netcdf.File(partial, "w") as file:
            _fill(file, run)
        with open(partial, "rb+") as written:
            os.fsync(written.fileno())
        os.replace(partial, target)
    except OSError as error:
        raise InputError(
            "out",
            str(target),
            "a place that can be written to",
            f"free space or choose another ({error.strerror})",
        ) from error
    finally:
        partial.unlink(missing_ok=True)
    return target


def open_dataset(path: str | os.PathLike[str]) -> xarray.Dataset:
    """Open a file written by `write` (fields load lazily). Raises `InputError` for anything else."""
    try:
        dataset = xarray.open_dataset(path, engine="h5netcdf", decode_times=False)
    except (OSError, ValueError, KeyError, TypeError, AttributeError, RuntimeError) as error:
        reason = "no such file" if isinstance(error, FileNotFoundError) else "it is none or it is damaged"
        raise InputError("file", str(path), "a NetCDF file of a run", reason) from error
    if dataset.attrs.get("program") != "cyclosis" or "P" not in dataset:
        dataset.close()
        raise InputError("file", str(path), "a NetCDF file of a cyclosis run", "choose another file")
    return dataset


def check_writable(target: Path, force: bool) -> None:
    """Raise `InputError` if a file is in the way or its folder is missing."""
    if target.is_dir():
        raise InputError("out", str(target), "a file name", "add a name to the folder")
    if target.exists() and not force:
        raise InputError("out", str(target), "a new file", "add --force (force=True) to overwrite it")
    if not target.parent.is_dir():
        raise InputError("out", str(target), "in a folder that exists", f"create {target.parent} first")


def _temporary(target: Path) -> Path:
    try:
        handle, name = tempfile.mkstemp(prefix=f".{target.name}.", suffix=".partial", dir=target.parent)
    except OSError as error:
        raise InputError(
            "out", str(target), "in a folder that can be written to", f"choose another ({error.strerror})"
        ) from error
    os.close(handle)
    return Path(name)


def _fill(file: h5netcdf.File, run: Trajectory) -> None:
    coordinates = _coordinates(run)
    sizes = {name: len(values) for name, values in coordinates.items()}
    file.dimensions = sizes
    for name, values in coordinates.items():
        _variable(file, name, (name,), values, _attributes(_COORDINATES[name]))
    for name, dims, values, attributes in _small_variables(run):
        _variable(file, name, dims, values, attributes)
    shape = (sizes["time"], 2, *run.grid.shape)
    targets = {}
    for name, meaning in _FIELDS.items():
        dims = ("time", "component", "theta", "z")
        targets[name] = file.create_variable(name, dims, run.frames.dtype, chunks=(1, *shape[1:]))
        targets[name].attrs.update(_attributes(meaning))
    for name, (dims, meaning) in _ZONE_VARIABLES.items():
        kind = "int64" if name == "zone_count" else "float64"
        targets[name] = file.create_variable(name, ("time", *dims), kind)
        targets[name].attrs.update(_attributes(meaning))
    for index, frame in enumerate(_frames(run)):
        for name, values in frame.items():
            targets[name][index] = values
    file.attrs.update(provenance.attributes(run))


def _variable(
    file: h5netcdf.File,
    name: str,
    dims: tuple[str, ...],
    values: npt.NDArray[Any],
    attributes: dict[str, str],
) -> None:
    text = values.dtype == object
    variable = file.create_variable(name, dims, h5py.string_dtype() if text else values.dtype, data=values)
    variable.attrs.update(attributes)


def _coordinates(run: Trajectory) -> dict[str, npt.NDArray[Any]]:
    out: dict[str, npt.NDArray[Any]] = {
        "time": run.times,
        "component": np.array(["theta", "z"], dtype=object),
        "theta": run.grid.theta,
        "z": run.grid.z,
        "zone": np.arange(ZONES),
        "term": np.array([term.name for term in run.terms], dtype=object),
    }
    if _record_dim(run) == "record_time":
        out["record_time"] = run.record_times
    return out


def _record_dim(run: Trajectory) -> str:
    return "time" if np.array_equal(run.times, run.record_times) else "record_time"


def _small_variables(
    run: Trajectory,
) -> Iterator[tuple[str, tuple[str, ...], npt.NDArray[Any], dict[str, str]]]:
    for item in QUANTITIES:
        if item.name in run.records:
            attributes = _attributes(item.meaning) | {"symbol": item.symbol}
            yield item.name, (_record_dim(run), *item.dims), run.records[item.name], attributes
    for name, value in run.params.items():
        if isinstance(value, np.ndarray):
            yield name, ("theta", "z"), value, _attributes(f"parameter {name}")


def _frames(run: Trajectory) -> Iterator[dict[str, Any]]:
    for P in run.frames:
        state = P.astype(np.float64)
        u = flow(run.params, run.grid, state, run.settings.dealias).astype(P.dtype)
        angles, widths, count = _zones(state)
        yield {"P": P, "u": u, "zone_count": count, "zone_angle": angles, "stripe_width": widths}


def _zones(state: Array) -> tuple[Array, Array, int]:
    order = np.sqrt(np.mean(np.sum(state**2, axis=0)))
    angles = zone_angles(state[1].mean(axis=1)) if order >= DISORDER else np.empty(0)
    listed = angles if angles.size <= ZONES else np.empty(0)
    padding = np.full(ZONES - listed.size, np.nan)
    return np.append(listed, padding), np.append(stripe_widths(listed), padding), angles.size


def _attributes(meaning: str) -> dict[str, str]:
    return {"long_name": meaning, "units": "1"}


def status_of(dataset: xarray.Dataset) -> Status:
    """Return the status of a run read from a file."""
    return Status(json.loads(dataset.attrs["run"])["status"])
