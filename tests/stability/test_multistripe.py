"""More than two stripes: how many of their perturbations grow, how fast, and what flow can hold."""

import numpy as np
import pytest

import cyclosis as cy

CELL = cy.Parameters(alpha_p=0.5, d_r=0.05, d_s=0.01)


@pytest.mark.parametrize("count", [2, 4, 6])
def test_without_flow_all_but_one_shift_of_the_zones_grow(count):
    """count zones, of which the common rotation is neutral: count - 1 growing modes, counted directly too."""
    params = CELL.replace(alpha_p=0.25)
    found = cy.stability.stripe_modes(params, count, [0.0])
    assert found.unstable[0] == count - 1
    state = cy.stability.stripes(params.replace(alpha_u=0.0), count, 192)
    rates = state.spectrum(count + 4, components="z").eigenvalues.real
    assert np.sum(rates > 1e-10) == count - 1
    assert np.abs(rates).min() < 1e-11


@pytest.mark.slow
def test_rates_by_phase_are_those_of_neighbours_that_attract():
    """λ cos²(πb/count), for each front feels the next ones only."""
    count = 6
    found = cy.stability.stripe_modes(CELL, count, [0.0]).growth[0]
    b = np.arange(count // 2)
    assert found[0] == pytest.approx(cy.stability.elliptic_growth(CELL, count), rel=1e-6)
    assert found[:-1] / found[0] == pytest.approx(np.cos(np.pi * b / count) ** 2, rel=0.05)
    assert found[-1] < 0


def test_rates_by_phase_hold_every_growing_eigenvalue():
    found = cy.stability.stripe_modes(CELL, 6, [0.01])
    rates = cy.stability.stripes(CELL.replace(alpha_u=0.01), 6, 192).spectrum(8, components="z").eigenvalues
    growing = rates.real[rates.real > 1e-9]
    assert growing.size == found.unstable[0]
    expected = found.growth[0][found.growth[0] > 1e-9]
    assert all(np.abs(expected - rate).min() < 1e-9 for rate in growing)


def test_flow_holds_the_common_widening_and_nothing_else():
    value = cy.stability.common_threshold(CELL, 4)
    assert value.error < 1e-8 * value.alpha_u
    below, above = cy.stability.stripe_modes(CELL, 4, [0.99 * value.alpha_u, 1.01 * value.alpha_u]).growth
    assert below[0] > 0 > above[0]
    assert above[1] > 0
    assert cy.stability.stripe_modes(CELL, 4, [0.0, 0.1, 1.0]).unstable.tolist() == [3, 2, 2]


def test_of_two_stripes_it_is_the_threshold():
    params = cy.Parameters(alpha_p=0.1)
    value = cy.stability.common_threshold(params, 2)
    assert value.alpha_u == pytest.approx(cy.stability.threshold(params), rel=1e-10)
    found = cy.stability.stripe_modes(params, 2, [0.9 * value.alpha_u, 1.1 * value.alpha_u])
    assert found.unstable.tolist() == [1, 0]


def test_where_there_are_no_such_stripes_there_is_no_number():
    found = cy.stability.stripe_modes(cy.Parameters(alpha_p=0.1), 8, [0.0])
    assert found.unstable.tolist() == [-1]
    assert np.isnan(found.growth).all()
    for count in (3, 0, 64):
        with pytest.raises(cy.InputError, match="count"):
            cy.stability.stripe_modes(CELL, count)
