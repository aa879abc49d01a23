"""Initial concentrations of filaments: a bump or a gap, and states that contain a concentration."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from .arrays import FIELD_DIMS, STATE_DIMS, numbers
from .definitions import definition
from .doors import door
from .errors import InputError
from .grid import Array, CylinderGrid


@door
def bump(
    grid: CylinderGrid,
    height: float,
    theta: float = definition("initial", "bump_theta").default,
    z: float | None = None,
    width: float = definition("initial", "bump_width").default,
) -> Array:
    """Return a concentration c (n_theta, n_z) of mean 1 with a bump, or with a gap if `height` is negative.

    c is proportional to 1 + height exp(-s²/(2 width²)) with s² = 2 (1 - cos(θ - theta))
    + 2 (ℓ/2π)² (1 - cos(2π (z' - z)/ℓ)): near its centre s is the distance in radii, and far from it c is
    periodic. The centre is half way along by default. On a grid with one point along the axis c varies
    around it only. Dimensionless. Raises `InputError` for a height of -1 or less and other values out of
    range.

    Example:
        >>> import cyclosis as cy
        >>> grid = cy.CylinderGrid(32, 32)
        >>> c = cy.initial.bump(grid, height=-0.8)
        >>> round(float(c.mean()), 12), round(float(c.min() / c.max()), 3)
        (1.0, 0.2)
    """
    height = definition("initial", "bump").check(height)
    if height is None:
        raise InputError("bump", height, "a number above -1", "give its height")
    theta = definition("initial", "bump_theta").check(theta)
    z = definition("initial", "bump_z").check(z)
    width = definition("initial", "bump_width").check(width)
    along, radius = 2 * np.pi / grid.length, grid.length / (2 * np.pi)
    centre = 0.5 * grid.length if z is None else z
    around = 2.0 * (1.0 - np.cos(grid.theta - theta))[:, None]
    lengthwise = 2.0 * radius**2 * (1.0 - np.cos(along * (grid.z - centre))) * (grid.n_z > 1)
    c = 1.0 + height * np.exp(-(around + lengthwise) / (2.0 * width**2))
    return np.asarray(c / c.mean())


@door
def with_concentration(state: npt.ArrayLike, c: npt.ArrayLike = 1.0) -> Array:
    """Return a state (3, n_theta, n_z) of P (2, n_theta, n_z) and a concentration c, a number or a field.

    It is a state of `cyclosis.models.polar_model(concentration=True)`; c is relative to the concentration for
    which the force is |P|ⁿ P. Raises `InputError` for shapes that do not match and for c that is not above 0.

    Example:
        >>> import cyclosis as cy
        >>> grid, model = cy.CylinderGrid(16, 16), cy.models.polar_model(concentration=True)
        >>> state = cy.initial.with_concentration(cy.initial.stripes(grid), cy.initial.bump(grid, 1.0))
        >>> run = cy.simulate(cy.Parameters(), grid, state, t_end=1.0, model=model)
        >>> run.final_state.shape, round(float(run.final_state[2].mean()), 12)
        ((3, 16, 16), 1.0)
    """
    rule = "an array of real numbers of shape (2, n_theta, n_z)"
    P = numbers("state", state, rule, "give P_theta and P_z on a grid", STATE_DIMS)
    if P.ndim != 3 or len(P) != 2:
        raise InputError("state", P, rule, "give P_theta and P_z on a grid")
    rule = f"a positive number, or positive ones of shape {P.shape[1:]}"
    given: Any = numbers("c", c, rule, "make state and concentration match", FIELD_DIMS)
    if given.shape not in ((), P.shape[1:]):
        raise InputError("c", given, rule, "make state and concentration match")
    if not np.all(np.isfinite(given)) or given.min() <= 0:
        raise InputError("c", float(given.min()), rule, "a concentration is above 0 everywhere")
    return np.stack([*P, np.broadcast_to(given, P.shape[1:])])
