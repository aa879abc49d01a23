"""The closed cell in three-dimensional space, from closed formulas: an oracle for `cyclosis.closed`.

Nothing is shared with the package, which works with covariant components in surface harmonics. Here vectors
have three Cartesian components, and no derivative is taken numerically. n is the outward normal, B = grad n
the shape operator, H its trace, I - nn the projection on the tangent plane, and a covariant derivative is the
projection of one in space. The order vector is the tangent part of a field A(x) of plane waves; T = grad A:

    grad P = (I - nn) T (I - nn) - (A·n) B
    Lap_B P = (I - nn)(Lap A - n·(grad grad A)·n - H T n) - 2 B Tᵗ n - B² A - (A·n) grad H

The second is the projected divergence of the first, with div B = grad H (Codazzi). The stream function of the
flow is a polynomial in space, ψ = Re Σ c_mj (x + iy)^m L_j(z/h), and u = n x grad ψ, so that

    grad u = (I - nn)(B x grad ψ + n x grad grad ψ)(I - nn)

The flow is that with the least ∫ |u - F|² + 2 μ |D|², which is the weak form of -2 μ div D + u + grad Π = F.
"""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
from numpy.polynomial import legendre
from scipy.integrate import quad
from scipy.optimize import brentq
from scipy.special import erf

CROSS = np.zeros((3, 3, 3))
CROSS[0, 1, 2] = CROSS[1, 2, 0] = CROSS[2, 0, 1] = 1
CROSS[0, 2, 1] = CROSS[2, 1, 0] = CROSS[1, 0, 2] = -1


def ellipse(c):
    """Return the meridian of a spheroid: a function of t in [0, π], and π."""

    def at(t):
        sin, cos = np.sin(t), np.cos(t)
        g = np.hypot(cos, c * sin)
        dg = (c**2 - 1) * sin * cos / g
        k_s, k_t = c / g**3, c / g
        dH = (-3 * c / g**4 - c / g**2) * dg / g
        return SimpleNamespace(
            r=sin, z=-c * cos, speed=g, er=cos / g, ez=c * sin / g, k_s=k_s, k_t=k_t, dH=dH
        )

    return at, np.pi, c


def capsule(length, w):
    """Return the meridian of a capsule: a function of the arc length, the length S and the half height."""

    def chi(s, a, order):
        """χ (order 0, apart from a constant), χ' (1) and χ'' (2)."""
        images = (length + 2 * a) * np.arange(-4, 6)
        up, down = ((s[..., None] - images + side * a) / w for side in (1, -1))
        if order == 2:
            return np.pi / (4 * a) * 2 / np.sqrt(np.pi) / w * (np.exp(-(up**2)) - np.exp(-(down**2))).sum(-1)
        if order == 1:
            return np.pi / (4 * a) * (erf(up) - erf(down)).sum(-1)
        up, down = (q * erf(q) + np.exp(-(q**2)) / np.sqrt(np.pi) for q in (up, down))
        return np.pi * w / (4 * a) * (up - down).sum(-1)

    def position(s, a):
        start = chi(np.zeros(1), a, 0)
        return [panels(lambda t, f=f: f(chi(t, a, 0) - start), s) for f in (np.cos, np.sin)]

    def middle(a):
        return position(np.array([0.5 * length + a]), a)

    a = brentq(lambda a: middle(a)[0][0] - 1, 0.5, 2.5, xtol=1e-15)
    S, half = length + 2 * a, float(middle(a)[1][0])

    def at(s):
        (r, z), k_s = position(s, a), chi(s, a, 1)
        angle = chi(s, a, 0) - chi(np.zeros(1), a, 0)
        er, ez = np.cos(angle), np.sin(angle)
        pole = np.minimum(s, S - s) < 1e-9
        r_ = np.where(pole, 1.0, r)
        k_t = np.where(pole, k_s, ez / r_)
        dH = np.where(pole, 0.0, chi(s, a, 2) + (k_s - k_t) * er / r_)
        r = np.where(pole, 0.0, r)
        return SimpleNamespace(r=r, z=z - half, speed=np.ones_like(s), er=er, ez=ez, k_s=k_s, k_t=k_t, dH=dH)

    return at, S, half


