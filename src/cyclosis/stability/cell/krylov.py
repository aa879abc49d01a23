"""Linear equations with the derivative of the whole cell: GMRES with a border.

    (J - θ) x + Bᵀ y = f,    B x = g

where B (rows, size) has few rows: directions to which x must be orthogonal, such as shifts of a state.
The preconditioner is the diagonal part of J less a typical local rate, with the border eliminated exactly.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy.sparse.linalg import LinearOperator, gmres

from ...model.grid import Array
from .linearised import Linearised

RESTART, RESTARTS = 120, 2
SMALLEST = 1e-6
"""Least divisor of the preconditioner, which keeps it finite where nothing decays by itself."""


def solve(
    operator: Linearised, theta: complex, local: float, border: Array, f: Any, g: Any, rtol: float
) -> tuple[Any, Any]:
    """Return x (size,) and y (rows,), complex where θ is; f is then complex as well.

    `local` is the typical local rate. The relative residual is `rtol` or what two restarts reach: the caller
    checks whether a solution is good enough.
    """
    rows, size = border.shape
    divisor = operator.diagonal - local - theta
    inverse = 1.0 / np.where(np.abs(divisor) < SMALLEST, -SMALLEST, divisor)
    corner = np.linalg.inv((border * inverse) @ border.T) if rows else np.zeros((0, 0))

    def prepared(v: Any) -> Any:
        x = inverse * v[:size]
        y = corner @ (times(border, x) - v[size:])
        return np.concatenate([x - inverse * times(border.T, y), y])

    def applied(v: Any) -> Any:
        w = prepared(v)
        x, y = w[:size], w[size:]
        return np.concatenate([operator(x) - theta * x + times(border.T, y), times(border, x)])

    right = np.concatenate([f, g])
    if not np.any(right):
        return right[:size], right[size:]
    whole = LinearOperator((size + rows, size + rows), applied, dtype=right.dtype)
    found = prepared(gmres(whole, right, rtol=rtol, restart=RESTART, maxiter=RESTARTS)[0])
    return found[:size], found[size:]


def times(matrix: Any, vector: Any) -> Any:
    """Return a real matrix times a vector that may be complex, without a complex copy of the matrix."""
    if np.iscomplexobj(vector):
        return matrix @ vector.real + 1j * (matrix @ vector.imag)
    return matrix @ vector
