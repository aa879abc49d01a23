import numpy as np
import pytest
from scipy.special import ellipj, ellipk

import cyclosis as cy
from cyclosis.stability.profiles import profile

ANGLES = np.linspace(0, 2 * np.pi, 40001)


def test_numbers_of_the_two_stripe_state():
    found = profile.cyclosis(cy.Parameters(alpha_p=1.0, alpha_u=0.5))
    P, u = found.at(ANGLES)
    assert P.max() == pytest.approx(0.9915720522, abs=1e-10)
    assert u.max() == pytest.approx(0.9714276568, abs=1e-10)
    assert np.sqrt(np.mean(found.u**2)) == pytest.approx(0.8182985977, abs=1e-10)
    assert np.mean(found.P**3 * found.u) == pytest.approx(0.7122318317, abs=1e-10)
    assert found.residual < 1e-11
    assert found.count == 2
    assert abs(found.pressure_gradient) < 1e-15
    assert abs(found.u.mean()) < 1e-15


@pytest.mark.parametrize("k2", [0.5, 0.99, 0.999999])
def test_without_alignment_by_flow_the_profile_is_a_jacobi_function(k2):
    """P = Pm sn(x/xi, k) with Pm² = 2k²/(1+k²) a/α_p and xi² = d_s (1+k²)/a; four quarters make a turn."""
    d_r, alpha_p = 0.1, 1.3
    a = alpha_p - d_r
    xi = 2 * np.pi / (4 * ellipk(k2))
    params = cy.Parameters(alpha_p=alpha_p, alpha_u=0.0, d_r=d_r, d_s=xi**2 * a / (1 + k2))
    found = profile.cyclosis(params)
    exact = np.sqrt(2 * k2 / (1 + k2) * a / alpha_p) * ellipj(found.theta / xi, k2)[0]
    assert pytest.approx(exact, abs=1e-11) == found.P


@pytest.mark.parametrize(
    ("count", "changes"),
    [
        (2, {}),
        (2, {"alpha_p": 0.2, "alpha_u": 0.3}),
        (2, {"alpha_p": 0.0, "alpha_u": 1.0}),
        (2, {"alpha_p": 0.0505, "alpha_u": 0.0}),  # just beyond where it appears
        (2, {"alpha_u": 4.0, "mu": 2.0}),
        (2, {"force_exponent": 0.0, "epsilon": 0.0}),
        (2, {"force_exponent": 4.0, "kappa": 0.0, "repulsion_angle": 1.0}),
        (4, {}),
        (6, {"alpha_p": 0.5, "d_r": 0.1}),
        (8, {}),
    ],
)
def test_the_whole_model_finds_them_steady(count, changes):
    params = cy.Parameters().replace(**changes)
    found = profile.stripes(params, count)
    grid = cy.CylinderGrid(256, 8, 5.0)
    state = np.zeros((2, *grid.shape))
    state[1] = found.P[:, None]
    assert np.abs(cy.rate_of_change(params, grid, state)).max() < 1e-11
    assert np.abs(cy.flow(params, grid, state)[1] - found.u[:, None]).max() < 1e-12
    zones = cy.zones.zone_angles(found.P)
    assert zones.size == count
    assert cy.zones.stripe_widths(zones) == pytest.approx(1 / count)
    assert found.P[1] > 0


@pytest.mark.slow
def test_the_profile_converges_exponentially():
    best = profile.cyclosis(cy.Parameters(), 512)
    errors = []
    for n in (64, 96, 128, 160):
        coarse = profile.cyclosis(cy.Parameters(), n)
        errors.append(np.abs(np.array(coarse.at(ANGLES)) - best.at(ANGLES)).max())
    falls = np.diff(np.log10(errors))
    assert np.all(falls < -1.3)
    assert falls[-1] < 0.8 * falls[0]  # as fast at the end as at the beginning
    assert profile.cyclosis(cy.Parameters(), 255).P.size == 255  # odd numbers of points too


def test_interpolation_puts_the_zone_where_it_is_wanted():
    found = profile.stripes(cy.Parameters(), 4)
    assert found.at(found.theta)[0] == pytest.approx(found.P, abs=1e-12)
    assert found.at(found.theta)[1] == pytest.approx(found.u, abs=1e-12)
    P, u = found.at([[1.0, 1.0 + 1e-3], [1.0 - 1e-3, 2.0]], zone=1.0)
    assert P.shape == u.shape == (2, 2)
    assert abs(P[0, 0]) < 1e-14
    assert P[0, 1] > 0 > P[1, 0]


@pytest.mark.parametrize(
    ("count", "changes"),
    [
        (2, {"alpha_p": 0.01, "alpha_u": 0.05}),
        (2, {"alpha_p": 0.0495, "alpha_u": 0.0}),  # just before it appears
        (8, {"alpha_p": 0.3, "alpha_u": 0.0}),
        (2, {"alpha_p": 0.0, "alpha_u": 0.0}),
    ],
)
def test_no_state_is_said_to_be_none(count, changes):
    with pytest.raises(cy.InputError, match=f"steady state of {count} stripes"):
        profile.stripes(cy.Parameters().replace(**changes), count)


@pytest.mark.parametrize(
    ("changes", "arguments", "field"),
    [
        ({"alpha_p": np.ones((8, 8))}, {}, "alpha_p"),
        ({"repulsion_angle": 0.3}, {}, "repulsion_angle"),
        ({}, {"count": 3}, "count"),
        ({}, {"count": 0}, "count"),
        ({}, {"count": 64}, "count"),
        ({}, {"n_theta": 4}, "n_theta"),
        ({"d_s": 1e-4}, {"n_theta": 64}, "n_theta"),
    ],
)
def test_bad_input_is_refused(changes, arguments, field):
    with pytest.raises(cy.InputError, match=field):
        profile.stripes(cy.Parameters().replace(**changes), **arguments)
