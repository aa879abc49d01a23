"""Regular functions of the latitude with azimuthal dependence e^{imθ}: weighted Jacobi polynomials.

    φ_n(x) = (1 - x)^{α/2} (1 + x)^{β/2} P_n^{(α,β)}(x) / norm,   x = cos τ,   ∫ φ_n φ_k dx = δ_nk

The south pole is x = 1. A scalar of mode m has α = β = |m|; the packed component p_θ + i p_s of a vector has
α = |m - 1| and β = |m + 1|, the powers with which a smooth field vanishes at the poles.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]


def weighted_jacobi(x: Array, alpha: int, beta: int, count: int) -> tuple[Array, Array]:
    """Return φ_n(x) and (1 - x²) φ_n'(x) for n < count, each of shape (points, count).

    By the three-term recurrence of orthonormal polynomials (DLMF 18.9), which starts from the weighted
    function itself, so that nothing overflows.
    """
    from scipy.special import gammaln  # slow to load

    n = np.arange(count + 1, dtype=np.float64)
    total = 2 * n + alpha + beta
    with np.errstate(invalid="ignore", divide="ignore"):
        middle = (beta**2 - alpha**2) / (total * (total + 2))
        square = 4 * n * (n + alpha) * (n + beta) * (n + alpha + beta) / (total**2 * (total**2 - 1))
    middle[0] = (beta - alpha) / (alpha + beta + 2)
    if count > 0 and alpha + beta == 0:
        square[1] = 1 / 3
    off = np.sqrt(square)  # x φ_n = off[n + 1] φ_{n+1} + middle[n] φ_n + off[n] φ_{n-1}
    log_norm = (alpha + beta + 1) * np.log(2) + gammaln(alpha + 1) + gammaln(beta + 1)
    log_norm -= gammaln(alpha + beta + 2)
    weight = 0.5 * (alpha * np.log1p(-x) + beta * np.log1p(x) - log_norm)
    phi = np.zeros((len(x), count + 1))
    phi[:, 0] = np.exp(weight)
    for k in range(count):
        below = off[k] * phi[:, k - 1] if k else 0.0
        phi[:, k + 1] = ((x - middle[k]) * phi[:, k] - below) / off[k + 1]
    slope = np.empty((len(x), count))
    for k in range(count):
        # (1 - x²) P_n' in P_n and P_{n-1} (DLMF 18.9.17), and the derivative of the weight.
        own = (0.5 * (beta - alpha) - 0.5 * (alpha + beta) * x) * phi[:, k]
        if k:
            tilt = (alpha - beta) / total[k] - x
            own += k * tilt * phi[:, k] + (total[k] + 1) * off[k] * phi[:, k - 1]
        slope[:, k] = own
    return phi[:, :count], slope
