"""The model by hand in Numba and FFTW: real transforms in batches, fourth-order exponential steps.

A right-hand side takes twelve real transforms in four calls of FFTW, and three loops over the points or the
waves between them. A step's sums are formed in the loop that ends each right-hand side. Modes are divided by
the number of points, so that no transform back needs a factor.
"""

import math

import numpy as np
import pyfftw
from numba import njit

PHYSICAL, WAVES = "float64", "complex128"
compiled = njit(fastmath=True, error_model="numpy")


def phi(z):
    """Return phi_1, phi_2 and phi_3 of z <= 0: a series near 0, the recurrence elsewhere."""
    small, large = np.where(z > -1, z, 0.0), np.where(z > -1, -1.0, z)
    found, last = [], np.exp(large)
    for k in (1, 2, 3):
        last = (last - 1 / math.factorial(k - 1)) / large
        series = sum(small**j / math.factorial(j + k) for j in range(18))
        found.append(np.where(z > -1, series, last))
    return found


def tableau(z, h):
    """Return the coefficients of ETDRK4-B (Krogstad 2005) for a step h and z = h L."""
    half1, half2, _ = phi(z / 2)
    full1, full2, full3 = phi(z)
    first = [np.exp(z / 2), h / 2 * half1, h * (half1 / 2 - half2), h * half2]
    last = [h * (full1 - 2 * full2), 2 * h * full2, h * (full1 - 3 * full2 + 4 * full3)]
    return np.stack([*first, np.exp(z), *last, 2 * h * (full2 - 2 * full3), h * (4 * full3 - full2)])


@compiled
def spread(Z, m, q, A):
    """Write the modes of P and of its divergence."""
    for i in range(m.size):
        for j in range(q.size):
            a, b = Z[0, i, j], Z[1, i, j]
            A[0, i, j], A[1, i, j] = a, b
            A[2, i, j] = 1j * (m[i] * a + q[j] * b)


@compiled
def force(p, F):
    """Write the force of the filaments."""
    for i in range(p.shape[1]):
        for j in range(p.shape[2]):
            a, b = p[0, i, j], p[1, i, j]
            square = a * a + b * b
            F[0, i, j], F[1, i, j] = square * a, square * b


@compiled
def flow(F, m, q, damping, B):
    """Write the modes of the flow and of its strain."""
    for i in range(m.size):
        for j in range(q.size):
            stream = damping[i, j] * (q[j] * F[0, i, j] - m[i] * F[1, i, j])
            u, v = q[j] * stream, -m[i] * stream
            B[0, i, j], B[1, i, j] = u, v
            B[2, i, j], B[3, i, j] = 1j * (m[i] * u), 0.5j * (q[j] * u + m[i] * v)
    B[0, 0, 0] = damping[0, 0] * F[0, 0, 0]


@compiled
def rate(p, u, values, C):
    """Write the rate of P without the curl of s, and s itself, the third field."""
    epsilon, alpha_p, alpha_u, kappa = values
    for i in range(p.shape[1]):
        for j in range(p.shape[2]):
            a, b, divergence = p[0, i, j], p[1, i, j], p[2, i, j]
            x, y, tt, tz = u[0, i, j], u[1, i, j], u[2, i, j], u[3, i, j]
            f, g = (alpha_p - kappa) * a + alpha_u * x, alpha_p * b + alpha_u * y
            along = a * f + b * g + epsilon * (tt * (a * a - b * b) + 2 * tz * a * b)
            C[0, i, j] = f - a * along - epsilon * divergence * x
            C[1, i, j] = g - b * along - epsilon * divergence * y
            C[2, i, j] = epsilon * (x * b - y * a)


def stage(k):
    """Return the loop that ends the right-hand side of stage k: it writes N and the next state."""

    @compiled
    def ended(C, m, q, kept, c, Z, N, S, A):
        for i in range(m.size):
            for j in range(q.size):
                s, w = 1j * C[2, i, j], kept[i, j]
                for x in range(2):
                    n = w * (C[x, i, j] + (q[j] * s if x == 0 else -m[i] * s))
                    if k == 0:
                        N[x, i, j] = n
                        new = c[0, i, j] * Z[x, i, j] + c[1, i, j] * n
                    elif k == 1:
                        S[x, i, j] = n
                        new = c[0, i, j] * Z[x, i, j] + c[2, i, j] * N[x, i, j] + c[3, i, j] * n
                    elif k == 2:
                        S[x, i, j] += n
                        new = c[4, i, j] * Z[x, i, j] + c[5, i, j] * N[x, i, j] + c[6, i, j] * n
                    else:
                        new = c[4, i, j] * Z[x, i, j] + c[7, i, j] * N[x, i, j]
                        new += c[8, i, j] * S[x, i, j] + c[9, i, j] * n
                        Z[x, i, j] = new
                    A[x, i, j] = new
                A[2, i, j] = 1j * (m[i] * A[0, i, j] + q[j] * A[1, i, j])

    return ended


STAGES = [stage(k) for k in range(4)]


def transforms(n, fields, forward):
    """Return a planned transform of some fields at once."""
    p = pyfftw.empty_aligned((fields, n, n), PHYSICAL)
    k = pyfftw.empty_aligned((fields, n, n // 2 + 1), WAVES)
    ends, direction = ((p, k), "FFTW_FORWARD") if forward else ((k, p), "FFTW_BACKWARD")
    flags = ("FFTW_MEASURE",) if forward else ("FFTW_MEASURE", "FFTW_DESTROY_INPUT")
    return pyfftw.FFTW(*ends, axes=(1, 2), direction=direction, flags=flags, threads=1)


def prepare(params, n, length, dt):
    """Return a function that takes a state P to time t in steps of `dt`."""
    p = params
    m, q = np.fft.fftfreq(n, 1 / n), 2 * np.pi / length * np.arange(n // 2 + 1)
    k2 = m[:, None] ** 2 + q**2
    c = tableau(-dt * (p.d_s * k2 + p.d_r), dt)
    highest = (2 * abs(m) == n)[:, None] | (2 * np.arange(n // 2 + 1) == n)
    kept = np.where(highest, 0, n**-2.0)
    damping = kept / np.where(k2 > 0, k2, 1) / (1 + p.mu * k2)
    m, q = np.where(2 * abs(m) == n, 0, m), np.where(2 * np.arange(n // 2 + 1) == n, 0, q)
    values = (float(p.epsilon), float(p.alpha_p), float(p.alpha_u), float(p.kappa))

    to_p, to_force = transforms(n, 3, False), transforms(n, 2, True)
    to_flow, to_rate = transforms(n, 4, False), transforms(n, 3, True)
    A, P, F_at, F = to_p.input_array, to_p.output_array, to_force.input_array, to_force.output_array
    B, u, C_at, C = to_flow.input_array, to_flow.output_array, to_rate.input_array, to_rate.output_array
    Z, N, S = (np.zeros((2, n, n // 2 + 1), complex) for _ in range(3))

    def step():
        for ended in STAGES:
            to_p.execute()
            force(P, F_at)
            to_force.execute()
            flow(F, m, q, damping, B)
            to_flow.execute()
            rate(P, u, values, C_at)
            to_rate.execute()
            ended(C, m, q, kept, c, Z, N, S, A)

    def advance(state, t_end):
        Z[:] = kept * np.fft.rfft2(state)
        spread(Z, m, q, A)
        for _ in range(round(t_end / dt)):
            step()
        return np.fft.irfft2(Z * n**2, s=(n, n))

    advance(np.zeros((2, n, n)), dt)  # compiles
    return advance
