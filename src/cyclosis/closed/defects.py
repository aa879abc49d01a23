"""Point defects of a vector field on a closed surface, and their indices."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from ..display.shown import shown
from ..model.doors import door
from ..model.spectral import pack
from .grid import Array, ClosedGrid
from .places import packed_at

Whole = npt.NDArray[np.intp]

STEPS = 8
"""Newton steps to the place of a defect from the middle of the square that holds it."""


@shown
@dataclass(frozen=True)
class Defect:
    """A point where a vector field vanishes and around which it turns `index` times.

    `theta` is its angle in radians and `s` its arc length from the south pole, in radii. An aster, a vortex
    and a spiral have index 1; a saddle has -1.

    Example:
        >>> import cyclosis as cy
        >>> cy.closed.Defect(index=-1, theta=0.0, s=2.5).index
        -1
    """

    index: int
    theta: float
    s: float


@door
def defects(grid: ClosedGrid, state: npt.ArrayLike) -> list[Defect]:
    """Return the point defects of a vector field (2, n_theta, n_s), from south to north.

    The field turns `index` times around each square of the grid that holds one, and around each pole. By the
    theorem of Poincaré and Hopf the indices sum to 2. Defects closer together than the grid's spacing are
    seen as one, with the sum of their indices. Raises `InputError` for a state that does not match the grid.

    Example:
        >>> import cyclosis as cy
        >>> grid = cy.ClosedGrid(cy.Sphere(), k_max=8)
        >>> cy.closed.defects(grid, cy.closed.source_to_sink(grid))  # a source and a sink
        [Defect(index=1, theta=0.0, s=0.0), Defect(index=1, theta=0.0, s=3.141592653589793)]
        >>> [found.index for found in cy.closed.defects(grid, cy.closed.rotation(grid))]
        [1, 1]
    """
    p = pack(grid.check_state(state))
    around = _turn(np.roll(p, -1, axis=0) / np.where(p == 0, 1.0, p))
    along = _turn(p[:, 1:] / np.where(p[:, :-1] == 0, 1.0, p[:, :-1]))
    squares = np.rint((around[:, :-1] + np.roll(along, -1, axis=0) - around[:, 1:] - along) / (2 * np.pi))
    south, north = (int(np.rint(around[:, end].sum() / (2 * np.pi))) for end in (0, -1))
    found = []
    # A field that is constant near a pole turns once around it in the frame (e_theta, e_s).
    if south != 1:
        found.append(Defect(1 - south, 0.0, 0.0))
    rows, columns = np.nonzero(squares)
    theta, s = _placed(grid, p, rows, columns)
    indices = squares[rows, columns].astype(int)
    held = sorted(zip(s, theta, indices, strict=True))
    found += [Defect(int(index), float(angle), float(place)) for place, angle, index in held]
    if north != -1:
        found.append(Defect(1 + north, 0.0, float(grid.surface.meridian_length)))
    return found


def _turn(ratio: npt.NDArray[np.complex128]) -> Array:
    return np.angle(ratio)


def _placed(
    grid: ClosedGrid, p: npt.NDArray[np.complex128], rows: Whole, columns: Whole
) -> tuple[Array, Array]:
    """Return where a packed field vanishes in some squares of the grid: Newton's method, kept inside."""
    x = grid.points.x
    tau = np.arccos(x)
    size = 2 * np.pi / grid.n_theta
    low, high = tau[columns], tau[columns + 1]
    angle: Array = np.asarray((rows + 0.5) * size, dtype=np.float64)
    latitude: Array = 0.5 * (low + high)
    step = 1e-5
    if len(rows):
        for _ in range(STEPS):
            value = packed_at(grid, p, angle, latitude)
            by_angle = (packed_at(grid, p, angle + step, latitude) - value) / step
            by_latitude = (packed_at(grid, p, angle, latitude + step) - value) / step
            volume = by_angle.real * by_latitude.imag - by_angle.imag * by_latitude.real
            volume = np.where(np.abs(volume) < 1e-12, np.inf, volume)
            d_angle = (value.imag * by_latitude.real - value.real * by_latitude.imag) / volume
            d_latitude = (value.real * by_angle.imag - value.imag * by_angle.real) / volume
            angle = np.clip(angle + d_angle, rows * size, (rows + 1) * size)
            latitude = np.clip(latitude + d_latitude, low, high)
    return angle % (2 * np.pi), grid.surface.meridian(latitude).s
