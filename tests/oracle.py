"""The model in plain array code, straight from its equations: an oracle for the package's right-hand side.

Nothing is shared with the package and nothing is clever: every real component has its own full transform,
every derivative and every product of the equations is written out.

    dP/dt + ε (u·∇)P = d_s ∇²P - d_r P + (I - PP)·[ε (P·∇)u + α_p P + α_u u - κ (P·d) d]
    -μ ∇²u + u + Π₀ e_z + ∇Π' = F = |P|ⁿ P,   ∇·u = 0,   <u_z> = 0,   d = (cos φ, sin φ)

`p` is anything with the attributes alpha_p, alpha_u, epsilon, d_s, d_r, kappa, mu, repulsion_angle,
zero_theta_flux and force_exponent. Conventions: modes at the Nyquist frequency are dropped from the state,
from the flow and from the result. With `fine`, a larger grid, all products are formed there (coefficient
fields of `p` are then given on it), while the force is cut back to the state's modes before it drives the
flow.
"""

from __future__ import annotations

import numpy as np

TERMS = (
    "advection", "shear", "bundling", "flow_alignment", "repulsion", "diffusion", "rotational_diffusion",
)  # fmt: skip


def wavenumbers(shape, length):
    """Return m and q as arrays that broadcast over (n_theta, n_z), in transform order."""
    n, k = shape
    m = np.array([i if i <= n // 2 else i - n for i in range(n)], dtype=float)
    j = np.array([i if i <= k // 2 else i - k for i in range(k)], dtype=float)
    return m[:, None], (2 * np.pi / length) * j[None, :]


def resampled(f, shape):
    """Return a scalar field on a grid of another shape: common modes below both Nyquist frequencies."""
    old = f.shape
    spectrum = np.fft.fft2(f) / (old[0] * old[1])
    m, j = ((min(a, b) - 1) // 2 for a, b in zip(old, shape, strict=True))
    rows, cols = (np.array([*range(h + 1), *range(-h, 0)]) for h in (m, j))
    kept = spectrum[np.ix_(rows % old[0], cols % old[1])]
    at = np.ix_(rows % shape[0], cols % shape[1])
    padded = np.zeros(shape, dtype=complex)
    padded[at] = kept
    return np.fft.ifft2(padded).real * (shape[0] * shape[1])


def both(f, shape):
    """Resample the two components of a vector field."""
    return np.stack([resampled(f[0], shape), resampled(f[1], shape)])


def gradient(f, length):
    """Return (df/dtheta, df/dz) of a scalar field without Nyquist modes."""
    m, q = wavenumbers(f.shape, length)
    spectrum = np.fft.fft2(f)
    return np.fft.ifft2(1j * m * spectrum).real, np.fft.ifft2(1j * q * spectrum).real


def laplacian(f, length):
    """Return the Laplacian of a scalar field."""
    m, q = wavenumbers(f.shape, length)
    return np.fft.ifft2(-(m**2 + q**2) * np.fft.fft2(f)).real


def force(p, P):
    """Return F = |P|ⁿ P."""
    return (P[0] ** 2 + P[1] ** 2) ** (p.force_exponent / 2) * P


def driven_flow(p, length, F):
    """Solve the momentum balance mode by mode: u_k = (I - kk/k²) F_k / (1 + μ k²), then the means."""
    n_theta, n_z = F[0].shape
    m, q = wavenumbers((n_theta, n_z), length)
    k2 = m**2 + q**2
    some = np.where(k2 > 0, k2, 1.0)
    Ft, Fz = np.fft.fft2(F[0]), np.fft.fft2(F[1])
    along = (m * Ft + q * Fz) / some
    not_mean = k2 > 0
    ut = not_mean * (Ft - m * along) / (1 + p.mu * k2)
    uz = not_mean * (Fz - q * along) / (1 + p.mu * k2)
    u = np.stack([np.fft.ifft2(ut).real, np.fft.ifft2(uz).real])
    mean_theta = 0.0 if p.zero_theta_flux else F[0].mean()
    return np.stack([u[0] + mean_theta, u[1]])


def flow(p, length, P, fine=None):
    """Return the flow that a state drives, on the state's grid."""
    shape = P[0].shape
    F = force(p, both(P, fine or shape))
    return driven_flow(p, length, both(F, shape))


def terms(p, length, P, names=TERMS, fine=None):
    """Return the named terms of dP/dt, each of shape (2, n_theta, n_z)."""
    shape = P[0].shape
    u = both(flow(p, length, P, fine), fine or shape)
    P = both(P, fine or shape)
    d = (np.cos(p.repulsion_angle), np.sin(p.repulsion_angle))
    grad_P = [gradient(P[i], length) for i in (0, 1)]
    grad_u = [gradient(u[i], length) for i in (0, 1)]

    def projected(T):
        along = P[0] * T[0] + P[1] * T[1]
        return [T[0] - P[0] * along, T[1] - P[1] * along]

    def one(name):
        if name == "advection":
            return [-p.epsilon * (u[0] * grad_P[i][0] + u[1] * grad_P[i][1]) for i in (0, 1)]
        if name == "shear":
            return projected([p.epsilon * (P[0] * grad_u[i][0] + P[1] * grad_u[i][1]) for i in (0, 1)])
        if name == "bundling":
            return projected([p.alpha_p * P[i] for i in (0, 1)])
        if name == "flow_alignment":
            return projected([p.alpha_u * u[i] for i in (0, 1)])
        if name == "repulsion":
            across = P[0] * d[0] + P[1] * d[1]
            return projected([-p.kappa * across * d[i] for i in (0, 1)])
        if name == "diffusion":
            return [p.d_s * laplacian(P[i], length) for i in (0, 1)]
        if name == "rotational_diffusion":
            return [-p.d_r * P[i] for i in (0, 1)]
        raise ValueError(name)

    return {name: both(one(name), shape) for name in names}


def rate(p, length, P, names=TERMS, fine=None):
    """Return dP/dt, shape (2, n_theta, n_z)."""
    return sum(terms(p, length, P, names, fine).values())
