"""The flow on one cross-section of the cell."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from ..model.errors import InputError, number, whole
from ..model.grid import Array
from .points import checked_radii
from .tables import Complex, Table

if TYPE_CHECKING:
    import xarray

    from .flow import VacuoleFlow

BLOCK = 64
"""Radii that are summed at once."""


def section(
    flow: VacuoleFlow, z: float, points: int | None, radii: npt.ArrayLike | None, n_theta: int | None
) -> xarray.Dataset:
    """Return the flow on a section; see `VacuoleFlow.section`."""
    height = number("z", z, -1e9, 1e9, "give a position along the axis, in R")
    if points is not None and (radii is not None or n_theta is not None):
        raise InputError("points", points, "given without radii and n_theta", "choose pixels or a polar grid")
    if radii is None and n_theta is None:
        remedy = "give the number of pixels across"
        return _pixels(flow, height, whole("points", 65 if points is None else points, 2, 4097, remedy))
    at = checked_radii(np.linspace(0.0, 1.0, 33) if radii is None else radii)
    around = whole(
        "n_theta", flow.grid.n_theta if n_theta is None else n_theta, 1, 2**16, "give a number of angles"
    )
    theta = 2 * np.pi / around * np.arange(around)
    r, angle = np.meshgrid(at, theta, indexing="ij")
    found = _evaluated(flow, height, at, np.arange(at.size).repeat(around), angle.ravel())
    return _dataset(flow, height, found.reshape(4, *r.shape), {"r": at, "theta": theta}, angle)


def _pixels(flow: VacuoleFlow, z: float, count: int) -> xarray.Dataset:
    across = np.linspace(-1.0, 1.0, count)
    x, y = np.meshgrid(across, across, indexing="ij")
    r, theta = np.hypot(x, y), np.arctan2(y, x)
    inside = r <= 1 + 1e-12
    radii, place = np.unique(np.minimum(r[inside], 1.0).round(14), return_inverse=True)
    out = np.full((4, count, count), np.nan)
    out[:, inside] = _evaluated(flow, z, radii, place, theta[inside])
    return _dataset(flow, z, out, {"x": across, "y": across}, theta)


def _evaluated(flow: VacuoleFlow, z: float, radii: Array, place: npt.NDArray[np.intp], theta: Array) -> Array:
    """Return velocity (r, θ, z) and pressure (4, n) at points, given their places in `radii` and angles."""
    highest = flow.modes.shape[1] // 2
    waves = np.concatenate([_around(flow, z, radii[i : i + BLOCK]) for i in range(0, radii.size, BLOCK)], 1)
    out = np.empty((4, theta.size))
    m = np.arange(1, highest + 1)
    for start in range(0, theta.size, 4096):
        here = slice(start, start + 4096)
        turn = np.exp(1j * np.outer(theta[here], m))
        c = waves[:, place[here]]
        out[:, here] = c[..., 0].real + 2 * np.einsum("cpm,pm->cp", c[..., 1:], turn).real
    out[3] += flow.pressure_gradient * z
    if flow.free:
        out[2] += flow.mean * 2 * (1 - radii[place] ** 2)
    return out


def _around(flow: VacuoleFlow, z: float, radii: Array) -> Complex:
    """Return the waves (4, n_r, m_max + 1) around a section, of velocity (r, θ, z) and pressure."""
    found = Table(flow.grid, radii)
    along = np.exp(1j * flow.q * z)
    spectrum = np.concatenate([found.velocity(flow.modes), found.pressure(flow.modes)[None]])
    # q > 0 stands for q < 0 too: the wave (-m, -q) is the conjugate of (m, q).
    ahead = spectrum @ along
    back = (spectrum[..., 1:] @ along[1:]).conj()
    highest = flow.modes.shape[1] // 2
    opposite = np.concatenate([back[..., :1], back[..., :highest:-1]], axis=-1)
    return ahead[..., : highest + 1] + opposite


def _dataset(flow: VacuoleFlow, z: float, found: Array, axes: dict[str, Any], theta: Array) -> xarray.Dataset:
    import xarray

    from .flow import cartesian

    dims = tuple(axes)
    v_x, v_y, _ = cartesian(found[:3], theta)
    meant = {
        "v_r": (found[0], "radial velocity"),
        "v_theta": (found[1], "velocity around the axis"),
        "v_z": (found[2], "velocity along the axis"),
        "v_x": (v_x, "velocity along x, the direction of theta = 0"),
        "v_y": (v_y, "velocity along y"),
        "pressure": (found[3], "pressure in units of eta U/R"),
    }
    data = {n: (dims, values, {"long_name": text, "units": "1"}) for n, (values, text) in meant.items()}
    about = {"closure": flow.closure, "length": flow.grid.length, "title": "Flow in the vacuole"}
    return xarray.Dataset(data, {**axes, "z": z}, about)
