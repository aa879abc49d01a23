import jax
import numpy as np
import pytest

import cyclosis as cy
from cyclosis.stability import dispersion

GRID = cy.CylinderGrid(16, 12, 5.0)
MODES = ((0, 0), (1, 0), (2, 0), (0, 1), (0, -2), (1, 1), (1, -1), (2, 3), (3, -2))
CELLS = {
    "paper": cy.Parameters(),
    "fast flow, weak order": cy.Parameters(
        alpha_p=0.12, alpha_u=0.8, epsilon=0.7, d_s=0.02, d_r=0.04, kappa=0.3, mu=0.2
    ),
    "zero mean u_theta": cy.Parameters(alpha_p=0.3, alpha_u=2.0, d_r=0.1, zero_theta_flux=True),
    "another force": cy.Parameters(alpha_p=0.2, alpha_u=0.3, d_r=0.05, force_exponent=3.0),
    "linear force": cy.Parameters(alpha_p=0.2, alpha_u=0.3, d_r=0.05, force_exponent=0.0),
    "no repulsion, any angle": cy.Parameters(kappa=0.0, repulsion_angle=1.0, alpha_p=0.3),
}


def measured(params, base, m, j):
    """The 2 x 2 matrix of one mode, from the derivative of the whole model about a uniform state."""
    q = 2 * np.pi * j / GRID.length
    phase = m * GRID.theta[:, None] + q * GRID.z
    with jax.enable_x64(True):

        def rate(P):
            return cy.traced.rate_of_change(params, GRID, P)

        columns = []
        for component in (0, 1):
            answer = 0
            # The derivative is real and linear, so that a complex wave takes two of them.
            for wave, unit in ((np.cos(phase), 1), (np.sin(phase), 1j)):
                direction = np.zeros((2, *GRID.shape))
                direction[component] = wave
                answer = answer + unit * np.asarray(jax.jvp(rate, (base,), (direction,))[1])
            columns.append(np.mean(answer * np.exp(-1j * phase), axis=(1, 2)))
    return np.stack(columns, axis=1)


@pytest.mark.parametrize("name", CELLS)
def test_matrices_are_derivatives_of_the_model(name):
    params = CELLS[name]
    base = cy.initial.unidirectional(GRID, float(dispersion.unidirectional_order(params)))
    assert np.abs(cy.rate_of_change(params, GRID, base)).max() < 1e-15
    m, j = np.array(MODES).T
    found = dispersion.unidirectional_matrix(params, m, 2 * np.pi * j / GRID.length)
    assert found.shape == (len(MODES), 2, 2)
    for k, mode in enumerate(MODES):
        assert np.abs(measured(params, base, *mode) - found[k]).max() < 1e-13


@pytest.mark.parametrize("name", [name for name in CELLS if name != "linear force"])
def test_disorder_rates_are_derivatives_of_the_model(name):
    params = CELLS[name]
    angle = params.repulsion_angle
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    for m, j in MODES:
        rates = dispersion.disorder_rates(params, m, 2 * np.pi * j / GRID.length)
        exact = turn @ np.diag(rates) @ turn.T
        assert np.abs(measured(params, np.zeros((2, *GRID.shape)), m, j) - exact).max() < 1e-13


def test_disorder_feels_repulsion_along_any_direction():
    params = cy.Parameters(repulsion_angle=0.4)
    turn = np.array([[np.cos(0.4), -np.sin(0.4)], [np.sin(0.4), np.cos(0.4)]])
    exact = turn @ np.diag(dispersion.disorder_rates(params, 1, 0.0)) @ turn.T
    assert np.abs(measured(params, np.zeros((2, *GRID.shape)), 1, 0) - exact).max() < 1e-13


