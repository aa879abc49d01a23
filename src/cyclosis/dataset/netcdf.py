"""Contents <-> NetCDF files that appear whole or not at all, and notice when they were altered."""

from __future__ import annotations

import errno
import hashlib
import json
import os
import tempfile
from collections.abc import Iterator
from itertools import chain
from pathlib import Path
from typing import Any

import h5netcdf
import h5py
import numpy as np
import numpy.typing as npt

from ..model.errors import InputError
from .contents import COORDINATES, FIELD_DIMS, FIELDS, GROWING, ZONE_VARIABLES, Contents, Variable, described
from .provenance import SCHEMA

DAMAGED = (OSError, ValueError, KeyError, TypeError, AttributeError, RuntimeError, UnicodeDecodeError)


def write_contents(contents: Contents, target: Path) -> None:
    """Write a file under a temporary name, sync it and rename it to `target`.

    Raises `InputError` if that fails; then no trace is left, and what stood at `target` stands.
    """
    try:
        handle, name = tempfile.mkstemp(prefix=f".{target.name}.", suffix=".new", dir=target.parent)
    except OSError as error:
        raise unwritable(target, error) from error
    os.close(handle)
    partial = Path(name)
    try:
        os.chmod(partial, 0o666 & ~_umask())
        with h5netcdf.File(partial, "w") as file:
            _fill(file, contents)
        with open(partial, "rb+") as written:
            os.fsync(written.fileno())
        os.replace(partial, target)
        sync_folder(target.parent)
    except (OSError, RuntimeError) as error:  # HDF5 reports a full disk as either
        raise unwritable(target, error) from error
    finally:
        partial.unlink(missing_ok=True)


def unwritable(target: Path, error: Exception) -> InputError:
    """Return the sentence for a file that could not be written."""
    full = getattr(error, "errno", None) == errno.ENOSPC or "No space left" in str(error)
    full = full or "errno = 28" in str(error)
    reason = (
        "free some disk space"
        if full
        else f"choose another place ({getattr(error, 'strerror', None) or error})"
    )
    saved = "what was saved before is kept"
    return InputError("out", str(target), "a file that can be written whole", f"{reason}; {saved}")


def sync_folder(folder: Path) -> None:
    """Make a rename in a folder durable, where the system can."""
    if hasattr(os, "O_DIRECTORY"):
        handle = os.open(folder, os.O_RDONLY | os.O_DIRECTORY)
        try:
            os.fsync(handle)
        finally:
            os.close(handle)


def read_contents(path: Path, fields: bool = True) -> Contents:
    """Return what a file holds. Raises `InputError` for a file that is damaged, altered or of another schema.

    Frames are read one by one; without `fields` only the zone variables of each.
    """
    try:
        with h5netcdf.File(path, "r") as file:
            check(file, path)
            names = [name for name in file.variables if name in COORDINATES]
            coordinates = {name: _values(file.variables[name]) for name in names}
            frame_names = {*FIELDS, *ZONE_VARIABLES}
            variables = {
                name: Variable(v.dimensions, _values(v), {k: str(v.attrs[k]) for k in sorted(v.attrs)})
                for name, v in file.variables.items()
                if name not in COORDINATES and name not in frame_names
            }
            restart = {name: _values(v) for name, v in file.groups["restart"].variables.items()}
            attributes = {key: _plain(file.attrs[key]) for key in file.attrs if key != "digest"}
    except DAMAGED as error:
        raise damaged(path, error) from error
    chosen = [*ZONE_VARIABLES] + ([*FIELDS] if fields else [])
    return Contents(coordinates, variables, _frames(path, chosen), restart, attributes)


def joined(paths: list[Path], fields: bool = True) -> Contents:
    """Return the contents of consecutive parts of one run as a whole."""
    parts = [read_contents(path, fields) for path in paths]
    last = parts[-1]
    coordinates = dict(last.coordinates)
    for name in GROWING:
        if name in coordinates:
            coordinates[name] = np.concatenate([part.coordinates[name] for part in parts])
    variables = dict(last.variables)
    for name, variable in last.variables.items():
        if variable.dims[0] in GROWING:
            values = np.concatenate([part.variables[name].values for part in parts if name in part.variables])
            variables[name] = Variable(variable.dims, values, variable.attributes)
    frames = chain.from_iterable(part.frames for part in parts)
    return Contents(coordinates, variables, frames, last.restart, last.attributes)


def check(file: h5netcdf.File, path: Path) -> None:
    """Raise `InputError` unless an open file is one of ours, of this schema, and unaltered."""
    if "program" not in file.attrs or _plain(file.attrs["program"]) != "cyclosis":
        raise InputError("file", str(path), "a NetCDF file of a cyclosis run", "choose another file")
    schema = _plain(file.attrs["schema"])
    if schema != SCHEMA:
        remedy = "update cyclosis" if schema > SCHEMA else "read it with the version that wrote it"
        raise InputError(
            "schema of " + str(path), schema, f"{SCHEMA}, the layout that this version reads", remedy
        )
    if _plain(file.attrs["digest"]) != digest(file):
        raise InputError("file", str(path), "as it was written", "it was altered: restore it from a copy")


