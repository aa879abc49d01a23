"""Comparisons in sentences are true as they are printed."""

import re

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import cyclosis as cy
from cyclosis.model.wording import beside

numbers = st.floats(-1e9, 1e9, allow_subnormal=False)


@given(numbers, numbers, st.integers(1, 8))
def test_a_number_stands_to_another_as_printed(value, other, digits):
    shown = float(beside(value, other, digits))
    assert (shown < other, shown > other) == (value < other, value > other)


@given(st.floats(1e-6, 1e6), st.integers(1, 4), st.integers(1, 6))
def test_of_two_close_numbers_as_many_digits_as_needed(other, ulps, digits):
    value = other
    for _ in range(ulps):
        value = np.nextafter(value, 0.0)
    assert float(beside(float(value), other, digits)) < other


def test_usual_numbers_stay_short():
    assert beside(0.031234, 0.05, 2) == "0.031"
    assert beside(0.05, 0.05, 2) == "0.05"


@pytest.mark.parametrize("order", [0.0499999, 0.04996, 0.03])
def test_an_order_below_the_limit_is_printed_below_it(order):
    grid = cy.CylinderGrid(16, 16)
    found = cy.regime(cy.Parameters(), grid, cy.initial.unidirectional(grid, order))
    said = re.fullmatch(r"order (\S+) is below (\S+)", found.reason)
    assert float(said[1]) < float(said[2])


def outside(error):
    """Return the value and the bound that a refusal prints."""
    text = str(error).split(" = ", 1)[1]
    value, rule = text.split(" cannot be used: ")
    return float(value), float(re.search(r"(?:than|least|most)\D*([\d.]*\d)", rule)[1])


def test_refusals_beside_the_limit_print_what_is_refused():
    grid = cy.CylinderGrid(16, 16)
    state = cy.initial.unidirectional(grid, 1.0)
    with pytest.raises(cy.InputError) as found:
        grid.check_state(state * (1 + 5e-7), "state", bounded=True)
    assert outside(found.value)[0] > 1.0
    run = cy.simulate(cy.Parameters(), grid, 0.9 * state, 1.0000001)
    with pytest.raises(cy.InputError) as found:
        cy.resume(run, 1.00000001)
    value, bound = outside(found.value)
    assert value < bound
    with pytest.raises(cy.InputError) as found:
        cy.Protocol(cy.change(at=1.0, over=1.0000001, alpha_p=0.5), cy.change(at=2.00000001, alpha_p=0.1))
    value, bound = outside(found.value)
    assert value < bound
    with pytest.raises(cy.InputError) as found:
        cy.stability.fold(cy.Parameters(alpha_p=0.050000001))
    assert "alpha_p = 0.050000001 cannot be used: it must be at most d_r + d_s = 0.05," in str(found.value)
