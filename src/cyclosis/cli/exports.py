"""The command that writes a run for other programs."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Annotated, Any

import typer

from ..model.errors import InputError, choice
from .options import FILE, FORCE, OUTPUT, RADIUS, SPEED

TABLES = ("records", "zones", "profiles", "about")
KINDS = ("vtk", "csv", "xlsx", "netcdf", "npz", "zarr")
_NEXT_TO = {"csv": "-tables", "netcdf": "-export.nc", "xlsx": ".xlsx", "npz": ".npz", "zarr": ".zarr"}
"""Ends of default names next to the file: the NetCDF file must not replace the run."""
STREAM = "-"


def export(
    file: FILE,
    kind: Annotated[
        str | None,
        typer.Option(
            "--as",
            metavar="NAME",
            help="vtk: surface for ParaView; csv, xlsx (Excel): tables; netcdf, npz, zarr: "
            "all arrays. By default that of --out, and vtk without a suffix.",
        ),
    ] = None,
    table: Annotated[
        str | None,
        typer.Option(metavar="NAME", help="One table alone, as csv: records, zones, profiles or about."),
    ] = None,
    out: Annotated[
        Path | None,
        typer.Option(
            metavar="PATH",
            help="File or folder to write, or - for standard output (csv); by default next to FILE.",
            rich_help_panel=OUTPUT,
        ),
    ] = None,
    radius_um: RADIUS = None,
    speed_um_s: SPEED = None,
    force: FORCE = False,
) -> None:
    """Export a run for other programs: tables, Excel, NumPy, NetCDF, Zarr, or VTK for ParaView."""
    from .. import dataset

    if kind is not None:
        choice("as", kind, KINDS)
    if table is not None:
        choice("table", table, TABLES)
        if kind not in (None, "csv"):
            raise InputError("table", table, "given with --as csv", "leave it out")
    streamed = out is not None and str(out) == STREAM
    if streamed and kind not in (None, "csv"):
        raise InputError("out", STREAM, "a path, because only csv goes to standard output", "name a file")
    if streamed:
        with dataset.open_dataset(file) as data:
            data = dataset.with_scales(data, None, radius_um, speed_um_s)
            _print(data, table or TABLES[0])
        return
    with dataset.open_dataset(file) as data:
        data = dataset.with_scales(data, None, radius_um, speed_um_s)
        saved = dataset.export_run(data, out or _next_to(file, kind, table), kind, force, table)
    print(f"saved {saved}")


def _next_to(file: Path, kind: str | None, table: str | None) -> Path:
    """Return the default name of an export."""
    if table is not None:
        return file.with_name(f"{file.stem}-{table}.csv")
    if kind in (None, "vtk"):
        return file.with_suffix("")
    return file.with_name(file.stem + _NEXT_TO[str(kind)])


def _print(data: Any, table: str) -> None:
    from ..dataset.run_tables import as_text, run_table

    sys.stdout.writelines(as_text(run_table(data, table)))
