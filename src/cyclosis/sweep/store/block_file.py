"""One block as the bytes of a classic NetCDF file that contains its own checksum.

The same arrays always give the same bytes. The global attribute `sha256` is the SHA-256 of the whole file,
computed with the 64 characters of that attribute set to "0": every byte of the file is covered.
"""

from __future__ import annotations

import hashlib
import io
import json
from collections.abc import Collection, Mapping
from typing import Any

import numpy as np
import numpy.typing as npt
from scipy.io import netcdf_file

from ...version import __version__
from ..plan.sweep import Sweep
from ..plan.variables import Placed, attributes, of_members, of_states

SCHEMA = 1
"""Version of the layout of blocks and stores; any other is refused."""
CONVENTIONS = "CF-1.11"

_MARK = b"\x00\x00\x00\x06sha256\x00\x00\x00\x00\x00\x02\x00\x00\x00\x40"
"""The attribute as stored in a file: its name, type (text) and length (64); its characters follow."""
_BLANK = b"0" * 64

Arrays = dict[str, npt.NDArray[Any]]


class Damaged(ValueError):
    """A damaged or wrong block; the message says in a few words what is wrong with it."""


def pack(sweep: Sweep, index: int, arrays: Mapping[str, npt.ArrayLike]) -> bytes:
    """Return the file of a block as bytes, from an array (members, ...) for each of the sweep's variables.

    Raises `ValueError` if the names or the shapes are not those of the sweep's variables.
    """
    members = sweep.block(index).members
    held = {item.name: item for item in sweep.variables}
    if arrays.keys() != held.keys():
        raise ValueError(f"a block of this sweep holds {sorted(held)}, not {sorted(arrays)}")
    buffer = io.BytesIO()
    file = netcdf_file(buffer, "w", version=2)
    for name, value in _head(sweep, index).items():
        setattr(file, name, value)
    placed = of_members(sweep, members)
    for item in (*placed.values(), *of_states(sweep).values()):
        _add(file, item, item.attributes)
    places = " ".join(name for name in placed if name != "member")
    for name, variable in held.items():
        values = np.asarray(arrays[name]).astype(variable.dtype)
        shape = (len(members), *(sweep.sizes[dim] for dim in variable.dims))
        if values.shape != shape:
            raise ValueError(f"{name} has shape {values.shape}, not {shape}")
        described = attributes(variable) | {"coordinates": places}
        _add(file, Placed(name, ("member", *variable.dims), values, {}), described)
    file.flush()
    return _sealed(buffer.getvalue())


def unpack(data: bytes, sweep: Sweep, index: int, names: Collection[str] | None = None) -> Arrays:
    """Return the variables in the file of a block, or only those named, after checking every byte of it.

    Raises `Damaged` if the file was altered or truncated, or is not this block of this sweep.
    """
    _check_bytes(data)
    file = netcdf_file(io.BytesIO(data), "r", mmap=False)
    if file.schema != SCHEMA:
        raise Damaged(f"of layout {file.schema}; this version reads layout {SCHEMA}")
    if file.sweep.decode() != sweep.digest:
        raise Damaged("of another sweep")
    if file.block != index:
        raise Damaged(f"block {file.block} under another name")
    return {
        item.name: file.variables[item.name].data.astype(item.dtype)
        for item in sweep.variables
        if names is None or item.name in names
    }


def of_sweep(what: str, sweep: Sweep) -> str:
    """Return a title: what a file is, and the physics of the sweep."""
    title = sweep.model.title
    return f"{what} of {title[:1].lower()}{title[1:]}"


def _head(sweep: Sweep, index: int) -> dict[str, Any]:
    members = sweep.block(index).members
    texts = {
        "sha256": _BLANK.decode(),
        "Conventions": CONVENTIONS,
        "title": of_sweep("Block of a sweep", sweep),
        "source": sweep.model.source,
        "program": f"cyclosis {__version__}",
        "configuration": json.dumps(sweep.tables),
        "sweep": sweep.digest,
    }
    numbers = {
        "schema": SCHEMA,
        "block": index,
        "first_member": members[0],
        "last_member": members[-1],
    }
    return {name: text.encode() for name, text in texts.items()} | {
        name: np.int32(number) for name, number in numbers.items()
    }


def _add(file: netcdf_file, item: Placed, described: Mapping[str, Any]) -> None:
    dims, values = item.dims, item.values
    if values.dtype.kind == "U":
        values = np.char.encode(values, "utf-8")
        dims = (*dims, f"{item.name}_characters")
        values = values.view("S1").reshape(*values.shape, -1)
    for dim, size in zip(dims, values.shape, strict=True):
        if dim not in file.dimensions:
            file.createDimension(dim, size)
    variable = file.createVariable(item.name, values.dtype, dims)
    variable[:] = values
    for key, value in described.items():
        setattr(variable, key, value.encode() if isinstance(value, str) else value)


def _sealed(data: bytes) -> bytes:
    at = data.index(_MARK) + len(_MARK)
    return data[:at] + _digest(data, at).encode() + data[at + 64 :]


def _digest(data: bytes, at: int) -> str:
    view = memoryview(data)
    out = hashlib.sha256(view[:at])
    out.update(_BLANK)
    out.update(view[at + 64 :])
    return out.hexdigest()


def _check_bytes(data: bytes) -> None:
    if not data:
        raise Damaged("empty")
    found = data.find(_MARK)
    if not data.startswith(b"CDF\x02") or found < 0:
        raise Damaged("not a block of a sweep, or altered at its beginning")
    at = found + len(_MARK)
    if data[at : at + 64] != _digest(data, at).encode():
        raise Damaged("altered or truncated: its checksum does not fit")
