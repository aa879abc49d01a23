"""The drug: what theory says of stripes without bundling, and the verdict on made-up data."""

import numpy as np
import pytest
import xarray

import cyclosis as cy
from cyclosis.experiments.cytochalasin import (
    EXPERIMENT,
    WAYS,
    branch,
    first_wave,
    fold,
    least_order,
    left_over,
    misplaced,
    verdict,
)
from cyclosis.model import initial
from cyclosis.model.grid import CylinderGrid

GRID = CylinderGrid(16, 16, 5.0)


def test_the_branch_turns_round_at_the_fold():
    curve = branch(0.0, 0.5, 200)
    assert curve[:, 0].min() == pytest.approx(fold(0.0), rel=1e-3)
    assert fold(0.0) == pytest.approx(0.226724, abs=1e-6)
    upper = cy.stability.cyclosis(cy.Parameters(alpha_p=0.0, alpha_u=0.5))
    assert curve[0, 2] == pytest.approx(np.abs(upper.u).max(), rel=1e-3)


def test_stripes_last_above_the_unstable_branch_only():
    assert left_over(0.0, 0.2) < 1e-3
    assert left_over(0.0, 0.5) == pytest.approx(0.894, abs=2e-3)
    assert 0.3 < least_order(0.0, 0.5) < 0.4
    assert least_order(0.0, 0.1) == 1.0


def test_the_first_wave_of_a_sine_is_its_amplitude():
    assert first_wave(initial.stripes(GRID, magnitude=0.7)) == pytest.approx(0.7)


def made_up(disorder: bool, established: bool, fragmented: bool) -> xarray.Dataset:
    """Return cells that stream or do not at both alpha_u, and a map that theory foretells but for a point."""
    streams = np.broadcast_to(np.array([disorder, established, fragmented])[:, None, None], (3, 2, 100))
    edge, flow = np.array([0.2, 0.1]), np.array([0.05, 0.15, 0.201, 0.3])
    left = np.where(flow > edge[:, None], 0.9, 0.0)
    left[1, 3] = 0.0
    dims = ("frame", "component", "theta", "z")
    P = np.stack([initial.stripes(GRID)] * 6)
    return xarray.Dataset(
        {
            "P": (dims, P),
            "u": (dims, P),
            "speed": (("way", "alpha_u", "seed"), 0.8 * streams),
            "streams": (("way", "alpha_u", "seed"), streams),
            "left": (("map_alpha_p", "map_alpha_u"), left),
            "fold": ("map_alpha_p", edge),
            "least_wave": ("order_alpha_u", [0.6, 0.4]),
            "branch": (("along", "of_branch"), np.array([[1, 1.2, 0.9], [0.2, 0.8, 0.5], [1, 0.3, 0.1]])),
        },
        coords={
            "way": list(WAYS),
            "alpha_u": [0.2, 0.5],
            "map_alpha_p": [0.0, 0.03],
            "map_alpha_u": flow,
            "order_alpha_u": [0.25, 0.5],
        },
        attrs={"length": 5.0},
    )


@pytest.mark.parametrize(
    ("streaming", "outcome"),
    [
        ((False, False, False), "agrees"),
        ((False, True, False), "in part"),
        ((True, True, True), "does not"),
    ],
)
def test_verdict_and_figure_follow_from_the_data(streaming, outcome):
    data = made_up(*streaming)
    found = verdict(data)
    assert found.outcome == outcome
    assert ("does not stop an established cell" in found.measured) == streaming[1]
    assert len(EXPERIMENT.draw(data).axes) == 9


def test_points_on_the_wrong_side_of_the_fold_are_counted_unless_next_to_it():
    assert misplaced(made_up(False, True, False)) == (1, 7)
