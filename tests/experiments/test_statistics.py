"""Tests and intervals against known answers."""

import numpy as np
import pytest

from cyclosis.experiments.statistics import circular, in_words, median_interval, proportion


def test_uniform_angles_are_rarely_called_otherwise():
    """Under uniformity p-values are uniform themselves: 5 % lie below 0.05."""
    rng = np.random.default_rng(1)
    found = [circular(rng.uniform(0, 2 * np.pi, 100)) for _ in range(1000)]
    assert np.mean([one.rayleigh < 0.05 for one in found]) == pytest.approx(0.05, abs=0.02)
    assert np.mean([one.kuiper < 0.05 for one in found]) == pytest.approx(0.05, abs=0.02)


def test_concentrated_and_bipolar_angles_are_told_from_uniform():
    rng = np.random.default_rng(2)
    near = circular(rng.normal(1.0, 0.8, 100))
    assert near.rayleigh < 1e-10
    assert near.kuiper < 1e-10
    assert near.resultant == pytest.approx(np.exp(-0.32), abs=0.1)
    # Two opposite directions have no mean: Rayleigh cannot see them, Kuiper does.
    both = circular(rng.normal(0, 0.2, 200) + np.pi * rng.integers(0, 2, 200))
    assert both.rayleigh > 0.01
    assert both.kuiper < 1e-6


def test_where_angles_begin_makes_no_difference():
    angles = np.random.default_rng(3).uniform(0, 5.0, 60)
    one, turned = circular(angles), circular(angles + 2.1)
    assert turned.rayleigh == pytest.approx(one.rayleigh, rel=1e-9)
    assert turned.kuiper == pytest.approx(one.kuiper, rel=1e-9)


def test_the_median_lies_in_its_interval_as_often_as_said():
    rng = np.random.default_rng(4)
    inside = 0
    for _ in range(1000):
        _, low, high = median_interval(rng.exponential(size=41))
        inside += low <= np.log(2) <= high
    assert 0.95 <= inside / 1000 <= 0.99
    middle, low, high = median_interval([3.0, 1.0, 2.0])
    assert (middle, low, high) == (2.0, -np.inf, np.inf)
    assert np.isnan(median_interval([])[0])


def test_shares_in_words():
    share = proportion(90, 100)
    assert share[0] == 0.9
    assert share[1] == pytest.approx(0.8256, abs=1e-3)
    assert in_words(share) == "90.0 % (82.6 to 94.5 %)"
