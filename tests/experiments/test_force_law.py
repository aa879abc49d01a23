"""The force law: where growth begins, and every verdict, on made-up data."""

import numpy as np
import pytest
import xarray

from cyclosis.experiments import force_law as subject
from cyclosis.experiments import force_law as unbundled
from cyclosis.model.grid import CylinderGrid


def made_up(linear_revives: bool = True, cubic_keeps: bool = True, seeds: int = 40) -> xarray.Dataset:
    """Return a dataset as `measure` makes it, in which stripes stream at 0.8 wherever there are any."""
    strength = np.array([0.04, 0.2, 0.25, 0.5])
    speed = np.zeros((2, 2, strength.size, seeds))  # start, law, alpha_u, seed
    speed[:, 0, 1:] = 0.8 if linear_revives else 0.0
    speed[1, 1, 2:] = 0.8 if cubic_keeps else 0.0
    weak = np.array(subject.WEAK)
    noise = 1e-5 * np.random.default_rng(0).normal(size=(2, weak.size, 5))
    growth = noise - 0.05
    growth[0] += weak[:, None] / 1.05
    grid = CylinderGrid(12, 12, 5.0)
    P = np.zeros((4, 2, 12, 12), dtype=np.float32)
    P[:, 1] = 0.9 * np.sin(grid.theta)[:, None]
    frame = ("frame", "component", "theta", "z")
    return xarray.Dataset(
        {
            "P": (frame, P),
            "u": (frame, 0.8 * P),
            "speed": (("start", "law", "alpha_u", "seed"), speed),
            "growth": (("law", "weak_alpha_u", "grown_seed"), growth),
            "curve_alpha_u": (("law", "point"), [[0.06, 0.3, 0.5], [0.23, 0.3, 0.5]]),
            "theory_speed": (("law", "point"), [[0.4, 0.9, 0.95], [0.5, 0.7, 0.9]]),
            "theory_onset": 0.0525,
            "theory_fold": 0.2267,
            "theory_slope": 1 / 1.05,
        },
        coords={
            "frame_time": ("frame", [59.0, 260.0, 260.0, 260.0]),
            "start": ["disorder", "stripes"],
            "law": ["linear", "cubic"],
            "alpha_u": strength,
            "weak_alpha_u": weak,
        },
        attrs={"length": 5.0},
    )


@pytest.mark.parametrize(
    ("data", "outcome", "words"),
    [
        (made_up(), "in part", "survive under it too, from an α_u between 0.2 and 0.25 on"),
        (made_up(cubic_keeps=False), "agrees", "stripes that are there die under it as well"),
        (made_up(linear_revives=False), "does not", "does not let"),
    ],
)
def test_verdicts_follow_from_the_data_and_are_drawn(data: xarray.Dataset, outcome: str, words: str) -> None:
    found = subject.verdict(data)
    assert found.outcome == outcome
    assert words in found.measured
    assert len(subject.draw(data).axes) == 7


def test_onset_is_where_growth_crosses_zero() -> None:
    strength = np.array([0.1, 0.2, 0.4])
    rates = 2.0 * (strength[:, None] - np.array([0.15, 0.3]))
    assert np.allclose(unbundled.onsets(strength, rates), [0.15, 0.3])


def test_interval_of_a_mean_by_hand() -> None:
    middle, low, high = unbundled.mean_interval([1.0, 2.0, 3.0])
    assert middle == 2.0
    assert high - middle == pytest.approx(4.302653 / np.sqrt(3))
    assert middle - low == pytest.approx(high - middle)


@pytest.mark.parametrize(("exponent", "theory"), [(0.0, 0.1 / 1.05 - 0.05), (2.0, -0.05)])
def test_growth_of_the_wave_is_that_of_theory(exponent: float, theory: float) -> None:
    assert unbundled.wave_growth(exponent, 0.1, seed=3) == pytest.approx(theory, abs=2e-4)


def test_stripes_without_bundling_stream_above_the_fold_alone() -> None:
    assert np.isnan(unbundled.stripe_speed(2.0, 0.2))
    assert unbundled.stripe_speed(2.0, 0.5) == pytest.approx(0.8945, abs=1e-4)
    assert unbundled.stripe_speed(0.0, 0.06) == pytest.approx(0.38765, abs=1e-4)
