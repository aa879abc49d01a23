"""Results of theory as files: NetCDF, or a table of what has one value a row."""

from __future__ import annotations

import contextlib
import os
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..model.errors import InputError
from .provenance import origin

if TYPE_CHECKING:
    import xarray

SUFFIXES = (".nc", ".csv")
"""What a file of numbers may end in."""


def write_table(dataset: xarray.Dataset, path: str | os.PathLike[str]) -> Path:
    """Write a dataset of theory and return the path: .nc with all of it, .csv with its main columns.

    The columns are the variables over the first dimension alone. The file appears whole or not at all. Raises
    `InputError` for other suffixes and for places that cannot be written to.

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
    beside = target.with_name(f".{target.name}.{os.getpid()}.new")
    try:
        if target.suffix.lower() == ".nc":
            dataset.assign_attrs(origin()).to_netcdf(beside, engine="h5netcdf")
        else:
            _columns(dataset).to_csv(beside)
        os.replace(beside, target)
    except OSError as error:
        remedy = f"choose another ({error.strerror or error})"
        raise InputError("out", str(target), "a place that can be written to", remedy) from error
    finally:
        with contextlib.suppress(OSError):
            beside.unlink(missing_ok=True)
    return target


def _columns(dataset: xarray.Dataset) -> Any:
    first = next(iter(dataset.data_vars.values())).dims
    along = first[:1] if any(v.dims == first[:1] for v in dataset.data_vars.values()) else first
    names = [str(name) for name, variable in dataset.data_vars.items() if variable.dims == along]
    others = [str(n) for n, c in dataset.coords.items() if c.dims == along and n not in dataset.dims]
    return dataset[names + others].to_dataframe()[others + names]
