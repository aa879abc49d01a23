"""Stripes of unequal widths: the saddle between equal stripes and the unidirectional state."""

import numpy as np
import pytest

import cyclosis as cy
from cyclosis.stability.existence.thresholds import resolution

CELL = cy.Parameters(alpha_p=0.2, alpha_u=0.02)


@pytest.fixture(scope="module")
def branch():
    return cy.stability.unequal_branch(CELL)


def test_the_branch_goes_from_equal_stripes_to_the_unidirectional_state(branch):
    assert branch.alpha_u[0] == pytest.approx(cy.stability.threshold(CELL), rel=1e-9)
    assert branch.width[0] == pytest.approx(0.5, abs=1e-9)
    assert branch.mean[0] == pytest.approx(0, abs=1e-12)
    assert np.all(np.diff(branch.alpha_u) > 0)
    assert np.all(np.diff(branch.width[branch.width > 0]) < 0)
    assert branch.theta.shape == branch.P[0].shape == (resolution(CELL),)


def test_it_ends_where_the_unidirectional_state_breaks_into_stripes():
    """Both last states, at 0.99 and 0.995 of the mean of the end, to which α_u goes in proportion."""
    params = cy.Parameters(alpha_p=0.1)
    branch = cy.stability.unequal_branch(params)
    order, end = (
        float(f(params)) for f in (cy.stability.unidirectional_order, cy.stability.stripes_threshold)
    )
    assert branch.mean[-2:] / order == pytest.approx([0.99, 0.995])
    assert 2 * branch.alpha_u[-1] - branch.alpha_u[-2] == pytest.approx(end, rel=0.015)
    assert np.all(branch.alpha_u < end)
    assert branch.growth[-1] < branch.growth[-2] < branch.growth[-3]


def test_every_state_of_the_branch_is_a_steady_saddle(branch):
    grid = cy.CylinderGrid(branch.theta.size, 8, 5.0)
    for index in range(0, branch.alpha_u.size, 7):
        P = np.zeros((2, *grid.shape))
        P[1] = branch.P[index][:, None]
        params = CELL.replace(alpha_u=branch.alpha_u[index])
        assert np.abs(cy.rate_of_change(params, grid, P)).max() < 1e-9
    assert branch.growth[0] == 0
    assert np.all(branch.growth[1:] > 0)


def test_runs_fall_to_either_side_of_the_saddle():
    saddle, grid = cy.stability.unequal(CELL, 64), cy.CylinderGrid(64, 8, 5.0)
    found = saddle.spectrum(3, components="z")
    assert found.eigenvalues[0].real > 0
    assert np.sum(found.eigenvalues.real > 1e-5) == 1
    mode = found.modes[0, 1].real
    mode = 0.02 * mode * np.sign(mode.mean())
    ends = []
    for way in (-1, 1):
        P = np.zeros((2, *grid.shape))
        P[1] = (saddle.P + way * mode)[:, None]
        run = cy.simulate(CELL, grid, P, 3000.0, 3000.0)
        assert run.ok, run.message
        ends.append(run.final_state[1, :, 0])
    equal = cy.stability.cyclosis(CELL, 64)
    assert cy.zones.zone_angles(ends[0]).size == 2
    assert abs(ends[0].mean()) < 0.1 * saddle.P.mean()
    assert ends[0].max() == pytest.approx(equal.P.max(), rel=0.01)
    assert ends[1] == pytest.approx(float(cy.stability.unidirectional_order(CELL)), abs=1e-3)


def test_the_profile_is_the_one_of_its_alpha_u(branch):
    found = cy.stability.unequal(CELL)
    assert found.residual < 1e-8
    assert found.widths.sum() == pytest.approx(1)
    width = np.interp(np.log(CELL.alpha_u), np.log(branch.alpha_u), branch.width)
    assert found.widths.min() == pytest.approx(width, abs=2e-3)
    assert found.widths[1] < found.widths[0]


@pytest.mark.parametrize(
    ("changes", "match"),
    [
        ({"alpha_u": 1e-4}, "above the threshold"),
        ({"alpha_u": 0.5}, "dip"),
        ({"alpha_p": 0.02}, "alpha_p"),
        ({"repulsion_angle": 0.3}, "repulsion_angle"),
    ],
)
def test_what_cannot_be_is_refused(changes, match):
    with pytest.raises(cy.InputError, match=match):
        cy.stability.unequal(CELL.replace(**changes))
