import numpy as np
import pytest

import cyclosis as cy
from cyclosis.stability.profiles.reduced import reduced
from cyclosis.stability.profiles.slowest import cutoff, leading

N = 128


def states():
    """States that are resolved, steady or not, at parameters that differ."""
    rng = np.random.default_rng(5)
    x = 2 * np.pi / N * np.arange(N)
    for _ in range(6):
        params = cy.Parameters(
            alpha_p=rng.uniform(0, 1),
            alpha_u=rng.uniform(0, 1),
            epsilon=rng.uniform(0, 0.5),
            kappa=rng.uniform(0, 1),
            mu=rng.uniform(0.01, 0.2),
        )
        lean, a, b = rng.uniform(-0.6, 0.6, 3)
        tilted = lean + 0.2 * np.cos(2 * x + a)
        upright = 0.7 * np.tanh(2.5 * np.sin(x) + b)
        yield params, np.concatenate([tilted, upright])


@pytest.mark.parametrize(("params", "y"), list(states()))
def test_leading_eigenvalues_are_those_of_the_whole_matrix(params, y):
    problem = reduced(params, cy.CylinderGrid(N, 8, 5.0))
    assert cutoff(params) < 0.35 * N
    for matrix in (problem.jacobian(y) + 0.01 * problem.derivative, problem.waves(y, 1), problem.waves(y, 3)):
        full = np.linalg.eigvals(matrix)
        found = leading(matrix, problem.k, cutoff(params))
        assert found.size < full.size
        for value in full[np.argsort(-full.real)][:6]:
            assert np.abs(found - value).min() < 1e-8 * max(1, abs(value)) ** 2
        assert np.all(np.diff(found.real) < 1e-11)


def test_an_eigenvalue_at_zero_is_exact_and_can_be_left_out():
    params = cy.Parameters(alpha_p=0.3, alpha_u=0.2)
    found = cy.stability.cyclosis(params, N)
    problem = reduced(params, cy.CylinderGrid(N, 8, 5.0))
    y = np.concatenate([np.zeros(N), found.P])
    matrix, neutral = problem.jacobian(y), problem.slope(y)
    whole = leading(matrix, problem.k, cutoff(params))
    rest = leading(matrix, problem.k, cutoff(params), neutral)
    assert abs(whole[0]) < 1e-11
    assert rest.size == whole.size - 1
    assert rest[:5] == pytest.approx(whole[1:6], abs=1e-10)
    # Too few points to spare any: the whole matrix.
    few = leading(matrix, problem.k, np.inf, neutral)
    assert few.size == 2 * N - 1
    assert rest[:5] == pytest.approx(few[:5], abs=1e-7)
