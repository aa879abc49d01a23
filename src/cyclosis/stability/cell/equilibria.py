"""Steady and steadily moving states of the whole cell, by Newton's method on a simulation's right-hand side.

The unknowns are P and the drift c in

    dP/dt + c·∇P = 0 :

a state that moves at velocity c without changing. Along each direction in which P varies, its position is
fixed by requiring every step to be orthogonal to the shift, and c has a component; a helix, which a shift
along it leaves unchanged, has one direction and not two. On a closed surface c is an angular velocity, and
shifts are rotations about its axis, or any axis of a sphere. The linear equations are solved by GMRES,
matrix-free.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from ...closed.grid import ClosedGrid
from ...closed.system import PRINCIPAL
from ...display.shown import shown
from ...model.doors import door
from ...model.errors import InputError
from ...model.filaments import TermLike
from ...model.grid import Array, CylinderGrid
from ...model.parameters import Parameters
from ...model.wording import beside
from ...models import polar
from .krylov import solve
from .linearised import VARIES, WholeCell
from .whole import whole_cell

TOLERANCE = 1e-11
"""Root mean square of dP/dt + c·∇P below which a state counts as found; rounding leaves about 1e-15."""
ITERATIONS = 30
LONGEST = 0.3
"""Root mean square length of the longest step, which keeps Newton's method near its guess."""
ACCURACY = 1e-4
"""Relative residual of the linear equations."""
SHORTEST = 1.0 / 64
"""Least fraction of a step that is tried where the whole step does not lower the residual."""
RELAXATIONS = (0.0, 10.0, 100.0)
"""Times for which a guess is simulated before Newton's method is tried, one after the other."""
DISORDER = 1e-5
"""A state with no larger <|P|²>^½ counts as disorder."""
STRONG, ALIKE = 0.1, 0.5
"""Relative variation of a guess along an axis that must persist, and least correlation with the guess."""


@shown
@dataclass(frozen=True, eq=False)
class SteadyState:
    """A steady state, or one that moves without changing, dimensionless.

    `state` P (2, n_theta, n_z); `drift` its velocity (theta, z), or on a closed surface its angular velocity
    (x, y, z), zero along directions in which it does not vary; `residual` <|dP/dt + c·∇P|²>^½; `tail` the
    amplitude beyond two thirds of the resolved wavenumbers over that of all, a measure of how well the grid
    resolves it; `iterations` of Newton's method; `relaxed` the time for which the guess was simulated before
    them.

    Example:
        >>> import cyclosis as cy
        >>> params, grid = cy.Parameters(), cy.CylinderGrid(16, 16)
        >>> found = cy.stability.steady_state(params, grid, cy.initial.unidirectional(grid))
        >>> found.state.shape, found.residual < 1e-9, found.drift.tolist()
        ((2, 16, 16), True, [0.0, 0.0])
    """

    state: Array
    drift: Array
    residual: float
    tail: float
    iterations: int
    relaxed: float
    params: Parameters
    grid: CylinderGrid | ClosedGrid


