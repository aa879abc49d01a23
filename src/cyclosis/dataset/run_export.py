"""A run in the formats of other programs: tables, spreadsheets, arrays."""

from __future__ import annotations

import os
from collections.abc import Callable
from functools import partial
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ..model.errors import InputError, choice
from ..model.units import scales_in
from .place import check_writable, in_the_way
from .replaced import fill_folder, put_whole, refuse_existing
from .run_tables import TABLES, UNITS, Table, as_json, as_text, run_table, run_tables
from .tables import write_netcdf
from .vtk import export_vtk
from .whole import unwritable

if TYPE_CHECKING:
    import xarray

SUFFIXES = {"csv": ".csv", "xlsx": ".xlsx", "netcdf": ".nc", "npz": ".npz", "zarr": ".zarr", "vtk": ""}
"""All formats, and how the names of their files end; VTK files are in a folder, like several tables."""
MOST_ROWS = 2**20 - 1
"""Rows of values that a sheet of Excel can hold below its header."""


def export_run(
    dataset: xarray.Dataset,
    target: str | os.PathLike[str],
    kind: str | None = None,
    force: bool = False,
    table: str | None = None,
) -> Path:
    """Write a run's dataset for other programs and return the path.

    The `kind` is by default that of the suffix, and VTK without one:

    * csv: the tables of `run_table`; one of them, `table`, in a file .csv (by default the records), or all
      of them in a folder. Numbers have all their digits.
    * xlsx: the same, each a sheet of one file for Excel, with 15 digits; needs openpyxl,
      `pip install "cyclosis[excel]"`.
    * netcdf: everything except what is needed to resume, compressed, in one file .nc.
    * npz: the same as NumPy arrays by name, with the `attributes` as JSON; see `numpy.load`.
    * zarr: the same as a Zarr store of format 2, a folder .zarr.
    * vtk: the surface with P and u in every frame for ParaView, a folder; the path is that of
      its collection. See `export_vtk`.

    All values are dimensionless. Of a dataset with scales (see `with_scales`) tables have further columns,
    and arrays further coordinates, in micrometres and seconds, and VTK files are in these. What is written
    appears complete or not at all; files in a folder that are not of an earlier export are kept. Raises
    `InputError` for other kinds, a name with another suffix, a place that is in use (unless `force`) or
    cannot be written to, and without openpyxl for xlsx.

    Example:
        >>> import cyclosis as cy
        >>> from cyclosis.dataset import export_run
        >>> params, grid = cy.Parameters(), cy.CylinderGrid(16, 16)
        >>> data = cy.simulate(params, grid, cy.initial.stripes(grid), t_end=1.0).to_dataset()
        >>> print(export_run(data, "order.csv").read_text().splitlines()[0][:33])
        time,mean_P_theta,mean_P_z,order,
        >>> sorted(path.name for path in export_run(data, "tables", "csv").iterdir())
        ['about.csv', 'profiles.csv', 'records.csv', 'zones.csv']
        >>> import numpy as np
        >>> np.load(export_run(data, "run.npz"))["P"].shape
        (2, 2, 16, 16)
    """
    place = Path(os.path.abspath(target))
    kind = _kind(place, kind)
    if table is not None:
        choice("table", table, tuple(TABLES))
        if kind != "csv" or not place.suffix:
            raise InputError("table", table, "given for one file .csv", "name such a file, or leave it out")
    if kind == "vtk":
        return export_vtk(dataset, place, force)
    if kind == "csv" and not place.suffix:
        tables = run_tables(dataset)
        fill_folder(place, force, partial(_folder, tables), _earlier)
        return place
    if kind == "zarr":
        refuse_existing(place, force)
    else:
        check_writable(place, force)
    write = _writer(dataset, kind, table)
    try:
        with put_whole(place, force) as beside:
            write(beside)
    except FileExistsError as error:
        raise in_the_way(place, "a new name") from error
    except OSError as error:
        raise unwritable(place, error) from error
    return place


