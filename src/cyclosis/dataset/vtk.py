"""The saved fields as VTK files of the cell's surface, for ParaView."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ..model.grid import Array, covered
from ..model.units import length_unit, scales_in, speed_unit
from .replaced import fill_folder
from .revolved import Surface, is_revolved, revolved

if TYPE_CHECKING:
    import xarray


def export_vtk(dataset: xarray.Dataset, folder: str | os.PathLike[str], force: bool = False) -> Path:
    """Write one structured grid (.vts) a frame and a collection (.pvd) over time; return the collection.

    The surface is embedded in space with radius 1 and its axis along z; the seam is closed by repeating
    the first points, around and along the axis. Point data: vectors `P` and `u` in Cartesian
    components, scalars `P_theta`, `P_z`, `u_theta`, `u_z`, all dimensionless. Of a dataset with scales (see
    `with_scales`) lengths are in µm, times in s, and the flow is `u_um_per_s`, in µm/s. A closed surface has
    its true shape and its poles, and scalars `P_s` and `u_s` along the meridians. With `force` the files of
    an earlier export are replaced, and all others are kept. Raises `InputError` if the folder is not empty
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
    surface = revolved(dataset) if is_revolved(dataset) else _cylinder(dataset)
    fill_folder(target, force, lambda new: _write(dataset, surface, new, target.name), _earlier)
    return target / f"{target.name}.pvd"


def _earlier(folder: Path) -> list[Path]:
    """Return the files of an earlier export."""
    collections, frames = (sorted(folder.glob(kind)) for kind in ("*.pvd", "frame-*.vts"))
    return [*(path for path in collections if _FIRST in path.read_bytes()), *frames]


_FIRST = b'"frame-00000.vts"'
"""A name to which every collection written here refers."""


def _write(dataset: xarray.Dataset, surface: Surface, target: Path, title: str) -> None:
    from pyevtk.hl import gridToVTK  # imported only here, since every run loads this module
    from pyevtk.vtk import VtkGroup

    scales = scales_in(dataset)
    suffix = "" if scales is None else "_um_per_s"
    radius, speed = length_unit(scales).factor, speed_unit(scales).factor
    second = 1.0 if scales is None else scales.time_s
    points = [_flat(radius * values) for values in surface.points]
    collection = VtkGroup(str(target / title))
    for index, time in enumerate(dataset["time"].values):
        name = target / f"frame-{index:05d}"
        data: dict[str, Any] = {}
        for field in ("P", "u"):
            vector = surface.whole(np.asarray(dataset[field].isel(time=index).values, dtype=np.float64))
            if field == "u":
                vector = speed * vector
            in_space = vector[0] * surface.around + vector[1] * surface.along
            ending = suffix if field == "u" else ""
            data[f"{field}{ending}"] = tuple(_flat(component) for component in in_space)
            for axis, component in zip(("theta", surface.axis), vector, strict=True):
                data[f"{field}_{axis}{ending}"] = _flat(component)
        written = gridToVTK(str(name), *points, pointData=data)
        collection.addFile(written, sim_time=second * float(time))
    collection.save()


def _cylinder(dataset: xarray.Dataset) -> Surface:
    """Return the wall of the cylinder. Raises `InputError` for a part of it."""
    length = float(dataset.attrs["length"])
    for name, period in (("theta", 2 * np.pi), ("z", length)):
        covered(name, dataset[name].values, period, "the dataset")
    theta = np.append(dataset["theta"].values, 2 * np.pi)
    angle, height = np.meshgrid(theta, np.append(dataset["z"].values, length), indexing="ij")
    cos, sin, none = np.cos(angle), np.sin(angle), np.zeros_like(angle)
    around, along = np.stack([-sin, cos, none]), np.stack([none, none, none + 1.0])
    return Surface(np.stack([cos, sin, height]), around, along, "z", _closed)


def _closed(field: Array) -> Array:
    return np.pad(field, ((0, 0), (0, 1), (0, 1)), mode="wrap")


def _flat(values: Array) -> Array:
    """Return a surface as the three-dimensional array of one layer that VTK expects."""
    return np.ascontiguousarray(values[:, :, None])
