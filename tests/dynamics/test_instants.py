"""Times that mean the same are the same: in a run, whatever arithmetic they come from."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import cyclosis as cy
from cyclosis.dynamics.live import Live
from cyclosis.dynamics.settings import Settings
from cyclosis.dynamics.steps import Change
from cyclosis.figures.frames import indices_at
from cyclosis.model.instants import instant

GRID = cy.CylinderGrid(32, 24, 5.0)
PARAMS = cy.Parameters(d_s=0.1)
STATE = cy.initial.unidirectional(GRID, 0.8)
NEAR = 0.1 * 3
assert NEAR != 0.3

unhurried = settings(deadline=None, max_examples=40)
ROUTES = {
    "product": lambda k, n: k * 10.0**-n,
    "quotient": lambda k, n: k / 10**n,
    "sum": lambda k, n: float(np.cumsum(np.full(k, 10.0**-n))[-1]),
    "difference": lambda k, n: (k + 7) / 10**n - 7 / 10**n,
    "shares": lambda k, n: k * 3 / 10**n / 3,
    "arange": lambda k, n: float(np.arange(0, (k + 0.5) * 10.0**-n, 10.0**-n)[k]),
    "linspace": lambda k, n: float(np.linspace(0, (k + 1) / 10**n, k + 2)[k]),
}


@settings(deadline=None)
@given(st.integers(1, 20_000), st.integers(0, 4), st.sampled_from(sorted(ROUTES)))
def test_every_route_to_a_decimal_is_that_decimal(k, n, route):
    assert instant(ROUTES[route](k, n)) == float(f"{k}e-{n}")


@settings(deadline=None)
@given(st.floats(1e-9, 1e9), st.floats(1e-9, 1e9))
def test_instants_keep_order_and_stay(a, b):
    assert instant(instant(a)) == instant(a)
    assert (a <= b) <= (instant(a) <= instant(b))
    assert abs(instant(a) - a) <= 5.1e-12 * a
    assert instant(np.array([a, b])).tolist() == [instant(a), instant(b)]


def test_large_and_tiny_times_keep_apart():
    assert instant(1e6 + 0.1 * 3) == 1000000.3
    assert instant(1e6) != instant(1e6 + 1e-4)
    assert instant(1e-10) == 1e-10
    assert instant(0.0) == 0.0
    assert np.isinf(instant(np.inf))
    assert np.isnan(instant(np.nan))


def test_a_frame_at_the_time_of_a_step_is_after_it():
    """Each written another way: the frame shows the state after, and no step of an ulp is taken."""
    plain = cy.simulate(PARAMS, GRID, STATE, 0.6, 0.1, protocol=[cy.depolymerise(at=0.3, keep=0.5)])
    other = cy.simulate(PARAMS, GRID, STATE, 0.2 * 3, 0.1, protocol=[cy.depolymerise(at=NEAR, keep=0.5)])
    listed = cy.simulate(
        PARAMS, GRID, STATE, 0.6, save_at=[0.1, NEAR, 0.6], protocol=[cy.depolymerise(at=0.3, keep=0.5)]
    )
    assert plain.times[3] == 0.3
    assert np.array_equal(plain.frames[3], plain.interventions[0].after)
    assert np.array_equal(listed.frames[1], listed.interventions[0].after)
    same(plain, other)


def test_ramps_that_mean_the_same_end_together():
    ramp = cy.change(at=0.1, over=0.2, alpha_p=0.5, mu=0.1, d_s=0.06)
    assert ramp.until == 0.3
    steps = [ramp, cy.change(at=NEAR, alpha_p=0.2)]  # begins as the ramp ends, not before
    run = cy.simulate(PARAMS, GRID, STATE, 0.6, 0.3, protocol=steps)
    assert run.params_at(0.3).alpha_p == run.params_at(NEAR).alpha_p == 0.2
    assert run.params_at(NEAR - 1e-15).alpha_p == 0.2
    same(run, cy.simulate(PARAMS, GRID, STATE, 0.6, NEAR, protocol=steps))


def test_the_end_of_a_run_is_a_time_like_any_other():
    whole = cy.simulate(PARAMS, GRID, STATE, 0.6, 0.1)
    half = cy.simulate(PARAMS, GRID, STATE, NEAR, 0.1)
    assert half.t_final == 0.3
    assert half.times.tolist() == [0.0, 0.1, 0.2, 0.3]
    same(cy.resume(half, 0.1 * 6), whole)
    with pytest.raises(cy.InputError, match=r"later than the time reached, 0\.3"):
        cy.resume(half, NEAR)


def test_saved_times_from_arange_reach_the_end():
    times = np.arange(0, 0.7 + 1e-9, 0.1)
    assert times[-1] > 0.7
    run = cy.simulate(PARAMS, GRID, STATE, 0.7, save_at=times)
    assert run.times.tolist() == [0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7]
    same(run, cy.simulate(PARAMS, GRID, STATE, 0.7, 0.1))
    joined = np.union1d(times, [0.3])
    assert joined.size == 9
    assert Settings(t_end=0.7, save_at=joined).save_at == Settings(t_end=0.7, save_at=times).save_at


@pytest.mark.parametrize(
    ("save_at", "said"),
    [
        ([*range(40), 0.5], r"save_at = 0\.5 cannot be used: it must be later than the one before it, 39\.0"),
        ([*range(40), 39.0], r"save_at = 39\.0 .* the one before it, 39\.0"),
        ([*range(30), 200.25, 300.0], r"save_at = 200\.25 cannot be used: it must be at most t_end = 200;"),
    ],
)
def test_a_refused_list_names_the_time(save_at, said):
    with pytest.raises(cy.InputError, match=said):
        Settings(save_at=save_at)


@given(
    st.integers(1, 300), st.integers(1, 9), st.integers(1, 3), st.sampled_from([1.0, 1 + 2**-52, 1 - 2**-53])
)
def test_frames_fall_on_the_decimals_that_are_meant(count, digit, places, ulp):
    every = ulp * digit / 10**places
    times = Settings(t_end=count * every, save_every=every, record_every=every * 2).record_times()
    expected = [float(f"{digit * k}e-{places}") for k in range(count + 1)]
    assert times.tolist() == expected


@unhurried
@given(st.data(), st.integers(1, 4), st.integers(1, 6), st.integers(0, 12))
def test_every_way_to_write_a_run_is_the_same_run(data, every, frames, step):
    def written(tenths):
        route = data.draw(st.sampled_from(sorted(ROUTES)))
        return ROUTES[route](tenths, 1) if tenths else 0.0

    def run(way):
        protocol = [
            cy.change(at=way(step), over=way(3), alpha_p=0.6),
            cy.depolymerise(at=way(step), keep=0.5),
        ]
        return cy.simulate(
            PARAMS, GRID, STATE, way(every * frames), way(every), record_every=way(2), protocol=protocol
        )

    plain, other = run(lambda tenths: tenths / 10), run(written)
    same(plain, other)
    assert plain.params_at(1.3) == other.params_at(written(13))
    assert cy.resume(other, written(every * frames + 2)).t_final == (every * frames + 2) / 10


def test_a_live_cell_and_a_run_agree_on_all_times():
    live = Live(PARAMS, GRID, STATE, NEAR)
    live.do(cy.Protocol(cy.change(at=0.6, over=NEAR, alpha_p=0.4), cy.depolymerise(at=0.1 * 12, keep=0.5)))
    while live.t < 1.5:
        live.forward()
    assert live.at_frame
    run = cy.simulate(PARAMS, GRID, STATE, live.t, 0.3, protocol=live.protocol)
    assert run.t_final == live.t == 1.5
    assert np.array_equal(run.final_state, live.state)


def test_a_member_of_an_ensemble_ends_where_the_run_ends():
    steps = cy.Protocol(cy.depolymerise(at=0.1 + 0.2, keep=0.5))
    how = cy.ensemble.EnsembleSettings(t_end=NEAR, finish="t_end")
    member = cy.ensemble.Member(PARAMS, GRID, lambda: STATE, steps)
    [found] = cy.ensemble.follow([member], how)
    assert found.t_final == 0.3
    run = cy.simulate(PARAMS, GRID, STATE, 0.3, 0.3, protocol=steps)
    np.testing.assert_allclose(found.state, run.final_state, atol=1e-3)


def test_figures_find_the_frame_that_is_meant():
    data = cy.simulate(PARAMS, GRID, STATE, 0.3, 0.1).to_dataset()
    assert indices_at(data, [0.1, NEAR]) == [1, 3]
    old = data.assign_coords(time=[0.0, 0.1, 0.2, NEAR])
    assert indices_at(old, [0.0, 0.3]) == [0, 3]
    with pytest.raises(cy.InputError, match=r"from 0 to 0\.3;"):
        indices_at(data, [0.4])


def test_a_ramp_too_short_for_its_time_is_refused():
    with pytest.raises(cy.InputError, match="over"):
        cy.change(at=1e8, over=1e-6, alpha_p=0.1)
    assert isinstance(cy.change(at=1e3, over=1e-6, alpha_p=0.1), Change)


def test_a_run_stored_with_times_of_before_goes_on(monkeypatch, tmp_path):
    """What was saved an ulp beside the decimal is neither saved again nor left out."""
    import cyclosis.dynamics.settings as rules
    import cyclosis.dynamics.steps as steps

    with monkeypatch.context() as old:
        old.setattr(rules, "instant", lambda t: t)
        old.setattr(steps, "instant", lambda t: t)
        protocol = [cy.depolymerise(at=NEAR, keep=0.5)]
        half = cy.simulate(PARAMS, GRID, STATE, NEAR, save_at=[0.1, NEAR], protocol=protocol)
    assert half.t_final == NEAR
    path = cy.write(half, tmp_path / "old.nc")
    onward = cy.resume_file(path, 0.6)
    assert onward.times.tolist() == [0.1, NEAR]
    assert onward.t_final == 0.6
    assert len(onward.interventions) == 1
    with cy.open_dataset(path) as data:
        assert data.sizes["time"] == 2


def same(a, b):
    """Assert that two runs are bitwise the same, and took the same steps."""
    assert a.times.tolist() == b.times.tolist()
    assert a.record_times.tolist() == b.record_times.tolist()
    assert a.effort.accepted == b.effort.accepted
    assert np.array_equal(a.final_state, b.final_state)
    assert all(np.array_equal(x, y) for x, y in zip(a.frames, b.frames, strict=True))
    assert all(np.array_equal(a.records[name], b.records[name]) for name in a.records)
