"""The weak form against the pointwise equations on fields given by formulas; nothing of it is shared."""

import numpy as np
import pytest

from cyclosis.fitting.bumps import area, bump, in_space, in_time, slopes, weights
from cyclosis.fitting.weak import FILAMENTS, Chart, rows

THETA, Z, TIMES = np.linspace(-1.1, 1.1, 33), np.linspace(0.0, 2.4, 33), np.linspace(0.0, 3.0, 33)
VALUES = {"epsilon": 0.3, "d_s": 0.04, "d_r": 0.07, "alpha_p": 0.9, "alpha_u": 0.6, "kappa": 0.4}
ANGLE, MU, U = 0.35, 0.08, 1.3


def P_of(t, x, z):
    return (
        0.4 * np.sin(1.3 * x + 0.4 * t) * np.cos(1.1 * z) + 0.2,
        0.5 * np.cos(1.7 * x - 0.8 * z) * np.exp(-0.2 * t) + 0.1 * x,
    )


def u_of(t, x, z):
    """Return (∂_z ψ, -∂_θ ψ) of ψ = sin(1.2 x + 0.3) cos(0.9 z) (1 + 0.3 t), free of divergence."""
    a, g = 1.2 * x + 0.3, 1 + 0.3 * t
    return -0.9 * np.sin(a) * np.sin(0.9 * z) * g, -1.2 * np.cos(a) * np.cos(0.9 * z) * g


def slope(f, at, k, h=2e-3):
    """Return ∂f/∂(t, θ, z)_k by central differences of order 6 of the formula itself."""

    def moved(s):
        return np.array(f(*(x + s * h * (j == k) for j, x in enumerate(at))))

    return sum(c * (moved(s) - moved(-s)) for s, c in ((1, 45), (2, -9), (3, 1))) / (60 * h)


def laplacian(f, at):
    return sum(slope(lambda *x, k=k: slope(f, x, k), at, k) for k in (1, 2))


def pointwise(at):
    """Return ∂_t P and each term of the right-hand side, (2, ...) each."""
    P, u = np.array(P_of(*at)), np.array(u_of(*at))
    dP, du = ([slope(f, at, k) for k in (1, 2)] for f in (P_of, u_of))  # dP[j][i] = ∂_j P_i

    def projected(torque):
        return torque - P * (P * torque).sum(axis=0)

    d = np.array([np.cos(ANGLE), np.sin(ANGLE)]).reshape(2, 1, 1, 1)
    turning = projected(P[0] * du[0] + P[1] * du[1])
    terms = {
        "epsilon": -(u[0] * dP[0] + u[1] * dP[1]) + turning,
        "d_s": laplacian(P_of, at),
        "d_r": -P,
        "alpha_p": projected(P),
        "alpha_u": projected(u),
        "kappa": -projected((P * d).sum(axis=0) * d),
    }
    return slope(P_of, at, 0), terms


@pytest.fixture(scope="module")
def tested():
    at = np.meshgrid(TIMES, THETA, Z, indexing="ij")
    P, u = (np.stack(f(*at), axis=1) for f in (P_of, u_of))
    time = in_time(TIMES, np.array([1.4]), 1.3)
    rule = np.outer(weights(THETA), weights(Z)).ravel()
    x, z = np.meshgrid(THETA, Z, indexing="ij")
    space, whole = in_space(x.ravel(), z.ravel(), rule, np.array([[0.1, 1.2], [5.0, 5.0]]), (0.9, 1.1))
    assert whole.tolist() == [True, False]
    chart = Chart(slopes(THETA), slopes(Z))
    found = rows(P, u, np.zeros((2, *x.shape)), ANGLE, chart, time, space)
    phi = bump((at[0] - 1.4) / 1.3, 4) * bump((at[1] - 0.1) / 0.9, 7) * bump((at[2] - 1.2) / 1.1, 7)
    return found, at, phi * np.gradient(TIMES)[0] * np.gradient(THETA)[0] * np.gradient(Z)[0]


