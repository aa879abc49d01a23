"""Which states are stable: known points of the plane, and runs that confirm the unexpected ones."""

import numpy as np
import pytest

import cyclosis as cy
from cyclosis.stability.profiles.reduced import reduced
from cyclosis.stability.profiles.steady import relax
from cyclosis.stability.states import STATES, states


@pytest.mark.parametrize(
    ("values", "stable"),
    [
        ({}, {"unidirectional", "cyclosis"}),
        ({"alpha_u": 0.8}, {"cyclosis"}),
        ({"alpha_p": 0.02}, {"disordered", "cyclosis"}),
        ({"alpha_p": 0.02, "alpha_u": 0.1}, {"disordered"}),
        ({"alpha_p": 0.1, "alpha_u": 0.005}, {"unidirectional"}),
        ({"alpha_p": 0.1, "alpha_u": 0.01}, {"unidirectional", "cyclosis"}),
        ({"kappa": 0.2}, {"tilted"}),
        ({"kappa": 0.03}, {"circumferential"}),
        ({"alpha_p": 0.035, "alpha_u": 0.1}, {"uneven"}),
        ({"alpha_p": 0.042, "alpha_u": 0.08}, {"unidirectional", "uneven"}),
        ({"alpha_p": 0.042, "alpha_u": 0.1059}, set()),
    ],
)
def test_known_points(values, stable):
    found = states(cy.Parameters(**values))
    assert tuple(found) == STATES
    assert {name for name, standing in found.items() if standing.stable} == stable
    for standing in found.values():
        assert standing.exists or not standing.stable
        assert (standing.cause == "") == standing.stable


def test_length_decides_on_waves_along_the_cell():
    """ε = 0.45 bends stripes with one wave along a cell of length 5; a short cell has no room for it."""
    params = cy.Parameters(epsilon=0.45)
    assert states(params, 5.0)["cyclosis"].cause == "one wave along the cell"
    assert states(params, 1.0)["cyclosis"].stable


@pytest.mark.slow
def test_uneven_order_is_what_a_run_ends_in():
    params, grid = cy.Parameters(alpha_p=0.035, alpha_u=0.1), cy.CylinderGrid(32, 8, 5.0)
    P = cy.initial.unidirectional(grid, 0.5) + cy.initial.disordered(grid, seed=1)
    run = cy.simulate(params, grid, P, t_end=4000.0, save_at=(4000.0,))
    profile = run.final_state[1].mean(axis=1)
    assert np.ptp(profile) > 0.4
    assert np.ptp(run.final_state, axis=2).max() < 1e-6
    assert profile.min() == pytest.approx(0.0460, abs=2e-3)
    assert profile.max() == pytest.approx(0.5873, abs=2e-3)


def test_between_hopf_point_and_fold_stripes_oscillate():
    """No steady state is stable there, and what a run does is to swing at the frequency of the Hopf mode."""
    params, n = cy.Parameters(alpha_p=0.042, alpha_u=0.1059), 48
    problem = reduced(params, cy.CylinderGrid(n, 8, 5.0))
    theta = problem.turn / n * np.arange(n)
    y = relax(problem, np.concatenate([0 * theta, 0.3 + 0.3 * np.cos(theta)]), 12_000.0).y
    mean = []
    for _ in range(120):
        y = relax(problem, y, 20.0).y
        mean.append(abs(y[n:].mean()))
    mean = np.array(mean)
    assert np.ptp(mean[:60]) > 0.1
    assert np.ptp(mean[60:]) == pytest.approx(np.ptp(mean[:60]), rel=0.1)
    rising = np.flatnonzero((mean[1:] > mean.mean()) & (mean[:-1] <= mean.mean()))
    assert 20 * np.diff(rising).mean() == pytest.approx(2 * np.pi / 0.01178, rel=0.15)
