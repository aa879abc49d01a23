"""The kinetic model in plain array code, straight from its equation: an oracle for the package's hierarchy.

Nothing is shared with the package, nor with the oracle of the polar model. The density Ψ(θ, z, φ) of
filament angles lies on equally spaced angles φ_j = 2πj/n_φ, and the turning of a filament is the vector
expression on them: there are no moments and no complex packing.

    ∂Ψ/∂t + ε u·∇Ψ = d_s ∇²Ψ + d_r ∂²Ψ/∂φ² - ∂(ωΨ)/∂φ
    ω = q·[ε (p·∇)u + α_p P + α_u u - κ (p·d) d],   p = (cos φ, sin φ),   q = dp/dφ,   d = (cos b, sin b)
    c = ∫Ψ dφ,   P = ∫pΨ dφ/c

    -μ ∇²u + u + Π₀ e_z + ∇Π' = F = c |P|ⁿ P,   ∇·u = 0,   <u_z> = 0

This is how it follows from the paper. With T the bracket in ω, which is the paper's bracket with p in place
of P wherever a filament's own direction is meant, a filament turns as dp/dt = (I - pp)·T = q (q·T). It is
carried at εu and does not move by itself. Conservation of filaments in (x, φ), with noise d_s and d_r and
∇·u = 0, is the first line. Its first moment at c = 1 becomes the paper's equation for P if <pp> and <ppp> are
replaced by PP and PPP.

`values` is a dictionary or has the attributes epsilon, d_s, d_r, alpha_p, alpha_u, kappa, repulsion_angle and
mu; zero_theta_flux (False) and force_exponent (2) may be left out. alpha_p, alpha_u and kappa are numbers or
arrays (n_θ, n_z).

Conventions: a field is the real trigonometric polynomial through its values. At an even number of points its
part at the Nyquist frequency is a cosine: its first derivative is zero at the points, its second is not.
Derivatives along all three axes obey this. The flow alone has no part at a Nyquist frequency, of θ or of z.
Products are formed at the points, and no mode is dropped from Ψ or from its rate.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

OPTIONAL = {"zero_theta_flux": False, "force_exponent": 2.0}


def value(values, name):
    """Return a parameter from a dictionary or an object."""
    found = values.get(name) if isinstance(values, Mapping) else getattr(values, name, None)
    return OPTIONAL[name] if found is None else found


def angles(n_phi):
    """Return the angles of the grid."""
    return 2 * np.pi * np.arange(n_phi) / n_phi


def frequencies(n, period):
    """Return the wavenumbers of n points in transform order, the Nyquist frequency as positive."""
    return (2 * np.pi / period) * np.array([j if j <= n // 2 else j - n for j in range(n)], dtype=float)


def derivative(f, axis, period, order=1):
    """Return the first or second derivative at the points of the real trigonometric polynomial through f."""
    n = f.shape[axis]
    symbol = (1j * frequencies(n, period)) ** order
    if order % 2 and n % 2 == 0:
        symbol[n // 2] = 0.0
    shape = [1] * f.ndim
    shape[axis] = n
    return np.fft.ifft(symbol.reshape(shape) * np.fft.fft(f, axis=axis), axis=axis).real


def concentration(Psi):
    """Return c = ∫Ψ dφ, shape (n_θ, n_z)."""
    return (2 * np.pi / Psi.shape[2]) * Psi.sum(axis=2)


def order(Psi):
    """Return P, shape (2, n_θ, n_z)."""
    phi = angles(Psi.shape[2])
    weight = 2 * np.pi / Psi.shape[2]
    summed = [weight * (Psi * component).sum(axis=2) for component in (np.cos(phi), np.sin(phi))]
    return np.stack(summed) / concentration(Psi)


def flow(Psi, values, length):
    """Return u, shape (2, n_θ, n_z), from its vorticity w and stream function χ.

    The curl of the momentum balance is w - μ ∇²w = curl F, and u = (-∂χ/∂z, ∂χ/∂θ) with ∇²χ = w has no
    divergence. The means are apart: Π₀ holds that of u_z at zero, that of u_θ is the mean force.
    """
    P = order(Psi)
    F = concentration(Psi) * (P[0] ** 2 + P[1] ** 2) ** (value(values, "force_exponent") / 2) * P
    curl = derivative(F[1], 0, 2 * np.pi) - derivative(F[0], 1, length)
    n_theta, n_z = curl.shape
    k2 = frequencies(n_theta, 2 * np.pi)[:, None] ** 2 + frequencies(n_z, length)[None, :] ** 2
    k2[0, 0] = 1.0
    chi = -np.fft.fft2(curl) / (k2 * (1 + value(values, "mu") * k2))
    chi[0, 0] = 0.0
    if n_theta % 2 == 0:
        chi[n_theta // 2, :] = 0.0
    if n_z % 2 == 0:
        chi[:, n_z // 2] = 0.0
    chi = np.fft.ifft2(chi).real
    mean_theta = 0.0 if value(values, "zero_theta_flux") else F[0].mean()
    return np.stack([mean_theta - derivative(chi, 1, length), derivative(chi, 0, 2 * np.pi)])


def turning(Psi, values, length):
    """Return ω, shape (n_θ, n_z, n_φ)."""
    phi = angles(Psi.shape[2])
    p = (np.cos(phi), np.sin(phi))
    q = (-np.sin(phi), np.cos(phi))
    b = value(values, "repulsion_angle")
    d = (np.cos(b), np.sin(b))
    epsilon = value(values, "epsilon")
    alpha_p, alpha_u, kappa = (
        np.asarray(value(values, name), dtype=float)[..., None] for name in ("alpha_p", "alpha_u", "kappa")
    )
    P, u = order(Psi), flow(Psi, values, length)
    omega = np.zeros(Psi.shape)
    for i in (0, 1):
        along_theta = derivative(u[i], 0, 2 * np.pi)[..., None]
        along_z = derivative(u[i], 1, length)[..., None]
        torque = epsilon * (p[0] * along_theta + p[1] * along_z)
        torque = torque + alpha_p * P[i][..., None]
        torque = torque + alpha_u * u[i][..., None]
        torque = torque - kappa * (p[0] * d[0] + p[1] * d[1]) * d[i]
        omega = omega + q[i] * torque
    return omega


def rate(Psi, values, length):
    """Return dΨ/dt, shape (n_θ, n_z, n_φ)."""
    u = flow(Psi, values, length)[..., None]
    carried = u[0] * derivative(Psi, 0, 2 * np.pi) + u[1] * derivative(Psi, 1, length)
    spread = derivative(Psi, 0, 2 * np.pi, 2) + derivative(Psi, 1, length, 2)
    turned = derivative(turning(Psi, values, length) * Psi, 2, 2 * np.pi)
    noise = derivative(Psi, 2, 2 * np.pi, 2)
    return (
        -value(values, "epsilon") * carried
        + value(values, "d_s") * spread
        + value(values, "d_r") * noise
        - turned
    )


def integrated(Psi, values, length, t_end, dt):
    """Return Ψ at t_end by classical Runge-Kutta steps, dt or a little less."""
    steps = max(1, int(np.ceil(t_end / dt - 1e-9)))
    h = t_end / steps
    for _ in range(steps):
        a = rate(Psi, values, length)
        b = rate(Psi + h / 2 * a, values, length)
        c = rate(Psi + h / 2 * b, values, length)
        d = rate(Psi + h * c, values, length)
        Psi = Psi + h / 6 * (a + 2 * b + 2 * c + d)
    return Psi


def moments(Psi, n_max):
    """Return ∫exp(inφ) Ψ dφ for n = 0..n_max, shape (n_max + 1, n_θ, n_z)."""
    phi = angles(Psi.shape[2])
    weight = 2 * np.pi / Psi.shape[2]
    return np.stack([weight * (Psi * np.exp(1j * n * phi)).sum(axis=2) for n in range(n_max + 1)])
