"""Adaptive axial resolution: fewer points give the same equation, and the same members."""

from functools import partial

import jax
import numpy as np
import pytest

import cyclosis as cy
from cyclosis.analysis.axial_points import axial_tails, fewer_points, usable
from cyclosis.ensemble import EnsembleSettings, Member, follow
from cyclosis.ensemble.axial_lanes import run_axial_lane
from cyclosis.ensemble.packing import Packing, packed
from cyclosis.model.precision import double
from cyclosis.model.spectral import on_axial_points

GRID = cy.CylinderGrid(32, 24, 5.0)
ADAPTIVE = partial(EnsembleSettings, rtol=1e-3, axial_resolution="adaptive")
FIXED = partial(EnsembleSettings, rtol=1e-3)


def member(seed=0, grid=GRID, **values):
    return Member(cy.Parameters(**values), grid, partial(cy.initial.disordered, grid, 1000, seed))


def long_waves(grid, most, seed=3):
    """A state with waves up to `most` along the cell and up to 3 around it, |P| < 1."""
    rng = np.random.default_rng(seed)
    theta, z = np.meshgrid(grid.theta, 2 * np.pi * grid.z / grid.length, indexing="ij")
    waves = [(m, j, *rng.normal(size=4)) for m in range(4) for j in range(-most, most + 1)]
    P = np.array(
        [
            sum(
                w[2 + c] * np.cos(w[0] * theta + w[1] * z) + w[4 + c] * np.sin(w[0] * theta + w[1] * z)
                for w in waves
            )
            for c in (0, 1)
        ]
    )
    return 0.9 * P / np.hypot(*P).max()


@pytest.mark.parametrize("dealias", ["none", "full"])
def test_on_fewer_points_the_right_hand_side_is_the_same(dealias):
    # P has waves up to 2, and its products, of six factors, up to 12 = 24/2: nothing is folded back.
    fine, coarse = cy.CylinderGrid(32, 48, 5.0), cy.CylinderGrid(32, 24, 5.0)
    params = cy.Parameters(alpha_p=0.7, alpha_u=0.9, epsilon=0.3, kappa=0.4)
    P = long_waves(fine, 2)
    rates = [
        cy.rate_of_change(params, grid, cy.interpolate(P, grid.shape), dealias=dealias)
        for grid in (fine, coarse)
    ]
    assert np.abs(rates[1] - cy.interpolate(rates[0], coarse.shape)).max() < 1e-13
    with double():
        spectrum = np.fft.fft2(P[0] + 1j * P[1])
        there = on_axial_points(spectrum, 24)
        back = np.fft.ifft2(on_axial_points(there, 48))
    assert np.abs(back - (P[0] + 1j * P[1])).max() < 1e-14


def test_the_tail_is_the_amplitude_beyond_two_thirds_of_the_waves():
    grid = cy.CylinderGrid(16, 48, 5.0)
    z = 2 * np.pi * grid.z / grid.length
    P = np.ones((16, 1)) * (0.8 * np.cos(2 * z) + 0.1 * np.sin(8 * z) + 0.01 * np.sin(11 * z))
    with double():
        tails = np.asarray(axial_tails(np.fft.fft2(1j * P), (48, 32, 24, 12)))
    whole = np.sqrt(0.8**2 + 0.1**2 + 0.01**2)
    # The waves beyond two thirds of the highest: above 15 of 23, 10 of 15, 7 of 11, 3 of 5.
    expected = np.array([0.0, 0.01, np.hypot(0.1, 0.01), np.hypot(0.1, 0.01)]) / whole
    assert np.abs(tails - expected).max() < 1e-14


