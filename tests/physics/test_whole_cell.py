"""The linearisation of the whole cell: against closed forms, one wave at a time, and simulations."""

import pytest

from measure import check, whole_cell


def test_matrices_of_uniform_states():
    """Closed forms against automatic differentiation, at random parameters and wavenumbers."""
    check(whole_cell.closed_forms())


@pytest.mark.slow
@pytest.mark.parametrize("name", whole_cell.CASES)
def test_leading_modes_are_what_runs_show(name):
    check(whole_cell.rates_of(name))


@pytest.mark.slow
def test_a_shift_costs_nothing():
    check(whole_cell.shifts())


@pytest.mark.slow
def test_states_that_vary_both_ways_have_two_shifts():
    check(whole_cell.bent())
