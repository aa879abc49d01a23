import numpy as np
import pytest
import xarray

import cyclosis as cy
from cyclosis.experiments import emergence as streamlets
from cyclosis.experiments.emergence import COURSES, MOST, TIMES, draw, moments, verdict

GRID = cy.CylinderGrid(32, 32, 5.0)


def striped(m=1, j=0):
    P = np.zeros((2, *GRID.shape))
    P[1] = np.sin(m * GRID.theta[:, None] + 2 * np.pi * j / GRID.length * GRID.z[None, :] + 0.1)
    return P


def test_domains_of_stripes_are_as_wide_as_stripes():
    assert streamlets.domain_size(GRID, striped()) == pytest.approx(np.pi, rel=1e-6)
    assert streamlets.domain_size(GRID, striped(3)) == pytest.approx(np.pi / 3, rel=1e-6)
    assert streamlets.domain_size(GRID, np.full((2, *GRID.shape), 0.5)) == np.inf
    assert streamlets.elongation(GRID, striped(1, 2)) == pytest.approx(5 / (4 * np.pi))
    assert streamlets.two_stripes(striped())
    assert not streamlets.two_stripes(striped(2))
    assert streamlets.global_order(striped()) == pytest.approx(np.sqrt(0.5))
    assert streamlets.global_order(striped(1, 1)) == pytest.approx(0, abs=1e-12)


def test_domains_of_noise_grow_as_linear_theory_says():
    params = cy.Parameters(d_s=0.1)
    fine = cy.CylinderGrid(64, 64, 2 * np.pi)
    decay = np.exp(-params.d_s * 1.0 * (fine.m[:, None] ** 2 + fine.q[None, :] ** 2))
    sizes = []
    for seed in range(20):
        P = cy.initial.disordered(fine, seed=seed)
        smooth = np.fft.ifft2(np.fft.fft2(P) * decay).real
        sizes.append(1 / streamlets.domain_size(fine, smooth))
    assert 1 / np.mean(sizes) == pytest.approx(streamlets.expected_size(params, 1.0), rel=0.05)


def test_stops_and_reversals_are_counted_where_they_can_be_seen():
    speed = np.array([0, 0.2, 0.04, 0.07, 0.2, 0.2, 0.01, 0.3, 0.0])[:, None, None]
    assert streamlets.stops(speed).item() == 2
    v = np.array([0.0, 0.2, -0.05, 0.2, -0.05, -0.2, -0.3, 0.05, 0.2])[:, None, None]
    assert streamlets.reversals(v).tolist() == [0, 0, 0, 0, 0, 1, 0, 0, 1]


def test_times_at_which_a_course_is_somewhere():
    assert streamlets.reached([0, 1, 2], [0, 1, 3], 2) == 1.5
    assert np.isnan(streamlets.reached([0, 1, 2], [0, 1, 1], 2))
    assert streamlets.since([0, 1, 2, 3], [True, False, True, True]) == 2
    assert streamlets.since([0, 1], [True, True]) == 0
    assert np.isnan(streamlets.since([0, 1], [True, False]))


def test_a_course_has_what_it_says(monkeypatch):
    monkeypatch.setattr(streamlets, "TIMES", (0.0, 10.0, 21.0))
    courses, turns, places = streamlets.course(0)
    assert courses.shape == (len(COURSES), 3)
    assert np.all(np.diff(courses[0]) > 0)
    assert turns.shape == (2,)
    assert places.sum() == pytest.approx(1)


def made_up(local=6.0, whole=9.0, twice=0.0, cells=200):
    time = np.array(TIMES)
    rng = np.random.default_rng(0)
    delay = rng.uniform(0, 1, (cells, 1))
    order, wave = (1 / (1 + np.exp(-(time - delay - start))) for start in (local, whole))
    values = {
        "order": order,
        "global_order": wave,
        "speed": wave,
        "domain_size": np.minimum(np.pi, 0.1 + 0.25 * (time - delay)),
        "elongation": 1 + 0 * wave,
        "stripes": wave > 0.9,
    }
    P = np.zeros((5, 2, *GRID.shape), dtype=np.float32)
    P[:] = striped()
    places = np.zeros((cells, MOST + 1))
    places[:, 0], places[:, 2] = 1 - twice, twice
    dims = ("frame", "component", "theta", "z")
    return xarray.Dataset(
        {
            "P": (dims, P),
            "u": (dims, P),
            "reversals": (("seed", "period"), np.stack([delay[:, 0], 0.1 * delay[:, 0]], axis=1)),
            "places": (("seed", "stops"), places),
            **{name: (("seed", "time"), value) for name, value in values.items()},
        },
        coords={"time": time, "frame_time": ("frame", [1.0, 5.0, 8.0, 20.0, 100.0])},
        attrs={"length": 5.0, "d_s": 0.025},
    )


def test_verdicts_follow_from_the_data():
    assert np.median(moments(made_up())["local"]) == pytest.approx(6.5, abs=0.1)
    found = verdict(made_up())
    assert found.outcome == "in part"
    assert "not saltatory" in found.measured
    found = verdict(made_up(twice=0.8))
    assert found.outcome == "agrees"
    assert "is saltatory" in found.measured
    assert verdict(made_up(local=9.0, whole=6.0)).outcome == "does not"
    never = made_up()
    never["stripes"] = never["stripes"] * 0
    assert verdict(never).outcome == "does not"


def test_the_figure_shows_the_cell_and_three_panels():
    figure = draw(made_up(cells=30))
    assert len(figure.axes) == 8
    assert sum(patch.get_height() for patch in figure.axes[2].patches) == pytest.approx(100)
