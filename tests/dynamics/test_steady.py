"""What "steady" says: the rate of change has stayed low and has not grown for a time, and no more."""

import numpy as np
import pytest

import cyclosis as cy
from cyclosis.dynamics.advance import CALM

GRID = cy.CylinderGrid(32, 24, 5.0)
TILTING = cy.Parameters(alpha_p=0.3, alpha_u=0.9)
"""A tilt of the unidirectional state grows at α_u P0² - κ = 0.325."""
FINE = cy.Parameters(d_s=0.1)


def almost_unidirectional(params, size=1e-6):
    order = float(cy.stability.unidirectional_order(params))
    state = cy.initial.unidirectional(GRID, order)
    return state + size * np.random.default_rng(0).standard_normal(state.shape)


@pytest.mark.parametrize("settings", [{}, {"stepper": "etdrk4", "dt": 0.2}], ids=["adaptive", "etdrk4"])
@pytest.mark.parametrize("rate", [1e-4, 1e-5])
def test_a_tilt_that_grows_is_not_called_steady(rate, settings):
    growth = np.max(cy.stability.growth_rates(TILTING, "unidirectional", [0], [0]).real)
    assert growth == pytest.approx(0.325, abs=1e-3)
    run = cy.simulate(TILTING, GRID, almost_unidirectional(TILTING), 25.0, 25.0, steady_rate=rate, **settings)
    assert run.status is cy.Status.COMPLETED
    assert run.t_final == 25.0


def test_a_stable_state_is_steady_once_it_has_been_calm_for_a_while():
    params = TILTING.replace(alpha_u=0.2)
    run = cy.simulate(
        params, GRID, almost_unidirectional(params), 100.0, 100.0, steady_rate=1e-4, record_every=1.0
    )
    assert run.status is cy.Status.STEADY
    assert CALM <= run.t_final < 3 * CALM
    rates = run.records["rate_of_change"][run.record_times >= run.t_final - CALM]
    assert np.all(rates < 1e-4)
    assert "stayed below 0.0001 and did not grow" in run.message
    assert "whether the state is stable was not examined" in run.message


@pytest.mark.parametrize("rate", [1e-3, 1e-5, 1e-7, 1e-9])
@pytest.mark.parametrize("alpha_p", [1.0, 0.4])
def test_errors_of_the_solver_do_not_keep_a_run_from_becoming_steady(alpha_p, rate):
    """Steps that grow to the limit of stability would make the rate rise and fall for ever."""
    params = cy.Parameters(alpha_p=alpha_p, alpha_u=0.2)
    run = cy.simulate(params, GRID, cy.initial.unidirectional(GRID, 0.9), 500.0, 500.0, steady_rate=rate)
    assert run.status is cy.Status.STEADY
    assert run.t_final < 10 * CALM


def test_single_precision_becomes_steady_above_its_rounding():
    run = cy.simulate(
        FINE, GRID, cy.initial.stripes(GRID), 200.0, 200.0, steady_rate=1e-5, precision="float32"
    )
    assert run.status is cy.Status.STEADY


def test_a_state_that_is_exactly_steady_is_calm_from_its_first_step():
    run = cy.simulate(FINE, GRID, np.zeros((2, *GRID.shape)), 50.0, 50.0, steady_rate=1e-6)
    assert run.status is cy.Status.STEADY
    assert run.t_final < 2 * CALM + 1


@pytest.mark.parametrize("settings", [{}, {"stepper": "etdrk4", "dt": 0.07}], ids=["adaptive", "etdrk4"])
def test_a_run_cut_while_it_is_calm_becomes_steady_at_the_same_step(settings, tmp_path):
    state = cy.initial.unidirectional(GRID, 0.7)
    whole = cy.simulate(FINE, GRID, state, 200.0, 1.0, steady_rate=1e-3, **settings)
    assert whole.status is cy.Status.STEADY
    middle = whole.t_final - 0.5 * CALM

    def stop(snapshot):
        if snapshot.t >= middle:
            raise KeyboardInterrupt

    writer = cy.RunWriter(tmp_path / "run.nc")
    with pytest.raises(KeyboardInterrupt) as stopped:
        cy.simulate(
            FINE, GRID, state, 200.0, 1.0, steady_rate=1e-3, checkpoint=writer, progress=stop, **settings
        )
    part = stopped.value.run
    assert np.isfinite(part.restart.progress["calm_since"])
    writer.finish(part)
    onward = cy.resume_file(tmp_path / "run.nc")
    assert onward.status is cy.Status.STEADY
    assert onward.t_final == whole.t_final
    assert np.array_equal(onward.final_state, whole.final_state)


def test_a_stopped_run_of_an_earlier_version_goes_on():
    """Its restart does not say since when it has been calm: that begins anew."""

    def stop(snapshot):
        if snapshot.t >= 3.0:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt) as stopped:
        cy.simulate(
            FINE, GRID, cy.initial.unidirectional(GRID, 0.7), 200.0, 1.0, steady_rate=1e-3, progress=stop
        )
    part = stopped.value.run
    for name in ("calm_since", "least_rate"):
        del part.restart.progress[name]
    onward = cy.resume(part)
    assert onward.status is cy.Status.STEADY
    assert onward.t_final >= part.t_final + CALM
