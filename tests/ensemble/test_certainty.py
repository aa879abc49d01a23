"""What makes a regime certain, and what does not."""

import numpy as np
import pytest

import cyclosis as cy
from cyclosis.analysis.appearance import Look
from cyclosis.contract.members import CertainEnd
from cyclosis.ensemble.attractors import attractor, kind, standard_state
from cyclosis.ensemble.certainty import Certainty, _passed_saddle
from cyclosis.models import polar
from cyclosis.stability.profiles.reduced import reduced
from cyclosis.stability.profiles.steady import relax, rms, steady

GRID = cy.CylinderGrid(48, 48, 5.0)


def cyclosis(**values):
    params = cy.Parameters(**values)
    problem = reduced(params, GRID)
    x = GRID.theta
    y = relax(problem, np.concatenate([0 * x, 0.85 * np.tanh(3 * np.sin(x))]), 100.0).y
    return attractor(polar.problem(params, GRID), problem, steady(problem, y))


@pytest.mark.slow
def test_alignment_finds_the_shift():
    known = cyclosis(alpha_p=0.3)
    for distance in (0.0, 0.1, 2.0, -3.0):
        moved = known.problem.shifted(known.steady.y, distance)
        assert known.distance(moved) < 1e-6
        assert np.exp(1j * known.shift(moved)) == pytest.approx(np.exp(-1j * distance), abs=1e-6)


def test_what_is_captured_ends_there():
    known = cyclosis(alpha_p=0.3, alpha_u=0.1)
    rng = np.random.default_rng(1)
    captured = 0
    for size in (0.003, 0.01, 0.03, 0.1, 0.3):
        for _ in range(6):
            waves = sum(
                np.outer(rng.normal(size=2), np.cos(m * GRID.theta + rng.uniform(0, 6))).ravel()
                for m in range(5)
            )
            y = known.steady.y + size * waves / rms(waves)
            y = y * min(1.0, 0.999 / np.hypot(*y.reshape(2, -1)).max())
            if known.captures(known.problem.shifted(y, 0.7), 0.0):
                captured += 1
                assert known.distance(relax(known.problem, y, 400.0).y) < 1e-3
    assert 6 <= captured < 30


def test_stripes_of_unequal_widths_beyond_the_saddle_are_not_captured():
    """Near the threshold two stripes of unequal widths lose one; no such state may be taken for cyclosis."""
    known = cyclosis(alpha_p=0.1, alpha_u=0.012)
    assert known.stable
    x = GRID.theta
    fates = {}
    for width in (0.5, 0.52, 0.56, 0.6, 0.64, 0.7):
        y = np.concatenate([0 * x, 0.8 * np.tanh((width * np.pi - np.abs(x - np.pi)) / 0.7)])
        end = relax(known.problem, y, 3000.0).y
        fates[width] = known.distance(end) < 1e-2
        for time in (0.0, 10.0, 30.0, 100.0, 300.0):
            at = relax(known.problem, y, time).y if time else y
            assert not known.captures(at, 0.0) or fates[width]
    assert fates[0.5]
    assert not fates[0.7]


def test_a_remnant_too_large_for_a_slow_decay_is_refused():
    known = cyclosis(alpha_p=1.0, alpha_u=0.5)
    decay = -known.rates.growth
    assert known.captures(known.steady.y, 0.9 * np.sqrt(0.1 * decay))
    assert not known.captures(known.steady.y, 1.1 * np.sqrt(0.1 * decay))


def test_pinned_stripes_are_not_confirmed_by_the_finer_grid():
    params = cy.Parameters(alpha_u=0.0)
    problem = reduced(params, GRID)
    x = GRID.theta
    unequal = np.concatenate([0 * x, 0.98 * np.tanh((0.58 * np.pi - np.abs(x - np.pi)) / 0.25)])
    for shift in (0.0, np.pi / 48):
        state = steady(problem, relax(problem, problem.shifted(unequal, shift), 300.0).y)
        assert state is not None
        assert not attractor(polar.problem(params, GRID), problem, state).stable


def test_answers_do_not_depend_on_what_was_asked_before():
    from cyclosis.analysis.signs import Signs

    def signs(y):
        problem = reduced(cy.Parameters(alpha_p=0.3), GRID)
        P = problem.state(y, GRID)
        mean = problem.packed(y)
        along = np.zeros(48, dtype=complex)
        along[0] = mean[0]
        order = rms(y)
        uneven = rms(y - np.repeat(y.reshape(2, -1).mean(axis=1), 48))
        return Signs(
            np.hypot(*P).max(),
            order,
            0.0,
            uneven,
            uneven,
            0.0,
            0.0,
            0,
            0,
            mean,
            along,
        )

    x = GRID.theta
    problem = reduced(cy.Parameters(alpha_p=0.3), GRID)
    began = [np.concatenate([0 * x, 0.9 * np.tanh(3 * np.sin(x + s))]) for s in (0.0, 1.0, 2.5)]
    stripes = [relax(problem, y, 20.0).y for y in began]
    uniform = np.concatenate([0 * x, np.full(48, -0.9)])
    fresh = [Certainty(cy.Parameters(alpha_p=0.3), GRID).judge(signs(y), True) for y in (*stripes, uniform)]
    busy = Certainty(cy.Parameters(alpha_p=0.3), GRID)
    again = [busy.judge(signs(y), True) for y in (uniform, *stripes[::-1])][::-1]
    for a, b in zip(fresh, again, strict=True):
        assert isinstance(a, CertainEnd)
        assert a.regime == b.regime
        assert np.array_equal(a.state, b.state)
        assert a.eigenvalue == b.eigenvalue


def test_standard_states_are_of_their_kind():
    problem = reduced(cy.Parameters(), GRID)
    for stripes in (0, 2, 4):
        for component in (0, 1):
            for lean in (-1, 0, 1):
                for sign in (-1, 1):
                    y = standard_state(problem, kind(problem, _like(stripes, component, lean, sign)))
                    assert kind(problem, y) == kind(problem, _like(stripes, component, lean, sign))
                    assert np.hypot(*y.reshape(2, -1)).max() < 1


def _like(stripes, component, lean, sign):
    both = np.zeros((2, 48))
    both[component] = 0.8 * np.sin(stripes / 2 * GRID.theta + 0.1) if stripes else 0.8 * sign
    both[1 - component] = 0.3 * lean
    return both.ravel()


def test_a_near_passage_of_a_saddle_is_noticed():
    assert not _passed_saddle([1e-2, 1e-3, 1e-4, 1e-5], 1e-2)
    assert _passed_saddle([1e-3, 1e-6, 1e-3, 1e-4], 1e-2)
    assert not _passed_saddle([1e-3, 1e-4, 1e-3, 1e-4], 1e-2)


def test_looks():
    up = np.stack([np.zeros(GRID.shape), np.full(GRID.shape, 0.5)])
    stripes = cy.initial.stripes(GRID)
    around = up[::-1].copy()
    assert Look.of_state(up) == Look(True, 0, 0, False)
    assert Look.of_state(stripes) == Look(True, 2, 2, False)
    assert Look.of_state(around).circling
    assert Look.of_state(0.01 * up) == Look(False, 0, 0, False)
    looks = [
        (1.0, Look.of_state(stripes)),
        (2.0, Look.of_state(up)),
        (3.0, Look.of_state(stripes)),
        (4.0, Look.of_state(stripes)),
    ]
    assert Look.of_state(stripes).since(looks, 9.0) == 3.0
    assert Look.of_state(up).since(looks, 9.0) == 9.0
