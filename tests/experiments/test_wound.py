"""Wounds: when a course counts as healed, the theory of the old flow, and the verdict on made-up data."""

import numpy as np
import pytest
import xarray

from cyclosis.experiments.wound import (
    EXPERIMENT,
    MEASURES,
    SINCE,
    healed_after,
    place,
    same,
    striped,
    verdict,
)
from cyclosis.model import initial
from cyclosis.model.grid import CylinderGrid

GRID = CylinderGrid(16, 16, 5.0)


def test_a_wound_is_healed_once_order_stays():
    t = np.arange(5.0)
    assert healed_after(t, [0.0, 0.4, 0.8, 1.0, 1.0]) == pytest.approx(2.5)
    assert healed_after(t, [0.0, 0.95, 0.8, 1.0, 1.0]) == pytest.approx(2.5)
    assert healed_after(t, [0.95, 0.95, 0.91, 1.0, 1.0]) == 0.0
    assert np.isnan(healed_after(t, [0.0, 0.4, 0.8, 1.0, 0.8]))


def test_places_are_anywhere_and_differ():
    angles = np.array([place(seed) for seed in range(400)])
    assert 0 <= angles.min() < angles.max() < 2 * np.pi
    assert abs(np.mean(np.exp(1j * angles))) < 0.15


def test_stripes_are_told_from_other_order():
    assert striped(initial.stripes(GRID))
    assert not striped(0.01 * initial.stripes(GRID))
    assert not striped(initial.stripes(GRID, count=4))
    assert not striped(initial.unidirectional(GRID))


def made_up(healed: float = 2.0, shift: float = 0.01, fall: float = 0.0) -> xarray.Dataset:
    """Return wounds that all heal alike, but for the largest without bundling, which ends streaming."""
    drug = ["none", "none", "none", "everywhere", "everywhere", "in the wound"]
    radius = [0.6, 1.5, 3.0, 0.6, 3.4, 0.6]
    measured = np.zeros((6, 40, len(MEASURES)))
    measured[...] = (healed, fall, 0.9, shift, 1.0, 1.0)
    measured[4, :, MEASURES.index("stripes")] = 0.0
    measured[4, :, 0] = np.nan
    measured[2, 10:, MEASURES.index("shift")] = 0.5
    dims = ("frame", "component", "theta", "z")
    P = np.stack([initial.stripes(GRID)] * 6)
    return xarray.Dataset(
        {
            "P": (dims, P),
            "u": (dims, P),
            "measured": (("case", "seed", "measure"), measured),
            "course": (("case", "quantile", "since"), np.ones((6, 3, SINCE.size))),
            "by_old_flow": ("case", np.full(6, 1.6)),
        },
        coords={
            "drug": ("case", drug),
            "radius": ("case", radius),
            "share": ("case", [0.04, 0.22, 0.83, 0.04, 0.94, 0.04]),
            "measure": list(MEASURES),
            "since": SINCE,
        },
        attrs={"length": 5.0},
    )


@pytest.mark.parametrize(
    ("made", "outcome"),
    [
        ({}, "agrees"),
        ({"fall": 0.3}, "in part"),
        ({"shift": 0.4}, "does not"),
        ({"healed": np.nan}, "does not"),
    ],
)
def test_verdict_and_figure_follow_from_the_data(made, outcome):
    data = made_up(**made)
    assert verdict(data).outcome == outcome
    assert len(EXPERIMENT.draw(data).axes) == 9


def test_the_sentence_tells_of_large_wounds_and_of_the_drug():
    data = made_up()
    assert same(data, "none").sum(axis=1).tolist() == [40, 40, 10]
    sentence = verdict(data).measured
    assert "0.50 radians" in sentence
    assert "94 % in 0.0 %" in sentence
