"""The flow in the vacuole at one time."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from ..display.shown import shown
from ..model.doors import door
from ..model.errors import InputError, choice, whole
from ..model.grid import Array, CylinderGrid
from ..model.interior import wall
from .points import checked_points, checked_radii, summed
from .tables import Complex, field_of, spectrum_of, table, waves

if TYPE_CHECKING:
    import os
    from pathlib import Path

    import xarray

CLOSURES = ("zero_flux", "no_pressure_drop")
"""What is asked of a wall that moves along z on average: no net flux, or no pressure drop along the cell."""
SOLENOIDAL = 1e-8
"""Share of the wall's velocity gradient below which its divergence is that of rounding."""


@shown
@dataclass(frozen=True, eq=False, repr=False)
class VacuoleFlow:
    """Stokes flow inside the cell, r < 1, driven by the velocity of its wall r = 1.

        ∇p = ∇²v,   ∇·v = 0,   v(1, θ, z) = (0, u_θ, u_z)

    Dimensionless: lengths in R, speeds in U, pressure and traction in ηU/R, with η the viscosity of the
    vacuole. `modes` (2, 2 m_max + 1, n_q) are the waves of the wall's velocity, without Nyquist modes, in the
    order m = 0, 1, ..., -2, -1 and q >= 0. Where <u_z> is not 0, `closure` matters: with "zero_flux" the cell
    is closed, and a pressure gradient drives the fluid back; with "no_pressure_drop" the fluid moves along.
    Make one with `cyclosis.vacuole.flow`.

    Example:
        >>> import numpy as np
        >>> import cyclosis as cy
        >>> grid = cy.CylinderGrid(16, 16)
        >>> wall = np.zeros((2, 16, 16))
        >>> wall[1] = np.sin(grid.theta)[:, None]  # u_z = sin θ drives v_z = r sin θ
        >>> flow = cy.vacuole.flow(grid, wall)
        >>> flow.at([[0.5, np.pi / 2, 0.0]]).round(12) + 0.0
        array([[0. , 0. , 0.5]])
        >>> flow.cartesian_at([[0.0, 0.0, 1.0]]).shape, flow.pressure_at([[0.0, 0.0, 1.0]]).shape
        ((1, 3), (1,))
        >>> flow.volume([0.0, 0.5, 1.0]).shape, flow.wall_traction.shape
        ((3, 3, 16, 16), (2, 16, 16))
        >>> round(flow.dissipation, 6)  # half of the wall's area
        15.707963
        >>> bool(np.allclose(flow.surface, wall)), flow.solenoidal, flow.free, flow.flux
        (True, True, False, 0.0)
        >>> abs(flow.mean) < 1e-15, abs(flow.pressure_gradient) < 1e-15, flow.modes.shape, flow.q.shape
        (True, True, (2, 15, 8), (8,))
    """

    grid: CylinderGrid
    modes: Complex = field(repr=False)
    closure: str = "zero_flux"

    @property
    def q(self) -> Array:
        """The wavenumbers q >= 0 (n_q,) of `modes`."""
        return waves(self.grid)[1]

    @property
    def free(self) -> bool:
        """Whether the ends of the cell are open, without a pressure drop between them."""
        return self.closure == CLOSURES[1]

    @property
    def mean(self) -> float:
        """<u_z>, the mean velocity of the wall along z, in U."""
        return float(self.modes[1, 0, 0].real)

    @property
    def pressure_gradient(self) -> float:
        """The mean pressure gradient along the cell, 8 <u_z> of a closed cell, in ηU/R²."""
        return 0.0 if self.free else 8 * self.mean

    @property
    def flux(self) -> float:
        """The net flux through every cross-section, π <u_z> without a pressure drop, in UR²."""
        return np.pi * self.mean if self.free else 0.0

    @cached_property
    def surface(self) -> Array:
        """The velocity of the wall (2, n_theta, n_z), components (θ, z), without its Nyquist modes, in U."""
        return field_of(self.modes, self.grid.shape)

    @cached_property
    def solenoidal(self) -> bool:
        """Whether the wall's velocity has no divergence, as that of every model in this package."""
        m, q = self._wavenumbers
        a, b = self.modes
        gradient = np.hypot(m, q) * np.hypot(np.abs(a), np.abs(b))
        return bool(np.max(np.abs(m * a + q * b)) <= SOLENOIDAL * np.max(gradient))

    @property
    def _wavenumbers(self) -> tuple[Array, Array]:
        highest = self.modes.shape[1] // 2
        return np.roll(np.arange(-highest, highest + 1.0), -highest)[:, None], self.q

    def at(self, points: npt.ArrayLike) -> Array:
        """Return the velocity (n, 3) at points (n, 3) of (r, θ, z); components (r, θ, z), in U.

        On the axis the directions r and θ are those of the given θ. Raises `InputError` for r outside 0 to 1.
        """
        where = checked_points(points)
        found = summed(self.q, self.modes, where)
        if self.free:
            found[:, 2] += self.mean * 2 * (1 - where[:, 0] ** 2)
        return found

    def cartesian_at(self, points: npt.ArrayLike) -> Array:
        """Return the velocity (n, 3) at points (n, 3) of (r, θ, z); components (x, y, z), in U."""
        where = checked_points(points)
        return cartesian(self.at(where).T, where[:, 1]).T

    def pressure_at(self, points: npt.ArrayLike) -> Array:
        """Return the pressure (n,) at points (n, 3) of (r, θ, z), in ηU/R.

        Its mean at z = 0 is 0; with a `pressure_gradient` it is not periodic.
        """
        where = checked_points(points)
        return summed(self.q, self.modes, where, pressure=True)[:, 0] + self.pressure_gradient * where[:, 2]

    def volume(self, radii: npt.ArrayLike, shape: tuple[int, int] | None = None) -> Array:
        """Return the velocity (3, n_r, n_theta, n_z) on radii times the grid; components (r, θ, z), in U.

        Tables and one transform a radius; the tables of the last grids and radii are kept. `shape` is a finer
        (n_theta, n_z), by Fourier interpolation. Raises `InputError` for radii outside 0 to 1, and for a
        `shape` that is coarser than the grid.
        """
        at = checked_radii(radii)
        out = field_of(table(self.grid, at).velocity(self.modes), self._shape(shape))
        if self.free:
            out[2] += (self.mean * 2 * (1 - at**2))[:, None, None]
        return out

    def pressure_volume(self, radii: npt.ArrayLike, shape: tuple[int, int] | None = None) -> Array:
        """Return the pressure (n_r, n_theta, n_z) on radii times the grid, in ηU/R.

        Example:
            >>> import cyclosis as cy
            >>> grid = cy.CylinderGrid(16, 16)
            >>> flow = cy.vacuole.flow_of_state(cy.Parameters(), grid, cy.initial.disordered(grid, seed=0))
            >>> flow.pressure_volume([0.5, 1.0]).shape
            (2, 16, 16)
        """
        at, points = checked_radii(radii), self._shape(shape)
        out = field_of(table(self.grid, at).pressure(self.modes), points)
        return out + self.pressure_gradient * self.grid.length / points[1] * np.arange(points[1])

    def _shape(self, shape: Any) -> tuple[int, int]:
        if shape is None:
            return self.grid.shape
        if not isinstance(shape, list | tuple) or len(shape) != 2:
            raise InputError("shape", shape, "two whole numbers (n_theta, n_z)", "give that of a grid")
        remedy = "a finer grid has all waves of the flow"
        low, high = self.grid.shape
        return whole("shape", shape[0], low, 2**16, remedy), whole("shape", shape[1], high, 2**16, remedy)

    @cached_property
    def wall_traction(self) -> Array:
        """The tangential stress (2, n_theta, n_z) of the wall on the fluid, components (θ, z), in ηU/R."""
        return field_of(self._traction, self.grid.shape)

    @property
    def _traction(self) -> Complex:
        found = wall(*waves(self.grid))
        highest = self.modes.shape[1] // 2
        rows = np.abs(np.roll(np.arange(-highest, highest + 1), -highest))
        sign = np.where(np.arange(self.modes.shape[1]) > highest, -1.0, 1.0)[:, None]
        theta_a, cross, z_b = found.theta_a[rows], sign * found.cross[rows], found.z_b[rows].copy()
        if self.free:
            z_b[0, 0] = 0.0
        a, b = self.modes
        return np.stack([theta_a * a + cross * b, cross * a + z_b * b])

    @cached_property
    def dissipation(self) -> float:
        """The power dissipated in one period of the cell, ∫ 2 e:e dV, in ηU²R.

        It is the work of the wall, ∫ τ·u dA.
        """
        weight = np.where(self.q > 0, 2.0, 1.0)
        work = float(np.sum(weight * (self._traction * self.modes.conj()).real))
        return 2 * np.pi * self.grid.length * work

    def section(
        self,
        z: float,
        *,
        points: int | None = None,
        radii: npt.ArrayLike | None = None,
        n_theta: int | None = None,
    ) -> xarray.Dataset:
        """Return velocity and pressure on the cross-section at z, as an `xarray.Dataset`, dimensionless.

        On `points` x `points` pixels (65 if nothing is given) with coordinates x and y from -1 to 1, NaN
        outside the cell; or on polar coordinates, `radii` times `n_theta` angles. The variables are v_r,
        v_theta, v_z, v_x, v_y and pressure. Raises `InputError` for radii outside 0 to 1, and for both at
        once.

        Example:
            >>> import cyclosis as cy
            >>> grid = cy.CylinderGrid(16, 16)
            >>> flow = cy.vacuole.flow_of_state(cy.Parameters(), grid, cy.initial.stripes(grid))
            >>> dict(flow.section(2.5, points=33).sizes), dict(flow.section(0.0, radii=[0.5, 1.0]).sizes)
            ({'x': 33, 'y': 33}, {'r': 2, 'theta': 16})
        """
        from .sections import section

        return section(self, z, points, radii, n_theta)

    def to_dataset(self, radii: npt.ArrayLike | None = None) -> xarray.Dataset:
        """Return velocity v (vector, r, theta, z) and pressure in the volume as an `xarray.Dataset`.

        `radii` (n_r,) are by default 17 from 0 to 1, closer together at the wall. Dimensionless.

        Example:
            >>> import cyclosis as cy
            >>> from cyclosis.dataset import write_table
            >>> grid = cy.CylinderGrid(16, 16)
            >>> flow = cy.vacuole.flow_of_state(cy.Parameters(), grid, cy.initial.stripes(grid))
            >>> data = flow.to_dataset([0.0, 0.5, 1.0])
            >>> dict(data["v"].sizes), write_table(data, "volume.nc").name
            ({'vector': 3, 'r': 3, 'theta': 16, 'z': 16}, 'volume.nc')
        """
        from .volume import to_dataset

        return to_dataset(self, radii)

    def to_vtk(self, path: str | os.PathLike[str], radii: npt.ArrayLike | None = None) -> Path:
        """Write the flow in the volume as a VTK structured grid (.vts) for ParaView; return its path.

        Point data: the vector `v` in Cartesian components, `v_r`, `v_theta`, `v_z` and `pressure`. The seams
        are closed by repeating the first points. The file replaces an existing one. `radii` as in
        `to_dataset`. Raises `InputError` for another suffix, and for places that cannot be written to.

        Example:
            >>> import cyclosis as cy
            >>> grid = cy.CylinderGrid(16, 16)
            >>> flow = cy.vacuole.flow_of_state(cy.Parameters(), grid, cy.initial.stripes(grid))
            >>> flow.to_vtk("vacuole.vts").name
            'vacuole.vts'
        """
        from .volume import to_vtk

        return to_vtk(self, path, radii)

    def require_solenoidal(self, what: str) -> None:
        """Raise `InputError` unless the wall's velocity has no divergence.

        Example:
            >>> import numpy as np
            >>> import cyclosis as cy
            >>> grid = cy.CylinderGrid(16, 16)
            >>> u = np.stack([np.cos(grid.theta)[:, None] * np.ones(16), np.zeros((16, 16))])
            >>> cy.vacuole.flow(grid, u).require_solenoidal("the stream function")
            Traceback (most recent call last):
                ...
            cyclosis.model.errors.InputError: u = an array of shape (2, 16, 16) cannot be used: ...
        """
        if not self.solenoidal:
            rule = f"without divergence on the surface for {what}"
            raise InputError("u", self.surface, rule, "give the flow of a model, or remove its divergence")

    def __repr__(self) -> str:
        n_theta, n_z = self.grid.shape
        return f"VacuoleFlow({n_theta} x {n_z}, length {self.grid.length:g}, {self.closure})"


def cartesian(velocity: Array, theta: Array) -> Array:
    """Return components (x, y, z) of vectors (3, ...) with components (r, θ, z) at angles that broadcast."""
    r, around, z = velocity
    c, s = np.cos(theta), np.sin(theta)
    return np.stack([c * r - s * around, s * r + c * around, z])


@door
def of_surface(grid: CylinderGrid, u: Any, closure: str = "zero_flux") -> VacuoleFlow:
    """Return the `VacuoleFlow` of a wall's velocity u (2, n_theta, n_z) on a grid."""
    choice("closure", closure, CLOSURES)
    return VacuoleFlow(grid, spectrum_of(grid.check_state(u, "u")), closure)
