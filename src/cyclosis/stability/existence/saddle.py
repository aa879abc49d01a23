"""Two stripes of unequal widths: the saddle between equal stripes and the unidirectional state.

Without flow, stripes of unequal widths are not steady: the wider grows at the expense of the other, though
exponentially slowly. Flow with <u> = 0 pushes the zones back towards equal widths, by a force proportional
to the difference, while the attraction of two zones grows exponentially as they approach each other. So for
α_u above the threshold α_u* of `thresholds` there is one width of the narrow stripe at which the two balance:
from a larger width stripes become equal, from a smaller one the narrow stripe disappears. The branch of these
states leaves equal stripes at α_u*, and ends in the unidirectional state where that breaks into stripes,
`stripes_threshold`. Near its end the narrow stripe is only a dip in P, without zones.

The mean <P> is the branch's coordinate m, from 0 to P0. The state is even about the middle of a stripe, so
it is sought among cosines, where there is no neutral rotation: unknowns P and α_u, equations dP/dt = 0
and <P> = m.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq

from ...analysis.zones import zone_angles
from ...model.doors import door
from ...model.errors import InputError, whole
from ...model.grid import Array, CylinderGrid, interpolate
from ...model.parameters import Parameters
from ...model.system import flow, rate_of_change
from ...model.wording import beside
from ..profiles.profile import UNRESOLVED, Profile, check
from ..uniform.dispersion import unidirectional_order
from .crossings import Found, stable_from
from .equal import WIDTHS, Equal, EqualStripes
from .fastest_growing import CAUSES
from .thresholds import resolution

MEANS = np.concatenate([[0.03], np.linspace(0.05, 0.99, 48), [0.995]])
"""Means of the states of a branch beyond the first, relative to that of the unidirectional state."""
STEPS = 40
CLOSE = 1e-9
"""Largest change of P in a step of Newton's method after which a further step would only be rounding."""


@dataclass(frozen=True, eq=False)
class UnequalBranch:
    """The states of unequal widths, from equal stripes to the unidirectional state, dimensionless.

    Arrays (states,): `alpha_u`; `mean`, <P>; `width`, that of the narrow stripe as a fraction of the turn,
    0 where P has no zones; `lowest`, the least P; `growth`, the growth rate of P_z that makes it a saddle;
    and `P` (states, n_theta) at `theta` (n_theta,), the middle of the narrow stripe at π. The first state is
    that of equal stripes at their threshold, where `growth` is 0.
    """

    theta: Array
    alpha_u: Array
    mean: Array
    width: Array
    lowest: Array
    growth: Array
    P: Array


@door
def unequal_branch(params: Parameters) -> UnequalBranch:
    """Return the states of two stripes of unequal widths at `params.alpha_p`, each at its α_u.

    Raises `InputError` where there is no such branch: somewhat below d_r + d_s equal stripes appear in a
    fold, stable from there on, and no states of unequal widths branch off.

    Example:
        >>> import cyclosis as cy
        >>> found = cy.stability.unequal_branch(cy.Parameters(alpha_p=0.15))
        >>> found.P.shape == (found.alpha_u.size, found.theta.size), round(float(found.width[0]), 4)
        (True, 0.5)
        >>> bool(found.width[5] < 0.5), bool(found.growth[5] > 0)
        (True, True)
    """
    check(params)
    even = _Even(params)
    points = [even.began]
    for mean in MEANS:
        points.append(even.at_mean(mean * even.order, points))
    P = np.stack([point.P for point in points])
    width = np.array([_narrow(values) for values in P])
    growth = np.array([0.0] + [even.growth(point) for point in points[1:]])
    alpha_u = np.array([point.alpha_u for point in points])
    theta = CylinderGrid(even.problem.n, 8).theta
    return UnequalBranch(theta, alpha_u, P.mean(axis=1), width, P.min(axis=1), growth, P)


@door
def unequal(params: Parameters, n_theta: int = 256) -> Profile:
    """Return the steady state of two stripes of unequal widths, the narrow one pointing down.

    It is a saddle: stripes of widths less unequal than its `widths` become equal; of others the narrow one
    disappears. Raises `InputError` where no such state has two zones: below the threshold of stability, where
    any difference of widths grows, and far above it, where the narrow stripe has become a mere dip.

    Example:
        >>> import cyclosis as cy
        >>> state = cy.stability.unequal(cy.Parameters(alpha_p=0.3, alpha_u=0.1))
        >>> bool(state.widths[1] < 0.5 < state.widths[0]), round(float(state.widths.sum()), 6)
        (True, 1.0)
    """
    n = whole("n_theta", n_theta, 32, 2048, "choose a number of points")
    check(params)
    even, target = _Even(params), float(params.alpha_u)
    if target <= even.began.alpha_u:
        least = beside(even.began.alpha_u, target, 4)
        rule = f"above the threshold {least}, below which unequal widths are not steady"
        raise InputError("alpha_u", target, rule, "raise it")
    near = [even.began]
    for mean in MEANS:
        near = [*near[-1:], even.at_mean(mean * even.order, near)]
        if near[-1].alpha_u > target:
            return _profile(params, _between(even, near, target), n)
        if _narrow(near[-1].P) == 0:
            break
    last = near[-1].alpha_u
    most = beside(last, target, 3)
    rule = f"below about {most}, above which the narrow stripe is only a dip without zones"
    raise InputError("alpha_u", target, rule, "lower it")


