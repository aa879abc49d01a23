"""The model in Dedalus v3: Fourier x Fourier, implicit-explicit steps, the flow as a spectral operator.

Diffusion is implicit. The flow is a function of P, diagonal in Fourier space, so that it is applied within
the right-hand side rather than solved for: with it as an unknown, multistep schemes would lag behind it.
Products are formed in two functions on the grid, which takes half the time of the same in Dedalus'
expressions, and one matrix over all modes takes less than one for every mode.
"""

import os

os.environ.setdefault("OMP_NUM_THREADS", "1")

import dedalus.public as d3
import numpy as np
from dedalus.core.timesteppers import MultistepIMEX


def differentiated(a, k, axis):
    """Differentiate coefficients of cos(kx) and -sin(kx), which alternate along an axis."""
    cos, sin = np.moveaxis(a, axis, -1)[..., 0::2], np.moveaxis(a, axis, -1)[..., 1::2]
    pairs = np.stack([-k * sin, k * cos], axis=-1)
    return np.moveaxis(pairs.reshape(*pairs.shape[:-2], -1), -1, axis)


def steps(dt, count, gently):
    """Return the steps of a run: a multistep scheme, which starts at first order, starts with small ones.

    They grow by a quarter each, to four whole steps in all: growth by doubling costs SBDF4 its order.
    """
    growing = 1.25 ** np.arange(-16.0, 0.0)
    return [*(4 * dt * growing / growing.sum()), *[dt] * (count - 4)] if gently else [dt] * count


def prepare(params, n, length, dt, scheme="RK443", dealias=1):
    """Return a function that takes a state P to time t in steps of `dt`."""
    p, scheme = params, getattr(d3, scheme)
    coords = d3.CartesianCoordinates("theta", "z")
    dist = d3.Distributor(coords, dtype=np.float64)
    extents = {"theta": 2 * np.pi, "z": length}
    bases = [d3.RealFourier(coords[x], n, bounds=(0, extents[x]), dealias=dealias) for x in extents]
    P = dist.VectorField(coords, name="P", bases=bases)

    m, q = np.arange(n // 2), 2 * np.pi / length * np.arange(n // 2)
    k2 = np.repeat(m, 2)[:, None] ** 2 + np.repeat(q, 2) ** 2
    k2[k2 == 0] = np.inf
    damping = 1 / k2 / (1 + p.mu * k2)

    def function_of(function, layout, *fields):
        return d3.GeneralFunction(dist, P.domain, P.tensorsig, np.float64, layout, function, fields)

    def force(P):
        return (P.data[0] ** 2 + P.data[1] ** 2) * P.data

    def flow(F):
        curl = differentiated(F.data[1], m, 0) - differentiated(F.data[0], q, 1)
        stream = damping * curl
        u = np.stack([differentiated(stream, q, 1), -differentiated(stream, m, 0)])
        u[0, 0, 0] = F.data[0, 0, 0]
        return u

    def rate(P, grad_P, u, grad_u):
        P, u, dP, du = P.data, u.data, grad_P.data, grad_u.data
        T = p.epsilon * (P[0] * du[0] + P[1] * du[1]) + p.alpha_p * P + p.alpha_u * u
        T[0] -= p.kappa * P[0]
        return T - P * (P[0] * T[0] + P[1] * T[1]) - p.epsilon * (u[0] * dP[0] + u[1] * dP[1])

    u = function_of(flow, "c", function_of(force, "g", P))
    N = function_of(rate, "g", P, d3.grad(P), u, d3.grad(u))
    problem = d3.IVP([P], namespace={"P": P, "N": N, "d_s": p.d_s, "d_r": p.d_r})
    problem.add_equation("dt(P) - d_s*lap(P) + d_r*P = N")
    solver = problem.build_solver(scheme, matrix_coupling=(True, True))

    def advance(state, t_end):
        solver.timestepper = scheme(solver)  # forget the steps of the run before
        P.change_scales(1)
        P["g"] = state
        for step in steps(dt, round(t_end / dt), gently=issubclass(scheme, MultistepIMEX)):
            solver.step(step)
        P.change_scales(1)
        return P["g"].copy()

    return advance
