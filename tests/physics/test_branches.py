"""Branches of states: where they turn, meet and end, and how fast what drifts is seen to drift."""

import pytest

from measure import check, continuation


@pytest.mark.slow
def test_folds_branch_points_and_ends():
    check(continuation.ends())


@pytest.mark.slow
def test_tilted_stripes_and_their_drift():
    check(continuation.tilted())
