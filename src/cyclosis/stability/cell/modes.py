"""The leading modes of the linearised cell, matrix-free.

About a steady or steadily moving state P small perturbations obey dv/dt = J v, J the derivative of
dP/dt + c·∇P. Its eigenvalues with the largest real parts are found in two stages:

* Block Arnoldi: a few vectors are repeatedly evolved in time by the linearised equation. The space they span
  contains the modes that grow fastest or decay most slowly, real or complex, single or multiple.
* Newton's method: on the space X of the best Ritz vectors J is a small matrix. For each of its eigenvalues θ
  with residual r, (J - θ) t + X y = -r, Xᵀ t = 0 is solved by GMRES, t is added to X, and so on. The error
  is squared each time, down to rounding; the time stepping of the first stage does not affect the result.

A shift of a state that varies is a mode whose eigenvalue is 0 as exactly as the grid resolves the state.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
import scipy.linalg

from ...closed.grid import ClosedGrid
from ...closed.system import PRINCIPAL
from ...display.shown import shown
from ...model.doors import door
from ...model.errors import InputError, whole
from ...model.filaments import TermLike
from ...model.grid import Array, CylinderGrid
from ...model.parameters import Parameters
from .equilibria import SteadyState
from .krylov import solve, times
from .linearised import Linearised, WholeCell
from .whole import whole_cell

Complex = npt.NDArray[np.complex128]

SPARE, DEPTH, STEPS = 6, 4, 24
"""Vectors beyond those requested, blocks of a Krylov space, and time steps between them."""
SLOWEST = 0.5
"""Time steps are 1 over the fastest rate apart from diffusion, or over this if it is larger."""
CYCLES, ROUGH = 40, 0.03
"""Most Krylov spaces, and the residual, relative to the rate and to 1, at which Newton's method begins."""
ROUNDS, FINE = 6, 1e-11
"""Most rounds of Newton's method, and the residual <|J v - λ v|²>^½ of modes of size 1 at which it ends."""
ACCURACY = 1e-4
"""Relative residual of the linear equations."""
ACCEPTED = 1e-8
"""Modes with a larger residual are refused."""
STEADY = 1e-6
"""Root mean square of dP/dt + c·∇P, relative to P, above which a state does not count as steady."""


@shown
@dataclass(frozen=True, eq=False)
class CellModes:
    """Modes v e^{λt} of small perturbations of a state that moves at `drift`, dimensionless.

    `drift` is (2,), or on a closed surface an angular velocity (3,); `eigenvalues` λ (count,), the largest
    real part first; `modes` v (count, 2, n_theta, n_z), complex, with <|v|²> = 1, as real as a phase can make
    them; `residuals` <|J v - λ v|²>^½ (count,); `shifts` (count,) the share of each mode in the space of
    shifts, or of rotations: near 1 for a neutral one, but also large for some that decay. Perturbations are
    the real parts of v e^{λt}, seen from a frame that moves with the state. In the discretised equations λ of
    a shift is zero only as far as the grid resolves the state, and so measures how well it does; with
    `dealias = "full"` it is zero to rounding, as it always is about the axis of a closed cell.

    Example:
        >>> import cyclosis as cy
        >>> params, grid = cy.Parameters(alpha_p=0.1), cy.CylinderGrid(16, 16)
        >>> state = cy.stability.steady_state(params, grid, cy.initial.unidirectional(grid))
        >>> found = cy.stability.leading_modes(params, grid, state, count=2)
        >>> found.eigenvalues.shape, found.modes.shape, bool(found.residuals.max() < 1e-6)
        ((2,), (2, 2, 16, 16), True)
    """

    eigenvalues: Complex
    modes: Complex
    residuals: Array
    shifts: Array
    drift: Array
    grid: CylinderGrid | ClosedGrid


