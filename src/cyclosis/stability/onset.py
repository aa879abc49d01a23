"""Where cyclosis comes to life: existence and stability of two stripes about α_p = d_r + d_s.

Below d_r + d_s two stripes exist above the fold only. Far below it they are stable at once, and what they
coexist with at the fold is disorder alone. Nearer to it the fold is one of weak order, in which a mean
grows at α_p - d_r, faster than flow can hold it: stripes then exist from the fold on, but are stable from a
larger α_u. Both curves part at a corner, where a fold and unequal widths are marginal together.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy.optimize import brentq

from ..model.errors import InputError, number
from ..model.grid import Array
from ..model.parameters import Parameters
from .crossings import existing_from
from .equal import EqualStripes
from .families import WIDTHS
from .profile import check
from .thresholds import fold_with_error, resolution, threshold_with_error


@dataclass(frozen=True, eq=False)
class Neighbourhood:
    """Existence and stability of two stripes by α_p, dimensionless; arrays (points,).

    `exists` is the α_u above which they exist: the fold, the pitchfork at d_r + d_s, and 0 above it; `stable`
    that above which they are stable against perturbations of P_z that do not vary along the cell. Their
    errors stand beside them. `corner` is (α_p, α_u) of the point where the curves part.
    """

    alpha_p: Array
    exists: Array
    exists_error: Array
    stable: Array
    stable_error: Array
    corner: tuple[float, float]


def neighbourhood(params: Parameters, alpha_p: npt.ArrayLike | None = None) -> Neighbourhood:
    """Return the `Neighbourhood` at values `alpha_p` (points,) (default: 0.9 to 1.1 times d_r + d_s).

    `params` gives all else; its alpha_p and alpha_u play no part. Raises `InputError` for values out of
    range, as `threshold`, and for a force that is not cubic.
    """
    check(params)
    if params.force_exponent != 2:
        raise InputError("force_exponent", params.force_exponent, "2 here", "use fold and threshold")
    onset = params.d_r + params.d_s
    given = onset * np.linspace(0.9, 1.1, 41) if alpha_p is None else np.asarray(alpha_p, dtype=np.float64)
    values = [number("alpha_p", value, 0.0, 1e3, "give numbers") for value in np.ravel(given)]
    rows = []
    for value in values:
        # A round number that is d_r + d_s but for rounding is meant to be it.
        here = params.replace(alpha_p=onset if abs(value / onset - 1) < 1e-9 else value)
        ends = (0.0, 0.0)
        if here.alpha_p <= onset:
            ended = fold_with_error(here)
            ends = ended.alpha_u, ended.error
        held = threshold_with_error(here)
        rows.append((*ends, held.alpha_u, held.error))
    exists, exists_error, stable, stable_error = np.array(rows).reshape(-1, 4).T
    return Neighbourhood(np.array(values), exists, exists_error, stable, stable_error, corner(params))


def corner(params: Parameters) -> tuple[float, float]:
    """Return (α_p, α_u) at which stripes lose existence and stability together, dimensionless.

    Raises `InputError` where that does not happen between α_p = d_r and d_r + d_s.
    """
    check(params)

    def marginal(alpha_p: float) -> float:
        problem = EqualStripes(params.replace(alpha_p=alpha_p), 2, resolution(params))
        return problem.leading(existing_from(problem).state, WIDTHS).rate

    low, high = params.d_r, params.d_r + 0.999 * params.d_s
    if not marginal(low) < 0 < marginal(high):
        rule = "where stripes at the fold are stable for alpha_p = d_r, and unstable near d_r + d_s"
        raise InputError("mu", params.mu, rule, "choose others")
    found = float(brentq(marginal, low, high, xtol=1e-12))
    problem = EqualStripes(params.replace(alpha_p=found), 2, resolution(params))
    return found, existing_from(problem).alpha_u
