"""The saved fields as VTK files of the cylinder's surface, for ParaView."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ..model.errors import InputError
from ..model.grid import Array, covered
from .owner import claim
from .parts import folder_of
from .place import in_the_way
from .whole import remove, temporary

if TYPE_CHECKING:
    import xarray


def export_vtk(dataset: xarray.Dataset, folder: str | os.PathLike[str], force: bool = False) -> Path:
    """Write one structured grid (.vts) a frame and a collection (.pvd) over time; return the collection.

    The surface is embedded in space with radius 1 and its axis along z; the seam is closed by repeating
    the first points, around and along the axis. Point data: vectors `P` and `u` in Cartesian
    components, scalars `P_theta`, `P_z`, `u_theta`, `u_z`, all dimensionless. With `force` the files of an
    earlier export are replaced, and all others are kept. Raises `InputError` if the folder is not empty
    (unless `force`) or cannot be written, and if the dataset covers only a part of a cell.

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
    for name, period in (("theta", 2 * np.pi), ("z", float(dataset.attrs["length"]))):
        covered(name, dataset[name].values, period, "the dataset")
    new = temporary(target) if target.name else target
    try:
        used = target.exists() and (not target.is_dir() or any(target.iterdir()))
        if not target.name or (used and not force):
            raise in_the_way(target, "a new or empty folder")
        with claim(folder_of(target), target):
            new.mkdir()
            _write(dataset, new, target.name)
            target.mkdir(exist_ok=True)
            _replace(new, target)
    except OSError as error:
        remedy = f"choose another ({error.strerror or error})"
        raise InputError("out", str(target), "a folder that can be written to", remedy) from error
    finally:
        if target.name:
            remove(new)
    return target / f"{target.name}.pvd"


def _replace(new: Path, target: Path) -> None:
    """Move files into a folder, the collection last, in place of those of an earlier export."""
    collections, frames = (sorted(target.glob(kind)) for kind in ("*.pvd", "frame-*.vts"))
    for old in [*(path for path in collections if _FIRST in path.read_bytes()), *frames]:
        old.unlink()
    for written in sorted(new.iterdir(), key=lambda path: path.suffix, reverse=True):
        os.replace(written, target / written.name)


_FIRST = b'"frame-00000.vts"'
"""A name to which every collection written here refers."""


def _write(dataset: xarray.Dataset, target: Path, title: str) -> None:
    from pyevtk.hl import gridToVTK  # imported only here, since every run loads this module
    from pyevtk.vtk import VtkGroup

    length = float(dataset.attrs["length"])
    theta = np.append(dataset["theta"].values, 2 * np.pi)
    z = np.append(dataset["z"].values, length)
    angle, height = np.meshgrid(theta, z, indexing="ij")
    points = [_flat(values) for values in (np.cos(angle), np.sin(angle), height)]
    collection = VtkGroup(str(target / title))
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


def _closed(field: Array) -> Array:
    return np.pad(field, ((0, 0), (0, 1), (0, 1)), mode="wrap")


def _flat(values: Array) -> Array:
    """Return a surface as the three-dimensional array of one layer that VTK expects."""
    return np.ascontiguousarray(values[:, :, None])