def panels(f, s, count=12, nodes=12):
    """Return ∫_0^s f by Gauss-Legendre quadrature on panels; `s` of any shape."""
    x, weight = legendre.leggauss(nodes)
    ends = np.arange(count)[:, None] / count
    x, weight = (ends + 0.5 * (x + 1) / count).ravel(), np.tile(0.5 * weight / count, count)
    return (f(s[..., None] * x) @ weight) * s


def half_height(length, w, a):
    """Return ∫ sin χ ds from a pole to the middle, by adaptive quadrature of χ and of sin χ."""
    images = (length + 2 * a) * np.arange(-3, 5)

    def bend(s):
        return np.pi / (4 * a) * np.sum(erf((s - images + a) / w) - erf((s - images - a) / w))

    return quad(lambda s: np.sin(quad(bend, 0, s, epsabs=1e-13)[0]), 0, 0.5 * length + a, epsabs=1e-12)[0]


def surface(meridian, t, theta):
    """Return places x (..., 3), normals n, shape operators B (..., 3, 3), grad H and M at points."""
    at = meridian(t)
    one = np.ones(np.broadcast(t, theta).shape)
    cos, sin, zero = np.cos(theta) * one, np.sin(theta) * one, 0 * one
    around = np.stack([-sin, cos, zero], -1)
    along = np.stack([at.er * cos, at.er * sin, at.ez * one], -1)
    x = np.stack([at.r * cos, at.r * sin, at.z * one], -1)
    n = np.cross(around, along)
    B = at.k_t[..., None, None] * outer(around, around) + at.k_s[..., None, None] * outer(along, along)
    flat = np.eye(3) - outer(n, n)
    # (k_1² - k_2²) d d has the eigenvalues k_1² - k_2² and 0, so that B² minus its smaller eigenvalue is it.
    smaller = np.minimum(at.k_t, at.k_s) ** 2
    M = {"principal": B @ B - smaller[..., None, None] * flat}
    M["polynomial"] = B @ B - (at.k_t * at.k_s)[..., None, None] * flat
    M["bounded"] = M["principal"] / (at.k_t**2 + at.k_s**2)[..., None, None]
    return SimpleNamespace(
        x=x, n=n, B=B, dH=at.dH[..., None] * along, M=M, flat=flat, around=around, along=along
    )


def outer(a, b):
    """Return the products a_i b_j."""
    return a[..., :, None] * b[..., None, :]


class Waves:
    """A smooth field in space, A_i(x) = Σ_k a_ki sin(q_k·x + φ_ki), with its derivatives."""

    def __init__(self, seed=0, count=3, fastest=0.8, size=0.3):
        rng = np.random.default_rng(seed)
        q = rng.normal(size=(count, 3))
        self.q = fastest * q / np.linalg.norm(q, axis=1)[:, None]
        self.a, self.phase = size * rng.uniform(0.5, 1, (count, 3)), rng.uniform(0, 6, (count, 3))

    def value(self, x):
        return np.einsum("ki,...ki->...i", self.a, np.sin((x @ self.q.T)[..., None] + self.phase))

    def slope(self, x):
        """∂_j A_i, with j last."""
        cos = np.cos((x @ self.q.T)[..., None] + self.phase)
        return np.einsum("ki,...ki,kj->...ij", self.a, cos, self.q)

    def second(self, x):
        """∂_j ∂_l A_i, with i first."""
        sin = np.sin((x @ self.q.T)[..., None] + self.phase)
        return -np.einsum("ki,...ki,kj,kl->...ijl", self.a, sin, self.q, self.q)


