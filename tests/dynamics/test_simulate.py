import jax.numpy as jnp
import numpy as np
import pytest
from scipy.integrate import solve_ivp

import cyclosis as cy
from cyclosis.dynamics.frames import Frames
from cyclosis.dynamics.settings import Settings

GRID = cy.CylinderGrid(32, 24, 5.0)
PARAMS = cy.Parameters()
START = cy.initial.disordered(GRID, 100)


def run(params=PARAMS, state=START, grid=GRID, **settings):
    return cy.simulate(params, grid, state, **{"t_end": 4.0, "save_every": 1.0} | settings)


@pytest.mark.parametrize("stepper", ["adaptive", "etdrk4", "rk4"])
def test_frames_land_exactly_on_their_times(stepper):
    result = run(t_end=2.0, save_every=0.3, stepper=stepper)
    assert result.times == pytest.approx([0, 0.3, 0.6, 0.9, 1.2, 1.5, 1.8, 2.0], abs=0)
    assert result.t_final == 2.0
    assert len(result.frames) == 8
    assert np.array_equal(result.frames[-1], result.final_state)


def test_chosen_times_and_dense_records():
    result = run(save_at=[0.5, 2.25], save_every=9, record_every=1.0)
    assert result.times.tolist() == [0.5, 2.25]
    assert result.record_times.tolist() == [0, 0.5, 1, 2, 2.25, 3, 4]
    assert result.t_final == 4.0
    order = np.sqrt(np.mean(np.sum(result.frames[1] ** 2, axis=0)))
    assert result.records["order"][4] == pytest.approx(order, rel=1e-12)


def test_the_first_frame_is_the_initial_state_without_nyquist_modes():
    expected = np.fft.fft2(START)
    expected[:, 16], expected[:, :, 12] = 0, 0
    assert run(t_end=0.0).frames[0] == pytest.approx(np.fft.ifft2(expected).real, abs=1e-16)


def test_the_same_run_twice_is_bitwise_the_same_and_steppers_agree():
    a, b = run(), run()
    assert np.array_equal(a.final_state, b.final_state)
    assert a.effort.evaluations == b.effort.evaluations
    tight = run(rtol=1e-9).final_state
    for settings in ({"stepper": "etdrk4", "dt": 0.02}, {"stepper": "rk4", "dt": 0.02}):
        assert run(**settings).final_state == pytest.approx(tight, abs=3e-8)
    assert a.final_state == pytest.approx(tight, abs=1e-3)


def test_single_precision_follows_double():
    single = run(precision="float32", rtol=1e-5)
    assert single.frames.dtype == np.float32
    assert single.final_state == pytest.approx(run(rtol=1e-5).final_state, abs=2e-4)
    with pytest.raises(cy.InputError, match="float32"):
        run(precision="float32", rtol=1e-9)


def test_changing_a_number_never_recompiles():
    from cyclosis.dynamics.advance import advance

    run()
    before = advance._cache_size()
    run(params=PARAMS.replace(alpha_p=0.7, kappa=0.2, epsilon=0.3, repulsion_angle=0.4, zero_theta_flux=True))
    run(t_end=3.3, save_every=0.7, rtol=1e-5)
    run(grid=cy.CylinderGrid(32, 24, 7.0))
    assert advance._cache_size() == before


def test_a_steady_run_stops_and_says_when():
    params = PARAMS.replace(alpha_u=0.2)
    start = cy.initial.unidirectional(GRID, 0.9)
    result = run(params, start, t_end=500.0, save_every=500.0, steady_rate=1e-6)
    assert result.status == "steady"
    assert result.ok
    assert result.t_final < 50
    assert result.final_state[1] == pytest.approx(np.sqrt(1 - 0.025), abs=1e-5)
    assert result.times[-1] == result.t_final


def test_a_diverging_run_keeps_its_last_good_state():
    result = run(stepper="rk4", dt=0.5, t_end=50.0)
    assert result.status == "diverged"
    assert not result.ok
    assert result.t_final < 50
    assert np.all(np.isfinite(result.final_state))
    assert np.hypot(*result.final_state).max() <= 1.011
    assert "smaller dt" in result.message


def test_no_step_is_small_enough_for_a_singular_term():
    def blow_up(t, P, u, params, grid):
        return 50 * P

    result = run(terms=[blow_up], t_end=50.0)
    assert result.status == "diverged"
    assert result.effort.rejected > 0
    assert np.hypot(*result.final_state).max() <= 1.011


def test_a_step_across_a_sudden_change_is_tried_again():
    """What switches within a hundredth of a step: the long step across it errs, and must not stand."""

    def switched(t, P, u, params, grid):
        return -0.4 * (1 + jnp.tanh((t - 20.3) / 0.01)) * jnp.stack([0 * P[0], 1 + 0 * P[1]])

    params = cy.Parameters(alpha_u=0.0, kappa=0.0)
    found = cy.simulate(
        params, GRID, cy.initial.unidirectional(GRID, 0.9), 21.0, 21.0, terms=[*cy.TERMS, switched], rtol=1e-7
    )
    true = solve_ivp(
        lambda t, y: (1 - y**2) * y - 0.025 * y - 0.4 * (1 + np.tanh((t - 20.3) / 0.01)),
        (0, 21), [0.9], rtol=1e-12, atol=1e-14, max_step=0.01,
    ).y[0, -1]  # fmt: skip
    assert found.effort.rejected > 0
    assert found.final_state[1] == pytest.approx(true, abs=1e-6)


