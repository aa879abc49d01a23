"""What the ends of a closed cell do to linear modes, and how order sets in on a sphere: closed forms."""

from types import SimpleNamespace

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq
from scipy.special import gamma

import cyclosis as cy

NU = (np.sqrt(5) - 1) / 2  # ν (ν + 1) = 1
END = np.tan(np.pi * NU / 2) * gamma(NU / 2) * gamma(NU / 2 + 1) / 2
END /= gamma((NU + 1) / 2) * gamma((NU + 3) / 2)
"""P_ν¹ over its slope at the edge of a hemisphere: where order along the cell would vanish beyond it."""


def lowest(length, smoothing, k_max=4.0):
    """Return the lowest eigenvalue of -Lap_B for m = 0 and m = 1 on a capsule."""
    rate = cy.ClosedGrid(cy.Capsule(length, smoothing), k_max=k_max).tables.rate
    return rate[0, 0], rate[1, 0]


@pytest.mark.slow
def test_order_along_the_cell_reaches_beyond_its_straight_part():
    """λ → [π/(ℓ + 2b)]² for long capsules, b = 1.7622 with hemispheres."""
    assert pytest.approx(1.7621825, abs=1e-7) == END
    rates = np.array([lowest(length, 0.2)[0] for length in (8.0, 16.0, 32.0)])
    reach = np.pi / np.sqrt(rates) - np.array([8.0, 16.0, 32.0])
    slopes = np.diff(reach) / np.diff(rates)
    assert slopes[0] == pytest.approx(slopes[1], rel=0.05)  # a first correction in λ
    # What the extrapolation to λ = 0 leaves is the smoothing of the ends.
    assert reach[2] - slopes[1] * rates[2] == pytest.approx(2 * END, abs=0.01)


def at_edge(rate):
    """Return p'/p at the edge of a hemisphere, of p'' + cot s p' - [(1 - cos s)/sin s]² p = -λ p."""

    def slope(s, y):
        return [y[1], -y[1] / np.tan(s) + (np.tan(s / 2) ** 2 - rate) * y[0]]

    value, steep = solve_ivp(slope, (1e-6, np.pi / 2), [1.0, 0.0], rtol=1e-11, atol=1e-13).y[:, -1]
    return steep / value


def test_order_across_a_pole_is_bound_to_it():
    """Filaments that lie straight across a pole cost less than a wave around the cell: λ = 0.7465 < 1."""
    bound = brentq(lambda rate: at_edge(rate) + np.sqrt(1 - rate), 0.3, 0.999)
    assert bound == pytest.approx(0.746463, abs=1e-6)
    rates = [lowest(20.0, smoothing)[1] for smoothing in (0.2, 0.4)]
    assert 0 < rates[0] - bound < 0.3 * (rates[1] - bound) < 0.3 * 0.0086
    assert rates[1] == pytest.approx(0.754981, abs=1e-6)


@pytest.mark.slow
def test_growth_of_disorder_on_a_capsule():
    """Without repulsion by the harmonics alone; with it what is bound to the poles no longer leads."""
    grid = cy.ClosedGrid(cy.Capsule(5.0), k_max=8)
    none = np.zeros((2, *grid.shape))
    params = cy.Parameters(alpha_p=0.5, kappa=0.0)
    for kappa, known in ((0.0, (0.140696, 0.756193, 4.079803)), (0.5, (0.140696, 1.04522, 4.1761))):
        at = params.replace(kappa=kappa)
        for m, cost in enumerate(known):
            rates = cy.stability.azimuthal_rates(at, grid, none, m).real
            assert (0.475 - rates[0]) / 0.025 == pytest.approx(cost, rel=1e-4)
            if m == 0:  # order around the axis and along the cell differ by repulsion alone
                assert (abs(rates[0] - rates[1]) < 1e-12) == (kappa == 0)


@pytest.mark.slow
def test_a_sink_is_a_source_with_the_opposite_sign_of_epsilon():
    """P → -P turns one into the other and reverses ε: rates of m = 1 are a ± b ε to first order."""
    grid, params = cy.ClosedGrid(cy.Capsule(5.0), k_max=12), cy.Parameters(alpha_p=0.5, alpha_u=0.0)
    found = {}
    for epsilon in (0.0, 0.02, 0.047, 0.1):
        at = params.replace(epsilon=epsilon)
        state = cy.stability.source_to_sink(at, grid)
        rates = cy.stability.azimuthal_rates(at, grid, state.P, 1).real
        assert rates[0] == pytest.approx(rates[1], abs=1e-9)
        found[epsilon] = SimpleNamespace(sink=rates[0], source=rates[2])
    still = found[0.0]
    assert (still.sink, still.source) == pytest.approx((-0.024513, -0.024594), abs=1e-6)
    slopes = [(pair.sink - pair.source) / (2 * eps) for eps, pair in found.items() if eps]
    assert slopes == pytest.approx([0.548, 0.547, 0.545], abs=1e-3)
    assert abs(found[0.047].sink) < 2e-4
    assert found[0.1].sink == pytest.approx(0.024559, abs=1e-5)


@pytest.mark.slow
def test_circulation_of_a_droplet_branches_off_at_four_fifths():
    """|P| = A sin τ with A² = η/[(4/5)(α_p - α_u)], η = α_p - d_r - d_s; there is no order below η = 0."""
    grid = cy.ClosedGrid(cy.Sphere(), k_max=6)
    swirl = cy.closed.swirl(grid, 1.0)
    errors = []
    for eta in (1e-3, 2.5e-4):
        params = cy.Parameters(alpha_p=0.05 + eta, alpha_u=0.02)
        law = eta / (0.8 * (params.alpha_p - params.alpha_u))
        found = cy.stability.steady_state(params, grid, np.sqrt(law) * swirl)
        errors.append(1.5 * cy.diagnose(params, grid, found.state)["order"] ** 2 / law - 1)
    assert errors[0] / errors[1] == pytest.approx(4, rel=0.1)
    assert abs(errors[1]) < 0.01
