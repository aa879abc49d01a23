"""Surviving bundles: the law of the phase, how it is fitted, and the verdict on made-up data."""

import numpy as np
import pytest
import scipy.stats
import xarray

from cyclosis.dynamics.protocol import Protocol
from cyclosis.experiments.surviving_seeds import ALL, EXPERIMENT, GRID, counted, expected, steps, verdict
from cyclosis.experiments.survivors import effect, shifts, within, wrapped
from cyclosis.model import initial


def test_the_phase_of_a_displaced_normal_vector():
    a = np.array([0.0, 0.5, 2.0, 5.0])
    assert within(0.5 * np.pi, a) == pytest.approx(scipy.stats.norm.cdf(a), abs=1e-5)
    assert within(np.pi / 6, 0.0) == pytest.approx(1 / 6)
    drawn = np.random.default_rng(0).normal(size=(2, 200_000))
    near = np.mean(np.abs(np.arctan2(drawn[1], 1.0 + drawn[0])) < np.pi / 6)
    assert within(np.pi / 6, 1.0) == pytest.approx(near, abs=0.004)


def test_the_fitted_factor_is_that_of_the_counts():
    a = np.linspace(0.2, 3.0, 8)
    total = np.full(8, 1000)
    best, low, high = effect(a, 1000 * scipy.stats.norm.cdf(0.8 * a), total)
    assert best == pytest.approx(0.8, abs=1e-3)
    assert 0.7 < low < best < high < 0.9
    assert effect(a, total, total)[2] == np.inf
    assert effect(a, 0.5 * total, total)[1] == 0.0


def test_shifts_are_nan_without_two_stripes():
    theta = np.arange(48) * 2 * np.pi / 48
    profile = np.stack([np.sin(theta - 5.0), np.sin(theta - 1.0)])[:, None]
    swept = xarray.Dataset(
        {"profile": (("seed", "component", "theta"), profile), "regime": ("seed", [2, 1])},
        coords={"component": ["z"]},
    )
    assert shifts(swept) == pytest.approx([5.0 - 2 * np.pi, np.nan], nan_ok=True)
    assert wrapped(1.5 * np.pi) == pytest.approx(-0.5 * np.pi)


@pytest.mark.parametrize("squares", [0.0, 0.3, 1.0, 12.0, 48.0])
def test_as_many_squares_survive_as_are_told(squares):
    found = [step for step in Protocol.from_tables(steps(squares)).steps if step.action == "fragment"]
    region = found[0].where
    spared = 0 if region is None else int((~region.mask(GRID)).sum())
    assert spared == np.ceil(squares)
    if spared:
        assert set(np.flatnonzero((~region.mask(GRID)).any(axis=1))) == {12}


def made_up(spread: float, first: float = 2 * np.pi, lost: int = 0) -> xarray.Dataset:
    """Return cells whose places scatter by `spread` radians with survivors, and over `first` without."""
    rng = np.random.default_rng(1)
    shift = spread * rng.normal(size=(4, 200))
    shift[0] = rng.uniform(-0.5 * first, 0.5 * first, 200)
    shift = wrapped(shift)
    shift[2, :lost] = np.nan
    dims = ("frame", "component", "theta", "z")
    P = np.stack([initial.stripes(GRID)] * 6).astype(np.float32)
    shares = [0.0, 1e-4, 1e-3, 5e-3]
    return xarray.Dataset(
        {
            "P": (dims, P),
            "u": (dims, P),
            "thinned_shift": (("thinned", "seed"), shift),
            "cable_shift": (("cable", "seed"), shift),
        },
        coords={"thinned": shares, "cable": shares, "frame_time": ("frame", [4.0, 5, 25, 37, 125, 125])},
        attrs={"length": 5.0},
    )


@pytest.mark.parametrize(
    ("spread", "first", "expected_outcome"),
    [(0.3, 2 * np.pi, "agrees"), (5.0, 2 * np.pi, "does not"), (0.3, 0.5, "does not")],
)
def test_verdict_and_figure_follow_from_the_data(spread, first, expected_outcome):
    data = made_up(spread, first)
    assert verdict(data).outcome == expected_outcome
    assert len(EXPERIMENT.draw(data).axes) == 9


def test_cells_without_stripes_have_not_come_back():
    data = made_up(0.01, lost=50)
    count, total = counted(data, "cable", 0.5 * np.pi)
    assert total == 200
    assert count[1:].tolist() == [200, 150, 200]
    assert "No two stripes" in verdict(data).measured
    assert expected(data, "cable")[3] == pytest.approx(2 * 5e-3 * np.sqrt(ALL))
