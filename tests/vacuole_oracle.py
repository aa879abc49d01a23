"""Stokes flow in a cylinder to fifty digits and more, wave by wave: an oracle for `cyclosis.vacuole`.

Nothing is shared with the package. The general solution of Happel & Brenner is made of three harmonic
functions I_m(κr) e^{i(mθ + qz)},

    v = grad Ψ + curl(Ω e_z) + r ∂_r(grad X) + e_z ∂_z X,   p = -2 ∂_zz X

and the three amplitudes follow from v(1) = (0, a, b) by solving three linear equations with many digits,
which the cancellation of large numbers near the axis cannot exhaust. For q = 0 the solution is a polynomial.
"""

from __future__ import annotations

import mpmath as mp


def wave(m, q, a, b, r, digits=60):
    """Return (v_r, v_theta, v_z), p and (dv_theta/dr - v_theta, dv_z/dr at r = 1) of one wave at radius r."""
    with mp.workdps(digits):
        m, q, a, b, r = (mp.mpf(value) for value in (m, q, a, b, r))
        velocity, pressure = _flow(m, q, a, b)
        at, wall = velocity(r), mp.mpf(1)
        step = mp.mpf(10) ** (-digits // 4)
        # One-sided differences of second order, with steps far below double precision.
        near = [velocity(wall - k * step) for k in range(3)]
        slopes = [(3 * near[0][c] - 4 * near[1][c] + near[2][c]) / (2 * step) for c in (1, 2)]
        stress = (complex(slopes[0] - near[0][1]), complex(slopes[1]))
        return tuple(map(complex, at)), complex(pressure(r)), stress


def _flow(m, q, a, b):
    if q == 0:
        return _along(m, a, b)
    n, kappa = abs(m), abs(q)

    def potentials(r):
        f = mp.besseli(n, kappa * r)
        first = kappa * mp.besseli(n + 1, kappa * r) + n / r * f
        second = (kappa**2 + n**2 / r**2) * f - first / r
        i = mp.mpc(0, 1)
        grad = (first, i * m / r * f, i * q * f)
        curl = (i * m / r * f, -first, mp.mpf(0))
        spread = (r * second, i * m * (first - f / r), i * q * (r * first + f))
        return grad, curl, spread, f

    grad, curl, spread, _ = potentials(mp.mpf(1))
    found = mp.lu_solve(mp.matrix([[grad[c], curl[c], spread[c]] for c in range(3)]), mp.matrix([0, a, b]))

    def velocity(r):
        parts = potentials(r)
        return [sum(parts[k][c] * found[k] for k in range(3)) for c in range(3)]

    return velocity, lambda r: 2 * q**2 * potentials(r)[3] * found[2]


def _along(m, a, b):
    """The flow of a wave that does not vary along z: a polynomial, which the equations confirm by hand."""
    n, i = abs(m), mp.mpc(0, 1)
    if n == 0:
        return (lambda r: [mp.mpf(0), a * r, b * (2 * r**2 - 1)]), (lambda r: mp.mpf(0))

    def velocity(r):
        return [
            i * m * a / 2 * r ** (n - 1) * (1 - r**2),
            a / 2 * ((n + 2) * r ** (n + 1) - n * r ** (n - 1)),
            b * r**n,
        ]

    return velocity, lambda r: -2 * i * mp.sign(m) * (n + 1) * a * r**n