def order(field, here):
    """Return P, its covariant gradient (value, direction), and its Bochner Laplacian."""
    A, T, second = field.value(here.x), field.slope(here.x), field.second(here.x)
    flat, n, B = here.flat, here.n, here.B
    normal = np.sum(A * n, -1)
    P = A - normal[..., None] * n
    gradient = flat @ T @ flat - normal[..., None, None] * B
    inner = np.einsum("...ijl,...jl->...i", second, flat)
    inner = inner - np.trace(B, axis1=-2, axis2=-1)[..., None] * apply(T, n)
    laplacian = apply(flat, inner) - 2 * apply(B, apply(np.swapaxes(T, -1, -2), n))
    laplacian = laplacian - apply(B, apply(B, A)) - normal[..., None] * here.dH
    return P, gradient, laplacian


def apply(matrix, vector):
    """Return the products of matrices (..., 3, 3) with vectors (..., 3)."""
    return np.einsum("...ij,...j->...i", matrix, vector)


class Flow:
    """The flow that the force F (x -> vectors) drives on a surface, as a polynomial stream function."""

    def __init__(self, shape, force, mu, most=24, degree=64):
        self.meridian, stop, self.half = shape
        nodes, weight = legendre.leggauss(2 * degree + 40)
        t = 0.5 * stop * (nodes + 1)
        theta = 2 * np.pi * np.arange(2 * most + 16) / (2 * most + 16)
        at = self.meridian(t)
        area = np.sqrt(0.5 * stop * weight * at.r * at.speed)[:, None]
        here = surface(self.meridian, t[:, None], theta)
        F = force(here)
        # The components in a frame that turns with θ, of which a mode m varies as e^{imθ}.
        cos, sin = np.cos(theta)[None, :], np.sin(theta)[None, :]
        turned = np.stack(
            [cos * F[..., 0] + sin * F[..., 1], cos * F[..., 1] - sin * F[..., 0], F[..., 2]], -1
        )
        modes = np.fft.fft(turned, axis=1) / len(theta)
        first = surface(self.meridian, t, 0 * t)
        self.c = np.zeros((most + 1, degree), complex)
        for m in range(most + 1):
            u, slope = self.basis(m, degree, first)
            D = 0.5 * (slope + np.swapaxes(slope, -1, -2))
            rows = np.concatenate(
                [area[..., None] * u, np.sqrt(2 * mu) * area[..., None] * D.reshape(*u.shape[:2], 9)], -1
            )
            matrix = np.moveaxis(rows, 1, -1).reshape(-1, degree)
            wanted = np.concatenate([area * modes[:, m], np.zeros((len(t), 9))], -1).reshape(-1)
            size = np.linalg.norm(matrix, axis=0) + 1e-300
            self.c[m] = np.linalg.lstsq(matrix / size, wanted, rcond=1e-14)[0] / size * (2 if m else 1)

    def potentials(self, m, degree, here):
        """Return the gradients (n, degree, 3) and second derivatives in space of (x + iy)^m L_j(z/h)."""
        x, y, z = np.moveaxis(here.x, -1, 0)
        zeta = x + 1j * y
        ring = [falling(m, k) * zeta ** max(m - k, 0) for k in range(3)]
        values = legendre.legvander(z / self.half, degree - 1)
        L = [values[:, : degree - k] @ (legendre.legder(np.eye(degree), k) / self.half**k) for k in range(3)]
        turn = np.array([1, 1j, 0])
        up = np.array([0, 0, 1.0])
        product = lambda j, k: ring[j][:, None] * L[k]  # noqa: E731
        grad = product(1, 0)[..., None] * turn + product(0, 1)[..., None] * up
        hess = product(2, 0)[..., None, None] * outer(turn, turn) + product(0, 2)[..., None, None] * outer(
            up, up
        )
        hess = hess + product(1, 1)[..., None, None] * (outer(turn, up) + outer(up, turn))
        return grad, hess

    def basis(self, m, degree, here):
        """Return u (n, degree, 3) and its gradient (n, degree, 3, 3) of every stream function of a mode m."""
        grad, hess = self.potentials(m, degree, here)
        u = np.einsum("nik,ndk->ndi", np.einsum("ijk,nj->nik", CROSS, here.n), grad)
        slope = np.einsum("ndk,nikl->ndil", grad, np.einsum("ijk,njl->nikl", CROSS, here.B))
        slope = slope + np.einsum("nik,ndkl->ndil", np.einsum("ijk,nj->nik", CROSS, here.n), hess)
        return u, here.flat[:, None] @ slope @ here.flat[:, None]

    def at(self, here):
        """Return u (n, 3) and its covariant gradient (n, 3, 3) at places."""
        u, slope = 0.0, 0.0
        for m, c in enumerate(self.c):
            own_u, own_slope = self.basis(m, len(c), here)
            u = u + np.einsum("ndi,d->ni", own_u, c).real
            slope = slope + np.einsum("ndij,d->nij", own_slope, c).real
        return u, slope


