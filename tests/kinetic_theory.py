"""Closed forms and growth rates of the kinetic model, derived apart from the package and from its moments.

Uniform steady states. Where Ψ does not depend on θ and z, neither do P and u, so the turning is a slope:
ω = q·h - κ (q·d)(p·d) = d/dφ [h·p - κ (p·d)²/2] with h = α_p P + α_u u. The current d_r Ψ' - ωΨ is constant
in a steady state, and zero since ω is the slope of a periodic function. Therefore
Ψ ∝ exp[h·p/d_r - κ (p·d)²/(2 d_r)], with P = <p>. If P is along e_z, F has no θ part and Π₀ cancels
the other, so u = 0.

Thresholds. A little uniform order Pe, e along d or across it, in the nematic state P = 0: Pe = <p> with
h = α_p P e, to first order P = (α_p P/d_r) <(p·e)²>. Hence α_p = d_r/<(p·e)²> (u is of order 1 + n).
In the same way a state polar along e_z, across d = e_θ, tilts: δP_θ drives the flow u_θ = Pⁿ δP_θ, so that
1 = (α_p + α_u Pⁿ) <p_θ²>/d_r there.

Growth rates are eigenvalues of the equation linearised in f(φ) exp(i(mθ + qz)), on angles φ_j, with matrices
of the derivatives.
"""

from __future__ import annotations

import itertools

import numpy as np
from scipy.integrate import quad
from scipy.linalg import eigvals, null_space, orth
from scipy.optimize import brentq, root

from kinetic_oracle import value


def average(f, along, across, repulsion):
    """Return <f(χ)> for a weight exp[along cos χ + across sin χ - repulsion cos²χ], χ measured from d."""

    def exponent(chi):
        return along * np.cos(chi) + across * np.sin(chi) - repulsion * np.cos(chi) ** 2

    chi = np.linspace(-np.pi, np.pi, 721)
    top = exponent(chi).max()  # so that nothing overflows
    breaks = np.pi * np.linspace(-1, 1, 9)

    def integral(g):
        parts = itertools.pairwise(breaks)
        return sum(quad(g, a, b, epsabs=1e-15, epsrel=1e-13, limit=200)[0] for a, b in parts)

    whole = integral(lambda chi: np.exp(exponent(chi) - top))
    return integral(lambda chi: f(chi) * np.exp(exponent(chi) - top)) / whole


def threshold(d_r, kappa, along_d=False):
    """Return the α_p at which uniform polarity along d, or across it, leaves the nematic state."""
    component = np.cos if along_d else np.sin
    return d_r / average(lambda chi: component(chi) ** 2, 0.0, 0.0, kappa / (2 * d_r))


def polar_order(alpha_p, d_r, kappa=0.0):
    """Return P > 0 of the uniform state polar across d with u = 0; zero below its threshold."""
    if alpha_p <= threshold(d_r, kappa):
        return 0.0

    def excess(P):
        return average(np.sin, 0.0, alpha_p * P / d_r, kappa / (2 * d_r)) - P

    low = 0.5
    while excess(low) <= 0:
        low /= 2
    return brentq(excess, low, 1.0, xtol=1e-15, rtol=1e-14)


def tilt_threshold(alpha_p, d_r, kappa, exponent=2.0):
    """Return the α_u at which the uniform state polar along e_z tilts towards d = e_θ, <u_θ> being free."""
    P = polar_order(alpha_p, d_r, kappa)
    spread = average(lambda chi: np.cos(chi) ** 2, 0.0, alpha_p * P / d_r, kappa / (2 * d_r))
    return (d_r / spread - alpha_p) / P**exponent


def mean_flow(P, values):
    """Return u of a uniform order P."""
    speed = (P[0] ** 2 + P[1] ** 2) ** (value(values, "force_exponent") / 2) * P[0]
    return np.array([0.0 if value(values, "zero_theta_flux") else speed, 0.0])


def equilibrium(P, values, n_phi):
    """Return the density on φ_j = 2πj/n_φ that the torques of a uniform order P would hold, ∫Ψ dφ = 1."""
    phi = 2 * np.pi * np.arange(n_phi) / n_phi
    h = value(values, "alpha_p") * np.asarray(P) + value(values, "alpha_u") * mean_flow(P, values)
    exponent = h[0] * np.cos(phi) + h[1] * np.sin(phi)
    exponent -= value(values, "kappa") / 2 * np.cos(phi - value(values, "repulsion_angle")) ** 2
    weight = np.exp((exponent - exponent.max()) / value(values, "d_r"))
    return weight * n_phi / (2 * np.pi * weight.sum())


def uniform_state(values, start, n_phi):
    """Return (P, Ψ) of a uniform steady state near an order `start`, for any d and with its mean flow."""
    fine = max(n_phi, 256)
    phi = 2 * np.pi * np.arange(fine) / fine
    p = np.stack([np.cos(phi), np.sin(phi)])

    def excess(P):
        return (2 * np.pi / fine) * p @ equilibrium(P, values, fine) - P

    found = root(excess, np.asarray(start, dtype=float), tol=1e-14)
    if np.abs(excess(found.x)).max() > 1e-11:
        raise ValueError(f"no uniform state found near {start}")
    return found.x, equilibrium(found.x, values, n_phi)


