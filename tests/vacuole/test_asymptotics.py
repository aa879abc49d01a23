"""Transport at large Péclet numbers, and stripes with drag: laws without fitted constants."""

from functools import cache

import numpy as np
import pytest
from scipy.linalg import eigh

import cyclosis as cy
from cyclosis.experiments import dragged
from cyclosis.stability.existence.crossings import existing_from, stable_from
from measure.vacuole_flows import bands, stripes_profile, twisted


@pytest.mark.slow
def test_exchange_along_the_cell_is_that_of_layers_at_the_wall():
    """(q Pe/2)^½ <|u_z|^½> to leading order: in a layer i q u_z c = c_rr/Pe, and the rest is of order 1."""
    q, u = 0.4 * np.pi, np.fft.rfft(stripes_profile(), norm="forward")
    speed = np.fft.irfft(u, 1 << 16, norm="forward")
    law = np.sqrt(q / 2) * np.mean(np.sqrt(np.abs(speed)))
    assert law == pytest.approx(0.67737, abs=5e-6)
    rest = [cy.vacuole.band_exchange(twisted(0.0), pe, q) - law * np.sqrt(pe) for pe in (300.0, 1000.0)]
    assert rest == pytest.approx([-0.784, -0.788], abs=5e-4)


@cache
def averaged(Q, sine=False, count=6, nodes=80):
    """Return λ and c of infinite Pe: a scalar that is a function of ψ in each cell of the section, 0 between.

    λ is the least ∫|∇g|²/∫g² and c = max (∫ g v_z)²/∫|∇g|², over the area, of g = Σ a_k |ψ|^{1 + k/2}.
    """
    flow = bands(np.sin, Q, n=16) if sine else twisted(Q)
    psi = cy.vacuole.stream_function(flow)
    zone = -np.angle(psi.harmonics[1]) - 0.5 * np.pi
    x, weight = np.polynomial.legendre.leggauss(nodes)
    r, phi = 0.5 * (x + 1), zone + 0.5 * np.pi * (x + 1)
    area = (0.5 * weight * r)[:, None] * (0.5 * np.pi * weight)
    points = np.stack([np.repeat(r, nodes), np.tile(phi, nodes), np.zeros(nodes**2)], axis=1)
    v_r, v_theta, v_z = flow.at(points).T.reshape(3, nodes, nodes)
    values = psi.on(r, phi)
    # ∂_φ ψ = r v_r and -∂_r ψ = v_θ - Q r v_z; lengths along φ are those of a helical field.
    slopes = (v_theta - Q * r[:, None] * v_z) ** 2 + (1 + (Q * r[:, None]) ** 2) * v_r**2
    top = values.flat[np.abs(values).argmax()]
    s, power = np.maximum(values / top, 0.0), 1 + 0.5 * np.arange(count)[:, None, None]
    g, steep = s**power, power * s ** (power - 1)
    stiffness = np.einsum("iab,jab,ab->ij", steep, steep, area * slopes / top**2)
    mass = np.einsum("iab,jab,ab->ij", g, g, area)
    driven = np.einsum("iab,ab->i", g, area * v_z)
    least = eigh(stiffness, mass, eigvals_only=True)[0]
    return float(least), float(2 / np.pi * driven @ np.linalg.solve(stiffness, driven))


@pytest.mark.slow
def test_the_average_over_streamlines_is_resolved():
    assert averaged(2.0, True) == pytest.approx(averaged(2.0, True, 8, 120), rel=1e-4)
    for Q, limit, spread in (
        (0.5, 16.035, 0.007943),
        (0.4 * np.pi, 17.265, 0.003897),
        (2.0, 19.574, 0.001693),
        (3.0, 24.461, 0.000492),
    ):
        assert averaged(Q) == pytest.approx((limit, spread), rel=1e-3)


@pytest.mark.slow
def test_fast_circulation_brings_uptake_mixing_and_dispersion_to_that_average():
    """Uptake is still a third short at Pe = 1e4; the rest of mixing goes as Pe^-½."""
    flow, (limit, spread) = bands(np.sin, 2.0, n=16), averaged(2.0, True)
    assert limit == pytest.approx(19.535, abs=1e-3)
    rest = {
        name: np.array([limit - rate(flow, pe) for pe in (1e3, 1e4)]) / limit
        for name, rate in (("uptake", cy.vacuole.uptake), ("mixing", cy.vacuole.mixing_rate))
    }
    assert rest["uptake"] == pytest.approx([0.4679, 0.3196], abs=2e-3)
    assert rest["mixing"] == pytest.approx([0.3118, 0.0869], abs=2e-3)
    assert np.log10(rest["mixing"][0] / rest["mixing"][1]) == pytest.approx(0.55, abs=0.02)
    dispersed = [cy.vacuole.dispersion(flow, pe).coefficient for pe in (1e3, 1e4)]
    assert dispersed[0] > dispersed[1] > spread
    assert dispersed[1] / spread - 1 < 0.5 * (dispersed[0] / spread - 1)


def tails(mu, beta):
    """Return -2 Σ (-1)^m/(1 + μ m² + β m): the flow that a stripe's excess drives in the opposite zone."""
    m = np.arange(1, 100_001)
    each = (-1.0) ** m / (1 + mu * m**2 + beta * m)
    return -2 * float(each.sum() - 0.5 * each[-1])


@pytest.mark.slow
def test_the_law_of_fronts_with_the_drag_of_the_vacuole():
    """α_u* rises by 1/tails, about 1 + β/2; the error goes with the square of the width of zones."""
    assert [1 / tails(0.05, beta) for beta in (0.007, 0.1, 0.3)] == pytest.approx(
        [1.00375, 1.05552, 1.17700], abs=5e-6
    )
    errors = []
    for alpha_p in (0.5, 1.0):
        params = cy.Parameters(alpha_p=alpha_p)
        free, slow = (stable_from(dragged.DraggedStripes(params, beta)).alpha_u for beta in (0.0, 0.3))
        errors.append(slow / free * tails(0.05, 0.3) - 1)
    assert errors == pytest.approx([0.0112, 0.0051], abs=1e-4)
    assert errors[0] / errors[1] == pytest.approx((1 - 0.025) / (0.5 - 0.025), rel=0.1)


@pytest.mark.parametrize("beta", [0.0, pytest.param(0.3, marks=pytest.mark.slow)])
def test_the_fold_next_to_the_pitchfork_moves_with_the_drag(beta):
    """α_u = A {α_p + (8/3) [g (d_r + d_s - α_p)]^½}, A = 1 + μ + β, g = (α_p/16) [9 + A/(1 + 9μ + 3β)]."""
    errors = []
    for below in (1e-4, 2.5e-5):
        params = cy.Parameters(alpha_p=0.05 - below)
        resisted = 1 + params.mu + beta
        g = params.alpha_p / 16 * (9 + resisted / (1 + 9 * params.mu + 3 * beta))
        law = resisted * (params.alpha_p + 8 / 3 * np.sqrt(g * below))
        errors.append(existing_from(dragged.DraggedStripes(params, beta)).alpha_u - law)
    assert errors[0] / errors[1] == pytest.approx(4.0, rel=0.1)
    assert errors[0] < 4e-4
