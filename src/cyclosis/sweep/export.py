"""From a store to one file for other programs: Zarr, compressed NetCDF, or a table."""

from __future__ import annotations

import gzip
import os
import secrets
import shutil
import time
from collections.abc import Callable, Iterable, Iterator
from contextlib import AbstractContextManager, contextmanager, nullcontext
from dataclasses import replace
from functools import partial
from itertools import product
from pathlib import Path
from typing import IO, Any, cast

import h5netcdf
import h5py
import numpy as np
import numpy.typing as npt
import xarray

from ..dataset.contents import ZONES
from ..dataset.guarded import GuardedFile
from ..dataset.netcdf import sync_folder, unwritable
from ..model.errors import InputError
from .collect import choose, open_sweep
from .packed import Arrays
from .store import Store
from .variables import FIELD, Variable, meanings, of_members, of_states

PIECE_BYTES = 2**26
"""Memory that the piece of a variable that is being copied takes, about."""


def export(
    store: Store | str | os.PathLike[str],
    target: str | os.PathLike[str],
    force: bool = False,
    variables: Iterable[str] | None = None,
) -> Path:
    """Write the results in a store to one file, and return its path.

    The suffix decides: `.zarr` (a folder, format 2) and `.nc` (NetCDF-4, compressed) hold what `open_sweep`
    gives; `.csv` and `.csv.gz` have a row for every member: where it stands, then its variables, regime and
    status by name, nothing where a value is missing; all zones stand in one cell, and profiles and fields are
    left out. `variables` names those to export. The target appears whole or not at all.
    Raises `InputError` for another suffix, a target that stands (unless `force`), damaged blocks, unknown
    variables, and if it cannot be written.

    Example:
        >>> import cyclosis as cy
        >>> from cyclosis.sweep.block import compute
        >>> from cyclosis.sweep.export import export
        >>> from cyclosis.sweep.store import Store
        >>> tables = {"axes": {"alpha_p": {"values": [0.01]}}, "ensemble": {"seeds": 2}}
        >>> sweep = cy.Sweep.from_tables(tables | {"grid": {"n_theta": 16, "n_z": 16}})
        >>> path = Store.create("exported", sweep).write(0, compute(sweep, 0))
        >>> print(*export("exported", "exported.csv", variables=["regime"]).read_text().split())
        member,alpha_p,seed,regime 0,0.01,0,disordered 1,0.01,1,disordered
    """
    source = store if isinstance(store, Store) else Store(store)
    place = Path(os.path.abspath(target))
    writer = _writer(place)
    _refuse_standing(place, force)
    names = None if variables is None else list(variables)
    choose(source.sweep.variables, names)
    try:
        with _whole(place) as beside:
            writer(source, beside, names)
    except OSError as error:
        raise unwritable(place, error) from error
    return place


def _writer(target: Path) -> Callable[[Store, Path, list[str] | None], None]:
    name = target.name.lower()
    packed = partial(_table, packed=True)
    for suffix, writer in ((".zarr", _zarr), (".nc", _netcdf), (".csv", _table), (".csv.gz", packed)):
        if name.endswith(suffix) and len(name) > len(suffix):
            return writer
    rule = "a name that ends in .zarr, .nc, .csv or .csv.gz"
    raise InputError("out", str(target), rule, "change its suffix")


def _refuse_standing(target: Path, force: bool) -> None:
    if not target.parent.is_dir():
        raise InputError("out", str(target), "in a folder that exists", f"create {target.parent} first")
    if os.path.lexists(target) and not force:
        raise InputError("out", str(target), "a new name", "add --force (force=True) to overwrite it")
    folder = target.name.lower().endswith(".zarr")
    if target.is_dir() and not (folder and _is_zarr(target)):
        raise InputError("out", str(target), "no folder with other things", "choose another name")


def _is_zarr(folder: Path) -> bool:
    return any((folder / name).exists() for name in (".zgroup", "zarr.json"))


@contextmanager
def _whole(target: Path) -> Iterator[Path]:
    """Provide a temporary name beside a target, which it replaces if all goes well; else it is removed."""
    token = secrets.token_hex(4)
    new = target.with_name(f".{target.name}.{token}.new")
    old = target.with_name(f".{target.name}.{token}.old")
    try:
        yield new
        if target.is_dir():  # no folder can be replaced in one go
            os.replace(target, old)
        try:
            os.replace(new, target)
        except OSError:
            if old.exists():
                os.replace(old, target)
            raise
        sync_folder(target.parent)
    finally:
        for path in (new, old):
            _remove(path)


def _remove(path: Path) -> None:
    """Remove a file or a folder for good: where one of Zarr's writes fails, others are still on their way."""
    if not path.is_dir():
        path.unlink(missing_ok=True)
    for _ in range(100):
        if not path.is_dir():
            return
        shutil.rmtree(path, ignore_errors=True)
        time.sleep(0.1)


