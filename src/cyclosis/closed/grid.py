"""Points on a closed surface, and the vectors there."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
import numpy.typing as npt

from ..display.shown import shown
from ..model.arrays import vectors
from ..model.errors import InputError, number, whole
from ..model.spectral import pack
from .harmonics import Weighted
from .shapes import KINDS, Capsule, Meridian, Shape
from .tables import Tables, tables

Array = npt.NDArray[np.float64]

LEAST_K, MOST_K = 2.0, 96.0
"""The range of k_max, in waves per radian of a unit sphere."""
MOST_POINTS = 4096
PADDING = 2.0
"""Points in each direction over the least that hold the harmonics: products are formed on the points."""


@shown
@dataclass(frozen=True)
class ClosedGrid:
    """Points on a closed surface of revolution, with the harmonics that it resolves.

    `surface` is a `Capsule`, a `Spheroid` or a `Sphere`. The harmonics are those whose eigenvalue of the
    (Bochner) Laplacian is at most k_max²: the same resolution everywhere, also at the poles. theta_i = 2π i /
    n_theta; the n_s latitudes are Gauss-Legendre points in cos τ, from south to north, none on a pole. Fields
    have shape (n_theta, n_s), vectors (2, n_theta, n_s) with components (theta, s): around the cell, and
    along the meridian towards the north. Dimensionless: lengths in the largest radius. By default there are
    twice as many points in each direction as harmonics need. Raises `InputError` for values out of range.

    Example:
        >>> import numpy as np
        >>> import cyclosis as cy
        >>> grid = cy.ClosedGrid(cy.Sphere(), k_max=8)
        >>> grid.shape, grid.xyz.shape, round(grid.area / np.pi, 12)
        ((36, 18), (3, 36, 18), 4.0)
        >>> grid.mean(grid.xyz[2] ** 2).round(12)
        np.float64(0.333333333333)
        >>> grid.theta.shape, grid.s.shape, bool(np.allclose(grid.r**2 + grid.z**2, 1.0))
        ((36,), (18,), True)
        >>> bool(np.allclose(np.cross(grid.e_theta, grid.e_s, axis=0), grid.normal))
        True
        >>> round(float(grid.weights.sum() / grid.area), 12), grid.points.area.shape
        (1.0, (18,))
        >>> round(float(grid.meridian.k_s[0]), 12), grid.tables.rate[0, :3].round(6)  # l (l + 1) - 1
        (1.0, array([ 1.,  5., 11.]))
        >>> grid.check_state(np.ones((2, 36, 18)), bounded=True)
        Traceback (most recent call last):
            ...
        cyclosis.model.errors.InputError: max |P| of state = 1.41421 cannot be used: ...
    """

    surface: Shape = field(default_factory=Capsule)
    k_max: float = 24.0
    n_theta: int = 0
    n_s: int = 0

    def __post_init__(self) -> None:
        if not isinstance(self.surface, tuple(KINDS.values())):
            rule = "a cyclosis.Capsule, Spheroid or Sphere"
            raise InputError("surface", self.surface, rule, "give one, cyclosis.Capsule() for example")
        object.__setattr__(self, "k_max", number("k_max", self.k_max, LEAST_K, MOST_K, "the default is 24"))
        waves = {"n_theta": 2 * self.k_max + 2, "n_s": self.k_max * self._fastest + 1}
        for name, least in waves.items():
            given = getattr(self, name)
            chosen = _quick(PADDING * least) if given == 0 else given
            rule = "leave it out for twice the least"
            object.__setattr__(self, name, whole(name, chosen, int(np.ceil(least)), MOST_POINTS, rule))

    @property
    def _fastest(self) -> float:
        return float(self.surface.meridian(np.linspace(0, np.pi, 65)).speed.max())

    @property
    def shape(self) -> tuple[int, int]:
        """(n_theta, n_s)."""
        return (self.n_theta, self.n_s)

    @property
    def tables(self) -> Tables:
        """The harmonics on the points."""
        return tables(self.surface, self.k_max, self.n_s)

    @property
    def points(self) -> Weighted:
        """The latitudes and their weights."""
        return Weighted.of(self.surface, self.n_s)

    @property
    def meridian(self) -> Meridian:
        """Arc length, radius, height, slope and curvatures at the latitudes, arrays (n_s,)."""
        return self.points.meridian

    @property
    def theta(self) -> Array:
        """Angles of the points, shape (n_theta,), radians."""
        return 2 * np.pi * np.arange(self.n_theta) / self.n_theta

    @property
    def s(self) -> Array:
        """Arc lengths from the south pole, shape (n_s,), in radii."""
        return self.meridian.s

    @property
    def z(self) -> Array:
        """Heights above the equatorial plane, shape (n_s,), in radii."""
        return self.meridian.z

    @property
    def r(self) -> Array:
        """Distances from the axis, shape (n_s,), in radii."""
        return self.meridian.r

    @property
    def weights(self) -> Array:
        """The area of each point, shape (n_theta, n_s), in radii squared."""
        return np.broadcast_to(2 * np.pi / self.n_theta * self.points.area, self.shape)

    @property
    def area(self) -> float:
        """The area of the surface, in radii squared."""
        return float(2 * np.pi * self.points.area.sum())

    def mean(self, field: npt.ArrayLike) -> Any:
        """Return the mean over the surface of fields (..., n_theta, n_s)."""
        return np.sum(np.asarray(field) * self.weights, axis=(-2, -1)) / self.area

    @property
    def xyz(self) -> Array:
        """Positions of the points, shape (3, n_theta, n_s), in radii."""
        at, flat = self.meridian, np.ones(self.shape)
        cos, sin = np.cos(self.theta)[:, None], np.sin(self.theta)[:, None]
        return np.stack([at.r * cos, at.r * sin, at.z * flat])

    @property
    def e_theta(self) -> Array:
        """Unit vectors around the cell, shape (3, n_theta, n_s)."""
        flat = np.ones(self.shape)
        cos, sin = np.cos(self.theta)[:, None], np.sin(self.theta)[:, None]
        return np.stack([-sin * flat, cos * flat, 0 * flat])

    @property
    def e_s(self) -> Array:
        """Unit vectors along the meridians, to the north, shape (3, n_theta, n_s)."""
        at, flat = self.meridian, np.ones(self.shape)
        cos, sin = np.cos(self.theta)[:, None], np.sin(self.theta)[:, None]
        return np.stack([at.slope * cos, at.slope * sin, at.rise * flat])

    @property
    def normal(self) -> Array:
        """Outward unit normals e_theta x e_s, shape (3, n_theta, n_s)."""
        return np.cross(self.e_theta, self.e_s, axis=0)

    def position(self, theta: float, s: float) -> Array:
        """Return the position (3,), in radii, at an angle θ and an arc length s from the south pole.

        Raises `InputError` for an s beyond the poles.

        Example:
            >>> import numpy as np
            >>> import cyclosis as cy
            >>> cy.ClosedGrid(cy.Sphere(), k_max=8).position(0.0, np.pi / 2).round(12) + 0.0
            array([1., 0., 0.])
        """
        from .places import latitude_of

        at = self.surface.meridian(latitude_of(self.surface, s))
        return np.array([at.r * np.cos(theta), at.r * np.sin(theta), at.z])

    def cartesian(self, state: npt.ArrayLike, points: npt.ArrayLike) -> Array:
        """Return a vector field (2, n_theta, n_s) at points (n, 3) of the surface, as vectors (n, 3).

        Positions are (x, y, z) in radii, with z along the axis and 0 at the middle. Spectrally accurate for
        fields that the grid resolves. Raises `InputError` for points off the surface, and other states.

        Example:
            >>> import numpy as np
            >>> import cyclosis as cy
            >>> grid = cy.ClosedGrid(cy.Sphere(), k_max=8)
            >>> turning = np.stack([grid.r * np.ones(grid.shape), np.zeros(grid.shape)])
            >>> grid.cartesian(turning, [[0.6, 0.0, 0.8]]).round(12) + 0.0  # e_z x (x, y, z)
            array([[0. , 0.6, 0. ]])
        """
        from .places import frames, latitudes, packed_at

        field = pack(self.check_state(state))
        theta, tau = latitudes(self.surface, points)
        found, (around, along) = packed_at(self, field, theta, tau), frames(self.surface, theta, tau)
        return found.real[:, None] * around + found.imag[:, None] * along

    def check_state(self, state: Any, name: str = "state", bounded: bool = False) -> Array:
        """Return `state` as a float64 array (2, n_theta, n_s), or raise `InputError`.

        With `bounded`, a state with |P| > 1 anywhere is refused: P is the mean of unit vectors.
        """
        coordinates: dict[str, Any] = {
            "component": np.array(["theta", "s"]),
            "theta": self.theta,
            "s": self.s,
        }
        return vectors(name, state, self.shape, coordinates, bounded)


def _quick(least: float) -> int:
    """Return the smallest even number of at least `least` without prime factors beyond 5."""
    n = 2 * int(np.ceil(least / 2))
    while True:
        rest = n
        for prime in (2, 3, 5):
            while rest % prime == 0:
                rest //= prime
        if rest == 1:
            return n
        n += 2
