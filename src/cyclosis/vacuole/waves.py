"""The flow and the drag of single waves of the wall's velocity."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from ..display.shown import shown
from ..model import interior
from ..model.arrays import numbers
from ..model.doors import door
from ..model.errors import InputError, number, whole
from ..model.grid import Array
from .modes import radial
from .points import checked_radii
from .tables import Complex

HIGHEST = 10_000
"""The highest m of single waves."""


@shown
class Wave(NamedTuple):
    """The flow of one wave: complex amplitudes of e^{i(mθ + qz)}, dimensionless.

    `velocity` (3, n_r), components (r, θ, z); `pressure` (n_r,); and the `traction` (2,) of the wall on the
    fluid, components (θ, z).

    Example:
        >>> import cyclosis as cy
        >>> wave = cy.vacuole.wave(1, 0.0, 0.0, 1.0, [0.0, 0.5, 1.0])  # v_z = r e^{iθ}
        >>> wave.velocity[2].real, wave.traction.real
        (array([0. , 0.5, 1. ]), array([0., 1.]))
        >>> wave.pressure.shape
        (3,)
    """

    velocity: Complex
    pressure: Complex
    traction: Complex


@door
def wave(m: int, q: float, a: complex, b: complex, radii: npt.ArrayLike) -> Wave:
    """Return the `Wave` that a wall velocity (u_θ, u_z) = (a, b) e^{i(mθ + qz)} drives in the vacuole.

    `q` is in 1/R, `radii` (n_r,) in R, `a` and `b` in U. For m = q = 0 the cell is closed (no net flux); the
    pressure then has the gradient 8b besides. Raises `InputError` for m that is not whole and r outside 0 to
    1.

    Example:
        >>> import cyclosis as cy
        >>> cy.vacuole.wave(0, 0.0, 0.0, 1.0, [0.0, 1.0]).velocity[2].real
        array([-1.,  1.])
    """
    n = abs(whole("m", m, -HIGHEST, HIGHEST, "give the number of waves around the cell"))
    kappa = abs(number("q", q, -1e6, 1e6, "give 2π over the wavelength along the cell, in 1/R"))
    at = checked_radii(radii)
    f = [part[:, n, 0] for part in radial(n, np.array([kappa]), at)]
    ahead, along = (-1.0 if m < 0 else 1.0), (-1.0 if q < 0 else 1.0)
    a, b = complex(a), complex(b)
    response = [part[n, 0] for part in interior.wall(n, np.array([kappa]))]
    return Wave(
        np.stack(
            [
                1j * (ahead * a * f[0] + along * b * f[1]),
                a * f[2] + ahead * along * b * f[3],
                ahead * along * a * f[4] + b * f[5],
            ]
        ),
        1j * (ahead * a * f[6] + along * b * f[7]),
        np.array(
            [
                response[0] * a + ahead * along * response[1] * b,
                ahead * along * response[1] * a + response[2] * b,
            ]
        ),
    )


@door
def drag(m: npt.ArrayLike, q: npt.ArrayLike) -> Array:
    """Return the drag Z of the vacuole on waves of a wall without divergence, in units of ηU/R.

        Z(m, q) = Re(τ·u*)/|u|²,   m u_θ + q u_z = 0

    τ is the stress of the wall on the fluid. Its part along (m, q) does no work, and the pressure in the
    layer takes it up.     `m` and `q` (...) are wavenumbers that broadcast; the result has their common
    shape. Z = |m| for q = 0, Z = q I_2(q)/I_1(q) for m = 0, and Z = 0 for the mean, with which the fluid
    turns as a solid. Raises `InputError` for m that are not whole numbers.

    Example:
        >>> import cyclosis as cy
        >>> grid = cy.CylinderGrid(16, 8)
        >>> cy.vacuole.drag(grid.m[:, None], grid.q).shape, cy.vacuole.drag([0, 1, 2], 0.0)
        ((16, 8), array([0., 1., 2.]))
        >>> round(float(cy.vacuole.drag(1, 2.0)), 6)
        1.310268
    """
    rule, remedy = "whole numbers", "give the numbers of waves around the cell"
    around, along = (
        numbers("m", m, rule, remedy),
        numbers("q", q, "real numbers", "give 2π over the wavelengths"),
    )
    if not np.all(np.isfinite(along)):
        raise InputError("q", along, "finite everywhere", "give 2π over the wavelengths")
    if not np.all(np.abs(around) <= HIGHEST) or np.any(around != np.rint(around)):
        raise InputError("m", m, f"{rule} up to {HIGHEST}", remedy)
    try:
        np.broadcast_shapes(around.shape, along.shape)
    except ValueError:
        raise InputError(
            "q", along, f"of a shape that broadcasts with {around.shape}", "match m and q"
        ) from None
    return np.asarray(interior.drag(around, along))
