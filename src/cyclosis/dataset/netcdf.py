"""Contents <-> NetCDF files that appear whole or not at all, and notice when they were altered."""

from __future__ import annotations

import errno
import hashlib
import json
import os
import tempfile
from collections.abc import Callable, Iterator
from itertools import chain
from pathlib import Path
from typing import Any

import h5netcdf
import h5py
import numpy as np
import numpy.typing as npt

from ..model.errors import InputError
from .contents import COORDINATES, FIELD_DIMS, FIELDS, GROWING, ZONE_VARIABLES, Contents, Variable, described
from .guarded import GuardedFile
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
        with GuardedFile(partial) as guarded:
            with h5netcdf.File(guarded, "w") as file:
                _fill(file, contents, guarded.check)
            with h5py.File(guarded, "r+") as file:
                file.attrs["digest"] = digest(file)
            guarded.sync()
        os.replace(partial, target)
        sync_folder(target.parent)
    except OSError as error:
        raise unwritable(target, error) from error
    finally:
        partial.unlink(missing_ok=True)


def unwritable(target: Path, error: OSError) -> InputError:
    """Return the sentence for a file that could not be written."""
    full = error.errno in (errno.ENOSPC, errno.EDQUOT, errno.EFBIG)
    remedy = (
        "free some disk space and resume" if full else f"choose another place ({error.strerror or error})"
    )
    rule = "a file that can be written whole"
    return InputError("out", str(target), rule, f"{remedy}; what was saved before is kept")


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
        with h5py.File(path, "r") as file:
            check(file, path)
            stored = _variables(file)
            coordinates = {name: _values(v) for name, v in stored.items() if name in COORDINATES}
            others = stored.keys() - COORDINATES.keys() - FIELDS.keys() - ZONE_VARIABLES.keys()
            variables = {
                name: Variable(_dims(stored[name]), _values(stored[name]), attributes_of(stored[name]))
                for name in sorted(others)
            }
            restart = {name: _values(v) for name, v in _variables(file["restart"]).items()}
            attributes = {key: value for key, value in attributes_of(file).items() if key != "digest"}
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


def check(file: h5py.File, path: Path) -> None:
    """Raise `InputError` unless an open file is one of ours, of this schema, and unaltered."""
    found = attributes_of(file)
    if found.get("program") != "cyclosis":
        raise InputError("file", str(path), "a NetCDF file of a cyclosis run", "choose another file")
    schema = found["schema"]
    if schema != SCHEMA:
        remedy = "update cyclosis" if schema > SCHEMA else "read it with the version that wrote it"
        rule = f"{SCHEMA}, the layout that this version reads"
        raise InputError("schema of " + str(path), schema, rule, remedy)
    if found["digest"] != digest(file):
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


def digest(file: h5py.File) -> str:
    """Return a checksum of attributes and of all variables but the fields.

    Fields carry a checksum of their own in every chunk, which HDF5 verifies when it is read.
    """
    out = hashlib.sha256()
    for group in (file, file["restart"]):
        own = {key: value for key, value in attributes_of(group).items() if key != "digest"}
        out.update(json.dumps(own, sort_keys=True).encode())
        for name, variable in sorted(_variables(group).items()):
            described = [name, _dims(variable), str(variable.dtype), variable.shape, attributes_of(variable)]
            out.update(json.dumps(described, sort_keys=True).encode())
            if name not in FIELDS:
                values = _values(variable)
                out.update(
                    json.dumps(values.tolist()).encode() if values.dtype == object else values.tobytes()
                )
    return out.hexdigest()


def _fill(file: h5netcdf.File, contents: Contents, still_well: Callable[[], None]) -> None:
    """Fill an empty file; `still_well` raises as soon as the disk has failed."""
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
        still_well()
        stored += 1
    if stored != frames:
        raise ValueError(f"{stored} frames for {frames} times")
    group = file.create_group("restart")
    sizes = {name: _own_dims(name, values) for name, values in contents.restart.items()}
    group.dimensions = {dim: size for dims in sizes.values() for dim, size in dims.items()}
    for name, values in contents.restart.items():
        _create(group, name, tuple(sizes[name]), values.dtype, values, {})
    file.attrs.update(contents.attributes)


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
        with h5py.File(path, "r") as file:
            for index in range(file["time"].shape[0]):
                yield {name: file[name][index] for name in names}
    except DAMAGED as error:
        raise damaged(path, error) from error


def _variables(group: h5py.Group) -> dict[str, h5py.Dataset]:
    """Return the variables of a group, less the dimensions that have no values."""
    return {
        name: item
        for name, item in group.items()
        if isinstance(item, h5py.Dataset) and not item.attrs.get("NAME", b"").startswith(b"This is a netCDF")
    }


def _dims(variable: h5py.Dataset) -> tuple[str, ...]:
    if variable.is_scale:
        return (variable.name.rpartition("/")[2],)
    return tuple(scale[0].name.rpartition("/")[2] for scale in variable.dims)


def _values(variable: h5py.Dataset) -> npt.NDArray[Any]:
    if variable.dtype.kind == "O":
        return np.array(variable.asstr()[...], dtype=object)
    return np.asarray(variable[...])


_INTERNAL = ("CLASS", "NAME", "DIMENSION_LIST", "REFERENCE_LIST")


def attributes_of(item: h5py.HLObject) -> dict[str, Any]:
    """Return the attributes that are ours, as plain values; those of the format are left out."""
    return {
        key: _plain(item.attrs[key]) for key in item.attrs if key not in _INTERNAL and not key.startswith("_")
    }


def _plain(value: Any) -> Any:
    if isinstance(value, np.ndarray | np.generic):
        value = value.item() if value.size == 1 else value.tolist()
    return value.decode() if isinstance(value, bytes) else value


def _umask() -> int:
    current = os.umask(0)
    os.umask(current)
    return current
