import numpy as np
import pytest

import cyclosis as cy
from cyclosis.experiments import timescales
from cyclosis.experiments.lab import Lab
from cyclosis.experiments.timescales import (
    RANGES,
    READINGS,
    draw,
    estimate,
    heat_s,
    restriction,
    rotational_drag,
    sampled,
    times,
    verdict,
)


@pytest.fixture
def data(tmp_path):
    return timescales.measure(Lab(tmp_path, 400))


def test_the_papers_numbers():
    found = estimate()
    assert found.procession_s == pytest.approx(0.1)
    assert found.detachment_s == 1.0
    assert found.procession_s < found.vesicle_s < found.detachment_s
    assert found.best_margin() == pytest.approx(np.sqrt(10))
    for reading in READINGS:
        assert found.margin(reading) <= found.best_margin()


def test_physics_of_the_drags():
    # A rod of 10 µm in water: D_r = 3 kT (ln(L/d) - 0.66) / (π η L³), here by hand in SI units.
    diffusion = 3 * 1.380649e-23 * 293 * (np.log(10 / 0.008) - 0.66) / (np.pi * 1e-3 * 1e-15)
    assert heat_s(10.0, 1e-3) == pytest.approx(1 / (2 * diffusion))
    assert rotational_drag(10.0, 2e-3) == pytest.approx(2 * rotational_drag(10.0, 1e-3))
    assert restriction(10.0, 1.0, 10.0) == pytest.approx(10 * restriction(10.0, 1.0))
    assert restriction(10.0, 2.0) == pytest.approx(0.5 * restriction(10.0, 1.0))
    # Turning and walking both scale with the speed: their ratio is that of the drags alone.
    for speed in (10.0, 100.0):
        found = estimate(speed_um_per_s=speed)
        expected = 0.5 * (1 + restriction(10.0, 1.0, 10.0))
        assert found.vesicle_s / found.procession_s == pytest.approx(expected)


@pytest.mark.parametrize("bad", [{"dwell_s": 0.0}, {"filament_um": [1.0, -1.0]}, {"filament_um": 0.01}])
def test_impossible_values_are_refused(bad):
    with pytest.raises(cy.InputError):
        estimate(**bad)


def test_draws_lie_in_their_ranges():
    for name, (low, high) in RANGES.items():
        values = sampled(name, 1000)
        assert low <= values.min() < values.max() <= high
        assert np.median(values) == pytest.approx(np.sqrt(low * high), rel=0.2)
        assert np.array_equal(values[:10], sampled(name, 10))


def test_verdicts_follow_from_the_data(data):
    assert np.all(times(data).margin() <= times(data).best_margin() * (1 + 1e-6))

    def stretched(factor):
        changed = data.copy(deep=True)
        for prefix in ("", "paper_"):
            turning = changed[f"{prefix}procession_s"] * factor
            changed[f"{prefix}vesicle_s"] = turning
            changed[f"{prefix}detachment_s"] = turning * factor
        return changed

    assert verdict(data).outcome == "in part"
    assert verdict(stretched(20.0)).outcome == "agrees"
    assert verdict(stretched(5.0)).outcome == "in part"
    assert verdict(stretched(0.5)).outcome == "does not"
    assert "not in order" in verdict(stretched(0.5)).measured


def test_the_figure_has_three_panels(data):
    figure = draw(data)
    assert len(figure.axes) == 3
    assert len(figure.axes[0].patches) == 5
