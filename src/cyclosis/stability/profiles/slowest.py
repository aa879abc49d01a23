"""The slowest eigenvalues of a linearisation whose small scales only diffuse away.

Split into the modes of low wavenumber, |k| <= K, and the rest, let the matrix be [[A, B], [C, D]]. Diffusion
makes D large and negative, so that an eigenvalue σ of order one obeys, with D - σ expanded about σ = 0,

    (A - B D⁻¹ C) x = σ (1 + B D⁻² C) x + O(σ² B D⁻³ C):

a problem of less than half the size. The neglected part is of second order in σ/(d_s K²): where an eigenvalue
passes through zero the result is exact, and with K from `cutoff` it is accurate to 1e-8 σ² or better for σ
above 1, 1e-8 below (a test compares). Own derivation.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from ...model.grid import Array
from ...model.parameters import Parameters

Vector = npt.NDArray[np.complex128]

FAST = 5.0
"""How much faster than everything else the neglected modes diffuse away."""


def rate_scale(params: Parameters) -> float:
    """Return a bound on the rate at which alignment and repulsion act on a perturbation, dimensionless."""
    return float(params.alpha_p + (params.force_exponent + 1) * params.alpha_u + params.kappa + params.d_r)


def most_waves(params: Parameters, spacing: float) -> int:
    """Return a number of waves, `spacing` apart, beyond which diffusion outweighs all driving."""
    diffusion, friction = max(float(params.d_s), 1e-12), max(float(params.mu), 1e-12)
    fastest = 2 * np.sqrt(rate_scale(params) / diffusion) + float(params.epsilon) / diffusion
    return int(np.ceil(max(fastest, 1 / np.sqrt(friction)) / spacing) + 1)


def settled(matrix: Any, mu: float, q: float) -> bool:
    """Return whether waves of the axial wavenumber q and of all larger ones decay.

    Energy decays, and q > μ^(-1/2): beyond, diffusion grows with q while the response of the flow falls.
    """
    return mu * q**2 > 1 and decays(matrix)


def decays(matrix: Any) -> bool:
    """Return whether the symmetric part of a matrix is negative definite, so that energy decays."""
    try:
        np.linalg.cholesky(-0.5 * (matrix + matrix.conj().T))
    except np.linalg.LinAlgError:
        return False
    return True


def cutoff(params: Parameters) -> float:
    """Return the wavenumber K beyond which diffusion is `FAST` times quicker; infinite without diffusion."""
    if params.d_s == 0:
        return np.inf
    return float(max(np.sqrt(FAST * rate_scale(params) / params.d_s), 2 * params.epsilon / params.d_s))


def leading(matrix: Any, k: Array, largest: float, neutral: Array | None = None) -> Vector:
    """Return the eigenvalues (many,) of a matrix (2n, 2n) on (P_theta, P_z), the largest real part first.

    `k` (n,) are the wavenumbers of the points in transform order, `largest` the cutoff. `neutral` (2n,) is
    a vector that the matrix maps to zero, whose eigenvalue is left out. Only the leading ones are accurate;
    all of them are where the cutoff would save too little to be used.
    """
    low = np.abs(k) <= largest
    if not low.sum() < 0.7 * k.size:
        return _sorted(_without(matrix, neutral))
    kept = np.concatenate([low, low])
    waves = _in_waves(matrix, k.size)
    A, B = waves[np.ix_(kept, kept)], waves[np.ix_(kept, ~kept)]
    C, D = waves[np.ix_(~kept, kept)], waves[np.ix_(~kept, ~kept)]
    answer = np.linalg.solve(D, C)
    slow = A - B @ answer
    mass = np.eye(slow.shape[0]) + B @ np.linalg.solve(D, answer)
    part = None if neutral is None else _transform(neutral.reshape(2, -1), 1).ravel()[kept]
    return _sorted(_without(np.linalg.solve(mass, slow), part))


def _in_waves(matrix: Any, n: int) -> Any:
    """Return a matrix on (P_theta, P_z) as one on their amplitudes in transform order."""
    parts = np.reshape(matrix, (2, n, 2, n))
    if np.iscomplexobj(parts):
        return np.fft.ifft(np.fft.fft(parts, axis=1), axis=3).reshape(2 * n, 2 * n)
    return (_transform(_transform(parts, 1), 3) / n).reshape(2 * n, 2 * n)


def _transform(values: Any, axis: int) -> Any:
    """Return the Hartley transform of real values: √n times an orthogonal one, and real."""
    waves = np.fft.fft(values, axis=axis)
    return waves.real - waves.imag


def _without(matrix: Any, neutral: Any) -> Any:
    """Return a matrix with all the eigenvalues of another except that of a null vector."""
    if neutral is None:
        return matrix
    rest = np.linalg.qr(neutral[:, None], mode="complete")[0][:, 1:]
    return rest.conj().T @ matrix @ rest


def _sorted(matrix: Any) -> Vector:
    values = np.asarray(np.linalg.eigvals(matrix), dtype=np.complex128)
    # Conjugates of a complex matrix differ by rounding: the upper one of a pair comes first.
    return values[np.lexsort((-values.imag, -np.round(values.real, 12)))]
