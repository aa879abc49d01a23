"""A chosen solution with exact forcing, all terms on: convergence in space and order in time."""

import pytest

from cyclosis.dynamics.steppers import METHODS
from measure import check, manufactured


def test_the_chosen_solution_solves_the_forced_equation():
    """Its amplitude stays below 1, and all powers of it in the forcing are accounted for."""
    check(manufactured.forcing_defect())


@pytest.mark.slow
def test_error_falls_geometrically_with_resolution():
    check(manufactured.spectral(((16, 16), (32, 32), (64, 64))))


@pytest.mark.parametrize("stepper", [name for name, method in METHODS.items() if not method.adaptive])
@pytest.mark.slow
def test_fixed_steppers_have_the_order_that_they_claim(stepper):
    check(manufactured.fixed_steps(stepper))


@pytest.mark.parametrize("stepper", ["adaptive", pytest.param("multistep", marks=pytest.mark.slow)])
def test_adaptive_steppers_are_of_fourth_order(stepper):
    """The error of the solution falls with the fourth power of the number of steps."""
    check(manufactured.adaptive(stepper))


@pytest.mark.slow
def test_a_multistep_step_has_the_orders_of_its_derivation():
    check(manufactured.one_multistep())


@pytest.mark.slow
def test_error_estimate_is_that_of_a_third_order_method():
    """One step: estimate h⁴, true error h⁵."""
    check(manufactured.estimate())
