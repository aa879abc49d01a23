"""The grid on the cylinder's surface."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from ..display.notebook import cylinder, tree
from .definitions import GRID
from .errors import InputError

Array = npt.NDArray[np.float64]


@dataclass(frozen=True)
class CylinderGrid:
    """Evenly spaced points on the surface of a cylinder of radius 1 and axial period `length`.

    theta_i = 2π i / n_theta and z_j = length j / n_z, periodic in both. Fields have shape
    (n_theta, n_z), vector fields (2, n_theta, n_z) with components (theta, z). Dimensionless: lengths
    are in radii. Raises `InputError` for sizes outside `cyclosis.model.definitions.GRID`.

    Example:
        >>> import cyclosis as cy
        >>> grid = cy.CylinderGrid(n_theta=16, n_z=8, length=5.0)
        >>> grid.shape, grid.theta.shape, grid.z[:3]
        ((16, 8), (16,), array([0.   , 0.625, 1.25 ]))
        >>> grid.m[:3], grid.m[-2:]
        (array([0., 1., 2.]), array([-2., -1.]))
        >>> round(float(grid.q[1] * grid.length), 6)  # 2π: one wave along the cell
        6.283185
        >>> grid.resized(32, 16).shape
        (32, 16)
    """

    n_theta: int = GRID[0].default
    n_z: int = GRID[1].default
    length: float = GRID[2].default

    def __post_init__(self) -> None:
        for item in GRID:
            object.__setattr__(self, item.name, item.check(getattr(self, item.name)))

    @property
    def shape(self) -> tuple[int, int]:
        """(n_theta, n_z)."""
        return (self.n_theta, self.n_z)

    @property
    def theta(self) -> Array:
        """Angles of the points, shape (n_theta,), radians."""
        return _multiples(2 * np.pi / self.n_theta, self.n_theta)

    @property
    def z(self) -> Array:
        """Axial positions of the points, shape (n_z,), in radii."""
        return _multiples(self.length / self.n_z, self.n_z)

    @property
    def m(self) -> Array:
        """Azimuthal wavenumbers in transform order, shape (n_theta,)."""
        return _mode_numbers(self.n_theta)

    @property
    def q(self) -> Array:
        """Axial wavenumbers 2π j / length in transform order, shape (n_z,)."""
        return _mode_numbers(self.n_z) * (2 * np.pi / self.length)

    def _repr_html_(self) -> str:
        rows = [
            ("points", f"{self.n_theta} around x {self.n_z} along"),
            ("length", f"{self.length:g} radii"),
            ("spacing", f"{2 * np.pi / self.n_theta:.3g} x {self.length / self.n_z:.3g} radii"),
        ]
        return tree("CylinderGrid", rows, cylinder(self.length))

    def resized(self, n_theta: int, n_z: int) -> CylinderGrid:
        """Return a grid on the same cylinder with other numbers of points."""
        return CylinderGrid(n_theta, n_z, self.length)

    def check_state(self, state: Any, name: str = "state", bounded: bool = False) -> Array:
        """Return `state` as a float64 array (2, n_theta, n_z), or raise `InputError`.

        With `bounded`, a state with |P| > 1 anywhere is refused: P is the mean of unit vectors.

        Example:
            >>> import numpy as np
            >>> import cyclosis as cy
            >>> cy.CylinderGrid(16, 16).check_state(np.ones((2, 16, 16)), bounded=True)
            Traceback (most recent call last):
                ...
            cyclosis.model.errors.InputError: max |P| of state = 1.41421 cannot be used: ...
        """
        expected = (2, *self.shape)
        rule = f"an array of real numbers of shape {expected} (component, theta, z)"
        try:
            given = np.asarray(state)
        except (TypeError, ValueError) as error:
            raise InputError(name, state, rule, "give one array with all components") from error
        if given.dtype.kind not in "iuf" or given.shape != expected:
            raise InputError(name, given, rule, "make state and grid match")
        array = np.array(given, dtype=np.float64)
        if not np.all(np.isfinite(array)):
            raise InputError(name, array, "finite everywhere", "remove its NaN or infinite entries")
        largest = float(np.sqrt(np.max(np.sum(array**2, axis=0))))
        if bounded and largest > 1 + 1e-12:
            raise InputError(
                f"max |P| of {name}",
                float(f"{largest:.6g}") if largest > 1.00001 else largest,
                "at most 1, because P is a mean of unit vectors",
                "scale the state down, or raise filaments_per_square if it is noise",
            )
        return array


def interpolate(values: npt.ArrayLike, shape: tuple[int, int]) -> Array:
    """Return periodic fields (..., n_theta, n_z) on another grid of the same cylinder.

    Trigonometric interpolation: modes that both grids resolve are kept exactly, all others (among them
    the Nyquist modes of either grid, whose sign is ambiguous) are dropped. The result has `shape` as
    its last two dimensions. Onto the same shape it is an exact copy. Values keep their unit.

    Example:
        >>> import numpy as np
        >>> import cyclosis as cy
        >>> coarse, fine = cy.CylinderGrid(16, 16), cy.CylinderGrid(32, 32)
        >>> a, b = (np.cos(3 * grid.theta)[:, None] * np.ones(grid.n_z) for grid in (coarse, fine))
        >>> bool(np.allclose(cy.interpolate(a, fine.shape), b))
        True
    """
    field = np.asarray(values, dtype=np.float64)
    if field.shape[-2:] == tuple(shape):
        return field.copy()
    spectrum = np.fft.fft2(field, norm="forward")
    target = np.zeros(field.shape[:-2] + tuple(shape), dtype=complex)
    rows, cols = (_shared_modes(a, b) for a, b in zip(field.shape[-2:], shape, strict=True))
    target[..., rows[:, None], cols] = spectrum[..., rows[:, None], cols]
    return np.fft.ifft2(target, norm="forward").real


def _multiples(step: float, n: int) -> Array:
    return step * np.arange(n, dtype=np.float64)


def _mode_numbers(n: int) -> Array:
    return np.rint(n * np.fft.fftfreq(n)).astype(np.float64)


def _shared_modes(n: int, m: int) -> npt.NDArray[np.int64]:
    # Negative indices address the same wavenumber in arrays of either length.
    highest = (min(n, m) - 1) // 2
    return np.arange(-highest, highest + 1)
