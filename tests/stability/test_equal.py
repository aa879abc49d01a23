"""Equal stripes: symmetry families that do not mix, and derivatives against differences."""

import numpy as np
import pytest

import cyclosis as cy
from cyclosis.stability.existence.equal import FAMILIES, OWN, ROTATION, WIDTHS, EqualStripes, bases

N = 96


@pytest.fixture(scope="module", params=[2, 4], ids=["two", "four"])
def problem(request):
    return EqualStripes(cy.Parameters(alpha_p=0.3, mu=0.1), request.param, N)


@pytest.mark.parametrize("count", [2, 4, 6])
def test_families_are_orthonormal_and_of_two_stripes_complete(count):
    basis = np.concatenate(list(bases(N, count).values()), axis=1)
    assert basis.T @ basis == pytest.approx(np.eye(basis.shape[1]), abs=1e-13)
    if count == 2:
        assert basis.shape[1] == N - 1  # all but the Nyquist mode


def test_families_do_not_mix(problem):
    state = problem.full(0.1)
    for name in FAMILIES:
        basis = problem.bases[name]
        answer = problem.columns(state.P, state.alpha_u, name)
        assert np.abs(answer - basis @ (basis.T @ answer)).max() < 1e-11


def test_families_of_two_stripes_hold_every_eigenvalue():
    two = EqualStripes(cy.Parameters(alpha_p=0.3), 2, N)
    state = two.full(0.1)
    apart = np.sort(np.concatenate([two.rates(state, name) for name in FAMILIES]))
    whole = np.linalg.eigvals(two.applied(state.P, state.alpha_u, np.eye(N)))
    nyquist = np.argmin(np.abs(whole + two.params.d_r + two.params.d_s * (N / 2) ** 2))
    assert apart == pytest.approx(np.sort(np.delete(whole, nyquist).real), abs=1e-9)
    assert np.abs(two.rates(state, ROTATION)).min() < 1e-10


def test_the_slope_of_a_growth_rate_is_its_derivative(problem):
    def at(alpha_u):
        return problem.steady(alpha_u, problem.full(0.1).P)

    rate = [problem.sloping(at(0.1 + step), WIDTHS).rate for step in (-1e-4, 1e-4)]
    found = problem.sloping(at(0.1), WIDTHS)
    assert found.slope == pytest.approx((rate[1] - rate[0]) / 2e-4, rel=1e-5)
    assert found.rate == pytest.approx(problem.leading(at(0.1), WIDTHS).rate, abs=1e-12)


def test_the_amplitude_gives_the_state_and_how_its_alpha_u_changes(problem):
    state = problem.full(0.2)
    again = problem.at_amplitude(problem.amplitude(state.P), problem.full(0.1))
    assert again.alpha_u == pytest.approx(0.2, abs=1e-10)
    assert pytest.approx(state.P, abs=1e-10) == again.P
    apart = [problem.at_amplitude(problem.amplitude(state.P) + step, again).alpha_u for step in (-1e-5, 1e-5)]
    assert again.slope == pytest.approx((apart[1] - apart[0]) / 2e-5, rel=1e-5)


def test_drive_and_rate_are_those_of_the_whole_model(problem):
    grid = cy.CylinderGrid(N, 8, 5.0)
    P = problem.bases[OWN] @ np.random.default_rng(0).normal(size=problem.bases[OWN].shape[1])
    P *= 0.5 / np.abs(P).max()
    state = np.zeros((2, *grid.shape))
    state[1] = P[:, None]
    exact = [cy.rate_of_change(problem.params.replace(alpha_u=v), grid, state)[1, :, 0] for v in (0.2, 1.2)]
    assert problem.rate(P, 0.2) == pytest.approx(exact[0], abs=1e-12)
    assert problem.drive(P, 0.2) == pytest.approx(exact[1] - exact[0], abs=1e-12)


def test_an_amplitude_that_leads_nowhere_is_refused(problem):
    with pytest.raises(cy.InputError, match="amplitude"):
        problem.at_amplitude(3.0, problem.full(0.1))
