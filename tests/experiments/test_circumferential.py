"""Cables that turn around the axis: shares of order, the onset of a tilt, and verdicts on made-up data."""

import numpy as np
import pytest
import xarray

from cyclosis.analysis.regimes import REGIMES
from cyclosis.experiments.circumferential import EXPERIMENT, around, onset, tilt_growth, verdict, where
from cyclosis.model import initial
from cyclosis.model.grid import CylinderGrid

ROUND, TWO = (REGIMES.index(name) for name in ("circumferential", "cyclosis"))
SEEDS = 40


def made(
    lost: float, turned: float, half_lost: float, half_turned: float, one_way: bool = True
) -> xarray.Dataset:
    """Return data in which given shares of cells, and of order in halves, run around the axis."""
    grid = CylinderGrid(16, 16, 5.0)
    dims = ("frame", "component", "theta", "z")
    state = initial.stripes(grid)
    k = (np.arange(SEEDS) + 0.5) / SEEDS
    regime = np.where(np.array([lost, turned])[:, None, None] > k, ROUND, TWO)
    regime = np.broadcast_to(regime, (2, 2, SEEDS))
    half = np.array([[half_lost, 0.1], [half_turned, 0.2]])
    strength = np.array([0.2, 0.4, 0.8])
    return xarray.Dataset(
        {
            "P": (dims, np.stack([state] * 5)),
            "u": (dims, np.stack([state] * 5)),
            "regime": (("treatment", "start", "seed"), regime),
            "mean_P_theta": (
                ("treatment", "start", "seed"),
                np.full((2, 2, SEEDS), 0.99 if one_way else 0.0),
            ),
            "half_around": (
                ("treatment", "seed", "where"),
                np.broadcast_to(half[:, None], (2, SEEDS, 2)),
            ),
            "around": (
                ("treatment", "length", "band_seed", "where"),
                np.broadcast_to(half[:, None, None], (2, 3, 2, 2)),
            ),
            "tipped_regime": (("alpha_u", "seed"), np.full((2, SEEDS), TWO)),
            "growth": ("growing_alpha_u", strength - 0.5),
            "theory_order": 0.99,
            "theory_slope": 1.0,
            "theory_tilt": 0.5,
        },
        coords={
            "treatment": ["lost", "turned"],
            "start": ["established", "disorder"],
            "where": ["inside", "outside"],
            "length": [1.0, 2.0, 3.0],
            "growing_alpha_u": strength,
        },
        attrs={"length": 5.0},
    )


def test_around_is_the_share_of_order_along_theta_within_a_mask():
    grid = CylinderGrid(16, 20, 5.0)
    mask = where(2.5).mask(grid)
    state = np.zeros((2, *grid.shape))
    state[1] = 0.8
    state[0][mask] = 0.4
    assert mask.mean() == pytest.approx(0.5)
    assert around(state, mask) == pytest.approx(0.2)
    assert around(state, ~mask) == 0


def test_a_tilt_grows_at_the_rate_of_theory():
    assert tilt_growth(0.7) == pytest.approx(0.7 * 0.975 - 0.5, abs=1e-4)
    assert onset(made(1, 1, 0.9, 0.9)) == pytest.approx(0.5)


@pytest.mark.parametrize(
    ("shares", "expected"),
    [
        ((1, 1, 0.9, 0.9), "agrees"),
        ((1, 1, 0.5, 0.9), "in part"),
        ((1, 0.2, 0.9, 0.9), "in part"),
        ((0.1, 0.1, 0.2, 0.2), "does not"),
    ],
)
def test_verdict_and_figure_follow_from_the_data(shares, expected):
    data = made(*shares)
    found = verdict(data)
    assert found.outcome == expected
    assert ("neighbours hold" in found.measured) == (shares[2] < 0.8 < shares[3])
    assert len(EXPERIMENT.draw(data).axes) == 8


def test_bands_that_run_opposite_ways_are_no_streaming_around():
    assert verdict(made(1, 1, 0.9, 0.9, one_way=False)).outcome == "does not"
