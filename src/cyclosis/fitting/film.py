"""A measurement made plain: its fields on one part of the surface, and what was seen of them."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from ..model.errors import InputError
from ..model.grid import Array
from ..model.scales import Scales

if TYPE_CHECKING:
    import xarray

HOLES = 0.3
"""Share of the frames in which a point may be unseen and is still filled from its neighbours in time."""
FIELDS = ("P", "u", "angle")


@dataclass(frozen=True, eq=False)
class Film:
    """The order P and the flow u, each (n, 2, n_theta, n_z) or None, at `times` (n,), in R, R/U and U.

    `theta` and `z` are the window's coordinates, increasing. `seen` (n_theta, n_z) says where there are
    values in most frames, with holes filled by those before and after; other holes are filled with 0.
    `known` (n, n_theta, n_z) says which were measured. `facing` is the angle that faces the camera, and
    `scales` are those by which the file's units were divided. `angle` (n, n_theta, n_z) is that of the
    filaments from +z towards +θ, without polarity, or None.
    """

    times: Array
    theta: Array
    z: Array
    P: Array | None
    u: Array | None
    seen: npt.NDArray[np.bool_]
    facing: float
    scales: Scales | None
    attributes: dict[str, Any]
    known: npt.NDArray[np.bool_]
    angle: Array | None = None

    @property
    def frames(self) -> int:
        """The number of frames."""
        return self.times.size

    def cropped(self) -> Film:
        """Return the part of the film in the rows and columns in which something was seen."""
        rows, columns = np.flatnonzero(self.seen.any(axis=1)), np.flatnonzero(self.seen.any(axis=0))
        if not rows.size:
            return self
        part = slice(rows[0], rows[-1] + 1), slice(columns[0], columns[-1] + 1)
        P, u, angle = (None if f is None else f[..., *part] for f in (self.P, self.u, self.angle))
        seen, known = self.seen[part], self.known[:, *part]
        return replace(
            self, theta=self.theta[part[0]], z=self.z[part[1]], P=P, u=u, angle=angle, seen=seen, known=known
        )

    def spread(self) -> Film:
        """Return the film with the nearest value that was seen at points where there is none.

        Slopes beside a hole would be wrong by the size of the field over the spacing if holes were 0.
        """
        from scipy.ndimage import distance_transform_edt

        if self.seen.all() or not self.seen.any():
            return self
        i, j = distance_transform_edt(~self.seen, return_distances=False, return_indices=True)
        return self.with_fields(*(None if f is None else f[:, :, i, j] for f in (self.P, self.u)))

    def with_fields(self, P: Array | None, u: Array | None) -> Film:
        """Return the same film with other fields."""
        return replace(self, P=P, u=u)


def film_of(data: Any, scales: Scales | None) -> Film:
    """Return the `Film` of a dataset, or raise `InputError` for one that is not a measurement."""
    import xarray

    if not isinstance(data, xarray.Dataset):
        rule = "an xarray.Dataset with P and u, or u alone, over time, component, theta and z"
        raise InputError("data", data, rule, "open it by cyclosis.open_dataset or xarray.open_dataset")
    fields = {name: _field(data, name) for name in FIELDS if name in data}
    if not fields:
        rule = "a dataset with P and u, or u alone"
        raise InputError("data", ", ".join(map(str, data.data_vars)), rule, "name its variables P and u")
    one = next(iter(fields.values()))
    if scales is None and "radius_um" in data.attrs and "speed_um_per_s" in data.attrs:
        scales = Scales(float(data.attrs["radius_um"]), float(data.attrs["speed_um_per_s"]))
    times = _coordinate(one, "time", scales) if "time" in one.dims else np.zeros(1)
    theta, z = _coordinate(one, "theta", scales), _coordinate(one, "z", scales)
    arrays = {name: np.asarray(_plain(f).values, np.float64) for name, f in fields.items()}
    unit = _unit(fields["u"]) if "u" in fields else None
    if unit is not None:
        arrays["u"] = _divided("u", arrays["u"], unit, scales)
    if "angle" in arrays and (unit := _unit(fields["angle"])) is not None:
        arrays["angle"] = _divided("theta", arrays["angle"], unit, scales)
    theta = np.unwrap(theta) if theta.size > 1 else theta
    facing = _facing(data, theta)
    order_t, order_z = np.argsort(theta, kind="stable"), np.argsort(z, kind="stable")
    if not np.all(np.diff(times) > 0):
        raise InputError("time", times, "increasing", "sort the frames, and leave out repeats")
    for name, points in (("theta", theta[order_t]), ("z", z[order_z])):
        if not np.all(np.diff(points) > 0):
            raise InputError(name, points, "without repeated points", "leave out the repeats")
    known = np.ones((times.size, theta.size, z.size), bool)
    for name, array in arrays.items():
        arrays[name] = array = np.take(np.take(array, order_t, -2), order_z, -1)
        if name != "angle":
            known &= np.isfinite(array).all(axis=1)
    seen = known.mean(axis=0) >= 1 - HOLES
    filled = {name: _filled(arrays[name], times, known, seen) for name in ("P", "u") if name in arrays}
    return Film(
        times,
        theta[order_t],
        z[order_z],
        filled.get("P"),
        filled.get("u"),
        seen,
        facing,
        scales,
        {str(key): value for key, value in data.attrs.items()},
        known,
        arrays.get("angle"),
    )


def _field(data: xarray.Dataset, name: str) -> xarray.DataArray:
    array = data[name]
    dims = ("theta", "z") if name == "angle" else ("component", "theta", "z")
    missing = [dim for dim in dims if dim not in array.dims]
    extra = [str(dim) for dim in array.dims if dim not in ("time", *dims)]
    if missing or extra or array.sizes.get("component", 2) != 2:
        rule = "over time, theta and z" if name == "angle" else "over time, component (theta, z), theta and z"
        raise InputError(f"{name} of the data", tuple(array.dims), rule, "put it on the unrolled surface")
    if array.dtype.kind not in "iuf":
        raise InputError(f"{name} of the data", str(array.dtype), "of real numbers", "convert it")
    if array.size == 0 or not np.isfinite(array.values).any():
        raise InputError(f"{name} of the data", array.shape, "seen somewhere", "give its values")
    return array


def _plain(array: xarray.DataArray) -> xarray.DataArray:
    if "time" not in array.dims:
        array = array.expand_dims("time")
    labels = array.coords.get("component")
    if labels is not None and [str(label) for label in labels.values] == ["z", "theta"]:
        array = array.isel(component=[1, 0])
    dims = ("time", "component", "theta", "z")
    return array.transpose(*(dim for dim in dims if dim in array.dims))


def _unit(array: xarray.DataArray) -> str | None:
    unit = str(array.attrs.get("units", array.attrs.get("unit", "1"))).strip()
    return (
        None
        if unit.lower() in ("", "1", "dimensionless", "u", "r/u", "r", "rad", "radian", "radians")
        else unit
    )


def _coordinate(array: xarray.DataArray, name: str, scales: Scales | None) -> Array:
    if name not in array.coords:
        raise InputError(f"{name} of the data", None, "given as a coordinate", f"assign_coords({name}=...)")
    points = array.coords[name]
    if points.dtype.kind not in "iuf":
        raise InputError(f"{name} of the data", str(points.dtype), "plain numbers", "decode_times=False")
    values = np.asarray(points.values, np.float64)
    if not np.all(np.isfinite(values)):
        raise InputError(f"{name} of the data", values, "finite", "leave out what has no place")
    unit = _unit(points)
    return values if unit is None else _divided(name, values, unit, scales)


_FACTORS = {
    "time": {"s": 1.0, "second": 1.0, "seconds": 1.0, "ms": 1e-3, "min": 60.0, "minutes": 60.0, "h": 3600.0},
    "z": {"um": 1.0, "µm": 1.0, "μm": 1.0, "micrometer": 1.0, "mm": 1e3, "m": 1e6},
    "u": {"um/s": 1.0, "µm/s": 1.0, "μm/s": 1.0, "um s-1": 1.0, "mm/s": 1e3, "m/s": 1e6, "m s-1": 1e6},
    "theta": {"deg": np.pi / 180, "degree": np.pi / 180, "degrees": np.pi / 180},
}
PER_SECOND = ("s-1", "1/s", "R/s")
"""Radii per second, as `cyclosis measure` writes speeds."""
_SCALE = {"time": "time_s", "z": "radius_um", "u": "speed_um_per_s"}


def _divided(name: str, values: Array, unit: str, scales: Scales | None) -> Array:
    """Return values of a unit in units of the model."""
    if name == "u" and unit in PER_SECOND and scales is not None:
        return values * scales.time_s
    factor = 1.0 if name == "u" and unit in PER_SECOND else _FACTORS[name].get(unit)
    if factor is None:
        known = ", ".join(["1", *_FACTORS[name], *(PER_SECOND if name == "u" else ())])
        raise InputError(f"units of {name}", unit, f"one of {known}", "convert it")
    if name == "theta":
        return values * factor
    if scales is None:
        rule = "given with the scales of the cell"
        remedy = "add scales=cyclosis.Scales(radius_um, speed_um_per_s)"
        command = "give --radius-um R and --speed-um-s U, as `cyclosis compare` finds it"
        raise InputError(f"units of {name}", unit, rule, remedy, command)
    return values * (factor / float(getattr(scales, _SCALE[name])))


def _facing(data: xarray.Dataset, theta: Array) -> float:
    for name in ("facing", "theta_facing"):
        if name in data.attrs:
            return float(data.attrs[name])
    return float(0.5 * (theta[0] + theta[-1]))


def _filled(array: Array, times: Array, known: npt.NDArray[np.bool_], seen: npt.NDArray[np.bool_]) -> Array:
    """Return an array with holes of what was seen filled by cubic interpolation in time, and others by 0.

    Odd and even frames are filled from their own kind, so that their noise stays independent.
    """
    out = np.where(known[:, None], array, 0.0)
    for k in range(2 if times.size > 1 else 1):
        _fill(out[k::2], times[k::2], known[k::2], seen)
    return out


def _fill(out: Array, times: Array, known: npt.NDArray[np.bool_], seen: npt.NDArray[np.bool_]) -> None:
    from scipy.interpolate import CubicSpline

    for i, j in zip(*np.nonzero(seen & ~known.all(axis=0)), strict=True):
        good = known[:, i, j]
        if not good.any():
            continue
        at, values = times[good], out[good][:, :, i, j]
        # Beyond the first and the last value that was measured, the nearest one is taken.
        when = np.clip(times[~good], at[0], at[-1])
        if at.size > 3:
            out[~good, :, i, j] = CubicSpline(at, values)(when)
        else:
            out[~good, :, i, j] = values[np.abs(when[:, None] - at).argmin(axis=1)]
