"""Newton's method and the spectra of what it finds, against exact and high-accuracy results."""

import numpy as np
import pytest
from scipy.special import ellipj, ellipk

import cyclosis as cy
from cyclosis.stability.profiles.growth import across, along, rates_about
from cyclosis.stability.profiles.reduced import reduced
from cyclosis.stability.profiles.steady import relax, rms, steady


def two_stripes(problem, P_theta=0.0):
    x = problem.turn / problem.n * np.arange(problem.n)
    return np.concatenate([np.full(problem.n, P_theta), 0.85 * np.tanh(3 * np.sin(x))])


def found(n, guess=0.0, time=100.0, **values):
    problem = reduced(cy.Parameters(**values), cy.CylinderGrid(n, 8, 5.0))
    return problem, steady(problem, relax(problem, two_stripes(problem, guess), time).y)


def test_cyclosis_at_the_parameters_of_figure_4():
    problem, state = found(256)
    assert state.y.max() == pytest.approx(0.9915720522, abs=1e-9)
    assert abs(state.drift) < 1e-12
    assert not state.uniform
    rates = along(problem, state)[0]
    # In this order: a tilt of the filaments, the width of the stripes, and so on; the rotation is left out.
    assert np.abs(rates - -0.06406947).min() < 1e-7
    assert np.abs(rates - -1.841276).min() < 1e-5
    assert np.abs(rates).min() > 0.02


@pytest.mark.slow
@pytest.mark.parametrize(("alpha_p", "growth"), [(0.1, 3.28547e-3), (0.2, 1.31966e-4)])
def test_without_flow_stripes_are_the_exact_elliptic_ones_and_unstable(alpha_p, growth):
    problem, state = found(128, alpha_p=alpha_p, alpha_u=0.0)
    a, d_s = alpha_p - 0.025, 0.025
    low, high = 1e-9, 1 - 1e-12
    for _ in range(200):  # 4 K(k) xi = 2 pi for the modulus k, by bisection
        k2 = (low + high) / 2
        turn = 4 * ellipk(k2) * np.sqrt(d_s * (1 + k2) / a)
        low, high = (k2, high) if turn < 2 * np.pi else (low, k2)
    theta = 2 * np.pi / 128 * np.arange(128)
    zone = np.angle(problem.packed(state.y)[1] / 1j) * -1 - np.pi / 2
    exact = (
        np.sqrt(2 * k2 / (1 + k2) * a / alpha_p) * ellipj((theta - zone) / np.sqrt(d_s * (1 + k2) / a), k2)[0]
    )
    exact_y = np.concatenate([np.zeros(128), exact])
    assert min(rms(state.y - exact_y), rms(state.y + exact_y)) < 1e-8
    closed = a * (2 * np.sqrt(1 - k2 + k2**2) - (1 + k2)) / (1 + k2)
    largest = along(problem, state)[0][0].real
    assert largest == pytest.approx(closed, rel=1e-6)
    assert largest == pytest.approx(growth, rel=1e-5)


@pytest.mark.parametrize(("alpha_p", "threshold"), [(0.1, 7.47e-3), (0.2, 4.17e-4)])
def test_flow_stabilises_cyclosis_above_the_threshold(alpha_p, threshold):
    growth = []
    for alpha_u in (threshold * 0.997, threshold * 1.003):
        problem, state = found(128, alpha_p=alpha_p, alpha_u=alpha_u)
        growth.append(along(problem, state)[0][0].real)
    assert growth[0] > 0 > growth[1]


def test_uniform_state_and_its_two_instabilities():
    # The first pair lies about the tilt at alpha_u = 0.5128, the second about the stripes at 0.3267.
    for alpha_p, alpha_u, stable in (
        (1.0, 0.51, True),
        (1.0, 0.515, False),
        (0.1, 0.325, True),
        (0.1, 0.33, False),
    ):
        params = cy.Parameters(alpha_p=alpha_p, alpha_u=alpha_u)
        grid = cy.CylinderGrid(32, 32, 5.0)
        problem = reduced(params, grid)
        state = steady(problem, np.concatenate([np.zeros(32), np.full(32, 0.9)]))
        assert state.uniform
        assert state.y[-1] ** 2 == pytest.approx(1 - 0.025 / alpha_p, abs=1e-9)
        threshold = min(0.5 / (1 - 0.025 / alpha_p), _stripes(alpha_p))
        assert (alpha_u < threshold) is stable
        assert (rates_about(problem, state, 15).growth < 0) is stable


def _stripes(alpha_p, mu=0.05, d_s=0.025, d_r=0.025):
    a = alpha_p - d_r
    return alpha_p**2 * (1 + mu) * (2 * a + d_s) / (3 * d_r * a)


@pytest.mark.slow
def test_drifting_stripes_move_as_the_simulation_does():
    params = cy.Parameters(kappa=0.1)
    problem, state = found(64, 0.5, kappa=0.1)
    grid = cy.CylinderGrid(64, 8, 5.0)
    assert abs(state.drift) > 1e-3
    run = cy.simulate(params, grid, problem.state(state.y, grid), 20.0, 20.0, rtol=1e-8)
    moved = problem.state(problem.shifted(state.y, 20.0 * state.drift), grid)
    assert np.abs(run.final_state - moved).max() < 1e-5
    assert along(problem, state)[0][0].real < -0.01


@pytest.mark.slow
def test_growth_across_is_that_of_a_simulated_wave():
    params = cy.Parameters(alpha_p=0.5, alpha_u=0.3)
    problem, state = found(64, alpha_p=0.5, alpha_u=0.3)
    grid = cy.CylinderGrid(64, 8, 5.0)
    rate = across(problem, state.y, 1)[0]
    values, vectors = np.linalg.eig(problem.waves(state.y, 1))
    mode = vectors[:, np.argmax(values.real)].reshape(2, 64)
    wave = np.real(mode[:, :, None] * np.exp(2j * np.pi * grid.z / 5.0))
    P = problem.state(state.y, grid) + 1e-5 * wave
    run = cy.simulate(params, grid, P, 10.0, 10.0, rtol=1e-9, atol=1e-14)
    left = run.final_state - run.final_state.mean(axis=2, keepdims=True)
    began = P - P.mean(axis=2, keepdims=True)
    assert np.log(rms_of(left) / rms_of(began)) / 10.0 == pytest.approx(rate, rel=1e-3)


def rms_of(P):
    return np.sqrt(np.mean(np.sum(P**2, axis=0)))


def test_nothing_is_found_where_nothing_is():
    problem = reduced(cy.Parameters(alpha_p=0.3, alpha_u=0.1), cy.CylinderGrid(32, 8, 5.0))
    far = np.random.default_rng(0).normal(size=64) * 0.5
    assert steady(problem, far, iterations=3) is None
