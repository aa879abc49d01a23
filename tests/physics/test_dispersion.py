"""Small disturbances of the uniform states grow as linear theory says, mode by mode."""

import pytest

from measure import check, dispersion


@pytest.mark.slow
@pytest.mark.parametrize("name", dispersion.DISORDERED)
def test_growth_from_disorder(name):
    """α_p - d_r - d_s k² for P_z, that minus κ for P_theta: the flow drops out."""
    check(dispersion.disorder(name))


@pytest.mark.slow
@pytest.mark.parametrize("name", dispersion.ORDERED)
def test_growth_from_the_unidirectional_state(name):
    """Each mode's 2 x 2 matrix, oblique modes with ε ≠ 0 included."""
    check(dispersion.unidirectional(name))


def test_uniform_state():
    """P0² = 1 - d_r/α_p, reached at rate -2 (α_p - d_r), with Π₀ = P0³ and no flow."""
    check(dispersion.uniform_state())


def test_thresholds_of_the_unidirectional_state():
    """Tilt beyond α_u = κ/P0², stripes beyond α_u = α_p² (1 + μ)(2a + d_s)/(3 d_r a)."""
    check(dispersion.thresholds())
