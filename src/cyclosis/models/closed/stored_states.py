"""States of closed cells from files, carried to another resolution where they have to be."""

from __future__ import annotations

import json
from typing import Any

import numpy as np

from ...closed import initial
from ...closed.grid import Array, ClosedGrid
from ...model.errors import InputError
from .shape_table import grid_of

RULE = "a .nc file of a run on a closed surface, or a .npy file with a state"


def from_file(path: str, grid: ClosedGrid, frame: int = -1) -> Array:
    """Return a state (2, n_theta, n_s) stored in a file, on `grid`.

    From a NetCDF file of a run it takes `frame` of P. The surface of the run must be that of `grid`; where
    k_max or the points differ, the field is evaluated at the points of `grid` and projected. A `.npy` file
    holds an array of the grid's own shape. Raises `InputError` for other files, frames and surfaces.
    """
    try:
        if str(path).endswith(".npy"):
            return grid.check_state(np.load(path, allow_pickle=False), f"the state in {path}", bounded=True)
        stored, source = _frame_of(path, frame)
    except FileNotFoundError as error:
        raise InputError("path", path, RULE, "check the path: there is no such file") from error
    except (OSError, KeyError, ValueError, TypeError, EOFError) as error:
        if isinstance(error, InputError):
            raise
        reason = " ".join(str(error).split()) or type(error).__name__
        raise InputError("path", path, RULE, f"it gave: {reason[:90]}") from error
    if source.surface != grid.surface:
        rule = f"that of the grid, {grid.surface!r}"
        raise InputError(f"the surface in {path}", repr(source.surface), rule, "give the grid that shape")
    P = source.check_state(stored, f"P in {path}")
    if source == grid:
        return P
    points = np.moveaxis(grid.xyz, 0, -1).reshape(-1, 3)
    vectors = source.cartesian(P, points).reshape(*grid.shape, 3)
    return initial.from_vectors(grid, np.moveaxis(vectors, -1, 0))


def _frame_of(path: str, frame: int) -> tuple[Any, ClosedGrid]:
    """Return one frame of P in a NetCDF file, and its grid."""
    import h5py

    with h5py.File(path, "r") as file:
        if "surface" not in file.attrs:
            raise InputError(
                f"the cell in {path}", "a cylinder", "a closed surface", "use it with the polar model"
            )
        frames = file["P"]
        if not -len(frames) <= frame < len(frames):
            raise InputError("frame", frame, f"one of the {len(frames)} frames stored", "choose another")
        given = file.attrs["configuration"]
        text = given.decode() if isinstance(given, bytes) else str(given)
        return np.asarray(frames[frame], np.float64), grid_of(**json.loads(text)["grid"])
