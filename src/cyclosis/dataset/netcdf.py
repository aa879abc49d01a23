"""Contents <-> NetCDF files, which are written completely or not at all and have checksums."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable, Iterator
from itertools import chain
from pathlib import Path
from typing import Any

import h5netcdf
import h5py
import numpy as np
import numpy.typing as npt

from ..contract.model import FIELD, Coordinate, Model
from ..model.errors import InputError
from ..models import of_tables
from .contents import GROWING, Block, Contents, FileVariable, described, spans
from .guarded import GuardedFile
from .provenance import SCHEMA
from .whole import unwritable, whole

DAMAGED = (OSError, ValueError, KeyError, TypeError, AttributeError, RuntimeError, UnicodeDecodeError)


def write_contents(
    contents: Contents, target: Path, force: bool = True, before: Callable[[], None] = lambda: None
) -> None:
    """Write a file under a temporary name, sync it and rename it to `target`.

    `before` is called just before the rename. Raises `FileExistsError` if `target` exists by then, unless
    `force`, and `InputError` if writing fails. Then no temporary file is left, and `target` is unchanged.
    """
    try:
        with whole(target, force) as new, GuardedFile(new) as guarded:
            with h5netcdf.File(guarded, "w") as file:
                _fill(file, contents, guarded.check)
            with h5py.File(guarded, "r+") as file:
                file.attrs["digest"] = digest(file, contents.model)
            guarded.sync()
            before()
    except FileExistsError:
        raise
    except OSError as error:
        raise unwritable(target, error) from error


def read_contents(path: Path, fields: bool = True, model: Model | None = None) -> Contents:
    """Return the contents of a file. Raises `InputError` if it is damaged, altered or of another schema.

    Frames are read block by block; without `fields` only their small variables are. `model` is needed for a
    file of a model that is not in `cyclosis.models`.
    """
    try:
        with h5py.File(path, "r") as file:
            model = check(file, path, model)
            stored = _variables(file)
            along = [name for name, item in stored.items() if _dims(item) == (name,)]
            coordinates = {n: Coordinate(_values(stored[n]), _meaning(stored[n])) for n in along}
            others = stored.keys() - coordinates.keys() - {item.name for item in model.stored}
            variables = {
                name: FileVariable(_dims(stored[name]), _values(stored[name]), attributes_of(stored[name]))
                for name in sorted(others)
            }
            restart = {name: _values(v) for name, v in _variables(file["restart"]).items()}
            attributes = {key: value for key, value in attributes_of(file).items() if key != "digest"}
    except DAMAGED as error:
        raise damaged(path, error) from error
    chosen = [item.name for item in model.stored if fields or item.dtype != FIELD]
    frames = _frames(path, model.state_name, chosen)
    return Contents(model, coordinates, variables, frames, restart, attributes)


def read_joined(paths: list[Path], fields: bool = True, model: Model | None = None) -> Contents:
    """Return the joined contents of the files of consecutive parts of one run."""
    return joined([read_contents(path, fields, model) for path in paths])


def joined(parts: list[Contents]) -> Contents:
    """Return the joined contents of consecutive parts of one run."""
    last = parts[-1]
    coordinates = dict(last.coordinates)
    for name in GROWING:
        if name in coordinates:
            values = np.concatenate([part.coordinates[name].values for part in parts])
            coordinates[name] = Coordinate(values, coordinates[name].meaning)
    variables = dict(last.variables)
    for name, variable in last.variables.items():
        if variable.dims[0] in GROWING:
            values = np.concatenate([part.variables[name].values for part in parts if name in part.variables])
            variables[name] = FileVariable(variable.dims, values, variable.attributes)
    frames = chain.from_iterable(part.frames for part in parts)
    return Contents(last.model, coordinates, variables, frames, last.restart, last.attributes)


def check(file: h5py.File, path: Path, model: Model | None = None) -> Model:
    """Return the model of an open file.

    Raises `InputError` unless the file was written by cyclosis, with this schema, is unaltered, and has the
    given model or a known one.
    """
    found = attributes_of(file)
    if found.get("program") != "cyclosis":
        raise InputError("file", str(path), "a NetCDF file of a cyclosis run", "choose another file")
    schema = found["schema"]
    if schema != SCHEMA:
        remedy = "update cyclosis" if schema > SCHEMA else "read it with the version that wrote it"
        rule = f"{SCHEMA}, the layout that this version reads"
        raise InputError("schema of " + str(path), schema, rule, remedy)
    chosen = of_tables(json.loads(found["configuration"]), model)
    if found["digest"] != digest(file, chosen):
        raise InputError("file", str(path), "as it was written", "it was altered: restore it from a copy")
    return chosen


def damaged(path: Path, error: Exception) -> InputError:
    """Return the error for a file that cannot be read."""
    if isinstance(error, InputError):
        return error
    if isinstance(error, FileNotFoundError):
        return InputError("file", str(path), "a NetCDF file of a run", "check the path: no such file")
    if isinstance(error, PermissionError):
        return InputError("file", str(path), "a file that can be read", "check its permissions")
    return InputError(
        "file", str(path), "a NetCDF file of a run, not truncated or altered", "restore it from a copy"
    )


def digest(file: h5py.File, model: Model) -> str:
    """Return a checksum of the attributes and of all variables except the fields.

    Every chunk of a field has its own checksum, which HDF5 verifies when the chunk is read.
    """
    out, fields = hashlib.sha256(), [item.name for item in model.stored if item.dtype == FIELD]
    for group in (file, file["restart"]):
        own = {key: value for key, value in attributes_of(group).items() if key != "digest"}
        out.update(json.dumps(own, sort_keys=True).encode())
        for name, variable in sorted(_variables(group).items()):
            described = [name, _dims(variable), str(variable.dtype), variable.shape, attributes_of(variable)]
            out.update(json.dumps(described, sort_keys=True).encode())
            if name not in fields:
                values = _values(variable)
                out.update(
                    json.dumps(values.tolist()).encode() if values.dtype == object else values.tobytes()
                )
    return out.hexdigest()


def _fill(file: h5netcdf.File, contents: Contents, check_disk: Callable[[], None]) -> None:
    """Fill an empty file; `check_disk` raises an error if the disk has failed."""
    file.dimensions = {name: len(along.values) for name, along in contents.coordinates.items()}
    for name, along in contents.coordinates.items():
        _create(file, name, (name,), along.values.dtype, along.values, described(along.meaning))
    for name, variable in contents.variables.items():
        _create(file, name, variable.dims, variable.values.dtype, variable.values, variable.attributes)
    frames = len(contents.coordinates["time"].values)
    stored = contents.model.stored
    fields = {
        item.name: _create(
            file, item.name, ("time", *item.dims), contents.dtype(item), None, described(item.meaning), True
        )
        for item in stored
        if item.dtype == FIELD
    }
    numbers: dict[str, list[npt.NDArray[Any]]] = {i.name: [] for i in stored if i.name not in fields}
    done = 0
    for block in contents.frames:
        span = slice(done, done := done + len(block[contents.model.state_name]))
        for name, target in fields.items():
            target[span] = block[name]
        for name, listed in numbers.items():
            listed.append(block[name])
        check_disk()
    if done != frames:
        raise ValueError(f"{done} frames for {frames} times")
    for item in stored:
        if item.name in numbers:
            values = np.concatenate(numbers[item.name]) if frames else None
            dims = ("time", *item.dims)
            _create(file, item.name, dims, contents.dtype(item), values, described(item.meaning))
    check_disk()
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
    by_frame: bool = False,
) -> Any:
    text = np.dtype(dtype).kind == "O"
    if values is not None and values.dtype == bool:
        values, dtype = values.astype(np.int8), np.dtype(np.int8)
    shape = tuple(group.dimensions[dim].size for dim in dims)
    options: dict[str, Any] = {}
    if dims and not text and all(shape):
        options = {"fletcher32": True, "chunks": (1, *shape[1:]) if by_frame else shape}
    variable = group.create_variable(
        name, dims, h5py.string_dtype() if text else dtype, data=values, **options
    )
    variable.attrs.update(attributes)
    return variable


def _frames(path: Path, state: str, names: list[str]) -> Iterator[Block]:
    try:
        with h5py.File(path, "r") as file:
            frames, *shape = file[state].shape
            for span in spans(frames, int(np.prod(shape)), file[state].dtype):
                yield {name: file[name][span] for name in names}
    except DAMAGED as error:
        raise damaged(path, error) from error


def _variables(group: h5py.Group) -> dict[str, h5py.Dataset]:
    """Return the variables of a group, without dimensions that have no values."""
    return {
        name: item
        for name, item in group.items()
        if isinstance(item, h5py.Dataset) and not item.attrs.get("NAME", b"").startswith(b"This is a netCDF")
    }


def _dims(variable: h5py.Dataset) -> tuple[str, ...]:
    if variable.is_scale:
        return (variable.name.rpartition("/")[2],)
    return tuple(scale[0].name.rpartition("/")[2] for scale in variable.dims)


def _meaning(variable: h5py.Dataset) -> str:
    return str(attributes_of(variable).get("long_name", ""))


def _values(variable: h5py.Dataset) -> npt.NDArray[Any]:
    if variable.dtype.kind == "O":
        return np.array(variable.asstr()[...], dtype=object)
    return np.asarray(variable[...])


_INTERNAL = ("CLASS", "NAME", "DIMENSION_LIST", "REFERENCE_LIST")


def attributes_of(item: h5py.HLObject) -> dict[str, Any]:
    """Return the attributes that cyclosis wrote, as plain values, without those of the file format."""
    return {
        key: _plain(item.attrs[key]) for key in item.attrs if key not in _INTERNAL and not key.startswith("_")
    }


def _plain(value: Any) -> Any:
    if isinstance(value, np.ndarray | np.generic):
        value = value.item() if value.size == 1 else value.tolist()
    return value.decode() if isinstance(value, bytes) else value
