"""The weakest perturbation: two real matrices for each wave hold all that the complex one does."""

import numpy as np
import pytest

import cyclosis as cy
from cyclosis.stability.existence.equal import EqualStripes
from cyclosis.stability.existence.fastest_growing import Perturbations, reflections
from cyclosis.stability.profiles.reduced import reduced

N = 48
CELL = cy.Parameters(alpha_p=0.2, alpha_u=0.1, epsilon=0.4, kappa=0.1)


def test_reflections_are_orthonormal_and_complete():
    basis = np.concatenate(reflections(N), axis=1)
    assert basis.shape == (2 * N, 2 * N - 2)  # all but two Nyquist modes
    assert np.abs(basis.conj().T @ basis - np.eye(2 * N - 2)).max() < 1e-13


def test_every_kind_of_perturbation_is_looked_at():
    """The largest rate of each wave against the whole matrix, and of those uniform along the cell."""
    problem = EqualStripes(CELL, 2, N)
    state = problem.full(CELL.alpha_u)
    line = reduced(CELL, cy.CylinderGrid(N, 64, 5.0))
    y = np.concatenate([np.zeros(N), state.P])
    every = list(Perturbations(problem, state, 5.0).growths())
    waves = {growth.axial_mode: growth.rate for growth in every if growth.axial_mode}
    assert list(waves) == list(range(1, len(waves) + 1))
    for j, rate in waves.items():
        assert rate == pytest.approx(np.linalg.eigvals(line.waves(y, j)).real.max(), abs=1e-9)
    along = np.linalg.eigvals(line.jacobian(y))
    along = np.delete(along, np.argmin(np.abs(along)))
    assert max(growth.rate for growth in every if not growth.axial_mode) == pytest.approx(along.real.max())
    # What is beyond the last wave decays faster than it does.
    last = len(waves)
    beyond = [np.linalg.eigvals(line.waves(y, j)).real.max() for j in (last + 1, last + 4)]
    assert max(beyond) < 0


def test_an_answer_to_whether_anything_grows_is_that_of_the_rates():
    for kappa in (0.0, 0.1, 0.5):
        problem = EqualStripes(CELL.replace(kappa=kappa), 2, N)
        there = Perturbations(problem, problem.full(0.1), 5.0)
        every = [growth for growth in there.growths() if growth.rate > 0]
        found = there.growing()
        assert (found is None) == (not every)
        if found is not None:
            assert any(found.cause == growth.cause for growth in every)
            assert there.rate(found) == pytest.approx(found.rate, abs=1e-12)