def _kind(target: Path, kind: str | None) -> str:
    """Return the format, which is by default that of the suffix of a name."""
    suffix = target.suffix.lower()
    if kind is None and target.is_dir() and suffix != ".zarr":
        return "vtk"
    if kind is None:
        known = {ending: name for name, ending in SUFFIXES.items()}
        if suffix not in known and suffix[1:2].isalpha():
            rule = "a name that ends in " + ", ".join(filter(None, known)) + ", or without a suffix for VTK"
            raise InputError("out", str(target), rule, "change its suffix")
        return known.get(suffix, "vtk")
    ending = SUFFIXES[choice("as", kind, tuple(SUFFIXES))]
    if suffix == ending or (kind in ("csv", "vtk") and (target.is_dir() or not suffix[1:2].isalpha())):
        return kind
    if not ending:
        rule, remedy = "the name of a folder, because every frame becomes a file (.vts)", "leave out {0}"
        raise InputError("out", str(target), rule, remedy.format(target.suffix))
    rule = f"a name that ends in {ending}" + (", or the name of a folder" if kind == "csv" else "")
    raise InputError("out", str(target), rule, f"write {target.stem}{ending}, for example")


def _writer(dataset: xarray.Dataset, kind: str, table: str | None) -> Callable[[Path], None]:
    if kind == "csv":
        return partial(_csv, run_table(dataset, table or "records"))
    if kind == "xlsx":
        return partial(_excel, _fitting(run_tables(dataset)))
    return partial({"netcdf": _netcdf, "npz": _npz, "zarr": _zarr}[kind], dataset)


def _folder(tables: dict[str, Table], new: Path) -> None:
    for name, table in tables.items():
        _csv(table, new / f"{name}.csv")


def _earlier(folder: Path) -> list[Path]:
    return [folder / f"{name}.csv" for name in TABLES]


def _csv(table: Table, target: Path) -> None:
    with open(target, "w", encoding="utf-8", newline="") as file:
        file.writelines(as_text(table))
        file.flush()
        os.fsync(file.fileno())


def _fitting(tables: dict[str, Table]) -> dict[str, Table]:
    """Return the tables if Excel can be written and holds them."""
    if find_spec("openpyxl") is None:
        rule = "csv, for example, where openpyxl is not installed"
        raise InputError("as", "xlsx", rule, 'install it: pip install "cyclosis[excel]"')
    for name, table in tables.items():
        rows = len(next(iter(table.values())))
        if rows > MOST_ROWS:
            rule = f"at most {MOST_ROWS}, the most that a sheet of Excel holds"
            raise InputError(f"the number of rows of {name}", rows, rule, "write csv instead")
    return tables


def _excel(tables: dict[str, Table], target: Path) -> None:
    import openpyxl
    from openpyxl.cell import WriteOnlyCell
    from openpyxl.styles import Font

    book = openpyxl.Workbook(write_only=True)
    for name, table in tables.items():
        sheet = book.create_sheet(name)
        sheet.freeze_panes = "A2"
        head = [WriteOnlyCell(sheet, value=column) for column in table]
        for cell in head:
            cell.font = Font(bold=True)
        sheet.append(head)
        for row in zip(*(column.tolist() for column in table.values()), strict=True):
            sheet.append([None if value != value else value for value in row])
    with open(target, "wb") as file:
        book.save(file)


def _plain(dataset: xarray.Dataset) -> xarray.Dataset:
    """Return a dataset whose texts have a fixed length, without the encoding of its file."""
    texts = {
        name: item.astype(str) for name, item in dataset.variables.items() if item.dtype.kind in ("O", "T")
    }
    plain = dataset.assign(texts).drop_encoding().assign_attrs(program="cyclosis export")
    scales = scales_in(dataset)
    if scales is None:
        return plain
    factors = {name: unit for name, unit in UNITS.items() if name in dataset.coords}
    values = {"s": scales.time_s, "um": scales.radius_um}
    added = {
        f"{name}_{unit}": (name, dataset[name].values * values[unit], {"units": unit})
        for name, unit in factors.items()
    }
    return plain.assign_coords(added)


def _netcdf(dataset: xarray.Dataset, target: Path) -> None:
    plain = _plain(dataset)
    for item in plain.variables.values():
        if item.dtype.kind == "f" and item.ndim > 1:
            item.encoding = {"zlib": True, "complevel": 4, "shuffle": True}
    write_netcdf(plain, target)


def _npz(dataset: xarray.Dataset, target: Path) -> None:
    plain = _plain(dataset)
    arrays: dict[str, Any] = {str(name): item.values for name, item in plain.variables.items()}
    with open(target, "wb") as file:
        np.savez_compressed(file, attributes=np.array(as_json(plain.attrs)), **arrays)


def _zarr(dataset: xarray.Dataset, target: Path) -> None:
    _plain(dataset).to_zarr(target, mode="w-", zarr_format=2, consolidated=True)