class _Even:
    """The states even about the middle of the narrow stripe, at π, with the mean as their coordinate."""

    def __init__(self, params: Parameters) -> None:
        self.problem = EqualStripes(params, 2, resolution(params))
        n = self.problem.n
        waves = np.cos(np.outer(self.problem.theta, np.arange(n // 2)))
        self.basis = waves / np.linalg.norm(waves, axis=0)
        self.order = float(unidirectional_order(params))
        threshold = stable_from(self.problem)
        if threshold.cause != CAUSES[WIDTHS] or not np.isfinite(self.order):
            rule = "where equal stripes lose stability to unequal widths, and here they end in a fold instead"
            raise InputError("alpha_p", params.alpha_p, rule, "raise it")
        self.began = self._turned(threshold)

    def at_mean(self, mean: float, near: list[Equal]) -> Equal:
        """Return the state of a mean, from nearby ones; raises `InputError` if none is found."""
        P, alpha_u = self._guess(mean, near)
        size = self.basis.shape[1]
        average = np.full(P.size, 1 / P.size) @ self.basis
        for _ in range(STEPS):
            bordered = np.zeros((size + 1, size + 1))
            bordered[:size, :size] = self.basis.T @ self.problem.applied(P, alpha_u, self.basis)
            bordered[:size, size] = self.basis.T @ self.problem.drive(P, alpha_u)
            bordered[size, :size] = average
            wrong = np.append(self.basis.T @ self.problem.rate(P, alpha_u), P.mean() - mean)
            change = np.linalg.solve(bordered, wrong)
            P, alpha_u = P - self.basis @ change[:size], alpha_u - float(change[size])
            if not np.all(np.isfinite(P)) or np.abs(P).max() > 2:
                break
            if np.abs(self.basis @ change[:size]).max() < CLOSE:
                return Equal(P, alpha_u)
        rule = f"where stripes of unequal widths can be continued, and at <P> = {mean:.3g} they cannot"
        raise InputError("the parameter point", self.problem.point, rule, "raise alpha_p")

    def growth(self, point: Equal) -> float:
        """Return the largest growth rate of P_z apart from that of the rotation, which is odd."""
        matrix = self.basis.T @ self.problem.applied(point.P, point.alpha_u, self.basis)
        return float(np.linalg.eigvals(matrix).real.max())

    def _guess(self, mean: float, near: list[Equal]) -> tuple[Array, float]:
        last = near[-1]
        if len(near) == 1:
            # Beside equal stripes: their marginal mode, which has a mean.
            matrix = self.basis.T @ self.problem.applied(last.P, last.alpha_u, self.basis)
            values, vectors = np.linalg.eig(matrix)
            mode = self.basis @ vectors[:, np.argmin(np.abs(values))].real
            return last.P + mode * (mean / mode.mean()), last.alpha_u
        before = near[-2]
        share = (mean - last.P.mean()) / (last.P.mean() - before.P.mean())
        # α_u covers many decades, so that its logarithm is extrapolated.
        ratio = max(last.alpha_u / before.alpha_u, 1e-3)
        return last.P + share * (last.P - before.P), last.alpha_u * ratio**share

    def _turned(self, threshold: Found) -> Equal:
        """Return equal stripes with the middle of the one that points down at π."""
        return Equal(np.roll(threshold.state.P, -(self.problem.n // 4)), threshold.alpha_u)


def _narrow(P: Array) -> float:
    """Return the fraction of the turn on which P < 0."""
    zones = zone_angles(P)
    return float((zones[1] - zones[0]) / (2 * np.pi)) if zones.size == 2 else 0.0


def _between(even: _Even, near: list[Equal], target: float) -> Array:
    """Return P of the state at an α_u between those of two others."""
    first, last = (float(point.P.mean()) for point in near)
    span = last - first

    def excess(share: float) -> float:
        if share == 0:
            return float(np.log(near[0].alpha_u / target))
        return float(np.log(even.at_mean(first + share * span, near).alpha_u / target))

    share = float(brentq(excess, 0.0, 1.0, xtol=1e-13))
    return even.at_mean(first + share * span, near).P


def _profile(params: Parameters, P: Array, n: int) -> Profile:
    """Return the `Profile` on n points of a state with the middle of its narrow stripe at π."""
    zones = zone_angles(P)
    if zones.size != 2:
        rule = "smaller, so that P has two zones: here the narrow stripe is only a dip"
        raise InputError("alpha_u", params.alpha_u, rule, "lower it")
    m = np.fft.rfftfreq(P.size, 1 / P.size)
    turned = np.fft.irfft(np.fft.rfft(P) * np.exp(1j * m * zones[1]), P.size)
    found = []
    values = turned[:, None]
    for size in (n, 2 * n):
        # The second time from the n points themselves, to test how well they resolve the state.
        values = interpolate(values, (size, 1))
        grid = CylinderGrid(size, 8)
        state = np.zeros((2, *grid.shape))
        state[1] = values
        found.append((grid, state))
    residual = float(np.abs(rate_of_change(params, *found[1])).max())
    if residual > UNRESOLVED:
        rule = f"enough to resolve the zones between stripes (|dP/dt| is {residual:.1g} between points)"
        raise InputError("n_theta", n, rule, "double it")
    grid, state = found[0]
    P, u = state[1, :, 0], flow(params, grid, state)[1, :, 0]
    gradient = float(np.mean(np.abs(P) ** params.force_exponent * P))
    return Profile(grid.theta, P, u, gradient, residual, params, 2)