def test_no_wave_that_grows_about_disorder_is_left_out():
    grid = cy.CylinderGrid(16, 96, 5.0)
    numbers = fewer_points(grid)
    counts = []
    for alpha_p in (0.02, 1.0, 5.0, 40.0):
        params = cy.Parameters(alpha_p=alpha_p, kappa=0.0)
        counts.append(usable(params, grid))
        for n in numbers[: usable(params, grid)]:
            wave = 1e-7 * np.cos(2 * np.pi * ((n - 1) // 2 + 1) * grid.z / grid.length) * np.ones((2, 16, 1))
            assert np.sum(wave * cy.rate_of_change(params, grid, wave)) < 0
    assert counts == [3, 3, 2, 0]
    assert usable(cy.Parameters(d_s=0.0), grid) == 0
    assert usable(cy.Parameters(alpha_u=np.full(grid.shape, 0.5)), grid) == 0


@pytest.fixture
def places(monkeypatch):
    """The place of the number of points in each batch of steps, from all points (0) to the fewest."""
    seen = []

    def noted(*given, place, **named):
        seen.append(place)
        return run_axial_lane(*given, place=place, **named)

    monkeypatch.setattr("cyclosis.ensemble.run.run_axial_lane", noted)
    return seen


@pytest.mark.slow
def test_points_are_given_up_and_taken_back_within_the_tolerance(places):
    # Noise decays, then stripes form with short waves along the cell, then these decay too.
    one = member(1, cy.CylinderGrid(32, 32, 5.0), alpha_p=1.0, alpha_u=0.5)
    times = {"t_end": 40.0, "finish": "t_end"}
    (exact,) = follow([one], EnsembleSettings(rtol=1e-6, **times))
    (fixed,) = follow([one], FIXED(**times))
    (adaptive,) = follow([one], ADAPTIVE(**times))
    moves = np.diff(places)
    assert moves.max() > 0  # fewer points
    assert moves.min() < 0  # and more again
    assert places[-1] > 0
    errors = [np.sqrt(np.mean((run.state - exact.state) ** 2)) for run in (fixed, adaptive)]
    assert errors[1] < 2 * errors[0] + 1e-3
    assert adaptive.t_final == 40.0
    assert adaptive.regime == exact.regime


@pytest.mark.slow
def test_outcomes_are_those_of_all_points_and_do_not_depend_on_company():
    # Broad zones, so that states are not pinned to the points around the cell.
    points = ((0.5, 0.4), (0.025, 0.9), (0.85, 0.13))
    members = [member(seed, alpha_p=p, alpha_u=u, d_s=0.05) for seed, (p, u) in enumerate(points)]
    together, fixed = follow(members, ADAPTIVE()), follow(members, FIXED())
    backward = follow(members[::-1], ADAPTIVE())[::-1]
    for a, b, c in zip(together, backward, fixed, strict=True):
        assert (a.regime, a.t_final, a.evaluations) == (b.regime, b.t_final, b.evaluations)
        assert np.array_equal(a.t_order, b.t_order, equal_nan=True)
        assert np.array_equal(a.state, b.state)
        assert (a.regime, a.status) == (c.regime, c.status)
        waves = [np.abs(np.fft.fft2(run.state, norm="forward")) for run in (a, c)]
        assert np.abs(waves[0] - waves[1]).max() < 1e-8


def test_what_cannot_be_adaptive_is_refused():
    with pytest.raises(cy.InputError, match=r"lanes = 4 .* must be 1"):
        ADAPTIVE(lanes=4)
    with pytest.raises(cy.InputError, match=r"axial_resolution = 'some'|axial_resolution = some"):
        EnsembleSettings(axial_resolution="some")
    drug = cy.Protocol.from_tables([{"at": 1.0, "action": "change", "alpha_u": 0.1}])
    treated = Member(cy.Parameters(), GRID, partial(cy.initial.disordered, GRID), drug)
    with pytest.raises(cy.InputError, match="fixed where there is a protocol"):
        follow([treated], ADAPTIVE(finish="t_end"))


def test_a_sweep_has_the_setting_and_is_the_same_sweep_without_it():
    def sweep(**run):
        return cy.Sweep.from_tables({"axes": {"alpha_p": {"values": [0.3, 1.0]}}, "run": run})

    assert sweep().digest == sweep(axial_resolution="fixed").digest
    adaptive = sweep(axial_resolution="adaptive")
    assert adaptive.digest != sweep().digest
    assert (adaptive.settings.axial_resolution, adaptive.settings.lanes) == ("adaptive", 1)
    steps = [{"at": 1.0, "action": "change", "alpha_u": 0.1}]
    tables = {
        "axes": {"alpha_p": {"values": [0.3]}},
        "run": {"axial_resolution": "adaptive"},
        "protocol": steps,
    }
    with pytest.raises(cy.InputError, match="fixed where there is a protocol"):
        cy.Sweep.from_tables(tables)
    closed = {
        "axes": {"alpha_p": {"values": [0.3]}},
        "run": {"axial_resolution": "adaptive"},
        "model": {"kind": "closed"},
    }
    with pytest.raises(cy.InputError, match="fixed with the model"):
        cy.Sweep.from_tables(closed)


def test_packing_changes_no_bit():
    rng = np.random.default_rng(0)
    tree = {
        "flag": np.array([True, False]),
        "whole": np.int64(2**53 - 1),
        "single": rng.normal(size=(2, 3)).astype(np.float32),
        "waves": rng.normal(size=5) + 1j * rng.normal(size=5),
        "number": np.float64(np.nan),
    }
    with double():
        found = Packing(jax.eval_shape(lambda: tree)).unpacked(np.asarray(packed(tree)))
    for name, leaf in tree.items():
        assert found[name].dtype == leaf.dtype
        assert np.array_equal(found[name], leaf, equal_nan=leaf.dtype.kind == "f")
