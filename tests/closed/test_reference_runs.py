"""Runs against stored ones of an earlier, independent program: see tests/reference/README.md."""

import pytest

from measure import check, closed


@pytest.mark.slow
@pytest.mark.parametrize("name", closed.STORED)
def test_runs_are_the_stored_ones(name):
    check(closed.stored(name))
