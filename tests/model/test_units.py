"""Units in which dimensionless results are shown."""

import pytest

import cyclosis as cy
from cyclosis.model import units

CHARA = cy.Scales(radius_um=500.0, speed_um_per_s=75.0)


@pytest.mark.parametrize(
    ("time", "text"), [(9.0, "60 s"), (18.0, "2 min"), (1080.0, "2 h"), (25920.0, "2 d"), (1e6, "77.16 d")]
)
def test_times_are_told_in_the_unit_that_suits_them(time, text):
    """R/U is 20/3 s."""
    assert units.time_unit(CHARA, time)(time) == text


def test_without_scales_nothing_is_converted():
    for unit in (units.time_unit(None, 5.0), units.length_unit(None), units.speed_unit(None)):
        assert (unit.factor, unit.name, unit.brackets) == (1.0, "", "")
    assert units.length_text(5.0, None) == "5"


def test_lengths_and_speeds():
    assert units.length_text(5.0, CHARA) == "2.5\nmm"
    assert units.length_text(1.5, CHARA) == "750\nµm"
    assert units.speed_unit(CHARA)(0.5) == "37.5 µm/s"


@pytest.mark.parametrize(
    ("about", "length", "name"), [(1.0, 1.0, "500 µm"), (0.7, 0.4, "200 µm"), (2.5, 2.0, "1 mm")]
)
def test_bars_are_of_the_longest_round_length_that_fits(about, length, name):
    found, text = units.round_length(CHARA, about)
    assert (found, text) == (pytest.approx(length), name)


def test_a_table_of_scales_comes_back():
    assert units.of_table(units.table_of(CHARA)) == CHARA
    assert units.of_table({}) is None
    with pytest.raises(cy.InputError, match="given together with radius_um"):
        units.of_table({"speed_um_s": None, "radius_um": 5.0})
