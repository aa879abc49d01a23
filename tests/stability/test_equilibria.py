"""Steady and moving states of the whole cell: to rounding, of the kind asked for, or none."""

import numpy as np
import pytest

import cyclosis as cy

GRID = cy.CylinderGrid(48, 12, 5.0)
CELL = cy.Parameters(alpha_p=0.3, alpha_u=0.4)


def rough(grid, amount=0.03, seed=0):
    """Two stripes with smooth noise upon them, in both directions."""
    P = np.zeros((2, *grid.shape))
    P[1] = 0.7 * np.tanh(2 * np.sin(grid.theta - 0.3))[:, None]
    return P + amount * cy.interpolate(np.random.default_rng(seed).normal(size=(2, 6, 6)), grid.shape)


def moved(state, grid, drift):
    """dP/dt + c·∇P of a state on its own grid."""
    m = np.where(np.abs(grid.m) < grid.n_theta / 2, grid.m, 0)[:, None]
    q = np.where(np.abs(grid.q) < np.abs(grid.q).max(), grid.q, 0)
    return np.fft.ifft2(1j * (drift[0] * m + drift[1] * q) * np.fft.fft2(state)).real


@pytest.mark.slow
def test_stripes_are_those_of_the_profile_wherever_they_lie():
    found = cy.stability.steady_state(CELL, GRID, rough(GRID))
    profile = cy.stability.cyclosis(CELL, GRID.n_theta)
    assert found.residual < 1e-11
    left = cy.rate_of_change(CELL, GRID, found.state) + moved(found.state, GRID, found.drift)
    assert np.abs(left).max() < 1e-10
    # Zones between grid points are not quite symmetric on it.
    assert np.abs(found.drift).max() < 1e-7
    assert np.ptp(found.state, axis=2).max() < 1e-8
    zone = np.angle(np.fft.fft(found.state[1, :, 0])[1] / np.fft.fft(profile.P)[1])
    assert found.state[1, :, 0] == pytest.approx(profile.at(GRID.theta, -zone)[0], abs=1e-5)


@pytest.mark.slow
def test_what_rotates_is_found_with_its_speed():
    params, grid = cy.Parameters(kappa=0.1), cy.CylinderGrid(64, 8, 5.0)
    guess = rough(grid, 0.02)
    guess[0] += 0.5
    found = cy.stability.steady_state(params, grid, guess)
    # On one grid both see the same speed up to what the place of zones between points changes.
    assert abs(found.drift[0]) == pytest.approx(abs(cy.stability.drifting(params, 64).drift), rel=1e-3)
    assert abs(found.drift[1]) < 1e-20
    left = cy.rate_of_change(params, grid, found.state) + moved(found.state, grid, found.drift)
    assert np.abs(left).max() < 1e-9


@pytest.mark.slow
def test_unstable_states_are_found_too():
    params = CELL.replace(alpha_p=0.1, alpha_u=0.0)
    grid = cy.CylinderGrid(32, 8, 5.0)
    found = cy.stability.steady_state(params, grid, rough(grid, 0.0))
    largest = cy.stability.leading_modes(params, grid, found, 2).eigenvalues[0]
    assert largest.real == pytest.approx(cy.stability.elliptic_growth(params), abs=1e-6)


@pytest.mark.parametrize("zero", [False, True])
def test_disorder_and_uniform_states_are_found_for_such_guesses_only(zero):
    params = cy.Parameters(alpha_p=0.3)
    grid = cy.CylinderGrid(16, 12, 5.0)
    guess = np.zeros((2, *grid.shape)) if zero else cy.initial.unidirectional(grid, 0.8)
    found = cy.stability.steady_state(params, grid, guess)
    order = 0.0 if zero else np.sqrt(1 - params.d_r / params.alpha_p)
    assert found.state[1] == pytest.approx(order, abs=1e-12)
    assert not np.any(found.drift)


@pytest.mark.slow
@pytest.mark.parametrize(
    "params",
    [
        cy.Parameters(alpha_p=0.01, alpha_u=0.02),  # stripes decay to disorder
        cy.Parameters(alpha_p=0.04, alpha_u=0.05),  # to the unidirectional state or disorder
        cy.Parameters(kappa=0.0),  # to the circumferential state
    ],
)
def test_stripes_that_do_not_last_are_said_not_to(params):
    grid = cy.CylinderGrid(32, 16, 5.0)  # on 8 points along the cell patterns of the grid's own stand still
    with pytest.raises(cy.InputError, match="guess"):
        cy.stability.steady_state(params, grid, rough(grid))


@pytest.mark.slow
def test_terms_and_dealiasing_are_those_of_the_run():
    terms = ("bundling", "flow_alignment", "repulsion", "diffusion", "rotational_diffusion")
    grid = cy.CylinderGrid(32, 8, 5.0)
    found = cy.stability.steady_state(CELL, grid, rough(grid), terms=terms, dealias="full")
    end = cy.simulate(CELL, grid, found.state, 5.0, 5.0, terms=terms, dealias="full").final_state
    assert end == pytest.approx(found.state, abs=1e-9)
    with pytest.raises(cy.InputError, match="terms"):
        cy.stability.steady_state(CELL, grid, rough(grid), terms=[lambda t, P, u, params, grid: 0 * P])
    with pytest.raises(cy.InputError, match="guess"):
        cy.stability.steady_state(CELL, grid, np.zeros((2, 3, 3)))


@pytest.mark.slow
def test_a_guess_that_varies_along_the_cell_is_not_answered_by_straight_stripes():
    guess = rough(GRID, 0.0)
    guess[1] *= 1 + 0.3 * np.cos(2 * np.pi * GRID.z / GRID.length)
    with pytest.raises(cy.InputError, match="uniform along z"):
        cy.stability.steady_state(CELL, GRID, guess)