def slopes(n):
    """Return the matrices of d/dφ and d²/dφ² for trigonometric polynomials on n points, n even."""
    gap = np.subtract.outer(np.arange(n), np.arange(n))
    sign = np.where(gap % 2, -1.0, 1.0)
    off = gap != 0
    half = np.where(off, gap, 1) * np.pi / n
    first = np.where(off, sign / (2 * np.tan(half)), 0.0)
    second = np.where(off, -sign / (2 * np.sin(half) ** 2), -(n**2 / 12 + 1 / 6))
    return first, second


def nematic_operator(alpha_p, d_r, kappa, n_phi):
    """Return the operator of uniform perturbations of the nematic state, on angles χ_j measured from d."""
    chi = 2 * np.pi * np.arange(n_phi) / n_phi
    first, second = slopes(n_phi)
    weight = np.exp(-kappa / (2 * d_r) * np.cos(chi) ** 2)
    base = weight * n_phi / (2 * np.pi * weight.sum())
    own = kappa * np.sin(chi) * np.cos(chi)
    # -d/dχ [(q·δP) Ψ], with δP = ∫p f dχ
    along, across = first @ (np.sin(chi) * base), -first @ (np.cos(chi) * base)
    response = np.outer(along, np.cos(chi)) + np.outer(across, np.sin(chi))
    return d_r * second - first * own[None, :] + alpha_p * (2 * np.pi / n_phi) * response


def nematic_growth(alpha_p, d_r, kappa, along_d=False, n_phi=96):
    """Return the largest growth rate of uniform polarity along d, or across it, from the nematic state.

    f(χ + π) = -f(χ) makes it polar; f(-χ) = f(χ) is polar along d, f(-χ) = -f(χ) across it.
    """
    index = np.arange(n_phi)
    same = np.eye(n_phi)
    turned, mirrored = same[(index + n_phi // 2) % n_phi], same[-index % n_phi]
    sector = orth((same - turned) @ (same + (1 if along_d else -1) * mirrored))
    found = eigvals(sector.T @ nematic_operator(alpha_p, d_r, kappa, n_phi) @ sector)
    return found.real.max()


def wave_operator(base, values, m, q):
    """Return the operator on f(φ_j) of waves f exp(i(mθ + qz)) about a uniform steady density, c = 1."""
    n_phi = len(base)
    phi = 2 * np.pi * np.arange(n_phi) / n_phi
    weight = 2 * np.pi / n_phi
    p, across = np.stack([np.cos(phi), np.sin(phi)]), np.stack([-np.sin(phi), np.cos(phi)])
    b = value(values, "repulsion_angle")
    d = np.array([np.cos(b), np.sin(b)])
    k = np.array([m, q], dtype=float)
    k2 = k @ k
    epsilon, exponent = value(values, "epsilon"), value(values, "force_exponent")
    alpha_p, alpha_u = value(values, "alpha_p"), value(values, "alpha_u")

    P = weight * p @ base
    size = np.hypot(*P)
    u = mean_flow(P, values)
    # rows: what δc, δP, δF and δu are for each f
    dc = np.full(n_phi, weight)
    dP = weight * (p - P[:, None])
    dF = size**exponent * (dP + np.outer(P, dc))
    if size > 0:
        dF = dF + exponent * size ** (exponent - 2) * np.outer(P, P @ dP)
    if k2 > 0:
        du = (np.eye(2) - np.outer(k, k) / k2) @ dF / (1 + value(values, "mu") * k2)
    else:
        free = 0.0 if value(values, "zero_theta_flux") else 1.0
        du = np.array([[free], [0.0]]) * dF

    first, second = slopes(n_phi)
    omega = across.T @ (alpha_p * P + alpha_u * u) - value(values, "kappa") * (d @ p) * (d @ across)
    response = 1j * epsilon * (k @ p)[:, None] * (across.T @ du) + across.T @ (alpha_p * dP + alpha_u * du)
    return (
        value(values, "d_r") * second
        - (value(values, "d_s") * k2 + 1j * epsilon * (u @ k)) * np.eye(n_phi)
        - first * omega[None, :]
        - first @ (base[:, None] * response)
    )


def wave_growth(base, values, m, q, uniform_concentration=True):
    """Return the growth rates (complex) of waves about a uniform density, the fastest first.

    ∫f dφ obeys an equation of its own with the rate -d_s k² - iε u·k. That one is left out unless
    `uniform_concentration` is False.
    """
    operator = wave_operator(base, values, m, q)
    if uniform_concentration:
        kept = null_space(np.ones((1, len(base))))
        operator = kept.T @ operator @ kept
    found = eigvals(operator)
    return found[np.argsort(-found.real)]
