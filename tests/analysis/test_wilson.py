import numpy as np
import pytest
from scipy.stats import binomtest

import cyclosis as cy
from cyclosis.analysis.wilson import wilson


@pytest.mark.parametrize("trials", [1, 2, 7, 50, 1000])
@pytest.mark.parametrize("confidence", [0.5, 0.95, 0.999])
def test_intervals_are_those_of_scipy(trials, confidence):
    hits = np.unique(np.linspace(0, trials, 8).astype(int))
    low, high = wilson(hits, trials, confidence)
    for k, count in enumerate(hits):
        exact = binomtest(int(count), trials).proportion_ci(confidence, method="wilson")
        assert low[k] == pytest.approx(exact.low, abs=1e-14)
        assert high[k] == pytest.approx(exact.high, abs=1e-14)


def test_ends_solve_wilson_s_equation_and_stay_within_0_and_1():
    n = np.array([[3.0], [50.0], [1e7]])
    p = np.linspace(0, 1, 11)
    low, high = wilson(p * n, n)
    assert low.shape == high.shape == (3, 11)
    for end in (low, high):
        assert np.abs((p - end) ** 2 - 1.959963984540054**2 * end * (1 - end) / n).max() < 1e-15
    assert np.all(low[:, 0] == 0)
    assert np.all(high[:, -1] == 1)
    assert np.all((low >= 0) & (low <= p) & (p <= high) & (high <= 1))


def test_fifty_of_fifty():
    """What the paper's region C rests on."""
    low, high = wilson(50, 50)
    assert float(low) == pytest.approx(0.92865, abs=1e-5)
    assert float(high) == 1


def test_without_trials_nothing_is_known():
    low, high = wilson([0, 1], [0, 2])
    assert np.isnan([low[0], high[0]]).all()
    assert np.isfinite([low[1], high[1]]).all()


@pytest.mark.parametrize(
    ("hits", "trials", "confidence"),
    [(3, 2, 0.95), (-1, 2, 0.95), (np.nan, 2, 0.95), (1, 2, 1.0), (1, 2, "x")],
)
def test_impossible_counts_are_refused(hits, trials, confidence):
    with pytest.raises(cy.InputError):
        wilson(hits, trials, confidence)
