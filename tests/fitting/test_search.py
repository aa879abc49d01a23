"""The search of a film, and what it gives, on problems with a known answer."""

import numpy as np
import pytest
from scipy.optimize import minimize_scalar

from cyclosis.fitting.marginal import integrated
from cyclosis.fitting.problem import Problem
from cyclosis.fitting.search import approached, ended

EVERY = np.ones(42, bool)
SIZES = (0.03, 0.1)
"""Amplitudes of the two components of the toy's state."""


def toy(bend, noise=0.01, seed=0, waves=40):
    """Return a `Problem` of two logarithms and `waves` coefficients, its data bent, and the true unknowns."""
    rng = np.random.default_rng(seed)
    squares = np.linspace(0.0, 16.0, waves)
    component = np.arange(waves) % 2
    spread = np.array(SIZES)[component] * np.exp(-squares / (2 * 2.0**2))
    truth = np.concatenate([[0.4, -0.3], rng.normal(size=waves) * spread])
    matrix = rng.normal(size=(400, waves + 2)) * np.concatenate([[1.0, 1.0], np.full(waves, 3.0)])

    def model(x):
        flat = matrix @ x
        return flat + bend * flat**3

    def jacobian(x, used):
        return ((1 + 3 * bend * (matrix @ x) ** 2)[:, None] * matrix * used).T / noise

    data = model(truth) + noise * rng.normal(size=400)
    problem = Problem(
        lambda x: (model(x) - data) / noise,
        jacobian,
        np.zeros(2),
        squares,
        np.ones(waves),
        component,
        np.full(400, np.abs(data).max() / noise),
        np.zeros(400),
        np.ones(400),
        lambda logs: (0.1 * logs[0] * squares + logs[1], np.stack([0.1 * squares, np.ones(waves)])),
    )
    return problem, truth, matrix / noise


@pytest.mark.parametrize("bend", [0.0, 0.3])
def test_the_search_ends_at_the_most_probable_unknowns(bend):
    problem, truth, _ = toy(bend)
    steps = []
    near = approached(problem, np.zeros(truth.size), np.full(2, 0.3), lambda: steps.append(1))
    assert near.ratio < 2.0
    found = ended(problem, problem.first(near.y), np.full(2, 0.3), 3.5, lambda: steps.append(1))
    scale = problem.scale(found.sizes, found.width)
    slope = problem.jacobian(found.x, EVERY) @ problem.misfit(found.x) + found.x / scale**2
    hessian = problem.jacobian(found.x, EVERY) @ problem.jacobian(found.x, EVERY).T + np.diag(scale**-2)
    assert 0.5 * slope @ np.linalg.solve(hessian, slope) == pytest.approx(found.short, rel=1e-3, abs=1e-9)
    assert found.short < 1e-3
    assert found.covariance == pytest.approx(np.linalg.inv(hessian)[:2, :2], rel=1e-6)
    away = found.x[:2] - truth[:2]
    assert away @ np.linalg.solve(found.covariance, away) < 14  # 0.1 % of draws are beyond
    assert found.left @ found.left / (400 - found.effective) == pytest.approx(1.0, abs=0.3)
    assert len(steps) < 40


def test_the_prior_of_the_initial_state_is_found_by_its_evidence():
    ratios = []
    for seed in range(10):
        problem, truth, _ = toy(0.0, seed=seed)
        found = ended(problem, np.zeros(truth.size), np.full(2, 0.5), 4.0, lambda: None)
        power = np.exp(-problem.squares / 4)
        true = np.array(SIZES) * np.sqrt(np.bincount(problem.component, power))
        ratios.append([*found.sizes / true, found.width / 2.0])
    assert np.exp(np.mean(np.log(ratios), axis=0)) == pytest.approx([1.0, 1.0, 1.0], abs=0.2)


def test_slopes_in_what_growth_makes_of_the_state_are_those_of_differences():
    problem, truth, _ = toy(0.3)
    later, y = problem.later(), 0.3 * truth
    slopes = later.jacobian(y, EVERY)
    for k in (0, 1, 2, 20, 41):
        step = np.zeros(y.size)
        step[k] = 1e-5
        difference = (later.misfit(y + step) - later.misfit(y - step)) / 2e-5
        assert slopes[k] == pytest.approx(difference, rel=1e-6, abs=1e-6 * np.abs(difference).max())


def growing(rng, waves=40, unit=0.1, noise=0.02, own=0.03):
    """Return a `Problem` of one rate g: data exp(g) p of unknown states p, and g itself, both with noise."""
    truth = 0.3 * rng.normal()
    grown = np.exp(truth) * unit * rng.normal(size=waves) + noise * rng.normal(size=waves)
    direct = truth + own * rng.normal()

    def misfit(x):
        return np.append((np.exp(x[0]) * x[1:] - grown) / noise, (x[0] - direct) / own)

    def jacobian(x, used):
        out = np.zeros((waves + 1, waves + 1))
        out[0, :-1] = np.exp(x[0]) * x[1:] / noise
        out[1:, :-1] = np.exp(x[0]) / noise * np.eye(waves)
        out[0, -1] = 1 / own
        return out * used[:, None]

    def exact(g):
        """The posterior of g alone: the data are normal with the variance that p and the noise give."""
        variance = np.exp(2 * g) * unit**2 + noise**2
        return 0.5 * ((grown**2 / variance + np.log(variance)).sum() + ((g - direct) / own) ** 2 + g**2)

    ones = np.ones(waves)
    problem = Problem(
        misfit,
        jacobian,
        np.zeros(1),
        0 * ones,
        ones / waves,
        np.zeros(waves, int),
        np.ones(waves + 1),
        np.zeros(waves + 1),
        np.ones(waves + 1),
        lambda logs: (0 * ones, np.zeros((1, waves))),
    )
    return problem, unit, minimize_scalar(exact, bounds=(-2, 2), method="bounded", options={"xatol": 1e-6}).x


def test_with_the_state_integrated_out_growth_is_not_too_fast():
    """The joint optimum takes a small state for a probable one, and growth that is too fast."""
    joint, alone = [], []
    for seed in range(50):
        problem, unit, exact = growing(np.random.default_rng(seed))
        found = ended(problem, np.zeros(41), np.array([unit]), 1.0, lambda: None, known=True)
        deviation = np.sqrt(found.covariance[0, 0])
        joint.append((found.x[0] - exact) / deviation)
        alone.append((integrated(problem, found, lambda: None).x[0] - exact) / deviation)
    assert min(joint) > 0.9
    assert np.abs(alone).max() < 0.1
