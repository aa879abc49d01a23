"""Cells of all lengths: zones of made-up states, and every verdict, on made-up data."""

import numpy as np
import pytest
import xarray

from cyclosis.experiments import cell_shape as subject
from cyclosis.experiments import cell_shape as zone_course
from cyclosis.model.grid import Array, CylinderGrid


def stripes(grid: CylinderGrid, shift: Array) -> Array:
    """Return two stripes whose pattern is shifted about the axis by an angle (n_z,) at each z."""
    P = np.zeros((2, *grid.shape))
    P[1] = 0.9 * np.sin(grid.theta[:, None] - shift[None, :])
    return P


def test_slope_of_a_sine_is_that_of_its_derivative() -> None:
    grid = CylinderGrid(24, 200, 8.0)
    bent = stripes(grid, 0.3 * np.sin(2 * np.pi * grid.z / 8.0))
    assert zone_course.slope(bent, 8.0) == pytest.approx(0.3 * 2 * np.pi / 8.0 / np.sqrt(2), rel=1e-3)
    assert zone_course.two_zones(bent) == 1.0
    assert zone_course.slope(stripes(grid, np.zeros(200)), 8.0) == pytest.approx(0.0, abs=1e-12)


def test_slope_of_a_helix_is_its_pitch() -> None:
    grid = CylinderGrid(24, 64, 8.0)
    assert zone_course.slope(stripes(grid, 4 * np.pi * grid.z / 8.0), 8.0) == pytest.approx(np.pi / 2)


def test_two_zones_are_told_from_four() -> None:
    grid = CylinderGrid(24, 16, 5.0)
    P = stripes(grid, np.zeros(16))
    P[1, :, :4] = np.sin(2 * grid.theta)[:, None] + 0.1
    assert zone_course.two_zones(P) == 0.75


@pytest.mark.parametrize(
    ("paired", "first"),
    [([0.0, 1.0, 0.5, 1.0, 1.0], 4.0), ([1.0] * 5, 1.0), ([1.0, 1.0, 1.0, 1.0, 0.9], np.nan)],
)
def test_first_time_for_good(paired: list[float], first: float) -> None:
    found = zone_course.first_for_good(paired, np.arange(1.0, 6.0))
    assert found == pytest.approx(first, nan_ok=True)


def test_decay_of_an_exponential_and_of_nothing() -> None:
    times = np.arange(2.0, 42.0, 2.0)
    assert zone_course.decay(np.exp(-0.1 * times), times) == pytest.approx(0.1)
    assert np.isnan(zone_course.decay(np.full(20, 1e-9), times))


def test_grids_are_as_fine_at_every_length() -> None:
    assert [zone_course.grid_of(length).n_z for length in (1.0, 5.0, 100.0)] == [10, 48, 960]


def test_theory_of_straightening_is_that_of_the_whole_cell() -> None:
    assert zone_course.straightening(5.0) == pytest.approx(0.0541, abs=1e-4)


@pytest.mark.slow
def test_short_cell_is_followed_and_pictured() -> None:
    course = zone_course.follow(1.0, 0, (1.0, 2.0))
    assert course.paired.shape == course.slope.shape == course.winding.shape == (2,)
    P, u = zone_course.picture(1.0, 0, (1.0, 2.0), (16, 8))
    assert P.shape == u.shape == (2, 2, 16, 8)


def made_up(two: float, bent: bool, wound: bool, seeds: int = 40) -> xarray.Dataset:
    """Return a dataset of three lengths: `two` of the shortest cells have two stripes, and all others."""
    lengths, times = np.array([1.0, 5.0, 20.0]), np.arange(2.5, 61.0, 2.5)
    since = np.tile([[8.0], [15.0], [30.0]], (1, seeds)) + np.arange(seeds) / seeds
    since[0, round(two * seeds) :] = np.nan
    winding = np.zeros((3, seeds))
    winding[2, : seeds // 4] = 1.0 if wound else 0.0
    slope = np.full((3, seeds, times.size), 0.001)
    slope[2] = 0.3 if bent else 0.001
    rate = np.full((3, seeds), np.nan)
    rate[1] = 0.055
    grid = CylinderGrid(12, 12, 5.0)
    P = stripes(grid, np.zeros(12))[None].repeat(4, axis=0)
    cell = ("length", "seed")
    return xarray.Dataset(
        {
            "since": (cell, since),
            "winding": (cell, winding),
            "half_way": (cell, winding),
            "rate": (cell, rate),
            "tail": (cell, np.full((3, seeds), 0.003)),
            "slope": ((*cell, "time"), slope),
            "theory_rate": ("length", [1.0, 0.054, 0.006]),
            "P": (("frame", "component", "theta", "z"), P),
            "u": (("frame", "component", "theta", "z"), 0.8 * P),
            "frame_length": ("frame", [2.0, 5.0, 20.0, 20.0]),
            "frame_winding": ("frame", [0.0, 0.0, 0.0, 1.0]),
            "strip": (("look", "strip_theta", "strip_z"), P[:3, 1]),
        },
        coords={
            "length": lengths,
            "time": times,
            "cells": ("length", [seeds] * 3),
            "look": [10.0, 30.0, 60.0],
        },
        attrs={"strip_length": 20.0, "end": 60.0},
    )


@pytest.mark.parametrize(
    ("data", "outcome", "words"),
    [
        (made_up(1.0, bent=False, wound=False), "agrees", "straight in 100.0 %"),
        (made_up(0.9, bent=True, wound=False), "in part", "(fewest at 1)"),
        (made_up(1.0, bent=True, wound=True), "in part", "barber pole"),
        (made_up(0.2, bent=False, wound=False), "does not", "20.0 %"),
    ],
)
def test_verdicts_follow_from_the_data_and_are_drawn(data: xarray.Dataset, outcome: str, words: str) -> None:
    found = subject.verdict(data)
    assert found.outcome == outcome
    assert words in found.measured
    assert len(subject.draw(data).axes) == 8
