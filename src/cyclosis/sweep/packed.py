"""One block as the bytes of a classic NetCDF file that carries a checksum of itself.

The same arrays always give the same bytes. The global attribute `sha256` is the SHA-256 of the whole file,
taken with the 64 characters of that attribute set to "0": every byte of the file is covered.
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

from ..version import __version__
from .plan import Sweep
from .variables import Coordinate, attributes, of_members, of_states

SCHEMA = 1
"""Version of the layout of blocks and stores; another is refused, never guessed at."""
CONVENTIONS = "CF-1.11"
SOURCE = "Model of Woodhouse & Goldstein, PNAS 110 (2013), doi 10.1073/pnas.1302736110"

_MARK = b"\x00\x00\x00\x06sha256\x00\x00\x00\x00\x00\x02\x00\x00\x00\x40"
"""How the attribute stands in a file: its name, its type (text), its length (64); then its characters."""
_BLANK = b"0" * 64

Arrays = dict[str, npt.NDArray[Any]]


class Damaged(ValueError):
    """A block that is not what it should be; the message says why in a few words."""


def pack(sweep: Sweep, index: int, arrays: Mapping[str, npt.ArrayLike]) -> bytes:
    """Return the file of a block: an array (members, ...) for every one of the sweep's variables.

    Raises `ValueError` if these are not the sweep's variables in their shapes.
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
        _add(file, Coordinate(name, ("member", *variable.dims), values, {}), described)
    file.flush()
    return _sealed(buffer.getvalue())


def unpack(data: bytes, sweep: Sweep, index: int, names: Collection[str] | None = None) -> Arrays:
    """Return the variables in the file of a block, or only those named, after checking every byte of it.

    Raises `Damaged` for a file that was altered or truncated, is none, or is not this block of this sweep.
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


def _head(sweep: Sweep, index: int) -> dict[str, Any]:
    members = sweep.block(index).members
    texts = {
        "sha256": _BLANK.decode(),
        "Conventions": CONVENTIONS,
        "title": "Block of a sweep of self-organised cytoplasmic streaming on a cylinder",
        "source": SOURCE,
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


def _add(file: netcdf_file, item: Coordinate, described: Mapping[str, Any]) -> None:
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
        raise Damaged("no block of a sweep, or altered at its beginning")
    at = found + len(_MARK)
    if data[at : at + 64] != _digest(data, at).encode():
        raise Damaged("altered or truncated: its checksum does not fit")
