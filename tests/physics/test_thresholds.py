"""Where two stripes exist and where they are stable, each number with its error."""

import pytest

from measure import check, thresholds


@pytest.mark.slow
def test_thresholds_of_stability():
    check(thresholds.stability())


@pytest.mark.slow
def test_folds_and_the_pitchfork():
    check(thresholds.existence())


@pytest.mark.slow
@pytest.mark.parametrize("case", thresholds.TINY, ids=lambda case: f"alpha_p = {case[0]:g}")
def test_rates_below_the_rounding_of_eigenvalues(case):
    """Against the same equations in 40 digits."""
    check(thresholds.small_rates(*case))


@pytest.mark.slow
def test_thresholds_converge_exponentially():
    check(thresholds.convergence())
