"""Cells without motors: what counts as which outcome, and the verdict on made-up data."""

import numpy as np
import pytest
import xarray

from cyclosis.analysis.regimes import REGIMES
from cyclosis.experiments.myosin_inhibition import EXPERIMENT as chosen
from cyclosis.experiments.myosin_inhibition import by_law, outcomes, verdict, widest
from cyclosis.model import initial
from cyclosis.model.grid import CylinderGrid

ALONE, TWO, OPEN = (REGIMES.index(name) for name in ("unidirectional", "cyclosis", "undecided"))


def made(outcome: list[int], speed: float = 0.0, slowness: float = 1.0) -> xarray.Dataset:
    """Return a dataset of cells with outcomes, at one alpha_p, and prepared stripes slower than the law."""
    n = len(outcome)
    grid = CylinderGrid(16, 16, 5.0)
    state = initial.stripes(grid)
    dims = ("frame", "component", "theta", "z")
    displaced = np.full((1, 8), 0.3)
    rows = np.array([outcome])
    return xarray.Dataset(
        {
            "P": (dims, np.stack([state] * 5)),
            "u": (dims, np.stack([state] * 5)),
            "outcome": (("alpha_p", "seed"), rows),
            "width": (("alpha_p", "seed"), np.where(rows == 1, 0.6, np.nan)),
            "speed": (("alpha_p", "seed"), np.full((1, n), speed)),
            "control_regime": ("seed", np.full(n, TWO)),
            "control_width": ("seed", np.full(n, 0.5)),
            "growth": ("timed_alpha_p", [1e-3]),
            "displaced": (("timed_alpha_p", "prepared"), displaced),
            "life": (("timed_alpha_p", "prepared"), slowness * by_law(displaced)),
        },
        coords={"alpha_p": [1.0], "timed_alpha_p": [0.1]},
        attrs={"late": 300.0, "length": 5.0},
    )


def test_outcomes_tell_lasting_stripes_from_those_that_have_merged():
    regime = np.array([ALONE, ALONE, TWO, TWO, OPEN])
    since = np.array([50.0, 5000.0, 50.0, 50.0, 50.0])
    width = widest(np.array([[np.nan, np.nan], [np.nan, np.nan], [0.3, 0.7], [0.501, 0.499], [0.5, 0.5]]))
    assert outcomes(regime, since, width, 300.0).tolist() == [0, 1, 1, 2, 3]


@pytest.mark.parametrize(
    ("outcome", "speed", "slowness", "expected"),
    [
        ([0] * 150 + [1] * 50, 0.4, 1.0, "agrees"),
        ([0] * 150 + [1] * 50, 1e-9, 1.0, "in part"),
        ([0] * 150 + [1] * 50, 0.4, 3.0, "in part"),
        ([0] * 200, 0.4, 1.0, "in part"),
        ([2] * 150 + [1] * 50, 0.4, 1.0, "does not"),
    ],
)
def test_verdict_and_figure_follow_from_the_data(outcome, speed, slowness, expected):
    data = made(outcome, speed, slowness)
    found = verdict(data)
    assert found.outcome == expected
    assert ("nothing flows" in found.measured) == (speed < 0.05)
    assert len(chosen.draw(data).axes) == 8
