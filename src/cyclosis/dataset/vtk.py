"""The saved fields as VTK files of the cylinder's surface, for ParaView."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from pyevtk.hl import gridToVTK
from pyevtk.vtk import VtkGroup

from ..model.errors import InputError
from ..model.grid import Array

if TYPE_CHECKING:
    import xarray


def export_vtk(dataset: xarray.Dataset, folder: str | os.PathLike[str], force: bool = False) -> Path:
    """Write one structured grid (.vts) a frame and a collection (.pvd) over time; return the collection.

    The surface is embedded in space with radius 1 and its axis along z; the seam is closed by repeating
    the first points, around and along the axis. Point data: vectors `P` and `u` in Cartesian
    components, scalars `P_theta`, `P_z`, `u_theta`, `u_z`. Dimensionless. Raises `InputError` if
    the folder is not empty (unless `force`) or cannot be written.

    Example:
        >>> import cyclosis as cy
        >>> from cyclosis.dataset import export_vtk
        >>> params, grid = cy.Parameters(), cy.CylinderGrid(16, 16)
        >>> run = cy.simulate(params, grid, cy.initial.stripes(grid), t_end=1.0)
        >>> collection = export_vtk(run.to_dataset(), "surface")
        >>> collection.name, sorted(path.name for path in collection.parent.glob("*.vts"))
        ('surface.pvd', ['frame-00000.vts', 'frame-00001.vts'])
    """
    target = Path(folder).resolve()
    try:
        if target.exists() and (not target.is_dir() or any(target.iterdir())) and not force:
            raise InputError("out", str(target), "a new or empty folder", "add --force (force=True)")
        target.mkdir(exist_ok=True)
        return _write(dataset, target)
    except OSError as error:
        remedy = f"choose another ({error.strerror or error})"
        raise InputError("out", str(target), "a folder that can be written to", remedy) from error


def _write(dataset: xarray.Dataset, target: Path) -> Path:
    length = float(dataset.attrs["length"])
    theta = np.append(dataset["theta"].values, 2 * np.pi)
    z = np.append(dataset["z"].values, length)
    angle, height = np.meshgrid(theta, z, indexing="ij")
    points = [_flat(values) for values in (np.cos(angle), np.sin(angle), height)]
    collection = VtkGroup(str(target / target.name))
    for index, time in enumerate(dataset["time"].values):
        name = target / f"frame-{index:05d}"
        data: dict[str, Any] = {}
        for field in ("P", "u"):
            vector = _closed(np.asarray(dataset[field].isel(time=index).values, dtype=np.float64))
            around = (-np.sin(angle) * vector[0], np.cos(angle) * vector[0], vector[1])
            data[field] = tuple(_flat(component) for component in around)
            data[f"{field}_theta"], data[f"{field}_z"] = _flat(vector[0]), _flat(vector[1])
        written = gridToVTK(str(name), *points, pointData=data)
        collection.addFile(written, sim_time=float(time))
    collection.save()
    return target / f"{target.name}.pvd"


def _closed(field: Array) -> Array:
    return np.pad(field, ((0, 0), (0, 1), (0, 1)), mode="wrap")


def _flat(values: Array) -> Array:
    """Return a surface as the three-dimensional array of one layer that VTK expects."""
    return np.ascontiguousarray(values[:, :, None])
