"""The flow in the vacuole meets every bound of `measure.vacuole`."""

import pytest

from measure import check, vacuole


@pytest.mark.parametrize(
    "measured",
    ["reference", "oracle", "bands", "cyclosis", "helices", "budget", "drag", "limits"],
)
def test_it_is_exact(measured):
    check(getattr(vacuole, measured)())
