"""Exporting a store to one file for other programs: Zarr, compressed NetCDF, or a table."""

from __future__ import annotations

import gzip
import os
from collections.abc import Callable, Iterable, Iterator
from contextlib import AbstractContextManager, nullcontext
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

from ..dataset.guarded import GuardedFile
from ..dataset.place import in_the_way
from ..dataset.replaced import put_whole, refuse_existing
from ..dataset.run_tables import UNITS, factors_of
from ..dataset.scaled import with_scales
from ..dataset.whole import unwritable
from ..model.errors import InputError
from ..model.scales import Scales
from ..model.units import of_table
from .plan.variables import Variable, of_members, of_states
from .store.block_file import Arrays
from .store.read import choose, open_sweep
from .store.store import Store

__all__ = [
    "PIECE_BYTES",
    "export",
]


def __dir__() -> list[str]:
    return sorted(__all__)


_UNITS = UNITS | dict.fromkeys(("t_order", "t_final", "at", "over"), "s") | {"length": "um"}
"""Physical units of columns, as their names end; of the axes of a protocol by their last word."""
PIECE_BYTES = 2**26
"""Approximate memory of the pieces in which variables are copied."""


def export(
    store: Store | str | os.PathLike[str],
    target: str | os.PathLike[str],
    force: bool = False,
    variables: Iterable[str] | None = None,
    scales: Scales | None = None,
) -> Path:
    """Write the results in a store to one file, and return its path.

    The suffix sets the format: `.zarr` (a folder, format 2) and `.nc` (NetCDF-4, compressed) hold what
    `open_sweep` returns, and xarray opens them directly: integers stay integers, -1 where there is no value,
    as their attributes `valid_min` and `comment` say. `.csv` and `.csv.gz` have one row per member: its
    number, its values on the axes, its seed, then its variables. Regime and status are names, missing values
    are empty, all zones share one column, and profiles and fields are left out. `variables` names those to
    export. With `scales`, by default those in the table [scales] of the sweep, a table has a column in s, µm
    or µm/s after each one that has such a unit, and other files have the scales as an attribute. The target
    is written completely or not at all. Raises `InputError` for another suffix, an existing target (unless
    `force`), damaged blocks, unknown variables, and if it cannot be written.

    Example:
        >>> import cyclosis as cy
        >>> from cyclosis.sweep.store.block import compute
        >>> from cyclosis.sweep.export import export
        >>> from cyclosis.sweep.store.store import Store
        >>> tables = {"axes": {"alpha_p": {"values": [0.01]}}, "ensemble": {"seeds": 2}}
        >>> sweep = cy.Sweep.from_tables(tables | {"grid": {"n_theta": 16, "n_z": 16}})
        >>> path = Store.create("exported", sweep).write(0, compute(sweep, 0))
        >>> print(*export("exported", "exported.csv", variables=["regime"]).read_text().split())
        member,alpha_p,seed,regime 0,0.01,0,disordered 1,0.01,1,disordered
    """
    source = store if isinstance(store, Store) else Store(store)
    place = Path(os.path.abspath(target))
    writer = _writer(place)
    refuse_existing(place, force)
    names = None if variables is None else list(variables)
    choose(source.sweep.variables, names)
    try:
        with put_whole(place, force) as beside:
            writer(source, beside, names, scales or of_table(source.sweep.tables.get("scales", {})))
    except FileExistsError as error:
        raise in_the_way(place, "a new name") from error
    except OSError as error:
        raise unwritable(place, error) from error
    return place


def _writer(target: Path) -> Callable[[Store, Path, list[str] | None, Scales | None], None]:
    name = target.name.lower()
    packed = partial(_table, packed=True)
    for suffix, writer in ((".zarr", _zarr), (".nc", _netcdf), (".csv", _table), (".csv.gz", packed)):
        if name.endswith(suffix) and len(name) > len(suffix):
            return writer
    rule = "a name that ends in .zarr, .nc, .csv or .csv.gz"
    raise InputError("out", str(target), rule, "change its suffix")


def _opened(store: Store, names: list[str] | None, scales: Scales | None) -> xarray.Dataset:
    return with_scales(open_sweep(store.path, names), scales)


def _zarr(store: Store, target: Path, names: list[str] | None, scales: Scales | None) -> None:
    dataset = _opened(store, names, scales)
    name = store.sweep.model.state_name
    if name in dataset:  # read and written piece by piece
        field = dataset[name]
        dataset[name] = field.chunk(dict(zip(field.dims, _pieces_of(field), strict=True)))
    dataset.to_zarr(target, mode="w-", zarr_format=2, consolidated=True)


