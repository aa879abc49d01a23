"""Growth of small perturbations of the two uniform states, in closed form.

Perturbations are waves exp(i (mθ + qz) + σt) with k² = m² + q² and G = 1/(1 + μk²). With a = α_p - d_r:

* Disorder P = 0. A force |P|ⁿP with n > 0 has no linear part, so the flow drops out.
* The unidirectional state P = P0 e_z, P0² = 1 - d_r/α_p, with u = 0 and Π₀ = P0ⁿ⁺¹, for d = e_theta.

Written for the force |P|ⁿP; n = 2 is the model of Woodhouse & Goldstein 2013. Own derivation, since their
SI Text was not at hand. All quantities are dimensionless (rates per R/U).
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from ..model.errors import InputError
from ..model.grid import Array
from ..model.parameters import Parameters

Complex = npt.NDArray[np.complex128]


def disorder_rates(params: Parameters, m: npt.ArrayLike, q: npt.ArrayLike) -> Array:
    """Return the growth rates (..., 2) of waves about disorder, of P along d and of P across d.

        along d:   σ = α_p - d_r - d_s k² - κ        across d:   σ = α_p - d_r - d_s k²

    With d = e_theta these are P_theta and P_z. `m` and `q` (...) are wavenumbers around and along the cell
    and broadcast. Raises `InputError` for fields and for a force exponent of 0, with which the flow acts
    on the slightest order.
    """
    _numbers(params)
    if params.force_exponent == 0:
        raise InputError("force_exponent", 0.0, "above 0, so that the flow drops out", "raise it")
    k2 = np.square(np.asarray(m, dtype=np.float64)) + np.square(np.asarray(q, dtype=np.float64))
    across = params.alpha_p - params.d_r - params.d_s * k2
    return np.stack([across - params.kappa, across], axis=-1)


def unidirectional_order(params: Parameters, alpha_p: npt.ArrayLike | None = None) -> Array:
    """Return P0 = (1 - d_r/α_p)^½ (...), the order of the steady unidirectional state.

    For `alpha_p` (...) in place of the parameters' own; NaN where α_p <= d_r and there is no such state.
    Raises `InputError` for fields, and if d repels along the cell.
    """
    _axial(params)
    alpha = np.asarray(params.alpha_p if alpha_p is None else alpha_p, dtype=np.float64)
    weak = params.d_r / np.where(alpha > params.d_r, alpha, np.nan)
    return np.asarray(np.sqrt(1 - weak), dtype=np.float64)


def unidirectional_matrix(params: Parameters, m: npt.ArrayLike, q: npt.ArrayLike) -> Complex:
    """Return the matrices (..., 2, 2) on (P_theta, P_z) of waves about the unidirectional state.

    With W = (α_u + iε P0 q) G P0ⁿ/k²,

        [ -d_s k² - κ + W q²        -(n+1) m q W                              ]
        [ -(d_r/α_p) m q W          -d_s k² - 2a + (n+1) (d_r/α_p) m² W       ]

    and at k = 0 diag(-κ + α_u P0ⁿ, -2a): there the mean of u_theta follows the force, unless
    `zero_theta_flux` holds it, and then α_u P0ⁿ is missing. `m` and `q` (...) are wavenumbers around and
    along the cell and broadcast. Raises `InputError` for fields, if d repels along the cell, and where
    α_p <= d_r.
    """
    order = float(unidirectional_order(params))
    if not np.isfinite(order):
        rule = f"above d_r = {params.d_r:g}, where the unidirectional state exists"
        raise InputError("alpha_p", params.alpha_p, rule, "raise it")
    m, q = np.broadcast_arrays(np.asarray(m, dtype=np.float64), np.asarray(q, dtype=np.float64))
    k2 = m**2 + q**2
    uniform = k2 == 0
    push = order**params.force_exponent
    W = (params.alpha_u + 1j * params.epsilon * order * q) * push / (1 + params.mu * k2)
    W = np.where(uniform, 0.0, W / np.where(uniform, 1.0, k2))
    steep, weak, a = params.force_exponent + 1, params.d_r / params.alpha_p, params.alpha_p - params.d_r
    tilting = 0.0 if params.zero_theta_flux else params.alpha_u * push
    found = np.empty((*k2.shape, 2, 2), dtype=np.complex128)
    found[..., 0, 0] = -params.d_s * k2 - params.kappa + np.where(uniform, tilting, W * q**2)
    found[..., 0, 1] = -steep * m * q * W
    found[..., 1, 0] = -weak * m * q * W
    found[..., 1, 1] = -params.d_s * k2 - 2 * a + steep * weak * m**2 * W
    return found


def unidirectional_rates(params: Parameters, m: npt.ArrayLike, q: npt.ArrayLike) -> Complex:
    """Return the two growth rates σ (..., 2) of waves about the unidirectional state, the faster first.

    Eigenvalues of `unidirectional_matrix`; a wave grows where the first has a positive real part.
    """
    rates = np.linalg.eigvals(unidirectional_matrix(params, m, q))
    slowest_first = np.argsort(rates.real, axis=-1)
    return np.asarray(np.take_along_axis(rates, slowest_first[..., ::-1], axis=-1), dtype=np.complex128)


def tilt_threshold(params: Parameters, alpha_p: npt.ArrayLike | None = None) -> Array:
    """Return the α_u (...) above which the unidirectional state tilts as a whole: κ/P0ⁿ.

    For `alpha_p` (...) in place of the parameters' own. NaN where α_p <= d_r; infinite with
    `zero_theta_flux`. Filaments begin to turn towards the circumference; the end state may differ.
    Raises `InputError` as `unidirectional_order`.
    """
    order = unidirectional_order(params, alpha_p)
    found: Array = params.kappa / order**params.force_exponent
    return np.where(np.isfinite(found), np.inf, np.nan) if params.zero_theta_flux else found


def stripes_threshold(params: Parameters, alpha_p: npt.ArrayLike | None = None) -> Array:
    """Return the α_u (...) above which the unidirectional state breaks into stripes.

        α_u = α_p (1 + μ) (2a + d_s) / [(n+1) d_r P0ⁿ],    for n = 2   α_p² (1 + μ) (2a + d_s) / (3 d_r a)

    of the wave m = 1, q = 0, which is the first of all m. For `alpha_p` (...) in place of the parameters'
    own. NaN where α_p <= d_r; infinite where d_r = 0. Raises `InputError` as `unidirectional_order`.
    """
    order = unidirectional_order(params, alpha_p)
    alpha = np.asarray(params.alpha_p if alpha_p is None else alpha_p, dtype=np.float64)
    held = alpha * (1 + params.mu) * (2 * (alpha - params.d_r) + params.d_s)
    push = (params.force_exponent + 1) * params.d_r * order**params.force_exponent
    return np.asarray(held / push if params.d_r > 0 else held * np.inf, dtype=np.float64)


def _numbers(params: Parameters) -> None:
    for name, value in params.items():
        if isinstance(value, np.ndarray):
            raise InputError(name, value, "one number for a closed form", "choose a number")


def _axial(params: Parameters) -> None:
    """Refuse parameters under which P0 e_z with that P0 is no steady state."""
    _numbers(params)
    if params.kappa > 0 and abs(np.sin(params.repulsion_angle)) > 1e-12:
        rule = "0 or π, so that filaments along the axis feel no repulsion"
        raise InputError("repulsion_angle", params.repulsion_angle, rule, "change it or set kappa to 0")