def test_a_small_perturbation_of_a_run_grows_at_the_rate():
    """Stripes on the unidirectional state, 20 % beyond their threshold."""
    params = cy.Parameters(alpha_p=0.1)
    params = params.replace(alpha_u=1.2 * float(dispersion.stripes_threshold(params)))
    base = cy.initial.unidirectional(GRID, float(dispersion.unidirectional_order(params)))
    small = np.zeros_like(base)
    small[1] = 1e-6 * np.cos(GRID.theta)[:, None]
    run = cy.simulate(params, GRID, base + small, t_end=20.0, save_at=(0.0, 20.0), stepper="etdrk4", dt=0.1)
    begin, end = (np.mean(frame[1] * np.cos(GRID.theta)[:, None]) for frame in run.frames)
    rate = dispersion.unidirectional_rates(params, 1, 0.0)[0]
    assert rate.real > 0
    assert np.log(end / begin) / 20 == pytest.approx(rate.real, abs=1e-6)


@pytest.mark.parametrize("name", [name for name in CELLS if CELLS[name].kappa > 0])
@pytest.mark.parametrize("threshold", ["tilt", "stripes"])
def test_rates_change_sign_at_the_thresholds(name, threshold):
    params = CELLS[name]
    value = float(getattr(dispersion, f"{threshold}_threshold")(params))
    if threshold == "tilt" and params.zero_theta_flux:
        assert value == np.inf
        return
    component = ("tilt", "stripes").index(threshold)
    for factor, sign in ((1 - 1e-6, -1), (1 + 1e-6, 1)):
        matrix = dispersion.unidirectional_matrix(params.replace(alpha_u=factor * value), component, 0.0)
        assert np.sign(matrix[component, component].real) == sign


def test_thresholds_of_the_paper_s_cell():
    """κ/P0² and α_p² (1 + μ)(2a + d_s)/(3 d_r a), by hand."""
    params = cy.Parameters()
    assert float(dispersion.tilt_threshold(params)) == pytest.approx(0.5 / 0.975, rel=1e-14)
    assert float(dispersion.tilt_threshold(params, 0.1)) == pytest.approx(0.5 / 0.75, rel=1e-14)
    assert float(dispersion.stripes_threshold(params, 0.1)) == pytest.approx(
        0.1**2 * 1.05 * 0.175 / (3 * 0.025 * 0.075), rel=1e-14
    )


def test_the_first_stripes_are_two():
    """No other wave of a whole number m, and with ε = 0 none at all, grows below both thresholds."""
    params = cy.Parameters(alpha_p=0.1, epsilon=0.0)
    below = min(float(dispersion.tilt_threshold(params)), float(dispersion.stripes_threshold(params)))
    m, q = np.arange(0, 9)[:, None], np.linspace(-9, 9, 181)
    rates = dispersion.unidirectional_rates(params.replace(alpha_u=0.999 * below), m, q)
    assert rates.shape == (9, 181, 2)
    assert rates.real.max() < 0
    assert np.all(rates[..., 0].real >= rates[..., 1].real)


def test_thresholds_of_many_parameter_points():
    params = cy.Parameters()
    alpha_p = np.array([[0.0, 0.02, 0.025], [0.03, 0.1, 1.0]])
    for threshold in (dispersion.tilt_threshold, dispersion.stripes_threshold):
        found = threshold(params, alpha_p)
        assert found.shape == (2, 3)
        assert np.isnan(found[0]).all()
        for value, alone in zip(alpha_p[1], found[1], strict=True):
            assert alone == float(threshold(params.replace(alpha_p=value)))
    assert np.isinf(dispersion.stripes_threshold(params.replace(d_r=0.0)))
    assert float(dispersion.tilt_threshold(params.replace(d_r=0.0))) == params.kappa
    held = dispersion.tilt_threshold(params.replace(zero_theta_flux=True), alpha_p)
    assert np.isnan(held[0]).all()
    assert np.isinf(held[1]).all()


def test_what_no_closed_form_covers_is_refused():
    with pytest.raises(cy.InputError, match="alpha_p"):
        dispersion.unidirectional_matrix(cy.Parameters(alpha_p=0.025), 1, 0)
    with pytest.raises(cy.InputError, match="repulsion_angle"):
        dispersion.tilt_threshold(cy.Parameters(repulsion_angle=0.5))
    with pytest.raises(cy.InputError, match="force_exponent"):
        dispersion.disorder_rates(cy.Parameters(force_exponent=0.0), 1, 0)
    with pytest.raises(cy.InputError, match="kappa"):
        dispersion.disorder_rates(cy.Parameters(kappa=np.ones(GRID.shape)), 1, 0)
