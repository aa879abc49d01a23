"""The closure against the kinetic model: ends of made-up cells, and every verdict, on made-up data."""

import numpy as np
import pytest
import xarray

import cyclosis as cy
from cyclosis.experiments import closure as subject
from cyclosis.experiments import kinetic_cells
from cyclosis.experiments.kinetic_cells import OUTCOMES, End

STRIPES, NONE = OUTCOMES.index("two stripes"), OUTCOMES.index("disorder")


def end(outcome=STRIPES, order=0.92, speed=0.97, when=6.0, around=0.0):
    return np.array(End(outcome, order, order, around, 0.1, speed, when, 0.0))


def made_up(same_map=True, order=0.92, lasting=True, when=6.0, onset=0.025):
    """Return data in which the kinetic model has these numbers, and the paper's closure the usual ones."""
    rates, ratios = [0.2, 0.6, 1.0], [0.0, 4.0, 20.0]
    ring = np.empty((2, 3, 3, 4, 8))
    ring[:] = end()
    if not same_map:
        ring[1, :2] = end(NONE, 0.01, 0.0, np.nan)
    whole = np.empty((2, 2, 3, 8))
    whole[:] = end()
    whole[1] = end(order=order, when=when)
    scan = np.empty((4, 3, 1, 8))
    scan[:] = end()
    scan[1, 2] = end(order=order, when=when)
    threshold = np.full((3, 2, 2), onset)
    fading = np.full((4, 1, 3, 2, 5), 0.8)
    if not lasting:
        fading[1] = 0.01
    grid = cy.CylinderGrid(12, 12)
    P = np.stack([cy.initial.stripes(grid)] * 5)
    frame = ("frame", "component", "theta", "z")
    return xarray.Dataset(
        {
            "ring": (("model", "alpha_p", "alpha_u", "ring_seed", "number"), ring),
            "cell": (("model", "point", "cell_seed", "number"), whole),
            "scan": (("closure", "ratio", "scan_seed", "number"), scan),
            "threshold": (("ratio", "direction", "way"), threshold),
            "fading": (("closure", "fading_kappa", "fading_alpha_u", "quantity", "fading_time"), fading),
            "P": (frame, P),
            "u": (frame, 0.8 * P),
        },
        {
            "alpha_p": rates,
            "alpha_u": rates,
            "point_alpha_p": ("point", [0.25, 1.0]),
            "point_alpha_u": ("point", [0.5, 0.5]),
            "frame_time": ("frame", [10.0, 200.0, 10.0, 20.0, 200.0]),
            "ratio": ratios,
            "direction": ["theta", "z"],
            "way": ["measured", "theory"],
            "fading_kappa": [0.5],
            "fading_alpha_u": [0.1, 0.5, 1.0],
            "quantity": ["along", "around"],
            "fading_time": list(subject.FADING_TIMES),
            "model": ["paper", "kinetic"],
            "closure": list(subject.CLOSURES),
            "number": list(End._fields),
        },
        {"length": 5.0},
    )


@pytest.mark.parametrize(
    ("data", "outcome"),
    [
        (made_up(), "agrees"),
        (made_up(lasting=False), "in part"),
        (made_up(same_map=False), "in part"),
        (made_up(same_map=False, order=0.5), "does not"),
    ],
)
def test_verdicts_follow_from_the_data_and_are_drawn(data, outcome):
    assert subject.verdict(data).outcome == outcome
    assert len(subject.draw(data).axes) == 5 + 4


def test_the_sentence_has_the_numbers():
    words = subject.verdict(made_up(same_map=False, lasting=False, onset=0.469, when=12.0)).measured
    assert "above α_p = 0.469, not 0.025" in words
    assert "t = 12.0, not 6.0" in words
    assert "stripes last at 0 of 3 values of α_u, not 3" in words
    assert "33.3 %" in subject.decisive(made_up(same_map=False))


def test_the_closure_is_good_up_to_where_it_first_fails():
    same = {"order": 0.05}
    assert subject.good_up_to(made_up(), "paper", same, {"around": 0.05}) == 20.0
    assert subject.good_up_to(made_up(order=0.8), "paper", same, {}) == 4.0
    assert subject.good_up_to(made_up(order=0.8), "von_mises", same, {}) == 4.0
    assert subject.good_up_to(made_up(order=0.8), "paper", {}, {"around": 0.05}) == 20.0
    assert np.isnan(subject.good_up_to(made_up().isel(ratio=[2]), "paper", {"order": -1.0}, {}))


def test_the_most_frequent_outcome_leaves_out_cells_that_were_not_computed():
    ends = np.array([[3.0, 3.0, 2.0, np.nan, np.nan], [0.0, 2.0, 2.0, 2.0, 2.0]])
    assert subject.likely(ends).tolist() == [3, 2]


def test_one_seed_is_the_same_filaments_in_both_models():
    """On the same grid of noise P differs only by what the finer grid of the polar model interpolates."""
    for whole in (True, False):
        fine, P = kinetic_cells.disordered(cy.models.polar, 3, whole)
        coarse, m = kinetic_cells.disordered(cy.models.kinetic, 3, whole)
        shared = cy.interpolate(P, coarse.shape)
        found = cy.interpolate(cy.interpolate(cy.kinetic.order(m), fine.shape), coarse.shape)
        assert np.abs(shared - found).max() < 1e-15


def test_ends_are_those_of_known_states():
    run = cy.simulate(
        cy.Parameters(), cy.CylinderGrid(48, 1), cy.initial.stripes(cy.CylinderGrid(48, 1)), 60.0
    )
    found = kinetic_cells.ended(run, cy.models.polar)
    assert OUTCOMES[int(found.outcome)] == "two stripes"
    assert found.order == pytest.approx(0.9254, abs=1e-3)
    assert found.when == 0.0
    assert found.around == pytest.approx(0.0, abs=1e-6)


@pytest.mark.slow
def test_travelling_stripes_count_as_stripes():
    grid = cy.CylinderGrid(36, 1)
    m = cy.kinetic.dressed(kinetic_cells.established(grid), 40)
    run = cy.simulate(cy.Parameters(), grid, m, 40.0, rtol=1e-3, record_every=1.0, model=cy.models.kinetic)
    found = kinetic_cells.ended(run, cy.models.kinetic)
    assert OUTCOMES[int(found.outcome)] == "two stripes"
    assert abs(found.drift) == pytest.approx(0.0039, abs=2e-4)


def test_thresholds_are_found_from_measured_growth():
    exact = cy.kinetic.thresholds(cy.Parameters(kappa=0.1))
    found = kinetic_cells.threshold(cy.models.kinetic, {"kappa": 0.1}, 0, exact.along)
    assert found == pytest.approx(exact.along, rel=1e-4)


def test_the_time_to_half_order_is_between_two_records():
    assert kinetic_cells._crossing(np.array([0.0, 1.0, 2.0]), np.array([0.0, 0.4, 0.6]), 2) == pytest.approx(
        1.5
    )
