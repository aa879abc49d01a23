"""Results of theory as files: NetCDF, or a table of the variables with one value per row."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..model.errors import InputError
from .guarded import GuardedFile
from .place import vacate
from .provenance import origin
from .whole import whole

if TYPE_CHECKING:
    import xarray

SUFFIXES = (".nc", ".csv")
"""Suffixes of files of numbers."""


def write_table(dataset: xarray.Dataset, path: str | os.PathLike[str]) -> Path:
    """Write a dataset of theory and return the path: .nc with all variables, .csv with its main columns.

    The columns are the variables over the first dimension only. The file is written completely or not at all,
    and replaces whatever exists at `path`, including the parts of an unfinished run. Raises `InputError` for
    other suffixes, for paths that cannot be written to, and if a run is being written there.

    Example:
        >>> import cyclosis as cy
        >>> from cyclosis.dataset import write_table
        >>> profile = cy.stability.cyclosis(cy.Parameters(), n_theta=64)
        >>> write_table(profile.to_dataset(), "profile.csv").read_text().split()[0]
        'theta,P,u'
    """
    target = Path(path)
    if target.suffix.lower() not in SUFFIXES:
        raise InputError("out", str(target), "a file name that ends in .nc or .csv", "change its suffix")
    try:
        with whole(target) as beside:
            if target.suffix.lower() == ".nc":
                write_netcdf(dataset.assign_attrs(origin()), beside)
            else:
                _columns(dataset).to_csv(beside)
            vacate(target)
    except OSError as error:
        remedy = f"choose another ({error.strerror or error})"
        raise InputError("out", str(target), "a place that can be written to", remedy) from error
    return target


def write_netcdf(dataset: xarray.Dataset, target: Path) -> None:
    """Write a NetCDF file. Raises `OSError` if the disk is full, where HDF5 alone would crash."""
    import h5netcdf
    from xarray.backends import H5NetCDFStore

    with GuardedFile(target) as guarded:
        with h5netcdf.File(guarded, "w") as file:
            dataset.dump_to_store(H5NetCDFStore(file))
        guarded.sync()


def _columns(dataset: xarray.Dataset) -> Any:
    first = next(iter(dataset.data_vars.values())).dims
    along = first[:1] if any(v.dims == first[:1] for v in dataset.data_vars.values()) else first
    names = [str(name) for name, variable in dataset.data_vars.items() if variable.dims == along]
    others = [str(n) for n, c in dataset.coords.items() if c.dims == along and n not in dataset.dims]
    return dataset[names + others].to_dataframe()[others + names]
