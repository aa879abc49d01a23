"""Which named states exist at a parameter point, and which of them are stable, without a simulation.

Uniform states are found in closed form, stripes by Newton's method: two equal ones, two tilted ones that
rotate, and uneven order, with more of it upward than downward, which the unidirectional state reaches where
it breaks into stripes and equal ones do not exist. Each is stable if every perturbation of the whole cell
decays, at all wavenumbers around and along the cell.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..model.doors import door
from ..model.errors import InputError, number
from ..model.grid import Array, CylinderGrid
from ..model.parameters import Parameters
from .branches.points import NEUTRAL
from .existence.equal import EqualStripes
from .existence.fastest_growing import LONGEST_CELL, Perturbations, waves_in_words
from .existence.thresholds import resolution
from .profiles.reduced import reduced
from .profiles.slowest import cutoff, decays, leading, most_waves
from .profiles.steady import relax, steady
from .profiles.travelling import LENGTH, drifting
from .uniform.dispersion import growth_rates, stripes_threshold
from .uniform.uniform import orders

STATES = ("disordered", "unidirectional", "uneven", "cyclosis", "tilted", "circumferential")
"""The states sought; "tilted" are two stripes with a mean P_theta, which rotate about the axis."""
UNIFORM = {
    "disordered": "disorder",
    "unidirectional": "unidirectional",
    "circumferential": "circumferential",
}
POINTS = 96
"""Points around the cell for tilted and uneven stripes, whose zones are wider than those of equal ones."""
SMALL = 0.03
"""Mean of P_z, relative to unidirectional order, below which stripes are not uneven."""
UNEVEN, DURATION = (0.6, 0.4), 3000.0
"""Mean and wave, relative to unidirectional order, of a guess of uneven order, and the time for which it is
integrated: it may oscillate."""
SUBCRITICAL = 0.7
"""Uneven order is sought from this multiple of the α_u at which the unidirectional state breaks up."""


class Standing(NamedTuple):
    """The status of a state at a parameter point: whether it `exists`, is `stable`, and what grows if not."""

    exists: bool
    stable: bool
    cause: str


ABSENT = Standing(False, False, "there is no such state")


@door
def states(params: Parameters, length: float = LENGTH) -> dict[str, Standing]:
    """Return the `Standing` of each of `STATES` in a cell of a length (dimensionless, in radii).

    Stripes are those to which full order relaxes, tilted ones those to which a standard guess does. Raises
    `InputError` for fields, an oblique d, and lengths that are not above 0 and at most 200.

    Example:
        >>> import cyclosis as cy
        >>> found = cy.stability.states(cy.Parameters(alpha_p=0.02, d_r=0.025, alpha_u=0.01))
        >>> [name for name, standing in found.items() if standing.stable]
        ['disordered']
        >>> found["cyclosis"]
        Standing(exists=False, stable=False, cause='there is no such state')
    """
    length = number("length", length, 1e-6, LONGEST_CELL, "choose another length")
    found = {name: _uniform(params, base, length) for name, base in UNIFORM.items()}
    found["cyclosis"] = _upright(params, length)
    found["tilted"] = _tilted(params, length)
    found["uneven"] = _uneven(params, length) if _breaks(params) else ABSENT
    return {name: found[name] for name in STATES}


def _uniform(params: Parameters, base: str, length: float) -> Standing:
    roots = orders(params, base).size
    if roots == 0:
        return ABSENT
    m = np.arange(most_waves(params, 1.0) + 1.0)[:, None]
    j = np.arange(most_waves(params, 2 * np.pi / length) + 1.0)
    # With d along an axis, waves of negative number grow as their mirror images do.
    each = [_grown(params, base, m, j, length, root) for root in range(roots)]
    return next((standing for standing in each if standing.stable), each[0])


def _grown(params: Parameters, base: str, m: Array, j: Array, length: float, root: int) -> Standing:
    rates = growth_rates(params, base, m, 2 * np.pi / length * j, root)[..., 0].real
    worst = np.unravel_index(int(np.argmax(rates)), rates.shape)
    if rates[worst] <= NEUTRAL:
        return Standing(True, True, "")
    around, along = int(m[worst[0], 0]), int(j[worst[1]])
    if around == along == 0:
        return Standing(True, False, "a uniform perturbation")
    cause = "one wave around the axis" if around == 1 else f"{around} waves around the axis"
    if along:
        cause = waves_in_words(along) if not around else f"{cause}, {waves_in_words(along)}"
    return Standing(True, False, cause)


def _upright(params: Parameters, length: float) -> Standing:
    problem = EqualStripes(params, 2, resolution(params))
    try:
        state = problem.full(float(params.alpha_u))
    except InputError:
        return ABSENT
    grown = Perturbations(problem, state, length).growing()
    return Standing(True, grown is None, "" if grown is None else grown.cause)


def _tilted(params: Parameters, length: float) -> Standing:
    try:
        state = drifting(params, POINTS)
    except InputError:
        return ABSENT
    return _moving(params, length, state.P.ravel(), state.drift)


def _breaks(params: Parameters) -> bool:
    """Return whether there is a unidirectional state that breaks into stripes here or not far above."""
    if orders(params, "unidirectional").size == 0:
        return False
    return bool(params.alpha_u > SUBCRITICAL * stripes_threshold(params))


def _uneven(params: Parameters, length: float) -> Standing:
    problem = reduced(params, CylinderGrid(POINTS, 8, length))
    order = orders(params, "unidirectional")[0]
    theta = problem.turn / POINTS * np.arange(POINTS)
    began = np.concatenate([np.zeros(POINTS), order * (UNEVEN[0] + UNEVEN[1] * np.cos(theta))])
    found = steady(problem, relax(problem, began, DURATION).y)
    if found is None or found.uniform or abs(found.y[POINTS:].mean()) < SMALL * order:
        return ABSENT
    return _moving(params, length, found.y, found.drift)


def _moving(params: Parameters, length: float, y: Array, drift: float) -> Standing:
    """Return the `Standing` of a state y (2n,) that drifts about the axis, or is at rest."""
    waves = most_waves(params, 2 * np.pi / length)
    problem = reduced(params, CylinderGrid(POINTS, max(8, 2 * waves + 2), length))
    largest, turning = cutoff(params), drift * problem.derivative
    along = leading(problem.jacobian(y) + turning, problem.k, largest, problem.slope(y))
    if along[0].real > NEUTRAL:
        return Standing(True, False, "a change of shape")
    for j in range(1, waves + 1):
        matrix = problem.waves(y, j) + turning
        if decays(matrix):
            if params.mu * (j * problem.wavenumber) ** 2 > 1:
                break
        elif leading(matrix, problem.k, largest)[0].real > NEUTRAL:
            return Standing(True, False, waves_in_words(j))
    return Standing(True, True, "")