@door
def steady_state(
    params: Parameters,
    grid: CylinderGrid | ClosedGrid,
    guess: npt.ArrayLike,
    *,
    terms: Iterable[TermLike] | None = None,
    dealias: str = "none",
    repulsion: str = PRINCIPAL,
) -> SteadyState:
    """Return the steady or steadily moving state next to a guess P (2, n_theta, n_z), or (2, n_theta, n_s).

    It solves the equations that `simulate` integrates with the same `terms` and `dealias`, on a closed
    surface with that form of `repulsion` (see `cyclosis.models.closed_model`), to rounding, and may be stable
    or unstable. Newton's method starts from the guess and, where that fails, from the result of a short
    simulation of it. Raises `InputError` for input that does not match, for custom terms, and where no state
    of the guess's kind is found: disorder or a uniform state is never returned for a guess of stripes.

    Example:
        >>> import cyclosis as cy
        >>> params, grid = cy.Parameters(alpha_p=1.0, d_r=0.025), cy.CylinderGrid(16, 16)
        >>> found = cy.stability.steady_state(params, grid, cy.initial.unidirectional(grid, 0.9))
        >>> round(float(found.state[1].mean()), 6), round((1 - 0.025) ** 0.5, 6)
        (0.987421, 0.987421)
    """
    P = grid.check_state(guess, "guess", bounded=True)
    problem = whole_cell(params, grid, terms, dealias, repulsion)
    sought = problem.vector(P)
    begin, passed, verdict = sought, 0.0, ""
    for time in RELAXATIONS:
        begin, passed = (problem.relaxed(begin, time - passed) if time > passed else begin), time
        found, drift, residual, iterations = _newton(problem, begin)
        stalled = residual > TOLERANCE
        verdict = f"stalled at |dP/dt| = {residual:.0e}" if stalled else _unlike(problem, found, sought)
        if not verdict:
            tail = problem.tail(found)
            return SteadyState(problem.state(found), drift, residual, tail, iterations, time, params, grid)
    rule = f"near a steady or steadily moving state of its kind, but Newton's method {verdict}"
    raise InputError("guess", P, rule, "simulate it for longer first, or change the parameters")


def _newton(problem: WholeCell, begin: Array) -> tuple[Array, Array, float, int]:
    """Return the state, its drift, its residual, and the number of steps."""
    vector, drift = begin, np.zeros(len(problem.free))
    for done in range(ITERATIONS + 1):
        directions = problem.directions(vector)
        drift = directions.T @ (directions @ drift)
        residual = problem.rate(vector) + drift @ problem.slopes(vector)
        size = float(np.linalg.norm(residual))
        if size <= TOLERANCE or done == ITERATIONS:
            break
        step, faster = _step(problem, vector, drift, residual, directions)
        fraction = min(1.0, LONGEST / max(float(np.linalg.norm(step)), 1e-300))
        while not _lower(problem, vector + fraction * step, drift + fraction * faster, size, fraction):
            fraction *= 0.5
            if fraction < SHORTEST:
                return vector, drift, size, done
        vector, drift = vector + fraction * step, drift + fraction * faster
    return vector, drift, size, done


def _step(
    problem: WholeCell, vector: Array, drift: Array, residual: Array, directions: Array
) -> tuple[Array, Array]:
    """Return Newton's step of state and drift, the step of the state orthogonal to the shifts."""
    shifts = directions @ problem.slopes(vector)
    lengths = np.linalg.norm(shifts, axis=1)
    operator = problem.linearised(vector, drift)
    step, faster = solve(
        operator, 0.0, problem.local, shifts / lengths[:, None], -residual, np.zeros(lengths.size), ACCURACY
    )
    return step, directions.T @ (faster / lengths)


def _lower(problem: WholeCell, vector: Array, drift: Array, size: float, fraction: float) -> bool:
    """Return whether a fraction of a step lowers the residual by a fair part of the linear prediction."""
    after = problem.rate(vector) + drift @ problem.slopes(vector)
    return bool(np.linalg.norm(after) < (1 - 0.25 * fraction) * size)


def _unlike(problem: WholeCell, found: Array, sought: Array) -> str:
    """Return how a state differs in kind from the one sought, or ""."""
    size, aim = (float(np.linalg.norm(v)) for v in (found, sought))
    if size <= DISORDER:
        return "ended at disorder" if aim > DISORDER else ""
    largest = float(np.hypot(*problem.state(found)).max())
    if largest > polar.bound:
        return f"ended at a state with |P| = {beside(largest, 1.0, 3)}, beyond 1"
    now, then = problem.variation(found), problem.variation(sought)
    for axis in then:
        if then[axis] > STRONG and now[axis] < VARIES:
            return f"ended at a state that is uniform along {axis}"
    if problem.alike(found, sought) < ALIKE * size * aim:
        return "ended at a state of another pattern"
    return ""
