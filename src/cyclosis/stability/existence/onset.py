"""The onset of cyclosis: existence and stability of two stripes about α_p = d_r + d_s.

Below d_r + d_s two stripes exist only above the fold. Far below d_r + d_s they are stable from the fold on,
and coexist there with disorder alone. Nearer to it order at the fold is weak, and a mean grows at α_p - d_r,
faster than flow can suppress it: stripes then exist from the fold on, but are stable only from a larger α_u.
The two curves separate at a corner, where the fold and unequal widths are marginal together.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy.optimize import brentq

from ...model.arrays import series
from ...model.doors import door
from ...model.errors import InputError
from ...model.grid import Array
from ...model.parameters import Parameters
from ..profiles.profile import check
from .boundaries import Limits, limits
from .crossings import existing_from
from .equal import WIDTHS, EqualStripes
from .thresholds import resolution


@dataclass(frozen=True, eq=False)
class Neighbourhood(Limits):
    """The `Limits` of two stripes by α_p, and the `corner` (α_p, α_u) at which their curves separate."""

    corner: tuple[float, float]

    @property
    def alpha_p(self) -> Array:
        """The values of α_p (points,)."""
        return self.values


@door
def neighbourhood(params: Parameters, alpha_p: npt.ArrayLike | None = None) -> Neighbourhood:
    """Return the `Neighbourhood` at values `alpha_p` (points,) (default: 0.9 to 1.1 times d_r + d_s).

    d_r + d_s itself is always among them. `params` gives the other parameters; its alpha_p and alpha_u are
    ignored. Raises `InputError` for values out of range, as `corner` does, and for a force that is not cubic.

    Example:
        >>> import cyclosis as cy
        >>> near = cy.stability.neighbourhood(cy.Parameters(d_r=0.025, d_s=0.025, mu=0.05), [0.05])
        >>> near.exists.round(6), near.alpha_p  # α_p (1 + μ) at α_p = d_r + d_s
        (array([0.0525]), array([0.05]))
        >>> tuple(round(value, 4) for value in near.corner)
        (0.0472, 0.0816)
    """
    check(params)
    if params.force_exponent != 2:
        raise InputError("force_exponent", params.force_exponent, "2 here", "call fold and threshold instead")
    onset = params.d_r + params.d_s
    values = onset * np.linspace(0.9, 1.1, 41) if alpha_p is None else series("alpha_p", alpha_p)
    if not np.isclose(values, onset, rtol=1e-9, atol=0).any():
        values = np.sort(np.append(values, onset))
    found = limits(params, values)
    return Neighbourhood(**vars(found), corner=corner(params))


@door
def corner(params: Parameters) -> tuple[float, float]:
    """Return (α_p, α_u) at which stripes cease to exist and to be stable together, dimensionless.

    Raises `InputError` where that does not happen between α_p = d_r and d_r + d_s.
    """
    check(params)
    n = resolution(params.replace(alpha_p=params.d_r + params.d_s))

    def marginal(alpha_p: float) -> float:
        problem = EqualStripes(params.replace(alpha_p=alpha_p), 2, n)
        return problem.leading(existing_from(problem).state, WIDTHS).rate

    low, high = params.d_r, params.d_r + 0.999 * params.d_s
    if not marginal(low) < 0 < marginal(high):
        rule = "where stripes at the fold are stable for alpha_p = d_r, and unstable near d_r + d_s"
        raise InputError("mu", params.mu, rule, "change it")
    found = float(brentq(marginal, low, high, xtol=1e-12))
    problem = EqualStripes(params.replace(alpha_p=found), 2, n)
    return found, existing_from(problem).alpha_u
