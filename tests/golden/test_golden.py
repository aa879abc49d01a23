"""Runs, files, blocks, members and links are bit for bit those that were recorded on such a machine.

On other machines last digits differ: there numbers agree within rounding, and checksums are not compared.
"""

from pathlib import Path

import numpy as np
import pytest

from golden.cases import CASES
from golden.machine import machine

ROUNDING = {"float32": 2e-3}
"""How far rounding may drive results apart, relative to the largest number; 1e-6 where nothing is said."""


LONG = ("protocol",)


@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=[pytest.mark.slow] if name in LONG else []) for name in CASES]
)
def test_nothing_has_changed(name):
    with np.load(Path(__file__).parent / f"{name.replace(' ', '-')}.npz") as file:
        stored = dict(file)
    recorded_here = stored.pop("machine") == machine()
    found = CASES[name]()
    assert found.keys() == stored.keys()
    for key, values in stored.items():
        assert found[key].shape == values.shape, key
        assert found[key].dtype == values.dtype, key
        if recorded_here:
            assert found[key].tobytes() == values.tobytes(), key
        elif key not in ("sha256", "steps", "evaluations"):
            scale = ROUNDING.get(name, 1e-6) * max(1.0, float(np.nanmax(np.abs(values), initial=0.0)))
            np.testing.assert_allclose(found[key], values, rtol=0.0, atol=scale, err_msg=key)