def eigenvalues(shape, m, degree=64):
    """Return the eigenvalues of -Lap_B and of 2 ∫ D:D (unit ∫ |u|²) in fields of e^{imθ}, in order.

    By Rayleigh and Ritz in the tangent fields n x grad ψ + (I - nn) grad φ, and n x grad ψ for the second.
    Each eigenvalue of Lap_B occurs twice: for P_θ + i P_s, and for its mirror image in a symmetric surface.
    """
    made = object.__new__(Flow)
    made.meridian, stop, made.half = shape
    nodes, weight = legendre.leggauss(2 * degree + 40)
    t = 0.5 * stop * (nodes + 1)
    at, here = made.meridian(t), surface(made.meridian, t, 0 * t)
    area = np.sqrt(0.5 * stop * weight * at.r * at.speed)
    first = 1 if m == 0 else 0  # a constant has no gradient
    u, slope = (part[:, first:] for part in made.basis(m, degree, here))
    grad, hess = (part[:, first:] for part in made.potentials(m, degree, here))
    flat, n = here.flat[:, None], here.n[:, None]
    along = np.sum(grad * n, -1)[..., None, None] * here.B[:, None]
    both = np.concatenate([u, apply(flat, grad)], 1)
    spread = np.concatenate([slope, flat @ hess @ flat - along], 1)
    strain = 0.5 * (slope + np.swapaxes(slope, -1, -2))
    return ritz(area, both, spread), 2 * ritz(area, u, strain)


def ritz(area, fields, derived):
    """Return the stationary values of ∫ |derived|² where ∫ |fields|² = 1; each (n, count, ...)."""
    top, low = (
        np.moveaxis(area[:, None, None] * part.reshape(*part.shape[:2], -1), 1, -1)
        for part in (fields, derived)
    )
    top, low = top.reshape(-1, top.shape[-1]), low.reshape(-1, low.shape[-1])
    size = np.linalg.norm(top, axis=0)
    _, values, right = np.linalg.svd(top / size, full_matrices=False)
    held = values > 1e-11 * values[0]
    onto = right[held].conj().T / values[held]
    return np.linalg.svd((low / size) @ onto, compute_uv=False)[::-1] ** 2


def falling(m, k):
    """Return m (m - 1) ... of k factors."""
    return float(np.prod([m - i for i in range(k)]))


def rate(shape, field, p, places, most=24, degree=64):
    """Return dP/dt, u and P (n, 3) at places (t, theta) of a surface; `p` has the parameters as attributes.

    `rate` is by the name of the repulsion M.
    """

    def force(here):
        P = apply(here.flat, field.value(here.x))
        return np.sum(P**2, -1, keepdims=True) ** (0.5 * p.force_exponent) * P

    flow = Flow(shape, force, p.mu, most, degree)
    here = surface(shape[0], *places)
    P, gradient, laplacian = order(field, here)
    u, slope = flow.at(here)
    found = {}
    for name, M in here.M.items():
        drive = p.epsilon * apply(slope, P) + p.alpha_p * P + p.alpha_u * u - p.kappa * apply(M, P)
        drive = drive - np.sum(P * drive, -1, keepdims=True) * P
        found[name] = drive + p.d_s * laplacian - p.d_r * P - p.epsilon * apply(gradient, u)
    return SimpleNamespace(rate=found, u=u, P=P, here=here, flow=flow, laplacian=laplacian)
