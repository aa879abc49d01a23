"""Mixing by winding streams: verdicts on made-up rates, and rates that are known exactly."""

import numpy as np
import pytest
import xarray

from cyclosis.experiments.mixing import EXPERIMENT, bands, decisive, gains, rates, verdict
from cyclosis.model.parameters import Parameters
from cyclosis.stability import cyclosis

PITCHES, PECLETS = [np.inf, 5.0, 2.0], [1.0, 50.0, 5000.0]


def made(faster=(1.0, 1.2, 2.0), spread=1.0, last=0.002):
    """Return data in which a pitch of 5 multiplies uptake and dispersion, and exponents end at `last`."""
    straight = np.array([5.78, 5.78, 5.78])
    sherwood = np.stack([straight, straight * faster, 2 * straight])
    coefficient = np.full((3, 3), 0.1)
    coefficient[1] *= spread
    dims = ("pitch", "peclet")
    return xarray.Dataset(
        {
            "sherwood": (dims, sherwood),
            "mixing": (dims, 0.6 * sherwood),
            "dispersion": (dims, coefficient),
            "exponent": (("t", "seed"), np.outer([0.02, 0.01, last], [0.5, 1.0, 3.0])),
            "crossing": (("point", "axis"), np.random.default_rng(0).uniform(-0.7, 0.7, (40, 2))),
            "line": ("point", np.arange(40) % 4),
            "chara_peclet": ("substance", [50.0, 500.0, 5000.0]),
        },
        coords={"pitch": PITCHES, "peclet": PECLETS, "t": [100.0, 400.0, 800.0], "axis": ["x", "y"]},
    )


@pytest.mark.parametrize(
    ("data", "outcome"),
    [
        (made(), "agrees"),
        (made(faster=(1.0, 1.05, 2.0)), "in part"),  # small molecules gain nothing
        (made(spread=0.5), "in part"),  # dispersion along the cell is lost
        (made(faster=(1.0, 1.05, 1.09)), "does not"),
        (made(faster=(1.0, 0.9, 0.8), spread=0.5), "does not"),
    ],
)
def test_verdict_and_figure_follow_from_the_data(data, outcome):
    assert verdict(data).outcome == outcome
    assert len(EXPERIMENT.draw(data).axes) == 3


def test_the_sentence_has_the_numbers():
    words = verdict(made(faster=(1.0, 1.2, 2.0), spread=0.25)).measured
    assert "1.200 times as fast as with straight streams at Pe = 50" in words
    assert "2.00 times at Pe = 5000, by more than 10 % from Pe = 50 on" in words
    assert "to 25 % at Pe = 1" in words
    assert "at no Pe up to 5000" in verdict(made(faster=(1.0, 1.0, 1.0))).measured
    assert decisive(made()).startswith("1.200")


def test_only_a_falling_exponent_means_no_chaos():
    assert "does not mix chaotically" in verdict(made(last=0.007)).measured
    assert "chaotically" not in verdict(made(last=0.009)).measured


def test_gains_are_ratios_to_straight_streams():
    np.testing.assert_allclose(gains(made(spread=0.3), "dispersion"), 0.3)
    np.testing.assert_allclose(gains(made(), "sherwood"), [1.0, 1.2, 2.0])


def test_straight_streams_leave_uptake_and_mixing_to_diffusion():
    """The first zeros of J_0 and J_1', squared, and Taylor's series of the profile."""
    uptake, mixing, coefficient = rates(np.inf, 50.0)
    assert uptake == pytest.approx(5.783185963, rel=1e-7)
    assert mixing == pytest.approx(3.389957716, rel=1e-7)
    assert coefficient == pytest.approx(0.094872700924, rel=1e-7)


def test_bands_wind_once_in_a_pitch_at_the_speed_of_the_profile():
    flow = bands(5.0)
    turned = np.roll(flow.surface, (12, 12), axis=(1, 2))
    np.testing.assert_allclose(turned, flow.surface, atol=1e-12)
    speed = np.hypot(*flow.surface).max()
    assert speed == pytest.approx(cyclosis(Parameters()).u.max(), rel=5e-3)
