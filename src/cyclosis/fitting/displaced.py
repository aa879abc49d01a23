"""What an uncertain geometry of the camera adds to the covariance of parameters that were matched to a film.

In another geometry the same pixels show other points of the surface. The run is compared with the film there,
which changes the misfit by d, and the optimum moves by -H⁻¹ Jᵀ d. This is linear in the axis, the radius and
the centre line, so that one standard deviation of each tells all.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from ..model.grid import Array, CylinderGrid
from .compared import FAINT, Arrays
from .film import Film
from .geometry import Tilt, carried, turned

Waves = npt.NDArray[np.complex128]


def displaced(
    grid: CylinderGrid, arrays: Arrays, film: Film, waves: tuple[Waves, Waves], gain: Array, tilts: list[Tilt]
) -> Array:
    """Return the covariance of the logarithms that some geometries, each one deviation off, add.

    `waves` are those of P and u of the run at the film's times, and `gain` (logs, values) takes what is added
    to the misfit to what it moves.
    """
    before = _seen(grid, film, waves, Tilt())
    away = np.zeros((gain.shape[0], 0))
    for tilt in tilts:
        after = _seen(grid, film, waves, tilt)
        change = {name: after[name] - before[name] for name in ("u", "P")}
        if "angle" in arrays.data:
            along = [np.arctan2(P[:, 0], P[:, 1]) for P in (before["P"], after["P"])]
            square = (before["P"] ** 2).sum(axis=1)
            change["angle"] = 0.5 * np.sin(2 * (along[1] - along[0])) * square / (square + FAINT**2)
        parts = [change[name].ravel()[arrays.at[name]] / arrays.sigma[name] for name in arrays.data]
        away = np.column_stack([away, gain @ np.concatenate(parts)])
    return away @ away.T


def _seen(grid: CylinderGrid, film: Film, waves: tuple[Waves, Waves], tilt: Tilt) -> dict[str, Array]:
    """Return P and u (n, 2, n_theta, n_z) of a run as a film whose geometry is off shows them."""
    theta, z, frame = tilt.moved(film.theta, film.z, film.facing)
    inverse: Any = np.linalg.inv(np.moveaxis(frame, (0, 1), (-2, -1)))
    back = np.moveaxis(inverse, (-2, -1), (0, 1))
    q = 2 * np.pi / grid.length * np.arange(waves[0].shape[-1])
    around, along = np.exp(1j * theta[..., None] * grid.m), np.exp(1j * z[..., None] * q)
    P, u = (
        np.asarray(np.einsum("abm,tcmn,abn->tcab", around, wave, along, optimize=True).real, np.float64)
        for wave in waves
    )
    return {"P": turned(P, back), "u": carried(u, back)}
