"""Thresholds of two stripes: simulations on both sides, error bars that hold, and what is refused."""

import numpy as np
import pytest

import cyclosis as cy
from cyclosis.stability.existence import thresholds
from cyclosis.stability.existence.equal import EqualStripes
from cyclosis.stability.existence.fastest_growing import Perturbations

GRID = cy.CylinderGrid(64, 8, 5.0)


def growth(params, mode, time=20.0):
    """The rate at which a small (2, n_theta, n_z) disturbance of two stripes grows in runs."""
    still = np.zeros((2, *GRID.shape))
    still[1] = cy.stability.cyclosis(params, GRID.n_theta).P[:, None]
    ends = []
    for sign in (1, -1):
        run = cy.simulate(params, GRID, still + 1e-5 * sign * mode, time, stepper="etdrk4", dt=0.1)
        assert run.ok, run.message
        ends.append(run.final_state)
    answer = (ends[0] - ends[1]) / 2e-5
    return np.log(np.sum(answer * mode) / np.sum(mode**2)) / time


@pytest.mark.parametrize("alpha_p", [0.06, 0.1])
def test_runs_agree_on_which_side_stripes_stay_equal(alpha_p):
    params = cy.Parameters(alpha_p=alpha_p)
    value = cy.stability.threshold(params)
    for factor, sign in ((0.9, 1), (1.1, -1)):
        here = params.replace(alpha_u=factor * value)
        found = cy.stability.cyclosis(here, GRID.n_theta).spectrum(4, components="z")
        widths = int(np.argmax(np.abs(found.modes[:, 1].real.mean(axis=1))))
        mode = np.zeros((2, *GRID.shape))
        mode[1] = found.modes[widths, 1].real[:, None]
        rate = growth(here, mode)
        assert np.sign(rate) == sign
        assert rate == pytest.approx(found.eigenvalues[widths].real, abs=1e-6)


@pytest.mark.slow
def test_runs_agree_on_the_full_threshold():
    """A tilt of the filaments grows at 0.487 - κ without flow, and at 0.471 - κ at α_u = 0.5."""
    params = cy.Parameters(alpha_p=1.0, kappa=0.48)
    full = cy.stability.threshold_with_error(params, full=True)
    assert full.alpha_u > 1e6 * cy.stability.threshold(params)
    assert full.cause == "a tilt of the filaments"
    assert full.error < 1e-8
    for factor, sign in ((0.8, 1), (1.2, -1)):
        here = params.replace(alpha_u=factor * full.alpha_u)
        found = cy.stability.cyclosis(here, GRID.n_theta).spectrum(1, components="theta")
        rate = growth(here, np.broadcast_to(found.modes[0].real[:, :, None], (2, *GRID.shape)))
        assert np.sign(rate) == sign
        assert rate == pytest.approx(found.eigenvalues[0].real, abs=1e-6)


def test_stripes_exist_above_the_fold_only():
    for alpha_p in (0.0, 0.03):
        params = cy.Parameters(alpha_p=alpha_p)
        value = cy.stability.fold(params)
        assert cy.stability.cyclosis(params.replace(alpha_u=value * (1 + 1e-4))).residual < 1e-8
        with pytest.raises(cy.InputError, match="steady state of 2 stripes"):
            cy.stability.cyclosis(params.replace(alpha_u=value * (1 - 1e-4)))


def test_a_linear_force_makes_disorder_break_into_stripes():
    """The paper's reason for a cubic one: at α_p = 0 it grows from nothing once α_u > (d_r + d_s)(1 + μ)."""
    params = cy.Parameters(alpha_p=0.0, force_exponent=0.0)
    value = cy.stability.fold(params)
    assert value == pytest.approx(0.05 * 1.05, rel=1e-14)
    m = np.arange(6)
    for factor, sign in ((1 - 1e-9, -1), (1 + 1e-9, 1)):
        rates = cy.stability.growth_rates(params.replace(alpha_u=factor * value), "disorder", m, 0.0)
        assert np.sign(rates[1:].real.max()) == sign


@pytest.mark.slow
def test_error_bars_hold():
    params = cy.Parameters(alpha_p=0.2)
    best = cy.stability.threshold(params)
    coarse = cy.stability.threshold_with_error(params, n_theta=32)
    assert 1e-12 * best < abs(coarse.alpha_u - best) <= coarse.error < 1e-2 * best
    assert float(coarse) == coarse.alpha_u


@pytest.mark.slow
def test_strong_flow_tilts_what_weaker_flow_holds():
    params = cy.Parameters(alpha_p=1.0, kappa=0.48)
    lost = cy.stability.destabilised(params, start=0.5, most=2.0)
    problem = EqualStripes(params, 2, thresholds.resolution(params))
    for factor, sign in ((0.999, -1), (1.001, 1)):
        every = Perturbations(problem, problem.full(factor * lost.alpha_u), 5.0).growths()
        worst = max(every, key=lambda growth: growth.rate)
        assert np.sign(worst.rate) == sign
        assert worst.cause == lost.cause
    assert cy.stability.destabilised(params, start=0.5, most=0.9 * lost.alpha_u) is None
    with pytest.raises(cy.InputError, match="start"):
        cy.stability.destabilised(params, start=0.01)


def test_what_is_not_there_is_said():
    with pytest.raises(cy.InputError, match="alpha_p"):
        cy.stability.fold(cy.Parameters(alpha_p=0.06))
    with pytest.raises(cy.InputError, match="d_s"):
        cy.stability.threshold(cy.Parameters(d_s=1e-5))
    with pytest.raises(cy.InputError, match="full=False"):
        cy.stability.threshold(cy.Parameters(alpha_p=0.3, kappa=0.0), full=True)
    with pytest.raises(cy.InputError, match="repulsion_angle"):
        cy.stability.threshold(cy.Parameters(repulsion_angle=0.3))
    with pytest.raises(cy.InputError, match="n_theta"):
        cy.stability.threshold(cy.Parameters(), n_theta=8)
    with pytest.raises(cy.InputError, match="length"):
        cy.stability.threshold(cy.Parameters(), full=True, length=-1.0)
