"""Four, six and more equal stripes: which of their perturbations grow, and how flow affects them.

A state of `count` stripes becomes -P when shifted by one stripe, so that its perturbations of P_z, like waves
in a crystal, gain a phase from stripe to stripe: v(θ + 2π/count) = exp(2πi b/count) v(θ), b = 0 ... count/2,
with a degenerate partner -b except at both ends. All zones move alike for b = count/2, the rotation, and
neighbouring ones oppositely for b = 0: all stripes that point up widen at the expense of all others. In
between some widen at the expense of others that point the same way.

Without flow every b but the rotation grows, count - 1 modes in all, at λ cos²(πb/count) where zones are
narrow, since each front interacts only with its neighbours. Only b = 0 changes the mean force, so only b = 0
can be stabilised by <u> = 0, above a threshold; all others grow at every α_u examined. Two stripes have none
of these. Own derivation.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from ...model.arrays import series
from ...model.doors import door
from ...model.errors import InputError, number, whole
from ...model.grid import Array
from ...model.parameters import Parameters
from ..profiles.profile import check
from .crossings import stable_from
from .equal import OWN, ROTATION, SHAPES, WIDTHS, Equal, EqualStripes
from .thresholds import SIZES, Threshold, compared, resolution

ALPHA_U = (0.0, 1e-5, 1e-4, 1e-3, 0.01, 0.03, 0.1, 0.2, 0.5, 1.0, 2.0)


@dataclass(frozen=True, eq=False)
class StripeModes:
    """Growth rates of perturbations of P_z of `count` equal stripes by α_u and phase, dimensionless.

    `growth` (alpha_u, count/2 + 1) is the largest at each b = 0 ... count/2, without the neutral rotation;
    NaN where there is no such state. `unstable` (alpha_u,) counts the phases at which a mode grows,
    b and -b as two; -1 where there is no state.
    """

    count: int
    alpha_u: Array
    growth: Array
    unstable: Array


@door
def stripe_modes(params: Parameters, count: int = 4, alpha_u: Iterable[float] = ALPHA_U) -> StripeModes:
    """Return the `StripeModes` of `count` stripes at each α_u; `params.alpha_u` is ignored.

    Raises `InputError` for counts that are not even or larger than 32.

    Example:
        >>> import cyclosis as cy
        >>> found = cy.stability.stripe_modes(cy.Parameters(alpha_p=0.3), count=4, alpha_u=[0.0, 0.5])
        >>> found.growth.shape, (found.unstable > 0).tolist()  # no flow makes four stripes stable
        ((2, 3), [True, True])
    """
    problem = _problem(params, count)
    given = series("alpha_u", alpha_u, "give numbers") if hasattr(alpha_u, "__array__") else alpha_u
    if not isinstance(given, Iterable):
        raise InputError("alpha_u", given, "a list of numbers", "give numbers")
    values = [number("alpha_u", value, 0.0, 1e3, "give numbers") for value in given]
    growth = np.full((len(values), count // 2 + 1), np.nan)
    for row, value in zip(growth, values, strict=True):
        try:
            state = problem.full(value)
        except InputError:
            continue
        row[:] = _by_phase(problem, state)
    partners = np.full(count // 2 + 1, 2)
    partners[[0, -1]] = 1
    unstable = np.where(np.isnan(growth[:, 0]), -1, (growth > 0) @ partners)
    return StripeModes(count, np.array(values), growth, unstable)


@door
def common_threshold(params: Parameters, count: int = 4) -> Threshold:
    """Return the α_u above which stripes that point up no longer widen together, b = 0.

    For two stripes it equals `threshold`; more than two remain unstable above it. `params.alpha_u` is
    ignored. Raises `InputError` as `threshold` does.

    Example:
        >>> import cyclosis as cy
        >>> params = cy.Parameters(alpha_p=0.3)
        >>> two, four = (cy.stability.common_threshold(params, count).alpha_u for count in (2, 4))
        >>> round(four, 4), two < four
        (0.0357, True)
    """
    coarse = _problem(params, count)
    fine = EqualStripes(params, count, next(size for size in SIZES if size > coarse.n))
    return compared(stable_from(coarse), stable_from(fine), fine.n)


def _problem(params: Parameters, count: int) -> EqualStripes:
    check(params)
    count = whole("count", count, 2, 32, "choose an even number of stripes")
    if count % 2:
        raise InputError("count", count, "even, because stripes alternate", "choose an even number")
    # No fewer points per stripe than two stripes would have.
    needed = max(resolution(params), 16 * count)
    return EqualStripes(params, count, next(size for size in SIZES if size >= needed))


def _by_phase(problem: EqualStripes, state: Equal) -> Array:
    """Return the largest growth rate at each phase b = 0 ... count/2, the neutral rotation left out."""
    n, count = problem.n, problem.count
    matrix = problem.applied(state.P, state.alpha_u, np.eye(n))
    m = np.arange(-(n // 2) + 1, n // 2)
    found = [max(problem.rates(state, family)[0] for family in (WIDTHS, SHAPES))]
    for b in range(1, count // 2):
        own = m[(m - b) % count == 0]
        waves = np.exp(1j * np.outer(problem.theta, own)) / np.sqrt(n)
        found.append(np.linalg.eigvals(waves.conj().T @ matrix @ waves).real.max())
    rotation = problem.rates(state, ROTATION)
    rotation = np.delete(rotation, np.argmin(np.abs(rotation)))
    found.append(max(rotation[0], problem.rates(state, OWN)[0]))
    return np.array(found)
