"""Linear theory of the kinetic model: uniform steady states, thresholds, and the growth of waves about them.

Uniform states solve the self-consistency Ψ ∝ exp([H·p - (κ/2)(p·d)²]/d_r), H = a_p P + a_u u, P = <p>, with u
the uniform flow. The unpolarised one is nematic; with x = κ/(4 d_r) it has <p_perp²> = (1 + I_1(x)/I_0(x))/2
across the repulsive direction d and <p_d²> = 1 - <p_perp²> along it. Polarity along an axis grows from it
where a_p exceeds d_r/<p²> of this axis. Torques are literal: for those of "rate" double α_p and α_u.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt
from scipy.linalg import eig
from scipy.optimize import root
from scipy.special import ive

from ...display.shown import shown
from ...model.doors import door
from ...model.errors import InputError, choice, number, whole
from ...model.parameters import Parameters
from .angular import MODES

ANGLES = 2048
"""Angles of the quadrature, which converges exponentially."""
SAME = 1e-12
"""Largest |<p> - P| of a state that counts as steady."""


@shown
class NematicThresholds(NamedTuple):
    """Bundling rates a_p above which polarity grows from the nematic state, across and along d.

    Example:
        >>> import cyclosis as cy
        >>> cy.kinetic.thresholds(cy.Parameters(kappa=0.0, d_r=0.025))  # without repulsion 2 d_r
        NematicThresholds(across=0.05, along=0.05)
    """

    across: float
    along: float


@door
def thresholds(params: Parameters) -> NematicThresholds:
    """Return d_r/<p_perp²> and d_r/<p_d²> of the nematic state, dimensionless.

    Exact for uniform polarity; a wave has d_s k² to overcome besides. The flow plays no part, because the
    force is of third order in P. Raises `InputError` for fields.

    Example:
        >>> import cyclosis as cy
        >>> found = cy.kinetic.thresholds(cy.Parameters(kappa=0.5, d_r=0.025))
        >>> round(found.across, 7), round(found.along, 6)
        (0.0264078, 0.468969)
    """
    _refuse_fields(params)
    if params.d_r == 0:
        return NematicThresholds(0.0, 0.0)
    x = params.kappa / (4 * params.d_r)
    ratio = float(ive(1, x) / ive(0, x))
    # 1 - I_1/I_0 by itself would lose digits for a strong repulsion.
    rest = float((ive(0, x) - ive(1, x)) / ive(0, x))
    return NematicThresholds(params.d_r / (0.5 * (1 + ratio)), params.d_r / (0.5 * rest))


@door
def uniform_state(params: Parameters, direction: str = "z", modes: int = MODES) -> npt.NDArray[Any]:
    """Return the moments (modes + 1,) of the uniform state polarised along "z" or "theta", or "nematic".

    Raises `InputError` for fields, without rotational diffusion, and where no such state is found.

    Example:
        >>> import numpy as np
        >>> import cyclosis as cy
        >>> params = cy.Parameters(alpha_p=0.5, d_r=0.05, kappa=0.0)
        >>> m = cy.kinetic.uniform_state(params)  # |P| = I_1(x)/I_0(x), x = α_p |P|/d_r
        >>> round(float(m[1].imag), 12)
        0.945542186423
    """
    _refuse_fields(params)
    choice("direction", direction, ("z", "theta", "nematic"))
    modes = whole("modes", modes, 2, ANGLES // 2 - 2, f"the default is {MODES}")
    if params.d_r == 0:
        raise InputError("d_r", params.d_r, "above 0 for a steady state of some width", "raise it")
    if direction == "nematic":
        return _moments(params, np.zeros(2), modes)
    start = np.array([0.0, 0.99] if direction == "z" else [0.99, 0.0])
    for magnitude in (1.0, 0.8, 0.5, 0.2):
        found = root(lambda P: _mean(params, P) - P, magnitude * start, tol=1e-15)
        P = found.x
        along = P[1 if direction == "z" else 0]
        if np.abs(_mean(params, P) - P).max() < SAME and along > 1e-6:
            return _moments(params, P, modes)
    raise InputError(
        "alpha_p", params.alpha_p, f"large enough for a uniform state along {direction}", "raise it"
    )


@door
def growth_rates(params: Parameters, state: npt.ArrayLike, m: int, q: float) -> npt.NDArray[np.complex128]:
    """Return the growth rates (2N,) of a wave e^{i(mθ + qz)} about a uniform steady state, fastest first.

    `state` holds its moments (N + 1,), from `uniform_state`; m is a whole number, q a wavenumber in 1/radii.
    Complex, in units of U/R; perturbations keep the concentration. Raises `InputError` for fields.

    Example:
        >>> import cyclosis as cy
        >>> params = cy.Parameters(alpha_p=1.0)
        >>> base = cy.kinetic.uniform_state(params, "nematic")
        >>> cy.kinetic.growth_rates(params, base, 0, 0.0)[0].real.round(4)  # polarity along d
        np.float64(0.499)
    """
    _refuse_fields(params)
    q = number("q", q, -1e6, 1e6, "it is 2π j over the length of the cell")
    m = whole("m", m, -(10**6), 10**6, "it is a number of waves around the cell")
    values, _ = _modes(params, np.asarray(state, dtype=np.complex128), m, q)
    return values


def _modes(params: Parameters, base: Any, m: int, q: float) -> tuple[Any, Any]:
    """Return growth rates, fastest first, and their δ_n as columns, n = -N, ..., -1, 1, ..., N."""
    values, vectors = eig(matrix(params, base, m, q))
    order = np.argsort(-values.real, kind="stable")
    return values[order], vectors[:, order]


def matrix(params: Parameters, base: npt.NDArray[Any], m: int, q: float) -> npt.NDArray[np.complex128]:
    """Return the linear operator on (δ_{-N}, ..., δ_{-1}, δ_1, ..., δ_N) of a wave about uniform moments.

    δ_n and δ_{-n} are the e^{i(mθ + qz)} parts of m_n and of m_n*, which are independent.
    """
    N = len(base) - 1
    whole_base = {n: base[n] if n >= 0 else np.conj(base[-n]) for n in range(-N, N + 1)}
    index = {n: k for k, n in enumerate([*range(-N, 0), *range(1, N + 1)])}
    one = np.eye(2 * N, dtype=np.complex128)

    def row(n: int) -> Any:
        return one[index[n]] if n in index else np.zeros(2 * N)

    def at(n: int) -> Any:
        return whole_base.get(n, 0.0)

    P = np.array([base[1].real, base[1].imag])
    size2, k2 = float(P @ P), m**2 + q**2
    dP = np.array([0.5 * (row(1) + row(-1)), -0.5j * (row(1) - row(-1))])
    exponent = params.force_exponent
    power = size2 ** (0.5 * exponent) if size2 > 0 else float(exponent == 0)
    dF = power * dP
    if size2 > 0:
        dF = dF + exponent * power / size2 * np.outer(P, P @ dP)
    if k2 > 0:
        k = np.array([m, q])
        du = (dF - np.outer(k, k @ dF) / k2) / (1 + params.mu * k2)
    else:
        du = np.array([0.0 if params.zero_theta_flux else 1.0, 0.0])[:, None] * dF
    u = np.array([0.0 if params.zero_theta_flux else power * P[0], 0.0])
    H = params.alpha_p * base[1] + params.alpha_u * u[0]
    S = -0.5 * params.kappa * np.exp(2j * params.repulsion_angle)
    strain = (1j * m * du[0], 0.5j * (q * du[0] + m * du[1]))
    spin = 1j * (m * du[1] - q * du[0])
    dH, dH_ = (params.alpha_p * row(s) + params.alpha_u * (du[0] + s * 1j * du[1]) for s in (1, -1))
    dS, dS_ = (params.epsilon * (strain[0] + s * 1j * strain[1]) for s in (1, -1))
    out = np.zeros((2 * N, 2 * N), dtype=np.complex128)
    for n in index:
        drift = -params.d_s * k2 - n**2 * params.d_r - 1j * params.epsilon * m * u[0]
        turned = H * row(n - 1) - np.conj(H) * row(n + 1) + S * row(n - 2) - np.conj(S) * row(n + 2)
        turned = turned + dH * at(n - 1) - dH_ * at(n + 1) + dS * at(n - 2) - dS_ * at(n + 2)
        out[index[n]] = drift * row(n) + 0.5 * n * (turned + 1j * params.epsilon * spin * at(n))
    return out


def _weights(params: Parameters, P: npt.NDArray[Any]) -> tuple[Any, Any]:
    phi = 2 * np.pi / ANGLES * np.arange(ANGLES)
    flow = 0.0 if params.zero_theta_flux else float(P @ P) ** (0.5 * params.force_exponent) * P[0]
    torque = params.alpha_p * P + params.alpha_u * np.array([flow, 0.0])
    exponent = torque[0] * np.cos(phi) + torque[1] * np.sin(phi)
    exponent = (exponent - 0.5 * params.kappa * np.cos(phi - params.repulsion_angle) ** 2) / params.d_r
    weights = np.exp(exponent - exponent.max())
    return phi, weights / weights.sum()


def _mean(params: Parameters, P: npt.NDArray[Any]) -> npt.NDArray[Any]:
    phi, weights = _weights(params, P)
    return np.array([weights @ np.cos(phi), weights @ np.sin(phi)])


def _moments(params: Parameters, P: npt.NDArray[Any], modes: int) -> npt.NDArray[Any]:
    phi, weights = _weights(params, P)
    return np.exp(1j * np.outer(np.arange(modes + 1), phi)) @ weights


def _refuse_fields(params: Parameters) -> None:
    if params.shape is not None:
        raise InputError("params", "fields", "numbers: the state is uniform", "give one number for each")
