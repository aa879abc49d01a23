"""Runs, files, blocks, members and links are bit for bit those that were recorded on such a machine.

On other machines last digits differ: there numbers agree within rounding, and checksums are not compared.
"""

import numpy as np
import pytest

from golden.cases import CASES
from golden.machine import RECORDS, file_of, kinds, machine

ROUNDING = {"float32": 2e-3}
"""How far rounding may drive results apart, relative to the largest number; 1e-6 where nothing is said."""


LONG = ("protocol",)


@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=[pytest.mark.slow] if name in LONG else []) for name in CASES]
)
def test_nothing_has_changed(name):
    found = CASES[name]()
    for folder in kinds():
        with np.load(file_of(folder, name)) as file:
            compared(name, found, dict(file), exactly=folder == RECORDS / machine())


def compared(name, found, stored, exactly):
    """Assert that results are those stored: bit for bit, or within rounding."""
    assert found.keys() == stored.keys()
    for key, values in stored.items():
        assert found[key].shape == values.shape, key
        assert found[key].dtype == values.dtype, key
        if exactly:
            assert found[key].tobytes() == values.tobytes(), key
        elif key not in ("sha256", "steps", "evaluations"):
            scale = ROUNDING.get(name, 1e-6) * max(1.0, float(np.nanmax(np.abs(values), initial=0.0)))
            np.testing.assert_allclose(found[key], values, rtol=0.0, atol=scale, err_msg=key)


def test_there_are_records():
    assert kinds()
    assert all(file_of(folder, name).exists() for folder in kinds() for name in CASES)
