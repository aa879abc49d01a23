import numpy as np
import pytest
import xarray

import cyclosis as cy
from cyclosis.experiments.recovery import draw, rising, verdict

GRID = cy.CylinderGrid(32, 16, 5.0)


@pytest.mark.parametrize("zone", [0.0, 1.0, 4.5])
def test_the_zone_is_where_the_profile_turns_upward(zone):
    wave = np.sin(GRID.theta - zone)
    assert np.exp(1j * rising(wave)) == pytest.approx(np.exp(1j * zone), abs=1e-12)
    # Sharp zones alias a little on so few points.
    assert np.exp(1j * rising(np.tanh(3 * wave))) == pytest.approx(np.exp(1j * zone), abs=1e-6)


def made_up(shift, width, recovered=None):
    count = len(shift)
    P = np.zeros((5, 2, *GRID.shape), dtype=np.float32)
    P[:, 1] = np.sin(GRID.theta)[:, None]
    dims = ("frame", "component", "theta", "z")
    return xarray.Dataset(
        {
            "P": (dims, P),
            "u": (dims, P),
            "recovered": ("seed", np.ones(count, dtype=bool) if recovered is None else recovered),
            "zone_shift": ("seed", shift),
            "width": ("seed", width),
        },
        coords={"frame_time": ("frame", [19.0, 40.0, 48.0, 65.0, 400.0])},
        attrs={"length": 5.0},
    )


def test_verdicts_follow_from_the_data():
    rng = np.random.default_rng(0)
    anywhere, equal = rng.uniform(0, 2 * np.pi, 200), 0.5 + 1e-4 * rng.normal(size=200)
    assert verdict(made_up(anywhere, equal)).outcome == "agrees"
    assert verdict(made_up(0.3 * anywhere, equal)).outcome == "does not"
    assert verdict(made_up(anywhere, equal + 0.02)).outcome == "does not"
    some = np.arange(200) < 150
    assert verdict(made_up(np.where(some, anywhere, np.nan), equal, some)).outcome == "in part"
    assert verdict(made_up(anywhere, equal, np.zeros(200, dtype=bool))).outcome == "does not"


def test_the_figure_shows_the_cell_and_the_zones():
    rng = np.random.default_rng(0)
    figure = draw(made_up(rng.uniform(0, 2 * np.pi, 50), np.full(50, 0.5)))
    assert len(figure.axes) == 7
    heights = [patch.get_height() for patch in figure.axes[0].patches]
    assert sum(heights) == 50