def test_a_coarse_grid_is_called_underresolved_and_a_fine_one_is_not():
    coarse, fine = cy.CylinderGrid(32, 32, 5.0), cy.CylinderGrid(48, 48, 5.0)
    for grid, status in ((coarse, "underresolved"), (fine, "completed")):
        start = cy.initial.disordered(grid, 100, noise_grid=(16, 16))
        result = cy.simulate(PARAMS, grid, start, t_end=30.0, save_every=10.0)
        assert result.status == status, result.message
    assert coarse != fine


def test_an_interrupted_run_keeps_what_it_has():
    def stop(snapshot):
        if snapshot.t >= 2:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt) as stopped:
        run(t_end=100.0, progress=stop)
    result = stopped.value.run
    assert result.status == "interrupted"
    assert 2 <= result.t_final < 100
    assert result.times[-1] <= result.t_final
    straight = run(t_end=2.0)
    assert np.array_equal(result.frames[2], straight.frames[2])


def test_progress_sees_time_and_state():
    seen = []
    run(progress=seen.append)
    assert seen[-1].t == 4.0
    assert seen[-1].t_end == 4.0
    assert seen[-1].state.shape == (2, 32, 24)


def test_a_user_term_joins_by_name_and_selection_is_checked():
    def pull(t, P, u, params, grid):
        return -0.1 * params.alpha_p * P

    result = run(terms=[*cy.TERMS, pull], t_end=1.0)
    assert [term.name for term in result.terms][-1] == "pull"
    assert result.records["budget"].shape == (2, 8)
    alone = run(terms=[pull], t_end=1.0, rtol=1e-10)
    start = alone.frames[0]
    assert alone.final_state == pytest.approx(start * np.exp(-0.1), rel=1e-8)
    for bad in ("bundling", ["bundling", "bundling"], ["nonsense"], [3], 5):
        with pytest.raises(cy.InputError, match="terms"):
            run(terms=bad)


@pytest.mark.parametrize(
    ("settings", "field"),
    [
        ({"t_end": -1}, "t_end"),
        ({"t_end": "x"}, "t_end"),
        ({"save_every": 0}, "save_every"),
        ({"save_every": 1e-6, "t_end": 1e5}, "save_every"),
        ({"stepper": "euler"}, "stepper"),
        ({"rtol": 0}, "rtol"),
        ({"dealias": "two"}, "dealias"),
        ({"precision": "half"}, "precision"),
        ({"save_at": [3, 1]}, "save_at"),
        ({"save_at": [9.0]}, "save_at"),
        ({"nonsense": 1}, "setting"),
        ({"steady_rate": -1}, "steady_rate"),
        ({"state": np.full((2, 32, 24), 0.9)}, "max"),
        ({"params": cy.Parameters(kappa=np.ones((8, 8)))}, "parameter fields"),
    ],
)
def test_bad_input_is_refused_at_the_door(settings, field):
    with pytest.raises(cy.InputError, match=field):
        run(**settings)


def test_frames_spill_to_disk_and_read_back():
    frames = Frames((2, 4, 4), np.float64, limit=600)
    stored = [np.full((2, 4, 4), float(i)) for i in range(7)]
    for frame in stored:
        frames.append(frame)
    assert frames._file is not None
    assert all(np.array_equal(a, b) for a, b in zip(frames, stored, strict=True))
    assert np.array_equal(frames[-1], stored[-1])
    frames.append(stored[0])
    assert np.array_equal(frames[7], stored[0])
    with pytest.raises(IndexError):
        frames[8]
    assert [frame[0, 0, 0] for frame in frames[-2:]] == [6.0, 0.0]
    assert frames[1:1] == []


def test_save_times_end_at_the_end():
    assert Settings(t_end=1.0, save_every=0.3).save_times() == pytest.approx([0, 0.3, 0.6, 0.9, 1.0])
    assert Settings(t_end=0.3, save_every=0.1).save_times() == pytest.approx([0, 0.1, 0.2, 0.3])
    assert Settings(t_end=0.0).save_times().tolist() == [0.0]


def test_a_run_that_stops_where_it_has_just_saved_saves_nothing_twice():
    singular = run(cy.Parameters(d_s=0.5), stepper="rk4", dt=1.0, t_end=5.0)
    assert singular.status is cy.Status.DIVERGED
    steady = run(
        state=cy.initial.unidirectional(GRID, 0.5),
        t_end=25.0,
        steady_rate=1.0,
        protocol=[cy.change(at=1.0, epsilon=0.2)],
    )
    assert steady.status is cy.Status.STEADY
    for found in (singular, steady):
        assert np.all(np.diff(found.times) > 0)
        assert np.all(np.diff(found.record_times) > 0)
        assert len(found.frames) == found.times.size


def test_the_usual_step_of_rk4_is_stable_under_strong_repulsion():
    params = cy.Parameters(kappa=60.0)
    found = run(params, START, stepper="rk4", t_end=0.5, save_every=0.5)
    exact = run(params, START, t_end=0.5, save_every=0.5, rtol=1e-8)
    assert found.ok
    np.testing.assert_allclose(found.final_state, exact.final_state, atol=5e-3)


@pytest.mark.parametrize("terms", [[], ["advection", "its double"]])
def test_terms_that_would_be_mistaken_for_others_are_refused(terms):
    def shear(t, P, u, params, grid):
        return 0.0 * P

    with pytest.raises(cy.InputError, match="terms"):
        cy.diagnose(PARAMS, GRID, START, terms=[shear if name == "its double" else name for name in terms])
