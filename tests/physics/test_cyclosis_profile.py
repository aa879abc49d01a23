"""The steady two-stripe profile and its slowest relaxation, to the digits known."""

from measure import check, profile


def test_profile_and_relaxation_rate():
    check(profile.profile())