def _zarr(store: Store, target: Path, names: list[str] | None) -> None:
    dataset = open_sweep(store.path, names)
    if FIELD.name in dataset:  # it is read, and written, piece by piece
        field = dataset[FIELD.name]
        dataset[FIELD.name] = field.chunk(dict(zip(field.dims, _pieces_of(field), strict=True)))
    dataset.to_zarr(target, mode="w-", zarr_format=2, consolidated=True)


def _netcdf(store: Store, target: Path, names: list[str] | None) -> None:
    dataset = open_sweep(store.path, names)
    with GuardedFile(target) as guarded:
        with h5netcdf.File(guarded, "w") as file:
            file.attrs.update(dataset.attrs)
            file.dimensions = {str(name): size for name, size in dataset.sizes.items()}
            for name, item in dataset.variables.items():
                _copy(file, str(name), item, guarded.check)
        guarded.sync()


def _copy(file: h5netcdf.File, name: str, item: xarray.Variable, still_well: Callable[[], None]) -> None:
    """Copy a variable into a file, piece by piece."""
    text = item.dtype.kind in "UO"
    options: dict[str, Any] = {}
    sizes = _pieces_of(item)
    if not text:
        options = {"chunks": sizes, "compression": "gzip", "compression_opts": 4, "shuffle": True}
        options |= {"fletcher32": True, "fillvalue": item.attrs.get("_FillValue")}
    dtype = h5py.string_dtype() if text else item.dtype
    target = file.create_variable(name, item.dims, dtype, **options)
    target.attrs.update({key: value for key, value in item.attrs.items() if key != "_FillValue"})
    starts = (range(0, size, step) for size, step in zip(item.shape, sizes, strict=True))
    for corner in product(*starts):
        place = tuple(slice(at, at + step) for at, step in zip(corner, sizes, strict=True))
        values = item[place].values
        target[place] = values.astype(object) if text else values
        still_well()


def _pieces_of(item: Any) -> tuple[int, ...]:
    """Return the shape of pieces of about `PIECE_BYTES`, whole along the last dimensions."""
    left = max(1, PIECE_BYTES // max(1, item.dtype.itemsize))
    sizes = []
    for size in reversed(item.shape):
        sizes.append(max(1, min(size, left)))
        left = max(1, left // sizes[-1])
    return tuple(reversed(sizes))


def _table(store: Store, target: Path, names: list[str] | None, packed: bool = False) -> None:
    items = [item for item in choose(store.sweep.variables, names) if "theta" not in item.dims]
    with open(target, "wb") as raw, _packer(raw, packed) as sink:
        for text in _rows(store, items):
            sink.write(text.encode())
    with open(target, "rb") as done:
        os.fsync(done.fileno())


def _packer(raw: IO[bytes], packed: bool) -> AbstractContextManager[IO[bytes]]:
    """Return where bytes are to be written; the same ones always make the same file."""
    return cast(Any, gzip.GzipFile("", "wb", 9, raw, mtime=0)) if packed else nullcontext(raw)


def _rows(store: Store, items: list[Variable]) -> Iterator[str]:
    """Yield the table's head, and then its rows block by block."""
    sweep = store.sweep
    states = of_states(sweep)
    standing = store.present()
    for index in range(sweep.blocks):
        members = sweep.block(index).members
        arrays = store.read(index, {item.name for item in items}) if index in standing else {}
        columns = {name: _texts(place.values) for name, place in of_members(sweep, members).items()}
        for item in items:
            columns |= _columns(item, arrays, states, len(members))
        if index == 0:
            yield ",".join(columns) + "\n"
        yield "".join(",".join(row) + "\n" for row in zip(*columns.values(), strict=True))


def _columns(item: Variable, arrays: Arrays, states: dict[str, Any], count: int) -> dict[str, list[str]]:
    """Return the columns of a variable by their names."""
    if item.dims not in ((), ("zone",)):
        labels = [f"{item.name}_{at}" for at in states[item.dims[0]].values]
        parts = [replace(item, name=label, dims=()) for label in labels]
        values = arrays.get(item.name, item.empty((count, len(parts))))
        return {part.name: _column(part, values[:, at]) for at, part in enumerate(parts)}
    values = arrays.get(item.name, item.empty((count, *(ZONES for _ in item.dims))))
    return {item.name: _column(item, values)}


def _column(item: Variable, values: npt.NDArray[Any]) -> list[str]:
    if item.codes:
        names = meanings(item.codes)
        return [names[code] if code >= 0 else "" for code in values]
    if item.dims:
        return [" ".join(_texts(row[np.isfinite(row)])) for row in values]
    missing = np.isnan(values) if values.dtype.kind == "f" else values == item.missing
    return ["" if lacks else text for lacks, text in zip(missing, _texts(values), strict=True)]


def _texts(values: npt.NDArray[Any]) -> list[str]:
    return [repr(value) for value in values.tolist()]
