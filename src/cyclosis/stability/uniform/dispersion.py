"""Growth of small perturbations of the uniform states, in closed form.

Perturbations are waves exp(i (mθ + qz) + σt) with k² = m² + q² and G = 1/(1 + μk²). The base state is
P = P0 e with the flow u = A P and d along an axis, or disorder (see `uniform`). With τ = α_p - κ (e·d)² +
α_u A, so that (1 - P0²) τ = d_r, k∥ and k⊥ the wavenumbers along e and across, and

    W = (α_u + iε P0 k∥) G P0ⁿ/k²,    w = 1 - P0²,    D = -d_s k² - iε A P0 k∥,

a wave's amplitudes along e and across obey the matrix

    [ D - 2 (τ - d_r) - w α_u A + (n+1) w k⊥² W        -w k∥ k⊥ W                               ]
    [ -(n+1) k∥ k⊥ W                                   D + κ (d∥² - d⊥²) - α_u A + k∥² W        ]

for k ≠ 0. At k = 0 the mean of u_theta follows the force and no other part of the flow does: there the terms
in W are replaced by (n+1) w α_u P0ⁿ on P_theta if that is the component along e, by α_u P0ⁿ if it is the
one across, and by nothing with `zero_theta_flux`.

Written for the force |P|ⁿP; n = 2 is the model of Woodhouse & Goldstein 2013. Own derivation, since their
SI Text was not available. All quantities are dimensionless (rates per R/U).
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from ...model.arrays import alike, numbers
from ...model.doors import door
from ...model.errors import InputError
from ...model.grid import Array
from ...model.parameters import Parameters
from .uniform import OBLIQUE, Uniform, check_numbers, uniform

__all__ = [
    "growth_matrix",
    "growth_rates",
    "stripes_threshold",
    "tilt_threshold",
    "unidirectional_order",
]


def __dir__() -> list[str]:
    return sorted(__all__)


Complex = npt.NDArray[np.complex128]


@door
def growth_rates(
    params: Parameters, base: str, m: npt.ArrayLike, q: npt.ArrayLike, root: int | None = None
) -> Complex:
    """Return the two growth rates σ (..., 2) of waves exp(i (mθ + qz)) about a uniform state.

    The one with the larger real part comes first; the imaginary part is minus the wave's frequency. `base` is
    "disorder", "unidirectional" (P along e_z) or "circumferential" (P along e_theta). Where several such
    states exist `root` counts them, from 0 for the largest |P|, which is the default. `m` and `q` (...) are
    wavenumbers around and along the cell and broadcast; m = q = 0 is the uniform perturbation. Eigenvalues of
    `growth_matrix`, dimensionless. Raises `InputError` as it does.

    Example:
        >>> import cyclosis as cy
        >>> params = cy.Parameters(alpha_p=0.5, d_r=0.025, d_s=0.025, kappa=0.5)
        >>> rates = cy.stability.growth_rates(params, "disorder", m=[0, 1, 2], q=0.0)
        >>> rates.real.round(6)  # a - d_s m² of P_z, and κ less of P_theta
        array([[ 0.475, -0.025],
               [ 0.45 , -0.05 ],
               [ 0.375, -0.125]])
    """
    matrix = growth_matrix(params, base, m, q, root)
    half = 0.5 * (matrix[..., 0, 0] - matrix[..., 1, 1])
    mean = 0.5 * (matrix[..., 0, 0] + matrix[..., 1, 1])
    split = np.sqrt(half**2 + matrix[..., 0, 1] * matrix[..., 1, 0])
    return np.stack([mean + split, mean - split], axis=-1)


@door
def growth_matrix(
    params: Parameters, base: str, m: npt.ArrayLike, q: npt.ArrayLike, root: int | None = None
) -> Complex:
    """Return the matrices (..., 2, 2) on (P_theta, P_z) of waves about a uniform state.

    Arguments as in `growth_rates`, the equation above. About disorder, for which d may have any direction,

        (α_p - d_r - d_s k²) I - κ dd    and for n = 0   + α_u (I - kk/k²) G ,

    at k = 0 with e_theta e_theta (nothing with `zero_theta_flux`) in place of (I - kk/k²) G. Raises
    `InputError` for fields, unknown bases, wavenumbers that are not finite, where there is no such state or
    root, and for an oblique d, which would rotate an ordered state.

    Example:
        >>> import cyclosis as cy
        >>> params = cy.Parameters(alpha_p=1.0, alpha_u=0.5, d_r=0.025, kappa=0.6)
        >>> matrix = cy.stability.growth_matrix(params, "unidirectional", 0, 0)
        >>> matrix.real.diagonal().round(6)  # α_u P0² - κ of P_theta, and -2 (α_p - d_r) of P_z
        array([-0.1125, -1.95  ])
    """
    check_numbers(params)
    alike(m=m, q=q)
    wavenumbers = _wavenumbers("m", m), _wavenumbers("q", q)
    try:
        waves = np.broadcast_arrays(*wavenumbers)
    except ValueError as error:
        found, rule = tuple(array.shape for array in wavenumbers), "such that they broadcast to one shape"
        raise InputError("shapes of m and q", found, rule, "write m[:, None] for all pairs") from error
    state = uniform(params, base, root)
    if state.order == 0:
        return _disorder(params, *waves)
    matrix = _ordered(params, state, waves[state.axis], waves[1 - state.axis])
    return matrix if state.axis == 0 else matrix[..., ::-1, ::-1]


@door
def unidirectional_order(params: Parameters, alpha_p: npt.ArrayLike | None = None) -> Array:
    """Return P0 = (1 - d_r/α_p)^½ (...), the order of the steady unidirectional state.

    For `alpha_p` (...) instead of that of `params`; NaN where α_p <= d_r and there is no such state.
    Raises `InputError` for fields, and if d repels along the cell.

    Example:
        >>> import cyclosis as cy
        >>> cy.stability.unidirectional_order(cy.Parameters(d_r=0.025), [0.01, 0.1, 1.0]).round(4)
        array([   nan, 0.866 , 0.9874])
    """
    _axial(params)
    alpha = _couplings(params, alpha_p)
    weak = params.d_r / np.where(alpha > params.d_r, alpha, np.nan)
    return np.asarray(np.sqrt(1 - weak), dtype=np.float64)


@door
def tilt_threshold(params: Parameters, alpha_p: npt.ArrayLike | None = None) -> Array:
    """Return the α_u (...) above which the unidirectional state tilts as a whole: κ/P0ⁿ.

    For `alpha_p` (...) instead of that of `params`. NaN where α_p <= d_r; infinite with `zero_theta_flux`.
    Filaments begin to turn towards the circumference; the final state may differ. Raises `InputError` as
    `unidirectional_order` does.

    Example:
        >>> import cyclosis as cy
        >>> params = cy.Parameters(kappa=0.5, d_r=0.025)
        >>> float(cy.stability.tilt_threshold(params, 0.1).round(6))  # 0.5/(1 - 0.025/0.1)
        0.666667
    """
    order = unidirectional_order(params, alpha_p)
    found: Array = params.kappa / order**params.force_exponent
    return np.where(np.isfinite(found), np.inf, np.nan) if params.zero_theta_flux else found


@door
def stripes_threshold(params: Parameters, alpha_p: npt.ArrayLike | None = None) -> Array:
    """Return the α_u (...) above which the unidirectional state breaks into stripes.

        α_u = α_p (1 + μ) (2a + d_s) / [(n+1) d_r P0ⁿ],    for n = 2   α_p² (1 + μ) (2a + d_s) / (3 d_r a)

    with a = α_p - d_r, for the wave m = 1, q = 0, the first to grow of all m. For `alpha_p` (...) instead of
    that of `params`. NaN where α_p <= d_r; infinite where d_r = 0. Raises `InputError` as
    `unidirectional_order` does.

    Example:
        >>> import cyclosis as cy
        >>> params = cy.Parameters(alpha_p=0.1, kappa=5.0)
        >>> at = float(cy.stability.stripes_threshold(params))
        >>> waves = cy.stability.growth_rates(params.replace(alpha_u=at), "unidirectional", [1, 2], 0.0)
        >>> round(at, 4), [round(abs(float(rate)), 9) for rate in waves.real.max(axis=1)]  # m = 1 goes first
        (0.3267, [0.0, 0.096875])
    """
    order = unidirectional_order(params, alpha_p)
    alpha = _couplings(params, alpha_p)
    held = alpha * (1 + params.mu) * (2 * (alpha - params.d_r) + params.d_s)
    push = (params.force_exponent + 1) * params.d_r * order**params.force_exponent
    return np.asarray(held / push if params.d_r > 0 else held * np.inf, dtype=np.float64)


def _ordered(params: Parameters, state: Uniform, along: Array, across: Array) -> Complex:
    """Return the matrices on the components along and across the order of a state."""
    p, n, k2 = params, params.force_exponent, along**2 + across**2
    mean = k2 == 0
    push, room = state.order**n, 1 - state.order**2
    W = (p.alpha_u + 1j * p.epsilon * state.order * along) * push / (1 + p.mu * k2)
    W = np.where(mean, 0.0, W / np.where(mean, 1.0, k2))
    # The flow driven along e by the force along e, and across by the force across, per unit of force.
    whole = 0.0 if p.zero_theta_flux else p.alpha_u * push
    head = np.where(mean, whole * (state.axis == 0), across**2 * W)
    side = np.where(mean, whole * (state.axis == 1), along**2 * W)
    torque = p.alpha_p - p.kappa * state.along + p.alpha_u * state.swept
    both = -p.d_s * k2 - 1j * p.epsilon * state.swept * state.order * along - p.alpha_u * state.swept
    found = np.empty((*k2.shape, 2, 2), dtype=np.complex128)
    found[..., 0, 0] = both - 2 * (torque - p.d_r) + state.order**2 * p.alpha_u * state.swept
    found[..., 0, 0] += (n + 1) * room * head
    found[..., 0, 1] = -room * along * across * W
    found[..., 1, 0] = -(n + 1) * along * across * W
    found[..., 1, 1] = both + p.kappa * (state.along - state.across) + side
    return found


def _disorder(params: Parameters, m: Array, q: Array) -> Complex:
    k2 = m**2 + q**2
    mean = k2 == 0
    d = np.array([np.cos(params.repulsion_angle), np.sin(params.repulsion_angle)])
    alone = params.alpha_p - params.d_r - params.d_s * k2
    found: Complex = (alone[..., None, None] * np.eye(2) - params.kappa * np.outer(d, d)).astype(complex)
    if params.force_exponent == 0:
        across = np.stack([np.where(mean, 1.0, q), np.where(mean, 0.0, -m)], axis=-1)
        held = 0.0 if params.zero_theta_flux else 1.0
        answer = params.alpha_u / (1 + params.mu * k2) * np.where(mean, held, 1 / np.where(mean, 1.0, k2))
        found += answer[..., None, None] * across[..., :, None] * across[..., None, :]
    return found


def _wavenumbers(name: str, values: npt.ArrayLike) -> Array:
    found = numbers(name, values, "a number or an array of numbers", "give wavenumbers")
    if not np.all(np.isfinite(found)):
        raise InputError(name, values, "finite everywhere", "remove its NaN or infinite entries")
    return found


def _couplings(params: Parameters, alpha_p: npt.ArrayLike | None) -> Array:
    """Return the α_p of the parameters, or those given instead."""
    given = params.alpha_p if alpha_p is None else alpha_p
    return numbers("alpha_p", given, "a number or an array of numbers", "leave it out to use that of params")


def _axial(params: Parameters) -> None:
    """Refuse parameters under which P0 e_z with that P0 is not a steady state."""
    check_numbers(params)
    if params.kappa > 0 and abs(np.sin(params.repulsion_angle)) > OBLIQUE:
        rule = "0 or π, so that repulsion does not act on filaments along the axis"
        raise InputError("repulsion_angle", params.repulsion_angle, rule, "change it or set kappa to 0")
