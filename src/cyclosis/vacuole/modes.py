"""The Stokes flow of one wave of the wall's velocity, as real radial functions.

The wall r = 1 moves with (0, a, b) e^{i(nθ + κz)}, components (r, θ, z). With I_n(κr) for every harmonic
function, the solution of ∇p = ∇²v, ∇·v = 0 is, for n, κ >= 0,

    v_r = i (r_a a + r_b b),  v_θ = θ_a a + θ_b b,  v_z = z_a a + z_b b,  p = i (p_a a + p_b b)

with real functions of r, given in docs/theory_vacuole.md. They are written in
t_n(x) = I_{n+1}(x)/(x I_n(x)) (see `model.bessel`), so that nothing overflows, nothing cancels on the axis
or at the wall, and κ = 0 is not special. For other signs, r_a and p_a take the sign of m, r_b and p_b that
of q, θ_b and z_a that of mq.

For n = κ = 0 the wall pulls the fluid along. Here the cell is closed: no net flux, and a pressure gradient
8b.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..model.bessel import Array, ratios
from ..model.interior import constants


class Radial(NamedTuple):
    """The radial functions, arrays (n_r, n_max + 1, n_q); see the module for their meaning."""

    r_a: Array
    r_b: Array
    theta_a: Array
    theta_b: Array
    z_a: Array
    z_b: Array
    p_a: Array
    p_b: Array


def radial(n_max: int, kappa: Array, r: Array) -> Radial:
    """Return the `Radial` functions of n = 0 to `n_max` and κ >= 0 (n_q,) at radii (n_r,) from 0 to 1."""
    from scipy.special import i0e  # needed only here, and slow to load

    k = constants(n_max, kappa)
    radii = r[:, None, None]
    x = r[:, None] * kappa
    t = np.moveaxis(ratios(n_max + 1, x), 0, 1)  # (n_r, n_max + 2, n_q)
    # I_n(κr)/I_n(κ) = r^n G_n, with G_{n+1}/G_n = t_n(κr)/t_n(κ)
    first = i0e(x) / i0e(kappa) * np.exp(-kappa * (1.0 - r[:, None]))
    G = np.cumprod(np.concatenate([first[:, None], t[:, :-2] / k.T[:-1]], axis=1), axis=1)
    g = radii**k.n * G
    below = radii ** np.maximum(k.n - 1.0, 0.0) * G  # g/r for n > 0
    below[:, 0] *= r[:, None]  # g r for n = 0
    bend = radii**2 * t[:, :-1] - k.T
    H = (k.Lam + 2.0) * bend + (1.0 - radii**2)
    out = Radial(
        r_a=-below * k.c_a * H,
        r_b=-below * (kappa * bend + k.c_b * H),
        theta_a=below * (1.0 + k.s_a * bend),
        theta_b=below * k.s_b * bend,
        z_a=-g * kappa * k.c_a * bend,
        z_b=g * (1.0 - kappa * k.c_b * bend),
        p_a=2 * k.c_a * g,
        p_b=2 * k.c_b * g,
    )
    apart = k.T[0] - k.T1[0]
    out.r_b[:, 0] = -kappa * below[:, 0] * t[:, 0] * (r[:, None] ** 2 * t[:, 1] - k.T1[0]) / apart
    out.theta_a[:, 0] = below[:, 0] * t[:, 0] / k.T[0]
    out.z_b[:, 0] = g[:, 0] * (1.0 + bend[:, 0] / apart)
    return out