def damaged(path: Path, error: Exception) -> InputError:
    """Return the sentence for a file that cannot be read."""
    if isinstance(error, InputError):
        return error
    if isinstance(error, FileNotFoundError):
        return InputError("file", str(path), "a NetCDF file of a run", "check the path: no such file")
    if isinstance(error, PermissionError):
        return InputError("file", str(path), "a file that can be read", "check its permissions")
    return InputError(
        "file", str(path), "a whole NetCDF file of a run", "it is none, or truncated or altered: restore it"
    )


def digest(file: h5netcdf.File) -> str:
    """Return a checksum of attributes and of all variables but the fields.

    Fields carry a checksum of their own in every chunk, which HDF5 verifies when it is read.
    """
    out = hashlib.sha256()

    def add(*parts: Any) -> None:
        out.update(json.dumps(parts, sort_keys=True, default=str).encode())

    def add_group(group: Any, skip: tuple[str, ...]) -> None:
        add({key: _plain(group.attrs[key]) for key in group.attrs if key != "digest"})
        for name in sorted(group.variables):
            variable = group.variables[name]
            add(name, variable.dimensions, str(variable.dtype), variable.shape)
            add({key: _plain(variable.attrs[key]) for key in variable.attrs})
            if name not in skip:
                values = _values(variable)
                out.update(
                    json.dumps(values.tolist()).encode() if values.dtype == object else values.tobytes()
                )

    add_group(file, tuple(FIELDS))
    if "restart" in file.groups:
        add_group(file.groups["restart"], ())
    return out.hexdigest()


def _fill(file: h5netcdf.File, contents: Contents) -> None:
    file.dimensions = {name: len(values) for name, values in contents.coordinates.items()}
    for name, values in contents.coordinates.items():
        _create(file, name, (name,), values.dtype, values, described(COORDINATES[name]))
    for name, variable in contents.variables.items():
        _create(file, name, variable.dims, variable.values.dtype, variable.values, variable.attributes)
    frames = len(contents.coordinates["time"])
    targets = {}
    for name, meaning in FIELDS.items():
        targets[name] = _create(file, name, FIELD_DIMS, contents.dtype, None, described(meaning))
    for name, (dims, meaning) in ZONE_VARIABLES.items():
        kind = "int64" if name == "zone_count" else "float64"
        targets[name] = _create(file, name, ("time", *dims), kind, None, described(meaning))
    stored = 0
    for index, frame in enumerate(contents.frames):
        for name, values in frame.items():
            targets[name][index] = values
        stored += 1
    if stored != frames:
        raise ValueError(f"{stored} frames for {frames} times")
    group = file.create_group("restart")
    sizes = {name: _own_dims(name, values) for name, values in contents.restart.items()}
    group.dimensions = {dim: size for dims in sizes.values() for dim, size in dims.items()}
    for name, values in contents.restart.items():
        _create(group, name, tuple(sizes[name]), values.dtype, values, {})
    file.attrs.update(contents.attributes)
    file.attrs["digest"] = digest(file)


def _own_dims(name: str, values: npt.NDArray[Any]) -> dict[str, int]:
    return {f"{name}_{axis}": size for axis, size in enumerate(values.shape)}


def _create(
    group: Any,
    name: str,
    dims: tuple[str, ...],
    dtype: npt.DTypeLike,
    values: npt.NDArray[Any] | None,
    attributes: dict[str, str],
) -> Any:
    text = np.dtype(dtype).kind == "O"
    if values is not None and values.dtype == bool:
        values, dtype = values.astype(np.int8), np.dtype(np.int8)
    shape = tuple(group.dimensions[dim].size for dim in dims)
    options: dict[str, Any] = {}
    if dims and not text and all(shape):
        options = {"fletcher32": True, "chunks": (1, *shape[1:]) if dims == FIELD_DIMS else shape}
    variable = group.create_variable(
        name, dims, h5py.string_dtype() if text else dtype, data=values, **options
    )
    variable.attrs.update(attributes)
    return variable


def _frames(path: Path, names: list[str]) -> Iterator[dict[str, Any]]:
    try:
        with h5netcdf.File(path, "r") as file:
            for index in range(file.dimensions["time"].size):
                yield {name: file.variables[name][index] for name in names}
    except DAMAGED as error:
        raise damaged(path, error) from error


def _values(variable: Any) -> npt.NDArray[Any]:
    values = np.asarray(variable[...])
    if values.dtype == object:
        return np.array([v.decode() if isinstance(v, bytes) else v for v in values.ravel()], dtype=object)
    return values


def _plain(value: Any) -> Any:
    if isinstance(value, np.ndarray | np.generic):
        value = value.item() if value.size == 1 else value.tolist()
    return value.decode() if isinstance(value, bytes) else value


def _umask() -> int:
    current = os.umask(0)
    os.umask(current)
    return current
