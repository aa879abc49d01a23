"""A whole cell on a closed surface. A vector is made of amplitudes of surface harmonics.

Its motions are rotations about the axes x, y and z, which move a field by its Lie derivative along ω × x,

    L P = ∇_{ω × x} P - (ω·n) n × P,

where the second term turns filaments along with the surface. About its axis z every surface of revolution
may turn, a sphere about all.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from ...closed.shapes import Sphere
from ...closed.system import ClosedSystem
from ...contract.model import Problem
from ...model.grid import Array
from ...model.precision import double
from ...models.closed.quantities import tail
from .linearised import WholeCell
from .plane import refuse_custom


@dataclass(frozen=True)
class ClosedSurface(WholeCell):
    """The filament equation of a closed surface; its motions are rotations about x, y and z."""

    system: ClosedSystem

    @cached_property
    def _kept(self) -> Any:
        return np.flatnonzero(np.asarray(self.system.space.keep).ravel())

    @cached_property
    def _scale(self) -> float:
        return float(np.sqrt(2 * np.pi / self.system.space.area))

    @cached_property
    def _m(self) -> Any:
        """The wavenumbers m (2, M + 1, 1) around the cell."""
        return np.arange(self.system.space.keep.shape[1])[:, None] * np.array([1, -1])[:, None, None]

    @property
    def size(self) -> int:
        """The length of a vector."""
        return 2 * int(self._kept.size)

    def packed(self, vector: Array) -> Any:
        """Return the modes (2, M + 1, J) of a vector."""
        modes = np.zeros(self.system.space.keep.size, np.complex128)
        modes[self._kept] = np.ascontiguousarray(vector).view(np.complex128) / self._scale
        return modes.reshape(self.system.space.keep.shape)

    def flat(self, packed: Any) -> Array:
        """Return the vector of modes."""
        modes = np.asarray(packed, np.complex128).ravel()[self._kept]
        return np.ascontiguousarray(self._scale * modes).view(np.float64)

    def slopes(self, vector: Array) -> Array:
        """Return the Lie derivatives along rotations about x, y and z, (3, size)."""
        modes = self.packed(vector)
        tilted = np.zeros((2, self.size))
        if self.free[0]:
            with double():
                tilted = np.stack(
                    [self.flat(_turned(self.system.space, axis, modes)) for axis in np.eye(3)[:2]]
                )
        return np.concatenate([tilted, self.flat(1j * self._m * modes)[None]])

    def alike(self, one: Array, other: Array) -> float:
        """Return the scalar product of two vectors, maximised over free motions.

        On a sphere, whose rotations mix all harmonics of one eigenvalue, it is an upper bound: the product of
        their amplitudes, summed over eigenvalues.
        """
        a, b = self._scale * self.packed(one), self._scale * self.packed(other)
        if self.free[0]:
            level = np.rint(np.asarray(self.system.space.k2)).astype(np.int64).ravel()
            sizes = [np.sqrt(np.bincount(level, np.abs(f.ravel()) ** 2)) for f in (a, b)]
            return float(np.sum(sizes[0] * sizes[1]))
        product = np.sum(a * np.conj(b), axis=2)
        if not self.free[2]:
            return float(product.sum().real)
        order = np.concatenate([product[0], product[1, :0:-1]])
        padded = np.zeros(8 * len(order), np.complex128)
        padded[: len(product[0])], padded[-(len(product[0]) - 1) :] = product[0], product[1, :0:-1]
        return float((np.fft.ifft(padded) * padded.size).real.max())

    def tail(self, vector: Array) -> float:
        """Return the amplitude beyond two thirds of k_max over that of all."""
        with double():
            return float(tail(self.system, np.abs(self._scale * self.packed(vector)) ** 2))

    def variation(self, vector: Array) -> dict[str, float]:
        """Return the relative variation of a state around the cell."""
        modes = self.packed(vector)
        return {"theta": float(np.linalg.norm(modes[:, 1:]) / max(float(np.linalg.norm(modes)), 1e-300))}

    def moving(self, drift: Array) -> Any:
        """Return i m times the angular velocity about z."""
        return 1j * drift[2] * self._m

    def carried(self, drift: Array) -> Any:
        """Return the Lie derivative along a rotation about an axis in the plane of x and y, or None."""
        if not self.free[0] or not np.any(drift[:2]):
            return None
        partial: Any = jax.tree_util.Partial
        return partial(_turned, self.system.space, np.array([drift[0], drift[1], 0.0]))


@jax.jit
def _turned(space: Any, axis: Any, modes: Any) -> Any:
    """Return the Lie derivative of a field on a unit sphere, given and returned as modes, along axis × x."""
    latitudes = space.to_latitudes(modes)
    around, along = space.derivatives(latitudes)
    velocity = jnp.cross(axis[:, None, None], space.xyz, axis=0)
    towards = [jnp.sum(velocity * e, axis=0) for e in (space.e_theta, space.e_s)]
    outwards = jnp.sum(axis[:, None, None] * space.xyz, axis=0)
    moved = towards[0] * around + towards[1] * along - 1j * outwards * space.to_points(latitudes)
    return space.to_spectrum(moved)


def closed_surface(problem: Problem) -> ClosedSurface:
    """Return the `ClosedSurface` of a problem of the closed model, in double precision.

    Raises `InputError` for custom terms, which need not be autonomous.
    """
    refuse_custom(problem.terms)
    fields = [value for _, value in problem.params.items() if isinstance(value, np.ndarray)]
    axial = all(np.ptp(field, axis=0).max() == 0 for field in fields)
    sphere = isinstance(problem.grid.surface, Sphere) and not fields
    system: Any = problem.model.system(problem, True)
    return ClosedSurface(system, (sphere, sphere, axial))
