import numpy as np
import pytest
import xarray

import cyclosis as cy
from cyclosis.experiments import shear_straightening as bends
from cyclosis.experiments.shear_straightening import LEVELS, TIMES, draw, gains, prepared_gains, verdict

GRID = cy.CylinderGrid(64, 32, 5.0)
EPSILONS = [0.0, 0.1, 0.4]


def waving(amplitude, turns=0):
    z = GRID.z / GRID.length
    P = np.zeros((2, *GRID.shape))
    P[1] = np.sin(GRID.theta[:, None] - 6.2 - amplitude * np.sin(2 * np.pi * z) - 2 * np.pi * turns * z)
    return P


@pytest.mark.parametrize("amplitude", [0.0, 0.3, 2.0])
def test_the_bend_of_a_sine_is_its_root_mean_square(amplitude):
    assert bends.bend(GRID, waving(amplitude)) == pytest.approx(amplitude / np.sqrt(2), abs=1e-3)
    lines = bends.zone_lines(GRID, waving(amplitude))
    assert np.mean(lines[1] - lines[0]) % (2 * np.pi) == pytest.approx(np.pi, abs=1e-3)


def test_helices_and_other_numbers_of_zones_have_no_bend():
    assert np.isnan(bends.bend(GRID, waving(0.2, turns=1)))
    assert np.isnan(bends.bend(GRID, np.full((2, *GRID.shape), 0.5)))


def test_prepared_zones_have_the_bend_asked_for():
    assert bends.bend(bends.GRID, bends.bent(bends.GRID, 0.4)) == pytest.approx(0.4, rel=0.01)
    assert np.hypot(*bends.bent(bends.GRID, 1.4)).max() < 1


def test_times_and_rates_of_a_decay():
    t = np.arange(0.0, 50.0, 2.0)
    assert bends.fallen(t, 0.3 * np.exp(-0.1 * t), 0.1) == pytest.approx(10 * np.log(10))
    assert bends.fallen(t, np.exp(-0.01 * t), 0.1) == np.inf
    assert bends.late_rate(t, np.exp(-0.1 * t), 20.0) == pytest.approx(0.1)


def test_prepared_zones_straighten(monkeypatch):
    monkeypatch.setattr(bends, "TIMES", (0.0, 10.0))
    monkeypatch.setattr(bends, "FOLLOWED", 10.0)
    first, last = bends.prepared(0.1, True)
    assert last < 0.5 * first


def made_up(gain, late_gain=0.0, small_gain=None, cells=200):
    """Zones that take `gain` longer without shear; the last of small prepared bends `late_gain` longer."""
    rng = np.random.default_rng(0)
    size = rng.uniform(0.1, 1.0, cells)
    more = np.where(size < 0.3, gain if small_gain is None else small_gain, gain)
    fallen = np.empty((cells, 3, 2, len(LEVELS)))
    fallen[:] = rng.uniform(20, 25, (cells, 1, 1, 1))
    fallen[:, 1:, 1] *= 1 + (more + 0.02 * rng.normal(size=cells))[:, None, None]
    t = np.array(TIMES)
    prepared = np.stack([[np.exp(-0.05 * t), np.exp(-0.05 * t / (1 + late_gain))]] * 2)
    P = np.zeros((5, 2, *GRID.shape), dtype=np.float32)
    P[:] = waving(0.3)
    dims = ("frame", "component", "theta", "z")
    return xarray.Dataset(
        {
            "P": (dims, P),
            "u": (dims, P),
            "prepared": (("size", "shear", "time"), prepared),
            "stood": ("seed", np.full(cells, 12.0)),
            "bend": ("seed", size),
            "fallen": (("seed", "epsilon", "shear", "level"), fallen),
            "slowest": ("epsilon", [0.07, 0.05, 0.0]),
        },
        coords={
            "size": [0.1, 1.0],
            "shear": ["with", "without"],
            "time": t,
            "epsilon": EPSILONS,
            "level": list(LEVELS),
            "frame_time": ("frame", [0.0, 15.0, 30.0, 15.0, 30.0]),
        },
        attrs={"length": 5.0},
    )


def test_verdicts_follow_from_the_data():
    data = made_up(0.1, 0.1)
    assert np.median(gains(data)[1]) == pytest.approx(0.1, abs=0.01)
    assert prepared_gains(data) == pytest.approx([0.1, 0.1])
    assert verdict(data).outcome == "agrees"
    assert verdict(made_up(0.1, -0.1)).outcome == "in part"
    assert verdict(made_up(0.1, 0.1, small_gain=-0.2)).outcome == "in part"
    assert verdict(made_up(-0.1, 0.1)).outcome == "does not"
    assert verdict(made_up(0.0, 0.1)).outcome == "does not"
    never = made_up(0.1)
    never["fallen"] = never["fallen"] + np.inf
    assert verdict(never).outcome == "does not"
    few = verdict(made_up(0.03, cells=4))
    assert few.outcome == "in part"
    assert "too few cells" in few.measured


def test_the_figure_shows_the_cell_and_three_panels():
    figure = draw(made_up(0.1, cells=30))
    assert len(figure.axes) == 8
    assert len(figure.axes[1].lines[0].get_xdata()) == 30
