"""The radial functions of a grid's waves at fixed radii, so that one inverse transform a radius gives a flow.

A table depends on the grid and the radii alone. It is exact at its radii.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np
import numpy.typing as npt

from ..model.grid import Array, CylinderGrid
from .modes import Radial, radial

Complex = npt.NDArray[np.complex128]

TINY = 1e-200
"""Values of the radial functions that are taken as 0."""
KEPT = 4
"""Tables that are kept."""


def waves(grid: CylinderGrid) -> tuple[int, Array]:
    """Return the highest m of a grid, and its q >= 0 (n_q,), both without the Nyquist modes."""
    return (grid.n_theta - 1) // 2, grid.q[: (grid.n_z + 1) // 2].copy()


def spectrum_of(field: Array) -> Complex:
    """Return the waves (..., 2 m_max + 1, n_q) of real fields (..., n_theta, n_z).

    They are in the order m = 0, 1, ..., -2, -1 and q >= 0. Nyquist modes are dropped,
    because the sign of their wavenumber is lost.
    """
    n_theta, n_z = field.shape[-2:]
    highest, count = (n_theta - 1) // 2, (n_z + 1) // 2
    spectrum = np.fft.rfft2(field, norm="forward")[..., :count]
    rows = np.arange(-highest, highest + 1)
    return np.ascontiguousarray(spectrum[..., np.roll(rows, -highest), :])


def field_of(spectrum: Complex, shape: tuple[int, int]) -> Array:
    """Return real fields (..., *shape) of waves as `spectrum_of` gives them; the grid must resolve them."""
    highest, count = spectrum.shape[-2] // 2, spectrum.shape[-1]
    full = np.zeros((*spectrum.shape[:-2], shape[0], shape[1] // 2 + 1), np.complex128)
    full[..., : highest + 1, :count] = spectrum[..., : highest + 1, :]
    if highest:
        full[..., -highest:, :count] = spectrum[..., -highest:, :]
    return np.fft.irfft2(full, s=shape, norm="forward")


class Table:
    """The radial functions of all waves of a grid at radii (n_r,)."""

    def __init__(self, grid: CylinderGrid, radii: Array) -> None:
        # Transforms of denormal numbers take ten times as long.
        self.radial = Radial(*(np.where(np.abs(f) > TINY, f, 0.0) for f in radial(*waves(grid), radii)))

    def velocity(self, modes: Complex) -> Complex:
        """Return the waves (3, n_r, ...) of the velocity (r, θ, z) that those of the wall (2, ...) drive."""
        a, b = modes
        f = self.radial
        out = np.empty((3, *f.r_a.shape[:1], *a.shape), np.complex128)
        for rows, waves_of_m, sign in _halves(a.shape[0]):
            s, t = a[rows], b[rows]
            out[0][:, rows] = 1j * (sign * f.r_a[:, waves_of_m] * s + f.r_b[:, waves_of_m] * t)
            out[1][:, rows] = f.theta_a[:, waves_of_m] * s + sign * f.theta_b[:, waves_of_m] * t
            out[2][:, rows] = sign * f.z_a[:, waves_of_m] * s + f.z_b[:, waves_of_m] * t
        return out

    def pressure(self, modes: Complex) -> Complex:
        """Return the waves (n_r, ...) of the periodic part of the pressure."""
        a, b = modes
        f = self.radial
        out = np.empty((*f.r_a.shape[:1], *a.shape), np.complex128)
        for rows, waves_of_m, sign in _halves(a.shape[0]):
            out[:, rows] = 1j * (sign * f.p_a[:, waves_of_m] * a[rows] + f.p_b[:, waves_of_m] * b[rows])
        return out


def _halves(count: int) -> list[tuple[slice, slice, float]]:
    """Return rows of m in a spectrum, the rows of |m| in the radial functions, and the sign of m."""
    highest = count // 2
    return [
        (slice(0, highest + 1), slice(0, highest + 1), 1.0),
        (slice(highest + 1, count), slice(highest, 0, -1), -1.0),
    ]


def table(grid: CylinderGrid, radii: Array) -> Table:
    """Return the `Table` of a grid at radii (n_r,); the last few are kept."""
    return _table(grid, tuple(radii.tolist()))


@lru_cache(maxsize=KEPT)
def _table(grid: CylinderGrid, radii: tuple[float, ...]) -> Table:
    return Table(grid, np.array(radii))


__all__ = ["Radial", "Table", "field_of", "spectrum_of", "table", "waves"]
