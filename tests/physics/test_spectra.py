"""Eigenvalues of stripes: known digits, closed forms, exponential convergence, and rates seen in runs."""

import pytest

from measure import check, spectra


def test_known_eigenvalues():
    """0, -0.06406947, -1.841276 at α_p = 1, α_u = 0.5."""
    check(spectra.known())


@pytest.mark.slow
def test_lame_s_rates_without_flow():
    check(spectra.closed_forms())


@pytest.mark.slow
def test_exponential_convergence():
    check(spectra.convergence())


@pytest.mark.slow
def test_three_ways_to_one_rate():
    """The profile's spectrum, the whole cell's leading modes, and runs, for seven modes, two complex."""
    check(spectra.three_ways())
