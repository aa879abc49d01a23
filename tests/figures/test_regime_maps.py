"""Maps of every regime and of the time to order."""

import re

import numpy as np
import pytest

import cyclosis as cy
from cyclosis.figures import plane, regime_maps, swept
from figures.sweeps import CODE, colours, sweep, texts


@pytest.fixture(scope="module")
def figure5():
    return sweep()


def test_every_regime_and_the_time(figure5):
    figure = regime_maps.regimes_and_time(figure5)
    found = swept.swept(figure5)
    titles = [ax.get_title("left") for ax in figure.axes]
    names = [title.split(",")[0] for title in titles if "," in title]
    assert names == ["disordered", "unidirectional", "cyclosis", "multistripe"]
    assert "disordered, 1\N{THIN SPACE}000" in titles
    maps = [
        ax for ax in figure.axes if ax.get_title("left").split(",")[0] in [*names, "median time to order"]
    ]
    for ax, name in zip(maps, names, strict=False):
        shares = 100 * np.mean(figure5["regime"].values == CODE[name], axis=-1).T
        drawn = colours(ax, 1)
        np.testing.assert_array_equal(drawn.mask, shares == 0)
        np.testing.assert_allclose(drawn.filled(0.0), shares)
    times = colours(maps[-1], 1)
    assert times.mask[:, 0].all()
    expected = np.nanmedian(figure5["t_order"].values[1:], axis=-1).T
    np.testing.assert_allclose(times[:, 1:], expected)
    assert [int(count) for count in found.counts.sum(axis=(0, 1))][:4] == [
        int(re.sub(r"\D", "", title.split(",")[1])) for title in titles if "," in title
    ]


def test_regimes_along_one_axis_are_stacked_to_100_percent(figure5):
    figure = regime_maps.regimes_and_time(figure5, select={"alpha_u": 0.0763})
    upper, lower = figure.axes
    tops = np.array([patch.get_y() + patch.get_height() for patch in upper.patches]).reshape(-1, 20)
    np.testing.assert_allclose(tops[-1], 100)
    assert {text.split(",")[0] for text in texts(figure)} >= {"disordered", "unidirectional", "cyclosis"}
    assert np.isnan(lower.lines[0].get_ydata()[0])


def test_times_are_needed(figure5):
    with pytest.raises(cy.InputError, match="t_order"):
        regime_maps.regimes_and_time(figure5.drop_vars("t_order"))


def test_limits_and_colours_of_times():
    assert plane.rounded(np.array([3.0, np.nan]), np.array([70.0])) == (2.0, 100.0)
    assert plane.rounded(np.array([6.0]), np.array([6.1])) == (5.0, 20.0)
    assert plane.rounded(np.array([np.nan]), np.array([np.nan])) == (1.0, 10.0)
    norm = regime_maps.time_norm(np.array([[3.0, np.nan], [30.0, 5.0]]))
    assert (norm.vmin, norm.vmax) == (3.0, 30.0)
    assert regime_maps.time_norm(np.array([7.0])).vmax > 7.0
