"""Initial states on closed surfaces: arrays P of shape (2, n_theta, n_s), dimensionless."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from ..model.definitions import definition
from ..model.doors import door
from .grid import Array, ClosedGrid
from .space import closed_space
from .system import vector

SQUARE = 2 * np.pi / 64 * 5 / 64
"""Area of a square of the paper's grid of 64 x 64 points, in radii squared."""


def standard_modes(grid: ClosedGrid, stream: list[int]) -> npt.NDArray[np.complex128]:
    """Return normal random modes (2, M + 1, J) with a mean of |c|² of 1, from a seed sequence.

    Each azimuthal mode has random numbers of its own, taken in the order of its harmonics: a seed means the
    same state at every k_max, with more detail at larger ones.
    """
    keep = np.asarray(closed_space(grid).keep, dtype=bool)
    modes = np.zeros(keep.shape, complex)
    for side in (0, 1):
        for m in range(keep.shape[1]):
            count = int(keep[side, m].sum())
            drawn = np.random.default_rng([*stream, 2 * m + side]).normal(size=(count, 2))
            modes[side, m, :count] = (drawn[:, 0] + 1j * drawn[:, 1]) / np.sqrt(2)
    return modes


@door
def noise(grid: ClosedGrid, filaments_per_square: float = 1000, seed: int = 0) -> Array:
    """Return the order vector of N randomly oriented filaments in every area of 0.00767 radii squared.

    That area is one of 64 x 64 squares of the paper's cylinder, so that the same N is the same density here.
    The mean |P|² of each harmonic is that of white noise; what varies faster than k_max is left out. A seed
    gives the same state at every k_max, apart from its detail. Shape (2, n_theta, n_s). Raises `InputError`
    for settings out of range. Source: Woodhouse & Goldstein 2013, Materials and Methods.

    Example:
        >>> import numpy as np
        >>> import cyclosis as cy
        >>> grid = cy.ClosedGrid(cy.Sphere(), k_max=8)
        >>> P = cy.closed.noise(grid, filaments_per_square=1000, seed=1)
        >>> modes = 2 * sum(2 * l + 1 for l in range(1, 8))  # of real numbers; l (l + 1) - 1 <= 64
        >>> expected = 7.67e-3 / 1000 * modes / (2 * grid.area)
        >>> 0.8 < grid.mean(np.sum(P**2, axis=0)) / expected < 1.2
        np.True_
    """
    N = definition("initial", "filaments_per_square").check(filaments_per_square)
    seed = definition("initial", "seed").check(seed)
    scale = np.sqrt(SQUARE / (2 * np.pi * N))  # <|c|²> of harmonics that are normalised without their 2π
    return vector(closed_space(grid), scale * standard_modes(grid, [seed]))


@door
def disordered(grid: ClosedGrid, filaments_per_square: float = 1000, seed: int = 0) -> Array:
    """Return total filament disorder: `noise` alone. Raises `InputError` where |P| > 1.

    Example:
        >>> import cyclosis as cy
        >>> grid = cy.ClosedGrid(cy.Sphere(), k_max=8)
        >>> cy.closed.disordered(grid, seed=3).shape
        (2, 36, 18)
    """
    return with_noise(np.zeros((2, *grid.shape)), grid, filaments_per_square, seed)


@door
def with_noise(
    state: npt.ArrayLike, grid: ClosedGrid, filaments_per_square: float = 1000, seed: int = 0
) -> Array:
    """Return a state with `noise` added. Raises `InputError` where |P| > 1 then.

    Example:
        >>> import numpy as np
        >>> import cyclosis as cy
        >>> grid = cy.ClosedGrid(cy.Sphere(), k_max=8)
        >>> start = cy.closed.rotation(grid)
        >>> noisy = cy.closed.with_noise(start, grid, seed=2)
        >>> bool(np.allclose(noisy - start, cy.closed.noise(grid, seed=2)))
        True
    """
    noisy = grid.check_state(state) + noise(grid, filaments_per_square, seed)
    return grid.check_state(noisy, "the initial state", bounded=True)


@door
def from_vectors(grid: ClosedGrid, field: npt.ArrayLike) -> Array:
    """Return the tangent part (2, n_theta, n_s) of a vector field (3, n_theta, n_s) in space.

    A smooth field in space gives a smooth one on the surface, also at the poles.

    Example:
        >>> import numpy as np
        >>> import cyclosis as cy
        >>> grid = cy.ClosedGrid(cy.Sphere(), k_max=8)
        >>> P = cy.closed.from_vectors(grid, grid.e_s)
        >>> bool(np.allclose(P[0], 0)), bool(np.allclose(P[1], 1))
        (True, True)
    """
    given = np.asarray(field, dtype=np.float64)
    return np.stack([np.sum(given * grid.e_theta, axis=0), np.sum(given * grid.e_s, axis=0)])


@door
def source_to_sink(grid: ClosedGrid, magnitude: float = 0.9) -> Array:
    """Return filaments from the south pole to the north: the tangent part of `magnitude` e_z.

    Its defects are a source at the south pole and a sink at the north. Raises `InputError` for a magnitude
    outside [0, 1], as do the two functions below.

    Example:
        >>> import numpy as np
        >>> import cyclosis as cy
        >>> grid = cy.ClosedGrid(cy.Sphere(), k_max=8)
        >>> P = cy.closed.source_to_sink(grid, magnitude=0.5)
        >>> bool(np.allclose(P[1], 0.5 * grid.r))
        True
    """
    size = definition("initial", "magnitude").check(magnitude)
    axis = np.zeros((3, *grid.shape))
    axis[2] = size
    return from_vectors(grid, axis)


@door
def swirl(grid: ClosedGrid, magnitude: float = 0.9) -> Array:
    """Return filaments around the axis, P = magnitude r e_theta, in proportion to the distance from it.

    Example:
        >>> import cyclosis as cy
        >>> grid = cy.ClosedGrid(cy.Spheroid(aspect=2.0), k_max=8)
        >>> cy.regime(cy.Parameters(), grid, cy.closed.swirl(grid)).name
        'swirl'
    """
    size = definition("initial", "magnitude").check(magnitude)
    return np.stack([size * grid.r * np.ones(grid.shape), np.zeros(grid.shape)])


@door
def rotation(grid: ClosedGrid, magnitude: float = 0.9) -> Array:
    """Return two counter-streaming stripes that are joined over the poles: P ∝ e_y x (x, y, z).

    A rotation about an axis perpendicular to the cell, of largest magnitude `magnitude`: cyclosis of a closed
    cell. On a long cell its middle is `cyclosis.initial.stripes` with -cos θ instead of sin θ.

    Example:
        >>> import numpy as np
        >>> import cyclosis as cy
        >>> P = cy.closed.rotation(cy.ClosedGrid(cy.Sphere(), k_max=8))
        >>> 0.85 < np.hypot(*P).max() <= 0.9
        np.True_
    """
    size = definition("initial", "magnitude").check(magnitude)
    x, _, z = grid.xyz / grid.surface.half_height
    turning = from_vectors(grid, np.stack([z, 0 * z, -grid.surface.half_height * x]))
    largest = np.hypot(*turning).max()
    return size * turning / max(float(largest), 1.0)
