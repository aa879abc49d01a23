"""The flow on radii times the grid, as a dataset and as a VTK file."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from ..model.errors import InputError
from .points import checked_radii

if TYPE_CHECKING:
    import xarray

    from .flow import VacuoleFlow


def default_radii(count: int = 17) -> Any:
    """Return radii from the axis to the wall, close together at the wall, where waves decay."""
    return np.sin(0.5 * np.pi * np.linspace(0.0, 1.0, count))


def to_dataset(flow: VacuoleFlow, radii: npt.ArrayLike | None) -> xarray.Dataset:
    """Return the flow in the volume; see `VacuoleFlow.to_dataset`."""
    import xarray

    at = checked_radii(default_radii() if radii is None else radii)
    axes = ("r", "theta", "z")
    described = {"long_name": "velocity in the vacuole, components (r, theta, z)", "units": "1"}
    pressed = {"long_name": "pressure in units of eta U/R", "units": "1"}
    return xarray.Dataset(
        {
            "v": (("vector", *axes), flow.volume(at), described),
            "pressure": (axes, flow.pressure_volume(at), pressed),
        },
        {
            "vector": np.array(["r", "theta", "z"], dtype=object),
            "r": ("r", at, {"long_name": "distance from the axis in radii", "units": "1"}),
            "theta": (
                "theta",
                flow.grid.theta,
                {"long_name": "angle around the axis in radians", "units": "1"},
            ),
            "z": ("z", flow.grid.z, {"long_name": "position along the axis in radii", "units": "1"}),
        },
        {
            "Conventions": "CF-1.11",
            "title": "Flow in the vacuole",
            "length": flow.grid.length,
            "closure": flow.closure,
            "dissipation": flow.dissipation,
        },
    )


def to_vtk(flow: VacuoleFlow, path: str | os.PathLike[str], radii: npt.ArrayLike | None) -> Path:
    """Write the flow in the volume as a structured grid; see `VacuoleFlow.to_vtk`."""
    from pyevtk.hl import gridToVTK  # imported only here: it is slow to load

    from ..dataset.whole import whole  # loads all that files need
    from .flow import cartesian

    target = Path(path)
    if target.suffix.lower() != ".vts":
        raise InputError("path", str(target), "a file name that ends in .vts", "change its suffix")
    at = checked_radii(default_radii() if radii is None else radii)
    grid = flow.grid
    theta, z = np.append(grid.theta, 2 * np.pi), np.append(grid.z, grid.length)
    r, angle, height = np.meshgrid(at, theta, z, indexing="ij")
    velocity = _closed(flow.volume(at))
    pressure = _closed(flow.pressure_volume(at))
    pressure[..., -1] += flow.pressure_gradient * grid.length
    data = {
        "v": tuple(map(np.ascontiguousarray, cartesian(velocity, angle))),
        **{
            f"v_{n}": np.ascontiguousarray(part)
            for n, part in zip(("r", "theta", "z"), velocity, strict=True)
        },
        "pressure": np.ascontiguousarray(pressure),
    }
    try:
        place = [np.ascontiguousarray(part) for part in (r * np.cos(angle), r * np.sin(angle), height)]
        with whole(target) as beside:
            os.replace(gridToVTK(str(beside), *place, pointData=data), beside)
    except OSError as error:
        rule, remedy = "in a folder that can be written to", f"choose another ({error.strerror or error})"
        raise InputError("path", str(target), rule, remedy) from error
    return target


def _closed(field: Any) -> Any:
    """Return a field (..., n_theta, n_z) with its first points again after the last ones."""
    return np.pad(field, [(0, 0)] * (field.ndim - 2) + [(0, 1), (0, 1)], mode="wrap")
