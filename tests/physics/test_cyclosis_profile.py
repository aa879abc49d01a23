"""The steady two-stripe profile and its slowest relaxation, to the digits known."""

import pytest

from measure import check, profile


@pytest.mark.slow
def test_profile_and_relaxation_rate():
    check(profile.profile())
