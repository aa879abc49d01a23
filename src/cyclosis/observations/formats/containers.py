"""Files with several variables: MATLAB, HDF5 and NetCDF."""

from __future__ import annotations

import io
import json
from pathlib import Path
from typing import Any

import numpy as np

from ..view import View
from . import pivlab
from .content import SURFACE, VELOCITY, Array, Asked, Content, good_of, unreadable
from .images import section

_WHOLE = "save it again, it is damaged"


def matlab(path: Path, raw: bytes, asked: Asked) -> Content:
    """Return what a .mat file up to version 7 holds."""
    from scipy.io import loadmat

    try:
        found = loadmat(io.BytesIO(raw))
        variables = {name: _cells(value) for name, value in found.items() if not name.startswith("__")}
    except Exception as error:
        raise unreadable(path, f"a .mat file that is whole ({type(error).__name__})", _WHOLE) from error
    return _variables(path, variables, asked)


def _cells(value: Any) -> Any:
    """Return a cell array as a list, a text as a text, and a matrix as a list of one."""
    array = np.asarray(value)
    if array.dtype == object:
        return [np.asarray(each) for each in array.ravel(order="F")]
    return str(array.ravel()[0]) if array.dtype.kind == "U" and array.size else [array]


def hdf5(path: Path, raw: bytes, asked: Asked) -> Content:
    """Return what an HDF5 file holds: a .mat file of version 7.3, or NetCDF."""
    import h5py

    try:
        with h5py.File(io.BytesIO(raw), "r") as file:
            names, about = set(file), {name: file.attrs[name] for name in file.attrs}
            variables = _referred(file) if pivlab.in_mat(dict.fromkeys(names)) else None
    except Exception as error:
        raise unreadable(path, f"an HDF5 file that is whole ({type(error).__name__})", _WHOLE) from error
    if variables is not None:
        return _variables(path, variables, asked)
    if str(_text(about.get("program", ""))).startswith("cyclosis"):
        if "measurement" in about:
            return _surface(path, raw)
        rule = "a measurement, but it is a file of the model"
        raise unreadable(path, rule, "compare a measurement with it: `cyclosis compare MEASURED RUN`")
    return _netcdf(path, raw, "h5netcdf")


def _referred(file: Any) -> dict[str, Any]:
    """Return the variables of a .mat file of version 7.3: cells as lists, matrices as MATLAB has them."""
    import h5py

    out: dict[str, Any] = {}
    for name, item in file.items():
        if not isinstance(item, h5py.Dataset):
            continue
        if item.dtype == h5py.ref_dtype:
            out[name] = [_matrix(file[reference]) for reference in item[()].ravel()]
        elif item.attrs.get("MATLAB_class") in (b"char", "char"):
            out[name] = "".join(chr(code) for code in item[()].ravel(order="F"))
        else:
            out[name] = [_matrix(item)]
    return out


def _matrix(item: Any) -> Any:
    if item.attrs.get("MATLAB_empty", 0):
        return np.zeros(0)
    return np.asarray(item[()]).T


def _variables(path: Path, variables: dict[str, Any], asked: Asked) -> Content:
    if asked.format == "slice":
        return _section(path, variables)
    if pivlab.in_mat(variables):
        return pivlab.read_mat(path, variables)
    names = ", ".join(sorted(variables))[:80] or "nothing"
    rule = f"one with PIVlab's x, y, u_original and v_original; it has {names}"
    raise unreadable(path, rule, "save PIVlab's results, or write the vectors as a text with four columns")


def _section(path: Path, variables: dict[str, Any]) -> Content:
    """Return the one matrix of a file that can be a cross-section."""
    matrices = {
        name: np.squeeze(value[0])
        for name, value in variables.items()
        if isinstance(value, list) and len(value) == 1 and value[0].size > 1 and value[0].dtype.kind in "fiu"
    }
    if len(matrices) != 1 or next(iter(matrices.values())).ndim != 2:
        shapes = ", ".join(f"{name} {matrix.shape}" for name, matrix in matrices.items()) or "none"
        rule = f"one with a single matrix (rows, columns) of velocities; it has {shapes[:80]}"
        raise unreadable(path, rule, "save one section to a file")
    return section(next(iter(matrices.values())).astype(np.float64))


def netcdf3(path: Path, raw: bytes, asked: Asked) -> Content:
    """Return what a classic NetCDF file holds."""
    return _netcdf(path, raw, "scipy")


def _open(path: Path, raw: bytes, engine: Any) -> Any:
    import xarray

    try:
        with xarray.open_dataset(io.BytesIO(raw), engine=engine, decode_times=False) as data:
            return data.load()
    except Exception as error:
        raise unreadable(path, f"a NetCDF file that is whole ({type(error).__name__})", _WHOLE) from error


def _netcdf(path: Path, raw: bytes, engine: str) -> Content:
    """Return the vectors of a file of pivpy."""
    data = _open(path, raw, engine)
    if (
        not {"u", "v"} <= set(data)
        or not {"x", "y"} <= set(data.coords)
        or set(data["u"].dims) - {"t"} != {"y", "x"}
    ):
        rule = f"one with u and v over y and x; it has {', '.join(map(str, data.variables))[:80]}"
        raise unreadable(path, rule, "write the vectors as a text with four columns")
    try:
        frames = _fields(data)
    except (TypeError, ValueError) as error:
        raise unreadable(path, "one whose x, y, u and v are numbers", _WHOLE) from error
    notes = [
        "pivpy's units (pix) are its defaults, and not taken as said",
        "pivpy's chc means something else for every source and is not used",
        "exact zeros are not taken as measured",
    ]
    return Content("pivpy", VELOCITY, frames, complete=True, notes=notes)


def _fields(data: Any) -> list[dict[str, Array]]:
    xx, yy = np.meshgrid(np.asarray(data["x"], float), np.asarray(data["y"], float))
    x, y = xx.ravel(), yy.ravel()
    frames = []
    for k in range(data.sizes.get("t", 1)):
        now = data.isel(t=k) if "t" in data.sizes else data
        u, v = (np.asarray(now[name].transpose("y", "x").values, float).ravel() for name in ("u", "v"))
        good = good_of(x, y, u, v) & ((u != 0) | (v != 0))
        frames.append({"x": x, "y": y, "u": u, "v": v, "good": good.astype(float)})
    return frames


def _surface(path: Path, raw: bytes) -> Content:
    """Return a measurement that is on the surface already."""
    data = _open(path, raw, "h5netcdf")
    rule = "a file of `cyclosis measure` with fields over (time, component, theta, z) and its view"
    if "u" not in data and "angle" not in data:
        raise unreadable(path, rule, "measure it again")
    try:
        view = View.from_dict(json.loads(data.attrs["view"]))
    except (KeyError, TypeError, ValueError) as error:
        raise unreadable(path, rule, "measure it again") from error
    said = {name: float(data.attrs[name]) for name in ("pixel_um", "frame_s") if name in data.attrs}
    extra = {"dataset": data, "view": view, "time_unit": str(data.attrs.get("time_unit", "s"))}
    return Content(
        "surface",
        SURFACE,
        [],
        "px",
        None,
        "down",
        said.get("pixel_um"),
        said.get("frame_s"),
        notes=[str(data.attrs.get("conventions_applied", ""))],
        extra=extra,
    )


def _text(value: Any) -> Any:
    return value.decode(errors="replace") if isinstance(value, bytes) else value
