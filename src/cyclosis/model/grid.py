"""The grid on the cylinder's surface."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from ..display.notebook import cylinder, tree
from .arrays import COMPONENTS, FIELD_DIMS, numbers, vectors
from .definitions import GRID
from .doors import door
from .errors import InputError, whole

Array = npt.NDArray[np.float64]

ROUNDING = 16 * float(np.finfo(np.float64).eps)
"""A Nyquist mode below this share of the largest value counts as rounding."""


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

        With `bounded`, a state with |P| > 1 anywhere is refused: P is the mean of unit vectors. An array of
        xarray may have its dimensions component, theta and z in any order; its coordinates must be those of
        the grid. Masked entries, units, and values that JAX traces are refused.

        Example:
            >>> import numpy as np
            >>> import cyclosis as cy
            >>> cy.CylinderGrid(16, 16).check_state(np.ones((2, 16, 16)), bounded=True)
            Traceback (most recent call last):
                ...
            cyclosis.model.errors.InputError: max |P| of state = 1.41421 cannot be used: ...
        """
        coordinates: dict[str, Any] = {"component": COMPONENTS, "theta": self.theta, "z": self.z}
        return vectors(name, state, self.shape, coordinates, bounded)


@door
def interpolate(values: npt.ArrayLike, shape: tuple[int, int]) -> Array:
    """Return periodic fields (..., n_theta, n_z) on another grid of the same cylinder.

    Trigonometric interpolation: modes that both grids resolve are kept exactly, all others (among them
    the Nyquist modes of either grid, whose sign is ambiguous) are dropped. The result has `shape` as
    its last two dimensions. Onto the same shape it is an exact copy. Values keep their unit. Raises
    `InputError` for invalid fields and shapes.

    Example:
        >>> import numpy as np
        >>> import cyclosis as cy
        >>> coarse, fine = cy.CylinderGrid(16, 16), cy.CylinderGrid(32, 32)
        >>> a, b = (np.cos(3 * grid.theta)[:, None] * np.ones(grid.n_z) for grid in (coarse, fine))
        >>> bool(np.allclose(cy.interpolate(a, fine.shape), b))
        True
    """
    rule = "an array of real numbers (..., n_theta, n_z)"
    field = numbers("values", values, rule, "give a field on a grid", (..., *FIELD_DIMS))
    if field.ndim < 2 or 0 in field.shape:
        raise InputError("values", field, rule, "give a field on a grid")
    if not isinstance(shape, list | tuple) or len(shape) != 2:
        raise InputError("shape", shape, "two whole numbers (n_theta, n_z)", "give that of a grid")
    shape = (
        whole("shape", shape[0], 1, 2**20, "give that of a grid"),
        whole("shape", shape[1], 1, 2**20, "give that of a grid"),
    )
    if field.shape[-2:] == shape:
        return field
    spectrum = np.fft.fft2(field, norm="forward")
    target = np.zeros(field.shape[:-2] + tuple(shape), dtype=complex)
    rows, cols = (_shared_modes(a, b) for a, b in zip(field.shape[-2:], shape, strict=True))
    target[..., rows[:, None], cols] = spectrum[..., rows[:, None], cols]
    return np.fft.ifft2(target, norm="forward").real


@door
def resolved(field: npt.NDArray[Any]) -> Array:
    """Return fields (..., n_theta, n_z) without their Nyquist modes, as the model represents a state.

    On an even number of points the highest mode is sampled only at its crests. Its phase and the sign of its
    wavenumber are lost, so that it has no derivative. The right-hand side drops it, and so does
    everything that is reported about a state. Fields without it are returned bit for bit.

    Example:
        >>> import numpy as np
        >>> from cyclosis.model.grid import resolved
        >>> field = np.ones((8, 8)) + 0.1 * (-1.0) ** np.arange(8)[:, None]
        >>> bool(np.allclose(resolved(field), 1.0))
        True
    """
    out = np.asarray(field, dtype=np.float64)
    rounding = ROUNDING * float(np.max(np.abs(out), initial=0.0))
    for axis in (-2, -1):
        n = out.shape[axis]
        if n % 2 == 0:
            crests = np.where(np.arange(n) % 2, -1.0, 1.0).reshape((n, 1) if axis == -2 else (1, n))
            highest = np.mean(crests * out, axis=axis, keepdims=True)
            if not np.max(np.abs(highest)) <= rounding:
                out = out - crests * highest
    return out


def sign_changes(field: Array) -> npt.NDArray[np.int64]:
    """Return how often a field (n_theta, n) changes sign around each circle (n,)."""
    up = field > 0
    return np.sum(up != np.roll(up, 1, axis=0), axis=0)


def covered(name: str, points: npt.ArrayLike, period: float | None, where: str) -> float:
    """Return the period of the points of a stored axis, which must be `period` if that is known.

    `points` (n,) are the positions on the axis `name`, in radii or radians. A part of a cell is not periodic:
    points that do not span the whole period in even steps are refused with `InputError`. `where` names
    the file.
    """
    at = np.asarray(points, dtype=np.float64)
    if period is not None and at.tolist() == [0.0]:  # the same everywhere along this axis
        return period
    step = (at[-1] - at[0]) / (at.size - 1) if at.size > 1 else np.nan
    even = step > 0 and np.allclose(np.diff(at), step, rtol=0, atol=1e-6 * step * at.size)
    if not even or not same_length(step * at.size, step * at.size if period is None else period):
        shown = f"{at.size} points from {at[0]:.6g} to {at[-1]:.6g}" if at.size else "no points"
        rule = f"in even steps {'around' if name == 'theta' else 'along'} the whole cell"
        size = "" if period is None else f", of {period:.6g}"
        raise InputError(f"{name} in {where}", shown, rule + size, "store the whole cell, not a part of it")
    return float(step * at.size) if period is None else period


def same_length(one: float, other: float) -> bool:
    """Whether two lengths are equal to rounding, also of coordinates stored in single precision."""
    return abs(one - other) <= 1e-6 * abs(other)


def _multiples(step: float, n: int) -> Array:
    return step * np.arange(n, dtype=np.float64)


def _mode_numbers(n: int) -> Array:
    return np.rint(n * np.fft.fftfreq(n)).astype(np.float64)


def _shared_modes(n: int, m: int) -> npt.NDArray[np.int64]:
    # Negative indices address the same wavenumber in arrays of either length.
    highest = (min(n, m) - 1) // 2
    return np.arange(-highest, highest + 1)
