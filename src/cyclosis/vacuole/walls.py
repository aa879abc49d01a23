"""What the wall does to a scalar: nothing, absorb it, exchange it, or hold a pattern.

With the outward derivative c_r at r = 1, dimensionless (lengths in radii, c in any unit):

    Sealed            c_r = 0
    Absorbing         c = 0
    Exchange          c_r + Bi (c - outside) = 0,  Bi = k R/D with the permeability k of the wall
    Held              c = pattern
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from ..display.shown import shown
from ..model.arrays import numbers
from ..model.errors import InputError, number
from ..model.grid import Array

Pattern = float | npt.ArrayLike | Callable[[Array, Array], npt.ArrayLike]
"""A number, an array (n_theta, n_z), or a function of θ and z that takes arrays of these shapes."""


@shown
@dataclass(frozen=True)
class Sealed:
    """A wall that nothing passes: the amount in the vacuole is constant.

    Example:
        >>> import cyclosis as cy
        >>> cy.vacuole.Sealed().biot, cy.vacuole.Sealed().pattern
        (0.0, 0.0)
    """

    @property
    def biot(self) -> float:
        """The Biot number, dimensionless."""
        return 0.0

    @property
    def pattern(self) -> Pattern:
        """The value outside: 0, without effect."""
        return 0.0


@shown
@dataclass(frozen=True)
class Absorbing(Sealed):
    """A wall that takes up whatever reaches it: c = 0 there.

    Example:
        >>> import cyclosis as cy
        >>> cy.vacuole.Absorbing().biot
        inf
    """

    @property
    def biot(self) -> float:
        """The Biot number: infinite."""
        return np.inf


@shown
@dataclass(frozen=True)
class Exchange:
    """A wall that exchanges with a value `outside`: c_r + biot (c - outside) = 0.

    `biot` = k R/D is dimensionless, with the permeability k of the wall; `outside` is a number, an array
    (n_theta, n_z) or a function of θ and z. Raises `InputError` for a Biot number that is not positive.

    Example:
        >>> import numpy as np
        >>> import cyclosis as cy
        >>> cy.vacuole.Exchange(0.5, outside=lambda theta, z: 1 + np.cos(theta)).biot
        0.5
        >>> cy.vacuole.Exchange(0.5, outside=2.0).pattern
        2.0
        >>> cy.vacuole.Exchange(-1.0)
        Traceback (most recent call last):
            ...
        cyclosis.model.errors.InputError: biot = -1.0 cannot be used: ...
    """

    biot: float
    outside: Pattern = 0.0

    def __post_init__(self) -> None:
        remedy = "give k R/D, or use Sealed() for 0 and Absorbing() for infinity"
        object.__setattr__(self, "biot", number("biot", self.biot, 1e-12, 1e9, remedy))

    @property
    def pattern(self) -> Pattern:
        """The value outside."""
        return self.outside


@shown
@dataclass(frozen=True)
class Held(Absorbing):
    """A wall at which c is held at `value`: a number, an array (n_theta, n_z) or a function of θ and z.

    Example: a wall with bands across the axis, one period in a cell of 5 radii:
        >>> import numpy as np
        >>> import cyclosis as cy
        >>> cy.vacuole.Held(lambda theta, z: np.cos(2 * np.pi * z / 5)).biot
        inf
    """

    value: Pattern = 0.0

    @property
    def pattern(self) -> Pattern:
        """The value that is held."""
        return self.value


Wall = Sealed | Exchange
"""Any wall of this file: Absorbing and Held are kinds of Sealed with another condition."""


def pattern_on(wall: Any, theta: Array, z: Array) -> Array:
    """Return the pattern of a wall at the points of θ (n_theta,) and z (n_z,), shape (n_theta, n_z)."""
    if not isinstance(wall, Wall):
        rule = "Sealed(), Absorbing(), Exchange(biot) or Held(pattern) of cyclosis.vacuole"
        raise InputError("wall", wall, rule, "make one of these")
    shape = (theta.size, z.size)
    given = wall.pattern(theta[:, None], z[None, :]) if callable(wall.pattern) else wall.pattern
    rule = f"a number, an array of shape {shape} (theta, z), or a function of theta and z that returns one"
    found = numbers("the wall's pattern", given, rule, "give it on the grid of the transport")
    try:
        found = np.broadcast_to(found, shape).copy()
    except ValueError as error:
        raise InputError("the wall's pattern", found, rule, "give it on the grid of the transport") from error
    if not np.all(np.isfinite(found)):
        raise InputError("the wall's pattern", found, "finite everywhere", "remove NaN and infinite entries")
    return found
