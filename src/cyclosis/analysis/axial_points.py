"""How many points along the cell a state needs: few once its waves along the cell have decayed.

Stripes along the axis do not vary along it in the end, so that most modes of a grid that resolved their
formation are empty. On fewer points the right-hand side is the same up to the amplitude that they leave out.
"""

from __future__ import annotations

import jax
import jax.numpy as jnp
import numpy as np

from ..model.grid import CylinderGrid
from ..model.parameters import Parameters
from .diagnostics import TAIL_FRACTION

SHARES = ((2, 3), (1, 2), (1, 4))
"""The shares of the grid's axial points that may be used."""
FEWEST = 8
"""The smallest number of axial points that is used."""


def fewer_points(grid: CylinderGrid) -> tuple[int, ...]:
    """Return the numbers of axial points that may be used instead of n_z, from most to fewest, all even."""
    numbers = (2 * round(grid.n_z * above / (2 * below)) for above, below in SHARES)
    return tuple(dict.fromkeys(n for n in numbers if FEWEST <= n < grid.n_z))


def usable(params: Parameters, grid: CylinderGrid) -> int:
    """Return how many of the `fewer_points` a cell with these parameters may use, from the first on.

    A number that leaves out a wave that grows about disorder, d_s q² <= α_p - d_r, is not used: a wave that
    has been left out has no amplitude from which it could grow. None is used where couplings vary over the
    surface, or without diffusion.
    """
    if params.shape is not None or params.d_s <= 0:
        return 0
    q = np.sqrt(max(float(params.alpha_p - params.d_r), 0.0) / params.d_s)
    growing = float(q) * grid.length / (2 * np.pi)
    return sum(_highest(n) >= growing for n in fewer_points(grid))


def axial_tails(spectrum: jax.Array, numbers: tuple[int, ...]) -> jax.Array:
    """Return the axial tails of a packed spectrum on each of some numbers of points (traceable).

    They are (Σ beyond / Σ all)^½ of |P_k|², dimensionless; beyond are the waves along the cell above
    `TAIL_FRACTION` of the highest that so many points hold.
    """
    energy = spectrum.real**2 + spectrum.imag**2
    own = spectrum.shape[-1]
    j = np.abs(np.rint(own * np.fft.fftfreq(own)))
    beyond = [j > TAIL_FRACTION * _highest(n) for n in numbers]
    tails = jnp.stack([jnp.sum(jnp.where(waves, energy, 0.0)) for waves in beyond])
    return jnp.sqrt(tails / jnp.maximum(jnp.sum(energy), float(np.finfo(energy.dtype).tiny)))


def _highest(n_z: int) -> int:
    """Return the number of the highest wave that n_z points hold."""
    return (n_z - 1) // 2
