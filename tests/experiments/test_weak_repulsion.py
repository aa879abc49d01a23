"""Cells with little repulsion: kinds, speeds of turning, borders of theory, verdicts on made-up data."""

import numpy as np
import pytest
import xarray

from cyclosis.analysis.regimes import REGIMES
from cyclosis.experiments.weak_repulsion import (
    EXPERIMENT,
    beginning,
    circumferential_end,
    kinds,
    turned,
    upright,
    verdict,
)
from cyclosis.model import initial
from cyclosis.model.grid import CylinderGrid
from cyclosis.model.parameters import Parameters
from cyclosis.stability import growth_rates

SEEDS = 50


def made(weak: tuple[int, int], half: float, astray: float = 0.0) -> xarray.Dataset:
    """Return data with two kinds of cells at small kappa, and a share of early order around at 0.5."""
    grid = CylinderGrid(16, 16, 5.0)
    state = initial.stripes(grid)
    dims = ("frame", "component", "theta", "z")
    kind = np.array([weak[0], weak[1], 2, 2])[:, None] * np.ones(SEEDS, dtype=int)
    early = np.array([0.5, half, 1e-4])
    time = np.linspace(0, 8, 9)
    share = np.exp(-np.array([0.0, 0.5, 2.0])[:, None] * time) / 2
    return xarray.Dataset(
        {
            "P": (dims, np.stack([state] * 5)),
            "u": (dims, np.stack([state] * 5)),
            "kind": (("kappa", "seed"), kind),
            "mean_P_theta": (("kappa", "seed"), np.where(kind == 0, 0.99, np.where(kind == 1, 0.5, 0.0))),
            "speed": (("turning", "turning_seed"), np.array([[5e-3, 5e-3], [-2e-3, -2e-3]]) + astray),
            "theory_speed": ("turning", [5e-3, -2e-3]),
            "curve_speed": ("curve", [5e-3, -2e-3, np.nan]),
            "curve_mean": ("curve", [0.8, 0.5, np.nan]),
            "half_share": (("early", "seed"), early[:, None] * np.ones(SEEDS)),
            "half_time": (("early", "seed"), np.full((3, SEEDS), 6.5)),
            "share": (("quantile", "early", "time"), np.stack([0.9 * share, share, 1.1 * share])),
            "theory_upright": 0.47,
            "theory_round": 0.05,
            "theory_order": 0.99,
        },
        coords={
            "kappa": [0.0, 0.2, 0.5, 2.0],
            "turning": [0.1, 0.2],
            "curve": [0.1, 0.2, 0.3],
            "early": [0.0, 0.5, 2.0],
            "time": time,
        },
        attrs={"length": 5.0},
    )


def test_kinds_follow_from_regime_and_tilt():
    names = ("circumferential", "travelling", "cyclosis", "cyclosis", "undecided")
    regime = np.array([REGIMES.index(name) for name in names])
    # Tilted stripes that happen to stand still have the regime of upright ones.
    assert kinds(regime, np.array([0.99, 0.3, 0.5, 1e-6, 0.3])).tolist() == [0, 1, 1, 2, 3]


def test_the_speed_of_turning_is_that_of_a_shifted_state_in_its_own_sense():
    theta = CylinderGrid(16, 8, 5.0).theta[:, None]

    def state(shift: float, lean: float) -> np.ndarray:
        return np.stack([np.full((16, 8), lean), np.sin(theta - shift) * np.ones(8)])

    assert turned(state(0.0, 0.5), state(0.3, 0.5), 10.0) == pytest.approx(0.03)
    assert turned(state(0.0, -0.5), state(0.3, -0.5), 10.0) == pytest.approx(-0.03)


def test_borders_are_where_growth_rates_change_sign():
    usual = Parameters()
    end = circumferential_end(usual)
    assert growth_rates(usual.replace(kappa=end), "circumferential", 1, 0)[0].real == pytest.approx(
        0, abs=1e-9
    )
    assert upright(usual) == pytest.approx(0.470696, abs=1e-6)


def test_disorder_has_half_its_order_around_the_axis():
    start = beginning(2.0, 0)
    assert start[2] == pytest.approx(0.5, abs=0.05)
    assert start[0] < 0.01
    assert 3 < start[1] < 8


@pytest.mark.parametrize(
    ("weak", "half", "astray", "expected"),
    [
        ((0, 1), 0.1, 0.0, "agrees"),
        ((0, 1), 0.005, 0.0, "in part"),
        ((0, 1), 0.1, 1e-3, "in part"),
        ((0, 2), 0.1, 0.0, "in part"),
        ((2, 2), 0.1, 0.0, "does not"),
    ],
)
def test_verdict_and_figure_follow_from_the_data(weak, half, astray, expected):
    data = made(weak, half, astray)
    found = verdict(data)
    assert found.outcome == expected
    assert ("the paper denies" in found.measured) == (half < 0.01)
    assert len(EXPERIMENT.draw(data).axes) == 8
