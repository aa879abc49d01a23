"""A perturbation of a closed cell that does not depend on θ: it grows as it says, and terms add up."""

import numpy as np
import pytest

import cyclosis as cy
from cyclosis.models.on_polar import rate_modes

GRID, PARAMS = cy.ClosedGrid(cy.Capsule(2.0), k_max=8), cy.Parameters(alpha_p=0.5, alpha_u=0.1)
STATE = cy.stability.source_to_sink(PARAMS, GRID)


def rate(P):
    """Return dP/dt as a field."""
    problem = cy.models.closed.problem(PARAMS, GRID)
    system = cy.models.closed.system(problem, True)
    return system.state(rate_modes(problem, P))


@pytest.mark.slow
@pytest.mark.parametrize(("m", "rank"), [(0, 0), (1, 0), (1, 2)])
def test_it_grows_at_its_rate(m, rank):
    found = cy.stability.azimuthal_mode(PARAMS, GRID, STATE.P, m, rank)
    h = 1e-5
    change = (rate(STATE.P + h * found.P) - rate(STATE.P - h * found.P)) / (2 * h)
    assert abs(found.rate.imag) < 1e-9
    np.testing.assert_allclose(change, found.rate.real * found.P, atol=2e-6)
    assert sum(found.parts.values()) == pytest.approx(found.rate.real, abs=1e-9)
    assert GRID.mean(np.sum(found.P**2, axis=0)) == pytest.approx(1.0)


@pytest.mark.slow
def test_rotational_diffusion_contributes_itself():
    found = cy.stability.azimuthal_mode(PARAMS, GRID, STATE.P, 1)
    assert found.parts["rotational_diffusion"] == pytest.approx(-PARAMS.d_r, abs=1e-9)
    rates = cy.stability.azimuthal_rates(PARAMS, GRID, STATE.P, 1)
    assert found.rate == pytest.approx(rates[0], abs=1e-10)


def test_a_rank_that_there_is_not_is_refused():
    with pytest.raises(cy.InputError, match="rank"):
        cy.stability.azimuthal_mode(PARAMS, GRID, STATE.P, 1, 10_000)
