"""The equations tested with bumps: no derivative of P is taken, and the parameters enter linearly.

With a test function φ(t, θ, z) and ⟨ ⟩ for the integral, each component i of the filament equation gives

    -⟨P_i ∂_t φ⟩ = ε [⟨u_j P_i ∂_j φ⟩ + ⟨φ (P_j ∂_j u_i - P_i P_k P_j ∂_j u_k)⟩] + d_s ⟨P_i ∇²φ⟩ - d_r ⟨φ P_i⟩
                   + α_p ⟨φ (1 - P²) P_i⟩ + α_u ⟨φ (u_i - P_i P·u)⟩ - κ ⟨φ (P·d) (d_i - P_i P·d)⟩

and the curl of the flow equation, which needs neither the pressure nor the part of the cell that is not seen,

    ⟨φ ω⟩ - μ ⟨φ ∇²ω⟩ = U ⟨φ (∂_θ F_z - ∂_z F_θ)⟩,    ω = ∂_θ u_z - ∂_z u_θ,    F = |P|² P,

with all derivatives moved onto φ. Noise n of P with variances s_θ², s_z² adds to products what is subtracted
here: ⟨|P + n|² (P + n)_i⟩ = |P|² P_i + (s_θ² + s_z² + 2 s_i²) P_i, and so on.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from ..model.grid import Array
from .bumps import InSpace

FILAMENTS = ("epsilon", "d_s", "d_r", "alpha_p", "alpha_u", "kappa")
"""The parameters of the filament equation, in the order of their columns."""
FLOW = ("mu", "U")
"""Those of the flow equation."""
RATES = ("d_s", "d_r", "alpha_p", "kappa")
"""Those that are measured in U/R, so that they scale with the unit of speed."""

RIDGE = 0.1
"""Directions of bumps whose noise has a smaller share of the largest variance are not amplified further."""


@dataclass(frozen=True, eq=False)
class Rows:
    """What test functions give: filaments (rows, 1 + 6) and flow (rows, 1 + 2), the left-hand side first."""

    filaments: Array
    flow: Array


@dataclass(frozen=True, eq=False)
class White:
    """Matrices over bumps in space and over bumps in time, for the rows of the flow equation."""

    space: Array
    time: Array


@dataclass(frozen=True, eq=False)
class Chart:
    """The map from grid indices to the surface: `frame` (2, 2, n_theta, n_z) takes vectors to it.

    `slope_theta` and `slope_z` are matrices of differentiation along the window's own coordinates and
    `inverse` (2, 2, n_theta, n_z) the derivatives ∂(own)/∂(surface).
    """

    slope_theta: Array
    slope_z: Array
    inverse: Array | None = None

    def gradient(self, field: Array) -> tuple[Array, Array]:
        """Return the derivatives along θ and z of a field (..., n_theta, n_z)."""
        a, b = self.slope_theta @ field, field @ self.slope_z.T
        if self.inverse is None:
            return a, b
        J = self.inverse
        return J[0, 0] * a + J[1, 0] * b, J[0, 1] * a + J[1, 1] * b


def rows(
    P: Array,
    u: Array,
    noise: Array,
    angle: float,
    chart: Chart,
    time: tuple[Array, Array],
    space: InSpace,
    white: White | None = None,
) -> Rows:
    """Return the `Rows` of fields (n, 2, n_theta, n_z), with the variance of the noise of P taken out.

    `noise` is (2, n_theta, n_z), `angle` that of the repulsive direction from e_theta, `time` and `space` the
    bumps, and `white` what makes the noise of the rows of the flow equation independent.
    """
    value, slope = time

    def reduced(field: Array, by: Array = value) -> Array:
        """Return (points, bumps in time)."""
        flat = field.reshape(field.shape[0], -1)
        return (by @ flat).T

    def integral(matrix: object, field: Array) -> Array:
        return np.asarray(matrix @ field)  # type: ignore[operator]

    filaments = []
    s_theta, s_z = noise
    total = s_theta + s_z
    d = (np.cos(angle), np.sin(angle))
    dP = d[0] * P[:, 0] + d[1] * P[:, 1]
    s_d = d[0] ** 2 * s_theta + d[1] ** 2 * s_z
    square, power = P[:, 0] ** 2 + P[:, 1] ** 2, P[:, 0] * u[:, 0] + P[:, 1] * u[:, 1]
    G = [chart.gradient(u[:, k]) for k in range(2)]  # G[k][j] = ∂_j u_k
    along = [P[:, 0] * G[k][0] + P[:, 1] * G[k][1] for k in range(2)]
    stretch = P[:, 0] * along[0] + P[:, 1] * along[1]
    trace = s_theta * G[0][0] + s_z * G[1][1]
    F = []
    for i in range(2):
        p, s = P[:, i], noise[i]
        F.append(square * p - (total + 2 * s) * p)
        turned = P[:, 0] * G[0][i] + P[:, 1] * G[1][i]
        shear = along[i] - (p * stretch - s * along[i] - s * turned - trace * p)
        repelled = dP * d[i] - (p * dP**2 - s_d * p - 2 * d[i] * s * dP)
        carried = integral(space.theta, reduced(u[:, 0] * p)) + integral(space.z, reduced(u[:, 1] * p))
        p_t = reduced(p)
        filaments.append(
            np.stack([
                -integral(space.value, reduced(p, slope)),
                carried + integral(space.value, reduced(shear)),
                integral(space.laplacian, p_t),
                -integral(space.value, p_t),
                integral(space.value, reduced(p - F[i])),
                integral(space.value, reduced(u[:, i] - (p * power - s * u[:, i]))),
                -integral(space.value, reduced(repelled)),
            ])
        )  # fmt: skip
    U_t, F_t = [reduced(u[:, k]) for k in range(2)], [reduced(F[k]) for k in range(2)]

    def curl(theta: object, z: object, field: list[Array]) -> Array:
        return integral(z, field[0]) - integral(theta, field[1])

    flow = np.stack([
        curl(space.theta, space.z, U_t),
        curl(space.theta3, space.z3, U_t),
        curl(space.theta, space.z, F_t),
    ])  # fmt: skip
    joined = np.stack(filaments, axis=1)
    if white is not None:
        flow = white.space @ flow @ white.time.T
    return Rows(joined.reshape(joined.shape[0], -1).T, flow.reshape(flow.shape[0], -1).T)


def whitening(
    time: tuple[Array, Array], space: InSpace, noise: tuple[Array, Array], mu: float, force: float
) -> White:
    """Return what makes the noise of the rows of the flow equation independent.

    Rows overlap, and much of the noise of one is that of its neighbours: of u - μ ∇²u and of the force, whose
    variance is `force` times that of P. `noise` has the variances of P and of u.
    """
    s_P, s_u = (np.maximum(f, 1e-300).reshape(2, -1) for f in noise)
    pairs = ((0, space.z, space.z3), (1, space.theta, space.theta3))
    flow = np.zeros((space.z.shape[0], space.z.shape[0]))
    for c, side, third in pairs:
        flow += _squared(side - mu * third, s_u[c]) + force * _squared(side, s_P[c])
    return White(_inverse_root(flow), _inverse_root(time[0] @ time[0].T))


def _squared(matrix: Any, variance: Array) -> Array:
    return np.asarray((matrix * variance[None, :] @ matrix.T).todense())


def _inverse_root(covariance: Array) -> Array:
    """Return a matrix W with W C Wᵀ = 1, apart from directions of little noise, which are not amplified."""
    sizes, vectors = np.linalg.eigh(covariance)
    return (vectors / np.sqrt(sizes + RIDGE * sizes[-1])).T
