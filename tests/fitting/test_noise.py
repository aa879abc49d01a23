"""The noise of a film: its size at any times, and how many vectors share it."""

from math import comb

import numpy as np
import pytest

from cyclosis.fitting.noise import differences, left, noise_of, shared, surrogate

TIMES = np.cumsum(np.random.default_rng(0).uniform(0.5, 2.0, 60))
KNOWN = np.ones((60, 12, 20), bool)


@pytest.mark.parametrize("order", [3, 4, 5])
def test_differences_leave_white_noise_and_no_polynomial(order):
    matrix = differences(TIMES, order)
    assert (matrix**2).sum(axis=1) == pytest.approx(1.0)
    for power in range(order):
        assert matrix @ (TIMES / TIMES[-1]) ** power == pytest.approx(0.0, abs=1e-12)
    even = differences(np.arange(8.0), order)[0, : order + 1]
    expected = [(-1) ** k * comb(order, k) for k in range(order + 1)]
    assert np.abs(even) == pytest.approx(np.abs(expected) / np.sqrt(comb(2 * order, order)))


def moving(rng, noise):
    """Return a field that changes smoothly, with noise."""
    signal = np.sin(0.1 * TIMES)[:, None, None, None] * np.linspace(1, 2, 12)[None, None, :, None]
    return signal + noise * rng.normal(size=(60, 2, 12, 20))


def test_noise_at_uneven_times_and_with_holes():
    rng = np.random.default_rng(1)
    known = rng.random(KNOWN.shape) > 0.1
    field = np.where(known[:, None], moving(rng, 0.03), 5.0)
    assert np.sqrt(noise_of(field, TIMES, known)) == pytest.approx(np.full((2, 12, 20), 0.03), rel=0.2)
    assert np.sqrt(noise_of(field, TIMES, known).mean()) == pytest.approx(0.03, rel=0.03)


def test_how_many_vectors_share_their_noise():
    rng = np.random.default_rng(2)
    white = rng.normal(size=(60, 2, 12, 20))
    assert shared(left(white, TIMES, KNOWN)) == pytest.approx(1.0, abs=0.05)
    both = (white + np.roll(white, 1, 2)) / np.sqrt(2)
    assert shared(left(both, TIMES, KNOWN)) == pytest.approx(2.0, rel=0.1)
    overlapping = (both + np.roll(both, 1, 3)) / np.sqrt(2)
    assert shared(left(overlapping, TIMES, KNOWN)) == pytest.approx(4.0, rel=0.1)


def test_more_noise_has_the_pattern_of_the_noise():
    rng = np.random.default_rng(3)
    white = rng.normal(size=(60, 2, 12, 20))
    field = 0.1 * (white + np.roll(white, 1, 3)) / np.sqrt(2)
    more = surrogate(field, TIMES, noise_of(field, TIMES, KNOWN), rng)
    assert more.std() == pytest.approx(0.1, rel=0.05)
    assert np.mean(more[..., 1:] * more[..., :-1]) / more.var() == pytest.approx(0.5, abs=0.1)
    assert abs(np.mean(more[1:] * more[:-1])) / more.var() < 0.2