@door
def leading_modes(
    params: Parameters,
    grid: CylinderGrid | ClosedGrid,
    state: SteadyState | npt.ArrayLike,
    count: int = 6,
    *,
    terms: Iterable[TermLike] | None = None,
    dealias: str = "none",
    repulsion: str = PRINCIPAL,
) -> CellModes:
    """Return the `count` modes of largest growth rate about a steady or steadily moving state.

    `state` is P (2, n_theta, n_z), or what `steady_state` returned; `terms`, `dealias` and, on a closed
    surface, `repulsion` are those under which it is steady. Conjugate modes count as two, and so do different
    modes with the same eigenvalue. Raises `InputError` for input that does not match, for a state that is
    neither steady nor moves without changing, and where the modes are not found.

    Example:
        >>> import cyclosis as cy
        >>> params, grid = cy.Parameters(alpha_u=0.4, kappa=0.4, d_r=0.025), cy.CylinderGrid(16, 16)
        >>> state = cy.stability.steady_state(params, grid, cy.initial.unidirectional(grid))
        >>> found = cy.stability.leading_modes(params, grid, state, count=1)
        >>> found.eigenvalues.real.round(6)  # all filaments tilt back at α_u P0² - κ
        array([-0.01])
    """
    P = grid.check_state(state.state if isinstance(state, SteadyState) else state)
    problem = whole_cell(params, grid, terms, dealias, repulsion)
    count = whole("count", count, 1, min(64, problem.size // 32), "ask for fewer modes")
    vector = problem.vector(P)
    drift = _drift(problem, vector, P)
    operator = problem.linearised(vector, drift)
    values, vectors, residuals = _refined(operator, _rough(operator, problem, count), problem.local, count)
    if residuals.max() > ACCEPTED:
        rule = f"a number of modes that separate from the next (residual {residuals.max():.0e})"
        raise InputError("count", count, rule, "choose more or fewer modes")
    shifts = _share(vectors, problem.directions(vector) @ problem.slopes(vector))
    fields = np.stack([_field(problem, v) for v in vectors])
    return CellModes(values, fields, residuals, shifts, drift, grid)


def _drift(problem: WholeCell, vector: Array, P: Array) -> Array:
    """Return the velocity at which a state moves, or refuse a state that changes in another way."""
    directions = problem.directions(vector)
    shifts = directions @ problem.slopes(vector)
    rate = problem.rate(vector)
    speeds = np.linalg.lstsq(shifts.T, -rate, rcond=None)[0] if len(shifts) else np.zeros(0)
    change = float(np.linalg.norm(rate + speeds @ shifts))
    if change > STEADY * max(float(np.linalg.norm(vector)), 1.0):
        rule = f"steady or moving without change, not with a remaining |dP/dt| of {change:.1g}"
        raise InputError("state", P, rule, "find it with steady_state first")
    return np.asarray(directions.T @ speeds, dtype=np.float64)


def _rough(operator: Linearised, problem: WholeCell, count: int) -> Array:
    """Return orthonormal rows (rows, size) that nearly span the leading modes and a few more."""
    start = problem.noise(count + SPARE)
    step = 1.0 / max(operator.fastest(start[0]), SLOWEST)
    block = operator.evolved(start, step, STEPS)
    for _ in range(CYCLES):
        space = block = _orthonormal(block)
        for _ in range(DEPTH):
            block = _orthonormal(operator.evolved(block, step, STEPS), space)
            space = np.concatenate([space, block])
        block = _leading(operator, space, count, count + SPARE)
        values, _, residuals = _ritz(operator, block)
        if np.all(residuals[:count] < ROUGH * np.maximum(1.0, np.abs(values[:count]))):
            break
    return block


def _refined(operator: Linearised, space: Array, local: float, count: int) -> tuple[Complex, Complex, Array]:
    """Return the leading eigenvalues, their vectors (count, size) and residuals, by Newton's method."""
    for _ in range(ROUNDS):
        values, vectors, residuals = _ritz(operator, space)
        if residuals[:count].max() < FINE:
            break
        steps = [_correction(operator, space, local, *pair) for pair in zip(values, vectors, strict=True)]
        grown = np.concatenate([space, _orthonormal(np.concatenate(steps), space)])
        space = _leading(operator, grown, len(space), len(space))
    return values[:count], vectors[:count], residuals[:count]


def _correction(operator: Linearised, space: Array, local: float, value: complex, vector: Complex) -> Array:
    """Return Newton's step from a Ritz vector as rows (0 to 2, size); a conjugate's second half has none."""
    if value.imag < 0:
        return np.empty((0, vector.size))
    theta, v = (value.real, vector.real) if value.imag == 0 else (value, vector)
    right = theta * v - operator(v)
    right = right - times(space.T, times(space, right))
    step = solve(operator, theta, local, space, right, np.zeros(len(space)), ACCURACY)[0]
    return np.stack([step] if value.imag == 0 else [step.real, step.imag])


def _ritz(operator: Linearised, space: Array) -> tuple[Complex, Complex, Array]:
    """Return Ritz values of J on orthonormal rows, the largest real part first, vectors and residuals."""
    answers = operator(space)
    values, small = scipy.linalg.eig(space @ answers.T)
    order = np.lexsort((-values.imag, -values.real))
    values, small = values[order], small[:, order].T
    turned = small.real @ answers + 1j * (small.imag @ answers)
    vectors = small.real @ space + 1j * (small.imag @ space)
    return values, vectors, np.linalg.norm(turned - values[:, None] * vectors, axis=1)


def _leading(operator: Linearised, space: Array, least: int, most: int) -> Array:
    """Return orthonormal rows for the leading Ritz values, `least` to `most` of them, cut at the widest gap.

    The Schur form is used because the balancing of general eigenvalue routines amplifies the rounding errors
    that are left between the space and a step that has become small.
    """
    small = space @ operator(space).T
    triangle, turn = scipy.linalg.schur(small, output="complex")
    values, vectors = scipy.linalg.eig(triangle)
    order = np.argsort(-values.real, kind="stable")
    growth = values.real[order]
    size = least + int(np.argmax(growth[least - 1 : most] - growth[least : most + 1]))
    chosen = turn @ vectors[:, order[:size]]
    real = np.linalg.svd(np.concatenate([chosen.real, chosen.imag], axis=1), full_matrices=False)[0]
    return np.ascontiguousarray(real[:, :size].T @ space)


def _share(vectors: Complex, rows: Array) -> Array:
    """Return the share (count,) of vectors of size 1 in the space of some rows."""
    if len(rows) == 0:
        return np.zeros(len(vectors))
    basis = _orthonormal(rows).T
    share: Array = np.sum((vectors.real @ basis) ** 2 + (vectors.imag @ basis) ** 2, axis=1)
    return share / np.sum(np.abs(vectors) ** 2, axis=1)


def _orthonormal(rows: Array, against: Array | None = None) -> Array:
    """Return orthonormal rows that span the given ones less their part in other orthonormal rows."""
    rows = rows / np.linalg.norm(rows, axis=1, keepdims=True)
    for _ in range(2):  # the second time removes what cancellation left in the first
        if against is not None:
            rows = rows - (rows @ against.T) @ against
        rows = np.linalg.qr(rows.T)[0].T
    return np.ascontiguousarray(rows)


def _field(problem: WholeCell, vector: Complex) -> Complex:
    """Return a mode (2, n_theta, n_z) of size 1, with the phase that makes it as real as possible."""
    turned = vector * np.exp(-0.5j * np.angle(np.sum(vector**2))) / np.linalg.norm(vector)
    field = problem.state(turned.real.copy()) + 1j * problem.state(turned.imag.copy())
    return field * np.sign(field.ravel()[np.argmax(np.abs(field.real))].real)
