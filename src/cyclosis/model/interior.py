"""How the fluid in the vacuole answers the wall: the stress of one wave of the wall's velocity, and its drag.

The wall r = 1 moves with (0, a, b) e^{i(nθ + κz)}, components (r, θ, z). The Stokes flow inside, of viscosity
η = 1, is built from harmonic functions I_n(κr) e^{i(nθ + κz)}; docs/theory_vacuole.md derives it.
Everything is written in T = t_n(κ) (see `bessel`), so that long and short waves are as exact as any.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from .bessel import Array, ratios


class Wall(NamedTuple):
    """The response at the wall, arrays (n_max + 1, n_q): tangential stress of the wall on the fluid.

    τ_rθ = theta_a a + cross b,  τ_rz = cross a + z_b b, with a common `cross`: the response is symmetric.
    """

    theta_a: Array
    cross: Array
    z_b: Array


class Constants(NamedTuple):
    """What does not depend on r, arrays (n_max + 1, n_q), except n (n_max + 1, 1) and kappa (n_q,)."""

    n: Array
    kappa: Array
    T: Array
    """t_n(κ)"""
    T1: Array
    """t_{n+1}(κ)"""
    Lam: Array
    """κ I_n'(κ)/I_n(κ) = n + κ² T"""
    nu: Array
    """Its slope at the wall over κ², T (2 - κ² (T - T1))"""
    c_a: Array
    """Share of a in the harmonic function of the pressure, c = i (c_a a + c_b b), p = 2 c I_n(κr)/I_n(κ)"""
    c_b: Array
    s_a: Array
    """Share of a in that of the swirl; both s are 0 for n = 0, where the swirl follows by itself"""
    s_b: Array


def constants(n_max: int, kappa: Array) -> Constants:
    """Return the `Constants` of n = 0 to `n_max` and κ >= 0 (n_q,)."""
    n = np.arange(n_max + 1.0)[:, None]
    square = kappa**2
    t = ratios(n_max + 1, kappa)
    T, T1 = t[:-1], t[1:]
    Lam = n + square * T
    nu = T * (2.0 - square * (T - T1))
    D = nu * (Lam + 2.0) - 2.0
    D[0] = -1.0  # not used
    c_a = n / D
    c_b = kappa * T * (2 * n + square * T) / D
    # The pressure of a wave along z (n = 0) grows as 1/κ when it becomes long.
    c_b[0] = -1.0 / (np.where(kappa > 0, kappa, np.inf) * (T[0] - T1[0]))
    divided = np.maximum(n, 1.0)
    M = n**2 - square * nu + 2 * Lam
    s_a = -c_a * M / divided
    s_b = -(c_b * M + kappa * Lam) / divided
    s_a[0] = s_b[0] = 0.0
    return Constants(n, kappa, T, T1, Lam, nu, c_a, c_b, s_a, s_b)


def wall(n_max: int, kappa: Array) -> Wall:
    """Return the `Wall` response of n = 0 to `n_max` and κ >= 0 (n_q,)."""
    k = constants(n_max, kappa)
    theta_a = k.Lam - 2.0 + k.nu * k.s_a
    z_b = k.Lam - kappa * k.c_b * k.nu
    theta_a[0] = kappa**2 * k.T1[0]
    z_b[0] = 2 * k.T[0] / (k.T[0] - k.T1[0])
    return Wall(theta_a, -kappa * k.c_a * k.nu, z_b)


def drag(m: Array, q: Array) -> Array:
    """Return the drag Z of the vacuole on solenoidal waves of its wall, Re(τ·u*)/|u|², in units of ηU/R.

    `m` and `q` are wavenumbers that broadcast; m is whole. Of m a + q b = 0 only the wave (a, b) = (-q, m) is
    left. Z = |m| for q = 0, and q I_2(q)/I_1(q) for m = 0. The mean has none, as the fluid
    turns with the wall.
    """
    m, q = np.broadcast_arrays(np.abs(m), np.abs(q))
    kappa, place = np.unique(q, return_inverse=True)
    rows = np.rint(m).astype(int)
    response = wall(int(rows.max(initial=0)), kappa)
    theta_a, cross, z_b = (part[rows, place.reshape(q.shape)] for part in response)
    square = m**2 + q**2
    Z = theta_a * q**2 - 2 * m * q * cross + z_b * m**2
    return Z / np.where(square > 0, square, 1.0)