def test_every_term_of_the_filament_equation(tested):
    found, at, phi = tested
    rate, terms = pointwise(at)
    left = (phi * rate).sum(axis=(1, 2, 3))
    size = np.abs(left).max()
    assert found.filaments[:, 0] == pytest.approx(left, abs=2e-4 * size)
    for k, name in enumerate(FILAMENTS, 1):
        expected = (phi * terms[name]).sum(axis=(1, 2, 3))
        assert found.filaments[:, k] == pytest.approx(expected, abs=2e-4 * np.abs(expected).max()), name


def test_every_term_of_the_flow_equation(tested):
    found, at, phi = tested

    def force(*x):
        P = np.array(P_of(*x))
        return (P**2).sum(axis=0) * P

    t, x, z = at
    stream = np.sin(1.2 * x + 0.3) * np.cos(0.9 * z) * (1 + 0.3 * t)
    k2 = 1.2**2 + 0.9**2  # ω = -∇²ψ = k² ψ
    curl = slope(force, at, 1)[1] - slope(force, at, 2)[0]
    expected = [k2 * stream, -(k2**2) * stream, curl]
    for k, field in enumerate(expected):
        assert found.flow[0, k] == pytest.approx((phi * field).sum(), rel=1e-3), k


def test_products_of_the_noise_with_itself_are_removed():
    """The mean over normal noise is what the noise-free fields give.

    Products are at most cubic in P, so that three nodes of Gauss and Hermite for each component give the mean
    exactly.
    """
    s, P, u = np.array([0.3, 0.15]), np.array([0.4, -0.2]), np.array([0.3, 0.5])
    x, z, t = np.linspace(-1, 1, 9), np.linspace(-1, 1, 9), np.linspace(-1, 1, 9)
    places = (f.ravel() for f in np.meshgrid(x, z, indexing="ij"))
    rule = np.outer(weights(x), weights(z)).ravel()
    space, whole = in_space(*places, rule, np.zeros((1, 2)), (1, 1))
    assert whole.all()
    time = in_time(t, np.full(1, 0.1), 0.9)
    chart = Chart(slopes(x), slopes(z))
    flow = np.stack([u[0] + 0.7 * x[:, None] + 0.2 * z, u[1] - 0.4 * x[:, None] + 0.3 * z])
    ones = np.ones((9, 1, 9, 9)) * (1 + 0.4 * x[:, None] + 0.3 * z)
    variance = (s**2)[:, None, None] * np.ones((2, 9, 9))

    def found(value, noise):
        field = ones * P[None, :, None, None] + value[None, :, None, None]
        made = rows(field, np.ones((9, 1, 1, 1)) * flow, noise, ANGLE, chart, time, space)
        return np.concatenate([made.filaments.ravel(), made.flow.ravel()])

    nodes = [(-np.sqrt(3.0), 1 / 6), (0.0, 2 / 3), (np.sqrt(3.0), 1 / 6)]
    mean = sum(a * b * found(s * np.array([n, m]), variance) for n, a in nodes for m, b in nodes)
    exact, plain = (found(np.zeros(2), noise) for noise in (0 * variance, variance))
    assert mean == pytest.approx(exact, abs=1e-12)
    assert (np.abs(plain - exact) > 1e-3).sum() >= 7  # all that is not linear in P


@pytest.mark.parametrize("points", [np.linspace(0, 1, 30), np.arcsin(np.linspace(-0.9, 0.9, 40))])
def test_quadrature_of_a_bump_at_any_spacing(points):
    half = 0.45 * (points[-1] - points[0])
    x = (points - 0.5 * (points[0] + points[-1])) / half
    assert weights(points) @ bump(x, 7) / half == pytest.approx(area(7), rel=1e-4)
    assert weights(points) @ bump(x, 7, 1) == pytest.approx(0.0, abs=1e-3)
    assert slopes(points) @ points**4 == pytest.approx(4 * points**3, abs=1e-10)
