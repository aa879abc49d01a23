"""The growth of unequal widths in 40 digits: the one-dimensional equations again, from the formulas alone.

    d_s P'' - d_r P + (1 - P²)(α_p P + α_u u) = 0,    u - μ u'' = P³,    P odd about 0, even about π/2
    L v = d_s v'' + [-d_r + α_p (1 - 3P²) - 2 α_u P u] v + 3 α_u (1 - P²) [G(P² v) - <P² v>]

for even v of period π, on the midpoints of a quarter of a turn, where sines of odd and cosines of even
wavenumbers are complete. Shares nothing with the package.
"""

from __future__ import annotations

from functools import lru_cache

from mpmath import mp, mpf

DIGITS = 40


@lru_cache(maxsize=2)
def _quarter(points):
    """Return the values of the waves at the points, wavenumbers and the matrices of modes to values."""
    theta = [mp.pi * (2 * i + 1) / (4 * points) for i in range(points)]
    odd, even = ([2 * j + start for j in range(points)] for start in (1, 0))
    sines = mp.matrix([[mp.sin(m * x) for m in odd] for x in theta])
    cosines = mp.matrix([[mp.cos(m * x) for m in even] for x in theta])
    return theta, (odd, sines, sines**-1), (even, cosines, cosines**-1)


def _operator(waves, symbol):
    m, values, modes = waves
    scaled = modes.copy()
    for j in range(len(m)):
        for i in range(len(m)):
            scaled[j, i] *= symbol(m[j])
    return values * scaled


def growth(alpha_p, alpha_u, points, d_s="0.025", d_r="0.025", mu="0.05"):
    """Return the growth rate of unequal widths at parameters given as texts, or as doubles taken as exact."""
    with mp.workdps(DIGITS):
        alpha_p, alpha_u, d_s, d_r, mu = map(mpf, (alpha_p, alpha_u, d_s, d_r, mu))
        theta, sines, cosines = _quarter(points)
        spread, answer = (
            _operator(sines, lambda m: -d_s * m**2),
            _operator(sines, lambda m: 1 / (1 + mu * m**2)),
        )
        width = mp.sqrt(2 * d_s / (alpha_p - d_r))
        P = mp.matrix([mp.tanh(mp.sin(x) / width) * mp.sqrt(1 - d_r / alpha_p) for x in theta])

        def linear(diffusion, green):
            matrix = diffusion.copy()
            for i, p in enumerate(P):
                for j, other in enumerate(P):
                    matrix[i, j] += 3 * alpha_u * (1 - p**2) * green[i, j] * other**2
                matrix[i, i] += alpha_p * (1 - 3 * p**2) - d_r - 2 * alpha_u * p * flow[i]
            return matrix

        for _ in range(40):
            flow = answer * mp.matrix([p**3 for p in P])
            rate = spread * P
            for i, p in enumerate(P):
                rate[i] += (1 - p**2) * (alpha_p * p + alpha_u * flow[i]) - d_r * p
            change = mp.lu_solve(linear(spread, answer), rate)
            P -= change
            if mp.norm(change, mp.inf) < mpf(10) ** (5 - DIGITS):
                break
        flow = answer * mp.matrix([p**3 for p in P])
        matrix = linear(
            _operator(cosines, lambda m: -d_s * m**2),
            _operator(cosines, lambda m: 0 if m == 0 else 1 / (1 + mu * m**2)),
        )
        # Inverse iteration: next to this eigenvalue all others are far away.
        v = mp.matrix([mp.sech(mp.sin(x) / width) ** 2 for x in theta])
        for _ in range(8):
            v /= mp.norm(v)
            inverse = mp.lu_solve(matrix, v)
            rate, v = (v.T * v)[0] / (v.T * inverse)[0], inverse
        return rate
