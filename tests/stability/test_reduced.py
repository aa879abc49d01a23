"""States uniform along one axis obey the two-dimensional equation, and so do small waves upon them."""

import jax
import numpy as np
import pytest

import cyclosis as cy
from cyclosis.models import polar
from cyclosis.stability.cell.plane import plane
from cyclosis.stability.profiles.reduced import reduced, reduced_of

PARAMS = cy.Parameters(alpha_p=0.7, alpha_u=0.6, epsilon=0.3, kappa=0.2, repulsion_angle=0.4)


def smooth(n, seed, size=0.3):
    """Random values on n points with few modes, and no Nyquist mode."""
    rng = np.random.default_rng(seed)
    x = 2 * np.pi / n * np.arange(n)
    return size * sum(rng.normal() * np.cos(m * x + rng.uniform(0, 6)) / (1 + m) for m in range(4))


def jacobian(params, grid, P):
    """The derivative of the two-dimensional right-hand side by JAX, from the public traced function."""

    def rate(y):
        return cy.traced.rate_of_change(params, grid, y.reshape(P.shape)).ravel()

    with jax.enable_x64(True):
        return np.asarray(jax.jit(jax.jacfwd(rate))(P.ravel()))


@pytest.mark.parametrize("axis", [0, 1])
@pytest.mark.parametrize("dealias", ["none", "full"])
def test_rate_is_that_of_the_whole_cell(axis, dealias):
    grid = cy.CylinderGrid(20, 24, 3.0)
    problem = reduced_of(polar.problem(PARAMS, grid, dealias=dealias), axis)
    y = np.concatenate([smooth(problem.n, 1), smooth(problem.n, 2)])
    expected = cy.rate_of_change(PARAMS, grid, problem.state(y, grid), dealias=dealias)
    np.testing.assert_allclose(problem.state(problem.rate(y), grid), expected, atol=1e-14)


@pytest.mark.slow
@pytest.mark.parametrize("axis", [0, 1])
def test_jacobian_and_waves_hold_every_eigenvalue_of_the_whole_cell(axis):
    grid = cy.CylinderGrid(9, 11, 4.0) if axis == 1 else cy.CylinderGrid(11, 9, 4.0)
    problem = reduced(PARAMS, grid, axis)
    y = np.concatenate([smooth(problem.n, 3), smooth(problem.n, 4)])
    whole = np.linalg.eigvals(jacobian(PARAMS, grid, problem.state(y, grid)))
    parts = [np.linalg.eigvals(problem.jacobian(y))]
    for j in range(1, 6):
        parts += [np.linalg.eigvals(problem.waves(y, j)), np.linalg.eigvals(problem.waves(y, -j))]
    found = np.concatenate(parts)
    assert found.size == whole.size

    def ordered(values):
        return values[np.lexsort((np.round(values.imag, 7), np.round(values.real, 7)))]

    np.testing.assert_allclose(ordered(found), ordered(whole), atol=1e-9)


def test_waves_upon_the_uniform_state_have_the_growth_rates_of_the_closed_form():
    params = cy.Parameters(alpha_p=0.4, alpha_u=0.3, epsilon=0.2)
    grid = cy.CylinderGrid(16, 16, 5.0)
    problem = reduced(params, grid)
    P0 = np.sqrt(1 - params.d_r / params.alpha_p)
    y = np.concatenate([np.zeros(16), np.full(16, P0)])
    q = 2 * np.pi / 5.0
    expected = []
    for m in grid.m[np.abs(grid.m) < 8]:
        k2 = m**2 + q**2
        W = (params.alpha_u + 1j * params.epsilon * P0 * q) * P0**2 / (1 + params.mu * k2) / k2
        a, ratio = params.alpha_p - params.d_r, params.d_r / params.alpha_p
        matrix = [
            [-params.d_s * k2 - params.kappa + W * q**2, -3 * m * q * W],
            [-ratio * m * q * W, -params.d_s * k2 - 2 * a + 3 * ratio * m**2 * W],
        ]
        expected.extend(np.linalg.eigvals(matrix))
    found = np.linalg.eigvals(problem.waves(y, 1))
    assert all(np.abs(found - value).min() < 1e-12 for value in expected)


def test_shift_slope_and_derivative():
    grid = cy.CylinderGrid(24, 8, 5.0)
    problem = reduced(PARAMS, grid)
    y = np.concatenate([np.sin(grid.theta), np.cos(2 * grid.theta)])
    moved = problem.shifted(y, 0.3)
    np.testing.assert_allclose(moved[:24], np.sin(grid.theta - 0.3), atol=1e-14)
    np.testing.assert_allclose(problem.slope(y)[24:], -2 * np.sin(2 * grid.theta), atol=1e-13)
    np.testing.assert_allclose(problem.derivative @ y, problem.slope(y), atol=1e-12)


@pytest.mark.parametrize("n", [16, 17])
def test_the_slope_is_exact_up_to_the_highest_mode(n):
    problem = reduced(PARAMS, cy.CylinderGrid(n, 8, 5.0))
    x, m = 2 * np.pi / n * np.arange(n), (n - 1) // 2
    y = np.concatenate([np.sin(m * x), np.cos(m * x)])
    slope = np.concatenate([m * np.cos(m * x), -m * np.sin(m * x)])
    np.testing.assert_allclose(problem.slope(y), slope, atol=1e-12)


def test_waves_are_given_no_nyquist_modes():
    """On a grid of even size that resolves little, against the whole cell's derivative on the same grid."""
    grid = cy.CylinderGrid(12, 10, 4.0)
    problem, whole = reduced(PARAMS, grid), plane(polar.problem(PARAMS, grid))
    y = np.concatenate([smooth(12, 3), smooth(12, 4)])
    linear = whole.linearised(whole.vector(problem.state(y, grid)), np.zeros(2))
    for j in (1, 4):
        matrix, along = problem.waves(y, j), 2 * np.pi * j / grid.length * grid.z
        v = np.concatenate([smooth(12, 5), smooth(12, 6)])
        answer = (matrix @ v).reshape(2, 12, 1)
        expected = whole.state(linear(whole.vector(v.reshape(2, 12, 1) * np.cos(along))))
        np.testing.assert_allclose(np.real(answer * np.exp(1j * along)), expected, atol=1e-13)
