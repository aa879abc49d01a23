"""The law of fronts, and stripes that are timed."""

import numpy as np
import pytest

from cyclosis.experiments.myosin_inhibition import by_law, ending, timed


def test_ending_is_where_the_least_order_rises_through_zero():
    assert ending([0.0, 1.0, 2.0, 3.0], [-1.0, -1.0, 1.0, 1.0]) == pytest.approx(1.5)
    assert np.isnan(ending([0.0, 1.0], [-1.0, -0.5]))
    assert np.isnan(ending([0.0, 1.0], [0.5, 0.6]))


def test_the_law_of_fronts_is_the_integral_of_its_speed():
    displaced = 0.6
    reach = np.linspace(displaced, 12, 400_001)
    by_hand = np.trapezoid(4 / np.sinh(4 * reach), reach)
    assert by_law(displaced) == pytest.approx(by_hand, rel=1e-6)


def test_nearly_equal_stripes_live_as_long_as_the_law_says():
    displaced, lived = timed(0.1, 0.46)
    assert displaced == pytest.approx(np.pi * 0.04 / 0.8165, rel=0.02)
    assert lived == pytest.approx(float(by_law(displaced)), rel=0.08)
