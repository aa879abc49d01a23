"""Where cyclosis comes to life: existence and stability part at a corner."""

import numpy as np
import pytest

import cyclosis as cy
from cyclosis.stability.existence import onset


@pytest.fixture(scope="module")
def near():
    return cy.stability.neighbourhood(cy.Parameters(), [0.03, 0.046, 0.0485, 0.05, 0.0505, 0.055])


@pytest.mark.slow
def test_stability_needs_more_than_existence_beyond_the_corner_only(near):
    alpha_p, alpha_u = near.corner
    assert 0.046 < alpha_p < 0.0485
    before = near.alpha_p < alpha_p
    assert near.stable[before] == pytest.approx(near.exists[before], abs=1e-11)
    assert np.all(near.stable[~before] > near.exists[~before] + 1e-4)
    assert np.all(np.diff(near.stable) < 0)
    assert near.exists[near.alpha_p > 0.05].tolist() == [0, 0]
    assert near.exists[3] == pytest.approx(0.05 * 1.05, rel=1e-14)
    assert np.all(near.exists_error < 1e-9)
    assert np.all(near.stable_error < 1e-9)
    assert cy.stability.fold(cy.Parameters(alpha_p=alpha_p)) == pytest.approx(alpha_u, rel=1e-9)


def test_at_the_corner_two_growth_rates_vanish_together():
    alpha_p, alpha_u = onset.corner(cy.Parameters())
    state = cy.stability.cyclosis(cy.Parameters(alpha_p=alpha_p, alpha_u=alpha_u * (1 + 1e-6)), 128)
    rates = np.sort(np.abs(state.spectrum(6, components="z").eigenvalues))
    assert rates[0] < 1e-10  # the rotation
    assert rates[2] < 1e-3 < 5 * rates[3]


def test_a_force_that_is_not_cubic_is_refused():
    with pytest.raises(cy.InputError, match="force_exponent"):
        cy.stability.neighbourhood(cy.Parameters(force_exponent=1.0))
    with pytest.raises(cy.InputError, match="alpha_p"):
        cy.stability.neighbourhood(cy.Parameters(), [-1.0])


@pytest.mark.slow
def test_the_onset_is_always_there_and_ignored_parameters_are(near):
    found = onset.neighbourhood(cy.Parameters(alpha_p=150.0), [0.049, 0.051])
    np.testing.assert_allclose(found.alpha_p, [0.049, 0.05, 0.051])
    assert found.exists[1] == pytest.approx(0.0525, rel=1e-6)
    assert found.corner == pytest.approx(near.corner, rel=1e-9)
