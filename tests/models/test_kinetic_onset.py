"""Onset and loss of uniform order in the kinetic model, against quadrature and one response function.

With weights w on angles, <·> of a steady uniform density and h = H/d_r, a weak torque field along an axis
changes <p> by w_j λ_j/(d_r (s + λ_j)) summed over the modes of the density at rest: `response`.
"""

import numpy as np
import pytest
from scipy.optimize import brentq, minimize_scalar

import cyclosis as cy

D_R, N = 0.025, 256
CHI = 2 * np.pi * np.arange(N) / N
p = np.stack([np.cos(CHI), np.sin(CHI)])
WAVES = np.fft.fftfreq(N, 1 / N)
UNITS = np.fft.fft(np.eye(N), axis=0)
FIRST = np.fft.ifft(np.where(np.abs(WAVES) < N // 2, 1j * WAVES, 0)[:, None] * UNITS, axis=0).real
SECOND = np.fft.ifft(-(WAVES**2)[:, None] * UNITS, axis=0).real


def weights(kappa, h=(0.0, 0.0)):
    """Return the share (n,) of filaments at each angle, exp(h·p - κ p_θ²/2d_r) up to a factor."""
    exponent = h @ p - kappa / (2 * D_R) * p[0] ** 2
    found = np.exp(exponent - exponent.max())
    return found / found.sum()


def mean(w, values):
    return float(w @ values)


def response(s, kappa, h, axis):
    """Return δ<p> per δH, both along an axis and growing as e^{st}: from (s - L) f = -∂(Ψ q), densely."""
    w, q = weights(kappa, h), np.stack([-p[1], p[0]])
    omega = D_R * (np.asarray(h) @ q) - kappa * p[0] * q[0]
    f = np.linalg.solve(s * np.eye(N) - D_R * SECOND + FIRST * omega, -FIRST @ (w * q[axis]))
    return float(p[axis] @ f)


def order_along(axis, kappa, a_p, a_u=0.0):
    """Return the largest uniform order along an axis; along θ it drives the flow that turns it."""

    def short(P):
        h = np.zeros(2)
        h[axis] = (a_p * P + (a_u * P**3 if axis == 0 else 0.0)) / D_R
        return mean(weights(kappa, h), p[axis]) - P

    return brentq(short, 0.3, 1.0, xtol=1e-15)


@pytest.mark.parametrize("a_p", [0.1, 0.5, 1.0])
@pytest.mark.parametrize("axis", [0, 1])
def test_waves_upon_disorder_grow_where_the_response_is_one_over_the_torque(axis, a_p):
    """And each wave grows by d_s k² less than uniform polarity."""
    params = cy.Parameters(alpha_p=a_p)
    base = cy.kinetic.uniform_state(params, "nematic")
    rates = cy.kinetic.growth_rates(params, base, 0, 0.0).real
    found = min(rates, key=lambda rate: abs(a_p * response(rate, 0.5, (0.0, 0.0), axis) - 1))
    assert a_p * response(found, 0.5, (0.0, 0.0), axis) == pytest.approx(1, abs=1e-5)
    k2 = 1 + (2 * np.pi / 5) ** 2
    wave = cy.kinetic.growth_rates(params, base, 1, 2 * np.pi / 5).real
    assert np.abs(wave - (found - params.d_s * k2)).min() < 1e-10


def test_growth_across_the_repulsion_is_slowed_by_a_barrier():
    """λ_1 of the nematic state is 1.366e-5, Kramers' estimate 1.445e-5; all else follows at once."""
    root = np.sqrt(weights(0.5))
    slopes = root[:, None] * FIRST / root
    values, modes = np.linalg.eigh(D_R * slopes.T @ slopes)
    share = (modes.T @ (root * p[1])) ** 2
    slow = np.argmax(share)
    assert values[slow] == pytest.approx(1.3657576e-5, rel=1e-6)
    kramers = [2 * kappa / np.pi * np.exp(-kappa / (2 * D_R)) for kappa in (0.5, 1.0)]
    assert values[slow] / kramers[0] == pytest.approx(0.945, abs=1e-3)
    rest = mean(weights(0.5), p[1] ** 2) - share[slow]
    for a_p, known in ((0.1, 3.832751e-5), (0.5, 2.537705e-4), (1.0, 5.412042e-4)):
        driven = a_p / D_R
        found = values[slow] * (driven * share[slow] / (1 - driven * rest) - 1)
        assert found == pytest.approx(known, rel=1e-4)


@pytest.mark.parametrize(
    ("kappa", "axis", "expected"),
    [
        *((0.0, 1, 0.5), (0.05, 0, 0.53024), (0.1, 0, 0.50808), (0.2, 0, 0.22287)),
        *((10.57109 * D_R, 0, 0.0), (0.5, 0, -0.12532)),
        *((0.1, 1, 0.42188), (0.5, 1, 0.35096), (1.0, 1, 0.34189)),
    ],
)
def test_order_branches_off_with_the_amplitude_of_two_cumulants(kappa, axis, expected):
    """|P|² = (a_p/a* - 1)/g, g = (3 s_2² - s_4)/(6 s_2³); flow along θ takes a_u/a* from g."""
    w = weights(kappa)
    s_2, s_4 = mean(w, p[axis] ** 2), mean(w, p[axis] ** 4)
    g = (3 * s_2**2 - s_4) / (6 * s_2**3)
    assert g == pytest.approx(expected, abs=5e-6)
    onset, P = D_R / s_2, 0.01
    found = cy.kinetic.thresholds(cy.Parameters(kappa=kappa))
    assert onset == pytest.approx((found.along, found.across)[axis], rel=1e-12)
    for a_u in (0.0, 0.5):
        effect = a_u if axis == 0 else 0.0

        def short(a_p, effect=effect):
            h = np.zeros(2)
            h[axis] = (a_p * P + effect * P**3) / D_R
            return mean(weights(kappa, h), p[axis]) - P

        a_p = brentq(short, 0.5 * onset, 2 * onset, xtol=1e-16)
        assert (a_p / onset - 1) / P**2 == pytest.approx(g - effect / onset, rel=2e-3, abs=2e-4)


def test_order_around_the_axis_sets_in_with_a_jump():
    """At κ = 0.5 it exists far below its threshold 0.469, the further the stronger the flow."""

    def least(kappa, a_u):
        def a_p(P):
            short = lambda a: mean(weights(kappa, ((a * P + a_u * P**3) / D_R, 0.0)), p[0]) - P  # noqa: E731
            return brentq(short, -5, 6)

        found = minimize_scalar(a_p, bounds=(0.05, 0.98), method="bounded", options={"xatol": 1e-8})
        return found.fun, found.x

    for a_u, known in ((0.0, (0.457416, 0.5327)), (0.5, (0.161104, 0.8595))):
        fold = least(0.5, a_u)
        assert fold == pytest.approx(known, abs=5e-5)
        above, below = (cy.Parameters(alpha_p=fold[0] + by, alpha_u=a_u) for by in (2e-4, -2e-4))
        order = abs(cy.kinetic.uniform_state(above, "theta")[1])
        assert order == pytest.approx(fold[1], abs=0.06)
        with pytest.raises(cy.InputError, match="uniform state along theta"):
            cy.kinetic.uniform_state(below, "theta")
    # Below this κ it lasts without any bundling.
    assert brentq(lambda kappa: least(kappa, 0.5)[0], 0.1, 0.5, xtol=1e-6) == pytest.approx(
        0.317459, abs=5e-6
    )


STREAM = {
    0.05: (0.92262, 0.54838, 6.7752),
    0.1: (0.97652, 0.49908, 8.4592),
    0.2: (0.98107, 0.49910, 12.250),
    0.5: (0.98708, 0.49974, 26.509),
    1.0: (0.99151, 0.49993, 61.372),
}
"""By a_p: |P| along the cell, and the α_u at which it tilts, and would break into stripes."""


@pytest.mark.parametrize("a_p", STREAM)
def test_one_stream_tilts_and_breaks_up_where_its_responses_say(a_p):
    """Tilt: (a_p + a_u P²) <p_θ²> = d_r; stripes: (a_p + 3 a_u P²/(1 + μ)) χ(d_s) = 1."""
    params = cy.Parameters(alpha_p=a_p)
    P = order_along(1, 0.5, a_p)
    h = np.array([0.0, a_p * P / D_R])
    w = weights(0.5, h)
    across = mean(w, p[0] ** 2)
    tilt = (D_R / across - a_p) / P**2
    assert tilt == pytest.approx(0.5 * mean(w, p[0] ** 2 * p[1]) / (P**3 * across), rel=1e-9)
    stripes = (1 + params.mu) / (3 * P**2) * (1 / response(params.d_s, 0.5, h, 1) - a_p)
    assert (P, tilt, stripes) == pytest.approx(STREAM[a_p], rel=4e-5)
    base = cy.kinetic.uniform_state(params, "z", 70)
    assert abs(base[1]) == pytest.approx(P, abs=1e-12)
    for a_u, m in ((tilt, 0), (stripes, 1)):
        at = params.replace(alpha_u=a_u)
        assert np.abs(cy.kinetic.growth_rates(at, base, m, 0.0)).min() < 1e-9
        if m:
            no_shear = cy.kinetic.growth_rates(at.replace(epsilon=0.0), base, m, 0.0)
            assert np.abs(no_shear).min() < 1e-9
    waves = [
        cy.kinetic.growth_rates(params.replace(alpha_u=0.99 * tilt), base, m, q)[0].real
        for m in range(3)
        for q in (0.0, 0.3, 2 * np.pi / 5)
    ]
    assert max(waves) < 0


@pytest.mark.slow
def test_the_free_energy_falls_without_flow():
    """F = ∫ [d_r Ψ ln Ψ + (κ/2) (p·d)² Ψ] dφ - (a_p/2) |P|² of uniform states."""
    grid = cy.CylinderGrid(8, 1)
    params = cy.Parameters(alpha_p=0.3, kappa=0.2, d_r=0.06, alpha_u=0.0, epsilon=0.0)
    phi = 2 * np.pi / 128 * np.arange(128)
    psi = np.exp(0.5 * np.cos(phi - 0.4) + 0.7 * np.cos(2 * phi - 1.0))
    psi = np.broadcast_to(psi / (2 * np.pi * psi.mean()), (*grid.shape, 128))
    start = cy.kinetic.moments(psi, 24)
    run = cy.simulate(params, grid, start, 20.0, 0.5, model=cy.models.kinetic, rtol=1e-7)
    energies, rates = [], []
    for m in run.frames:
        f, P = cy.kinetic.density(m)[0, 0], cy.kinetic.order(m)[:, 0, 0]
        angle = 2 * np.pi / f.size * np.arange(f.size)
        bent = params.kappa / 2 * np.cos(angle) ** 2
        steady = (
            params.d_r * np.log(f) + bent - params.alpha_p * (P[0] * np.cos(angle) + P[1] * np.sin(angle))
        )
        slope = np.fft.irfft(1j * np.arange(f.size // 2 + 1) * np.fft.rfft(steady), f.size)
        energies.append(
            2 * np.pi * np.mean(params.d_r * f * np.log(f) + bent * f) - 0.5 * params.alpha_p * (P @ P)
        )
        rates.append(-2 * np.pi * np.mean(f * slope**2))
    energies, rates = np.array(energies), np.array(rates)
    assert np.all(np.diff(energies) < 0)
    # Simpson's rule over two steps: the fall is the integral of the rate.
    fall = 0.5 * (rates[4:-2:2] + 4 * rates[5:-1:2] + rates[6::2]) / 3
    np.testing.assert_allclose(energies[6::2] - energies[4:-2:2], fall, rtol=2e-3, atol=1e-9)
