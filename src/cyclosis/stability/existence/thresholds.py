"""Where two equal stripes exist and where they are stable: values of α_u, each with its error.

Existence ends below α_p = d_r + d_s in a fold (`fold`). At α_p = d_r + d_s the branch ends in disorder: with
P = b sin θ the cubic force is (3/4) b³ sin θ + ... and db/dt = (3/4) [α_u/(1 + μ) - α_p] b³ + ..., which
vanishes at α_u = α_p (1 + μ). Above, the state exists for every α_u. Stability is a separate question
(`threshold`): where stripes end in a fold, the two values differ only near d_r + d_s. `crossings` finds them
on one grid; here they are found on two, and the error is the difference plus the rounding error.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...display.shown import shown
from ...model.doors import door
from ...model.errors import InputError, flag, number, whole
from ...model.parameters import Parameters
from ...model.wording import beside
from ..profiles.profile import check
from . import stable_range as window
from .crossings import Found, existing_from, stable_from
from .equal import EqualStripes

SIZES = (128, 192, 256, 384, 512, 768, 1024, 1536, 2048)
"""Numbers of points around the cell; the error comes from a comparison with the next."""
POINTS = 32.0
"""Points needed per turn, for each zone width (2 d_s/a)^½ per radian: P is then accurate to about 1e-11."""


@shown
@dataclass(frozen=True)
class Threshold:
    """The α_u above which two stripes exist, or are stable, and the error of this value, dimensionless.

    `cause` says what grows, or what ends, below it; `n_theta` is the finer number of points.

    Example:
        >>> import cyclosis as cy
        >>> found = cy.stability.threshold_with_error(cy.Parameters(alpha_p=0.15))
        >>> found.cause, round(found.alpha_u, 6), found.error < 1e-6 * found.alpha_u
        ('stripes of unequal widths', 0.001596, True)
    """

    alpha_u: float
    error: float
    cause: str
    n_theta: int

    def __float__(self) -> float:
        return self.alpha_u


@door
def threshold(
    params: Parameters, full: bool = False, length: float = 5.0, n_theta: int | None = None
) -> float:
    """Return α_u*, the least α_u above which the two-stripe state is stable at `params.alpha_p`.

    Stable against perturbations of P_z that do not vary along the cell; with `full` against all, of both
    components and with any number of waves along a cell of the given length. `params.alpha_u` is ignored.
    `n_theta` is chosen by the width of the zones unless given. Dimensionless.

    Where the state appears in a fold and is stable from there on, it is the fold. Raises `InputError`
    where zones are too narrow to be resolved, and with `full` where the state is never stable.

    Example:
        >>> import cyclosis as cy
        >>> [round(cy.stability.threshold(cy.Parameters(alpha_p=x)), 6) for x in (0.1, 0.15, 0.3)]
        [0.007472, 0.001596, 4.1e-05]
    """
    return threshold_with_error(params, full, length, n_theta).alpha_u


@door
def threshold_with_error(
    params: Parameters, full: bool = False, length: float = 5.0, n_theta: int | None = None
) -> Threshold:
    """Return the `Threshold` of stability; arguments and errors are those of `threshold`.

    Example:
        >>> import cyclosis as cy
        >>> found = cy.stability.threshold_with_error(cy.Parameters(alpha_p=0.1))
        >>> round(found.alpha_u, 5), found.error < 1e-8
        (0.00747, True)
    """
    coarse, fine = _problems(params, n_theta)
    lowest = stable_from(coarse)
    if flag("full", full):
        bracket = window.opening(coarse, lowest, length)
        if bracket is not None:
            return compared(window.zero(coarse, bracket), window.zero(fine, bracket), fine.n)
    return compared(lowest, stable_from(fine), fine.n)


@door
def fold(params: Parameters) -> float:
    """Return the α_u at which the branch of two stripes ends, at `params.alpha_p` <= d_r + d_s.

    Below it there is no such state of any amplitude. At α_p = d_r + d_s, for the cubic force, it is the
    pitchfork α_p (1 + μ). `params.alpha_u` is ignored. Raises `InputError` for larger α_p, where the
    branch does not end.

    Example:
        >>> import cyclosis as cy
        >>> round(cy.stability.fold(cy.Parameters(alpha_p=0.05, mu=0.05)), 6)  # α_p (1 + μ) at d_r + d_s
        0.0525
        >>> round(cy.stability.fold(cy.Parameters(alpha_p=0.04)), 4)
        0.1138
    """
    return fold_with_error(params).alpha_u


@door
def fold_with_error(params: Parameters) -> Threshold:
    """Return the `Threshold` of existence; arguments and errors are those of `fold`.

    Example:
        >>> import cyclosis as cy
        >>> found = cy.stability.fold_with_error(cy.Parameters(alpha_p=0.04))
        >>> found.cause, round(found.alpha_u, 4), found.error < 1e-8
        ('a fold of the branch', 0.1138, True)
    """
    coarse, fine = _problems(params, None)
    onset = params.d_r + params.d_s
    if params.alpha_p > onset * (1 + 1e-12):
        most = beside(onset, float(params.alpha_p))
        rule = f"at most d_r + d_s = {most}, since above it two stripes exist for every alpha_u"
        raise InputError("alpha_p", params.alpha_p, rule, "lower it, or call threshold for stability")
    at_onset = params.alpha_p >= onset * (1 - 1e-12)
    if params.force_exponent == 0 or (params.force_exponent == 2 and at_onset):
        # A linear force makes stripes of infinitesimal order.
        ends = (1 + params.mu) * (params.alpha_p if params.force_exponent else onset - params.alpha_p)
        return Threshold(float(ends), 4e-16 * float(ends), "a pitchfork from disorder", fine.n)
    return compared(existing_from(coarse), existing_from(fine), fine.n)


@door
def destabilised(
    params: Parameters, length: float = 5.0, start: float | None = None, most: float = 10.0
) -> Threshold | None:
    """Return where two stripes lose stability again as α_u grows, against all perturbations.

    The search begins at `start`, where they must be stable (default: just above the full threshold), and
    ends at `most` with None if they still are. Raises `InputError` as `threshold` does, and if the stripes
    are not stable at `start`.

    Example:
        >>> import cyclosis as cy
        >>> found = cy.stability.destabilised(cy.Parameters(alpha_p=0.3), start=0.4, most=0.5)
        >>> found is None  # stable throughout
        True
    """
    coarse, fine = _problems(params, None)
    most = number("most", most, 1e-6, 1e3, "the default is 10")
    # Slightly above a threshold the rate that vanishes there can be distinguished from zero.
    begin = 1.001 * threshold(params, True, length) + 1e-6 if start is None else start
    begin = number("start", begin, 0.0, most, "choose a smaller one")
    bracket = window.closing(coarse, begin, most, length)
    if bracket is None:
        return None
    return compared(window.zero(coarse, bracket), window.zero(fine, bracket), fine.n)


def resolution(params: Parameters) -> int:
    """Return a number of points that resolves the zones between two stripes at small α_u.

    Raises `InputError` where that is more than 1536.
    """
    drive = max(params.alpha_p - params.d_r, params.d_s)
    needed = POINTS * np.sqrt(drive / (2 * params.d_s)) if params.d_s > 0 else np.inf
    for size in SIZES[:-1]:
        if size >= needed:
            return size
    least = 0.5 * drive * (POINTS / SIZES[-2]) ** 2
    enough = beside(float(least), params.d_s, 3)
    rule = f"at least {enough} at this alpha_p, so that {SIZES[-2]} points resolve the zones"
    raise InputError("d_s", params.d_s, rule, "raise it, or use front_threshold")


def _problems(params: Parameters, n_theta: int | None) -> tuple[EqualStripes, EqualStripes]:
    check(params)
    if n_theta is None:
        first = resolution(params)
        second = next(size for size in SIZES if size > first)
    else:
        first = whole("n_theta", n_theta, 32, 1536, "choose a number of points, or leave it out")
        second = first + 2 * (first // 4)
    return EqualStripes(params, 2, first), EqualStripes(params, 2, second)


def compared(coarse: Found, fine: Found, n: int) -> Threshold:
    """Return the `Threshold` that two grids give, the finer of n points."""
    error = abs(coarse.alpha_u - fine.alpha_u) + max(coarse.rounding, fine.rounding)
    return Threshold(fine.alpha_u, float(error), fine.cause, n)
