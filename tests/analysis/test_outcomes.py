import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import cyclosis as cy
from cyclosis.analysis import outcomes

D, U, C, M, RING, T, X = range(7)
NAMES = list(outcomes.REGIONS)


def test_codes_are_those_of_the_table():
    assert [cy.REGIMES[k] for k in (D, U, C, M, RING, T, X)] == [
        "disordered",
        "unidirectional",
        "cyclosis",
        "multistripe",
        "circumferential",
        "travelling",
        "undecided",
    ]


def test_missing_members_are_not_counted():
    regime = np.array([[[C, C, -1], [U, -1, -1]], [[-1, -1, -1], [D, X, T]]], dtype=np.int8)
    counts = outcomes.tally(regime)
    assert counts.shape == (2, 2, 7)
    assert counts.sum(axis=-1).tolist() == [[2, 1], [0, 3]]
    assert counts[0, 0].tolist() == [0, 0, 2, 0, 0, 0, 0]
    assert counts[1, 1].tolist() == [1, 0, 0, 0, 0, 1, 1]
    np.testing.assert_array_equal(outcomes.share(counts), [[1.0, 0.0], [np.nan, 0.0]])
    np.testing.assert_array_equal(outcomes.share(counts, "travelling")[1], [np.nan, 1 / 3])


@pytest.mark.parametrize(
    ("members", "region"),
    [
        ([D, D, D], "D"),
        ([U, U, -1], "U"),
        ([C, C, C], "C"),
        ([C, U, C], "C/U"),
        ([C, U, M], "C/U"),
        ([C, C, M], "mixed"),
        ([D, C, C], "mixed"),
        ([D, U, -1], "mixed"),
        ([M, M, M], "M"),
        ([RING, -1, -1], "O"),
        ([T, T, T], "T"),
        ([X, X, X], "?"),
    ],
)
def test_regions(members, region):
    assert NAMES[outcomes.regions(outcomes.tally(np.array([members])))[0]] == region


def test_a_point_without_members_has_no_region():
    assert outcomes.regions(outcomes.tally(np.array([[-1, -1]]))).tolist() == [-1]


def test_time_to_order_is_that_of_ordered_members_with_a_time():
    regime = np.array([[C, U, C, D, -1, X], [D, D, D, -1, -1, -1]])
    times = np.array([[3.0, 5.0, np.nan, 1.0, 0.5, 10.0], [1.0, 2.0, np.nan, 3.0, 4.0, 5.0]])
    np.testing.assert_array_equal(outcomes.time_to_order(regime, times), [5.0, np.nan])
    np.testing.assert_array_equal(outcomes.time_to_order(regime, times, 0.25), [4.0, np.nan])


def test_a_clean_cut_is_found_in_the_middle_of_its_gap():
    found = outcomes.separation([8.0, 0.5, 1.0, 4.0], [True, False, False, True])
    assert found.threshold == pytest.approx(2.0)
    assert found.correct == 1
    assert found.guess == 0.5


def test_the_widest_of_equally_good_gaps_is_chosen():
    """Thresholds between 1 and 2, and between 3 and 30, both foretell five of six."""
    found = outcomes.separation([0.5, 1, 2, 3, 30, 40], [False, False, True, False, True, True])
    assert found.threshold == pytest.approx(np.sqrt(90))
    assert found.correct == 5 / 6


@pytest.mark.parametrize("values", [[1.0, 2.0, 3.0], [2.0, 2.0, 2.0]])
def test_where_no_threshold_helps_it_is_infinite(values):
    found = outcomes.separation(values, [True, True, False])
    assert found == (np.inf, 2 / 3, 2 / 3)


@settings(deadline=None, max_examples=60)
@given(
    st.lists(st.tuples(st.integers(1, 9), st.booleans()), min_size=1, max_size=14),
)
def test_no_other_threshold_does_better(members):
    x, y = (np.array(column) for column in zip(*members, strict=True))
    found = outcomes.separation(x.astype(float), y)
    tried = [np.mean((x > r) == y) for r in np.arange(0.5, 10)]
    assert found.correct == max(tried)
    if np.isfinite(found.threshold):
        assert np.mean((x > found.threshold) == y) == found.correct