def _netcdf(store: Store, target: Path, names: list[str] | None, scales: Scales | None) -> None:
    dataset = _opened(store, names, scales)
    with GuardedFile(target) as guarded:
        with h5netcdf.File(guarded, "w") as file:
            file.attrs.update(dataset.attrs)
            file.dimensions = {str(name): size for name, size in dataset.sizes.items()}
            for name, item in dataset.variables.items():
                _copy(file, str(name), item, guarded.check)
        guarded.sync()


def _copy(file: h5netcdf.File, name: str, item: xarray.Variable, check: Callable[[], None]) -> None:
    """Copy a variable into a file, piece by piece."""
    text = item.dtype.kind in "UO"
    options: dict[str, Any] = {}
    sizes = _pieces_of(item)
    if not text:
        options = {"chunks": sizes, "compression": "gzip", "compression_opts": 4, "shuffle": True}
        options["fletcher32"] = True
    dtype = h5py.string_dtype() if text else item.dtype
    target = file.create_variable(name, item.dims, dtype, **options)
    target.attrs.update(item.attrs)
    starts = (range(0, size, step) for size, step in zip(item.shape, sizes, strict=True))
    for corner in product(*starts):
        place = tuple(slice(at, at + step) for at, step in zip(corner, sizes, strict=True))
        values = item[place].values
        target[place] = values.astype(object) if text else values
        check()


def _pieces_of(item: Any) -> tuple[int, ...]:
    """Return the shape of pieces of about `PIECE_BYTES`, complete along the last dimensions."""
    left = max(1, PIECE_BYTES // max(1, item.dtype.itemsize))
    sizes = []
    for size in reversed(item.shape):
        sizes.append(max(1, min(size, left)))
        left = max(1, left // sizes[-1])
    return tuple(reversed(sizes))


def _table(
    store: Store, target: Path, names: list[str] | None, scales: Scales | None, packed: bool = False
) -> None:
    items = [item for item in choose(store.sweep.variables, names) if "theta" not in item.dims]
    with open(target, "wb") as raw, _packer(raw, packed) as sink:
        for text in _rows(store, items, scales):
            sink.write(text.encode())
    with open(target, "rb") as done:
        os.fsync(done.fileno())


def _packer(raw: IO[bytes], packed: bool) -> AbstractContextManager[IO[bytes]]:
    """Return a stream to write bytes to; the same bytes always give the same file."""
    return cast(Any, gzip.GzipFile("", "wb", 9, raw, mtime=0)) if packed else nullcontext(raw)


def _rows(store: Store, items: list[Variable], scales: Scales | None) -> Iterator[str]:
    """Yield the table's header, then its rows block by block."""
    sweep = store.sweep
    states = of_states(sweep)
    present = store.present()
    for index in range(sweep.blocks):
        members = sweep.block(index).members
        arrays = store.read(index, {item.name for item in items}) if index in present else {}
        columns = {name: _texts(place.values) for name, place in of_members(sweep, members).items()}
        for item in items:
            columns |= _columns(item, arrays, states, (len(members), *(sweep.sizes[d] for d in item.dims)))
        if scales is not None:
            columns = _in_units(columns, factors_of(scales))
        if index == 0:
            yield ",".join(columns) + "\n"
        yield "".join(",".join(row) + "\n" for row in zip(*columns.values(), strict=True))


def _in_units(columns: dict[str, list[str]], factors: dict[str, float]) -> dict[str, list[str]]:
    """Return the columns with one in seconds, µm or µm/s after each that has such a unit."""
    out = {}
    for name, texts in columns.items():
        out[name] = texts
        key = name.rpartition(".")[2] if name.startswith("protocol.") else name
        unit = _UNITS.get(key)
        if unit is not None:
            out[f"{name}_{unit}"] = [repr(factors[unit] * float(text)) if text else "" for text in texts]
    return out


def _columns(
    item: Variable, arrays: Arrays, states: dict[str, Any], shape: tuple[int, ...]
) -> dict[str, list[str]]:
    """Return the columns of a variable by their names."""
    if item.dims not in ((), ("zone",)):
        labels = [f"{item.name}_{at}" for at in states[item.dims[0]].values]
        parts = [replace(item, name=label, dims=()) for label in labels]
        values = arrays.get(item.name, item.empty(shape))
        return {part.name: _column(part, values[:, at]) for at, part in enumerate(parts)}
    values = arrays.get(item.name, item.empty(shape))
    return {item.name: _column(item, values)}


def _column(item: Variable, values: npt.NDArray[Any]) -> list[str]:
    if item.codes:
        return [item.codes[code] if code >= 0 else "" for code in values]
    if item.dims:
        return [" ".join(_texts(row[np.isfinite(row)])) for row in values]
    missing = np.isnan(values) if values.dtype.kind == "f" else values == item.missing
    return ["" if lacks else text for lacks, text in zip(missing, _texts(values), strict=True)]


def _texts(values: npt.NDArray[Any]) -> list[str]:
    return [repr(value) for value in values.tolist()]
