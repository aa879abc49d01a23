"""What is done to a running cell happens when and where it should, and nowhere else."""

import itertools
import json

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import cyclosis as cy
from cyclosis.dynamics.advance import advance
from cyclosis.dynamics.protocol import MOST_STEPS
from cyclosis.dynamics.schedule import Schedule
from cyclosis.model.actions import act
from cyclosis.model.region_tables import from_table

GRID = cy.CylinderGrid(32, 24, 5.0)
DIFFUSE = cy.Parameters(d_s=0.1)
STATE = cy.initial.disordered(GRID, 100)
DISC = cy.regions.disc(theta=3.1, z=2.5, radius=1.0)
UNIFORM = cy.initial.unidirectional(GRID, 0.3)
LOCAL = cy.Parameters(alpha_u=0.0, kappa=0.0)


def uniform(alpha, times, start=0.3, d_r=0.025):
    """Return P_z of a uniform state at the last of `times`, between which alpha_p(t) is smooth."""
    y = start
    for a, b in itertools.pairwise(times):
        found = solve_ivp(
            lambda t, y: (1 - y**2) * alpha(t) * y - d_r * y, (a, b), [y], rtol=1e-13, atol=1e-15
        )
        y = found.y[0, -1]
    return y


def final(protocol, t_end=6.0, state=UNIFORM, params=LOCAL, **settings):
    return cy.simulate(params, GRID, state, t_end, t_end, protocol=protocol, **settings)


def test_switching_bundling_off_leaves_rotational_diffusion_alone():
    """With alpha_p = alpha_u = 0 uniform order decays as exp(-d_r t), from the very moment of the switch."""
    run = cy.simulate(
        LOCAL, GRID, UNIFORM, 8.0, 1.0, protocol=cy.Protocol(cy.change(at=3.0, alpha_p=0.0)), rtol=1e-9
    )
    at3 = run.frames[3][1, 0, 0]
    assert at3 == pytest.approx(uniform(lambda t: 1.0, (0, 3)), abs=1e-9)
    for t in range(3, 9):
        assert run.frames[t][1] == pytest.approx(at3 * np.exp(-0.025 * (t - 3)), abs=1e-12)


@pytest.mark.parametrize("stepper", ["etdrk4", "rk4"])
def test_a_ramp_is_followed_to_the_order_of_the_method(stepper):
    """alpha_p from 1 to 0.2 between t = 1 and 4 in a uniform state against an independent solution.

    mu and d_s have no effect there.
    """
    protocol = cy.Protocol(cy.change(at=1.0, over=3.0, **USUAL))
    true = uniform(lambda t: np.interp(t, [1, 4], [1.0, 0.2]), (0, 1, 4, 6))
    errors = [abs(final(protocol, stepper=stepper, dt=1 / n).final_state[1, 0, 0] - true) for n in (4, 8, 16)]
    orders = np.log2(np.divide(errors[:-1], errors[1:]))
    assert errors[0] < 3e-6
    assert np.all((orders > 3.8) & (orders < 4.4)), orders


def test_the_adaptive_stepper_keeps_its_tolerance_on_a_ramp():
    protocol = cy.Protocol(cy.change(at=1.0, over=3.0, **USUAL))
    true = uniform(lambda t: np.interp(t, [1, 4], [1.0, 0.2]), (0, 1, 4, 6))
    assert abs(final(protocol, rtol=1e-8).final_state[1, 0, 0] - true) < 1e-9


USUAL = {"alpha_p": 0.2, "mu": 0.1, "d_s": 0.05}
"""What ramps in most tests, in other files too: programs are compiled for the parameters that ramp."""
RAMPS = {
    "usual": {"alpha_p": 0.2, "mu": 1.0, "d_s": 0.1},
    "others": {
        **{"d_r": 1.0, "alpha_u": 2.0, "epsilon": 1.0},
        **{"kappa": 2.0, "repulsion_angle": 1.0, "force_exponent": 1.0},
    },
}


@pytest.mark.parametrize("values", RAMPS.values(), ids=RAMPS)
def test_every_parameter_can_ramp_with_two_independent_steppers_alike(values):
    """Order 4 in a structured state, and the method that treats diffusion exactly agrees with the one that
    does not."""
    theta, z = GRID.theta[:, None], GRID.z[None]
    state = np.stack([0.3 * np.cos(theta) * np.sin(0.4 * np.pi * z), 0.5 * np.sin(theta + 0.3) + 0.0 * z])
    protocol = cy.Protocol(cy.change(at=0.5, over=1.0, **values), cy.wash_out(at=1.5, over=0.5))
    fine = final(protocol, 2.5, state=state, params=cy.Parameters(), stepper="rk4", dt=1 / 256).final_state
    errors = [
        np.abs(
            final(protocol, 2.5, state=state, params=cy.Parameters(), stepper="etdrk4", dt=1 / n).final_state
            - fine
        ).max()
        for n in (32, 64)
    ]
    assert errors[0] < 1e-6
    assert errors[0] / errors[1] > 11, errors


def test_washing_out_leads_back_to_the_attractor():
    """A cell whose motors were poisoned returns to the same steady stripes, to rounding of the tolerance."""
    params = cy.Parameters(d_s=0.1, alpha_u=1.0)
    state = cy.initial.stripes(GRID)
    protocol = cy.Protocol(cy.change(at=100.0, alpha_u=0.0), cy.wash_out(at=104.0))
    run = cy.simulate(params, GRID, state, 300.0, 50.0, protocol=protocol, rtol=1e-8)
    speeds = run.records["rms_speed"]
    assert run.params_at(102.0).alpha_u == 0.0
    assert run.params_at(104.0) == params
    assert np.abs(run.frames[-1] - run.frames[2]).max() < 1e-6
    assert speeds[-1] == pytest.approx(speeds[2], rel=1e-6)


def actions(where):
    return {
        "fragment": cy.fragment(at=4.0, where=where),
        "depolymerise": cy.depolymerise(at=4.0, keep=0.25, where=where),
        "noise": cy.noise(at=4.0, size=0.3, where=where),
    }


@pytest.mark.parametrize("precision", ["float64", "float32"])
@pytest.mark.parametrize("name", actions(None))
@pytest.mark.parametrize("where", [DISC, ~cy.regions.strips(4)], ids=["patch", "all but strips"])
def test_outside_a_patch_every_bit_is_as_before(name, where, precision):
    run = cy.simulate(DIFFUSE, GRID, STATE, 8.0, 2.0, protocol=[actions(where)[name]], precision=precision)
    (done,) = run.interventions
    mask = where.mask(GRID)
    assert done.time == 4.0
    assert np.array_equal(done.before[:, ~mask], done.after[:, ~mask])
    assert np.array_equal(np.hypot(*done.before)[~mask], np.hypot(*done.after)[~mask])
    assert not np.any(done.before[:, mask] == done.after[:, mask])
    assert np.array_equal(run.frames[2], done.after.astype(precision)), "a frame at that time is just after"
    undisturbed = cy.simulate(DIFFUSE, GRID, STATE, 4.0, 2.0, precision=precision)
    assert np.array_equal(undisturbed.final_state, done.before), "and before it nothing was different"


def test_what_is_done_to_the_state_is_what_is_said():
    def after(step, seed=0):
        run = cy.simulate(DIFFUSE, GRID, STATE, 4.0, 4.0, protocol=cy.Protocol(step, seed=seed))
        return run.interventions[0]

    done = after(cy.depolymerise(at=4.0, keep=0.25))
    assert np.array_equal(done.after, 0.25 * done.before)
    done = after(cy.fragment(at=4.0, filaments_per_square=50))
    assert np.std(done.after) == pytest.approx(0.1, rel=0.1)
    done = after(cy.noise(at=4.0, size=0.05))
    assert np.std(done.after - done.before) == pytest.approx(0.05, rel=0.1)
    done = after(cy.noise(at=4.0, size=5.0))
    assert np.hypot(*done.after).max() == pytest.approx(1.0, abs=1e-15)
    assert np.array_equal(after(cy.fragment(at=4.0)).after, after(cy.fragment(at=4.0)).after)
    assert not np.any(after(cy.fragment(at=4.0)).after == after(cy.fragment(at=4.0), seed=1).after)
    assert not np.any(after(cy.fragment(at=4.0)).after == after(cy.fragment(at=4.0, seed=9)).after)


def test_random_streams_are_those_documented_and_not_that_of_the_initial_state():
    run = cy.simulate(
        DIFFUSE, GRID, STATE, 1.0, 1.0, protocol=cy.Protocol(cy.fragment(at=0.0), cy.fragment(at=1.0), seed=5)
    )
    for number, done in enumerate(run.interventions, 1):
        rng = np.random.default_rng(np.random.SeedSequence(5, spawn_key=(number,)))
        assert np.array_equal(done.after, rng.normal(size=(2, *GRID.shape)) * np.sqrt(0.5 / 1000))
    assert not np.any(run.frames[0] == cy.initial.disordered(GRID, seed=5))


def test_one_noise_grid_means_one_disorder_on_every_grid():
    step = cy.fragment(at=0.0, noise_grid=(16, 16))
    fine, coarse = (
        Schedule(DIFFUSE, grid, cy.Protocol(step)).disturbed(0, np.zeros((2, *grid.shape)), act)
        for grid in (GRID.resized(64, 64), GRID.resized(32, 32))
    )
    assert np.abs(fine[:, ::2, ::2] - coarse).max() < 1e-15


def test_steps_land_on_events_exactly(monkeypatch):
    """No step of the solver begins before an event and ends after it, ramps' ends included."""
    reached = []

    def spy(*arguments):
        now = advance(*arguments)
        reached.append((float(arguments[2].t), float(now.t), float(arguments[3])))
        return now

    monkeypatch.setattr("cyclosis.dynamics.stretch.advance", spy)
    events = (1.2345, 2.2345, 3.0001)
    protocol = cy.Protocol(cy.change(at=1.2345, over=1.0, **USUAL), cy.noise(at=3.0001, size=0.01))
    cy.simulate(DIFFUSE, GRID, STATE, 5.0, 5.0, protocol=protocol)
    for begin, end, target in reached:
        assert target in (*events, 5.0)
        assert end <= target
        assert not any(begin < time < end for time in events)
    assert set(events) <= {end for _, end, _ in reached}


@pytest.mark.slow
def test_parameters_in_force():
    protocol = cy.Protocol(
        cy.change(at=1.0, alpha_p=0.5),
        cy.change(at=2.0, over=2.0, alpha_p=1.5, mu=0.25, d_s=0.08),
        cy.change(at=3.0, where=DISC, kappa=0.0),
        cy.change(at=4.0, zero_theta_flux=True, alpha_p=0.0),
        cy.wash_out(at=5.0, over=2.0),
    )
    run = cy.simulate(DIFFUSE, GRID, STATE, 8.0, 1.0, protocol=protocol)
    assert run.params == DIFFUSE
    expected = {0.5: 1.0, 1.0: 0.5, 1.9: 0.5, 2.0: 0.5, 3.0: 1.0, 3.5: 1.25, 4.0: 0.0, 6.0: 0.5, 7.0: 1.0}
    for t, value in expected.items():
        assert run.params_at(t).alpha_p == pytest.approx(value, abs=1e-15), t
    assert run.params_at(3.0).mu == pytest.approx(0.15)
    assert run.params_at(2.5).kappa == 0.5
    assert np.array_equal(run.params_at(3.0).kappa, np.where(DISC.mask(GRID), 0.0, 0.5))
    assert run.params_at(4.5).zero_theta_flux
    assert run.params_at(5.5).zero_theta_flux is False
    assert run.params_at(7.0) == DIFFUSE
    numbers = cy.diagnose(run.params_at(4.0), GRID, run.frames[4])
    assert run.records["rate_of_change"][4] == pytest.approx(numbers["rate_of_change"], rel=1e-9)
    assert run.to_dataset()["u"].values[4] == pytest.approx(cy.flow(run.params_at(4.0), GRID, run.frames[4]))


def test_a_users_term_sees_the_parameters_in_force():
    def relax(t, P, u, params, grid):
        return -params.alpha_p * P

    protocol = cy.Protocol(cy.change(at=1.0, over=2.0, alpha_p=0.0))
    run = final(protocol, 5.0, terms=[relax], rtol=1e-9)
    assert run.final_state[1] == pytest.approx(0.3 * np.exp(-2.0), abs=1e-8)


def test_a_patch_of_a_parameter_is_the_same_as_a_field_from_the_start():
    """A change at t = 0 is the run with the field itself, bit by bit; and promoting costs no accuracy."""
    field = np.where(DISC.mask(GRID), 0.0, 0.5)
    params = DIFFUSE.replace(kappa=field)
    run = cy.simulate(DIFFUSE, GRID, STATE, 4.0, 1.0, protocol=[cy.change(at=0.0, where=DISC, kappa=0.0)])
    assert np.array_equal(run.final_state, cy.simulate(params, GRID, STATE, 4.0, 1.0).final_state)


def test_numbers_and_times_never_recompile():
    def go(a, b):
        protocol = cy.Protocol(
            cy.change(at=a, alpha_p=b),
            cy.change(at=a + 0.5, where=DISC, kappa=b),
            cy.change(at=a + 1.0, over=0.5, alpha_p=0.9, mu=b, d_s=0.05),
            cy.wash_out(at=a + 2.0, over=0.5),
        )
        cy.simulate(DIFFUSE, GRID, STATE, 5.0, 5.0, protocol=protocol)

    go(1.0, 0.3)
    compiled = advance._cache_size()
    go(1.3, 0.7)
    assert advance._cache_size() == compiled


def test_an_empty_protocol_is_none():
    whole = cy.simulate(DIFFUSE, GRID, STATE, 4.0, 1.0)
    assert np.array_equal(
        cy.simulate(DIFFUSE, GRID, STATE, 4.0, 1.0, protocol=cy.Protocol()).final_state, whole.final_state
    )


@pytest.mark.parametrize("dealias", ["none", pytest.param("cubic", marks=pytest.mark.slow)])
def test_a_cut_through_full_order_is_survived(dealias):
    """Sharp edges overshoot |P| = 1 while they diffuse; that is no divergence and no lack of resolution."""
    params, state = cy.Parameters(d_s=0.1, alpha_p=3.0), cy.initial.unidirectional(GRID, 0.99)
    protocol = [cy.depolymerise(at=2.0, where=DISC), cy.noise(at=6.0, size=0.2)]
    run = cy.simulate(params, GRID, state, 12.0, 0.25, protocol=protocol, dealias=dealias)
    assert run.status == "completed", run.message
    assert run.records["max_P"].max() > 1.0
    assert run.records["max_P"][-1] < 1.0


def test_a_run_that_diverges_still_says_so():
    run = cy.simulate(
        cy.Parameters(), GRID, STATE, 60.0, 1.0, protocol=[cy.noise(at=1.0, size=0.1)], stepper="rk4", dt=0.5
    )
    assert run.status == "diverged"


def test_no_state_is_steady_before_the_last_step():
    params, state = cy.Parameters(d_s=0.1), cy.initial.unidirectional(GRID, 0.9)
    settings = {"steady_rate": 1e-3}
    alone = cy.simulate(params, GRID, state, 100.0, 1.0, **settings)
    assert alone.status == "steady"
    assert alone.t_final < 30.0
    run = cy.simulate(
        params, GRID, state, 100.0, 1.0, protocol=[cy.depolymerise(at=40.0, keep=0.3)], **settings
    )
    assert run.status == "steady"
    assert 40.0 < run.t_final < 70.0


def test_a_protocol_as_tables_and_back():
    protocol = cy.Protocol(
        cy.wash_out(at=9.0),
        cy.change(at=1.0, over=2.0, alpha_p=0.5, mu=0.1),
        cy.change(at=2, where=DISC | cy.regions.strips(3), kappa=0.0),
        cy.change(at=2.5, zero_theta_flux=True),
        cy.fragment(at=4.0, noise_grid=(16, 16), where=~DISC),
        cy.noise(at=5.0, size=0.1, seed=7),
        cy.depolymerise(at=6.0, keep=0.5),
        seed=3,
    )
    assert [step.at for step in protocol] == sorted(step.at for step in protocol)
    again = cy.Protocol.from_tables(json.loads(json.dumps(protocol.as_tables())), seed=3)
    assert again == protocol
    assert again != protocol.with_seed(4)
    assert len(protocol) == len(repr(protocol).splitlines()) - 1


def intricate(at):
    parts = [cy.regions.disc(0.1 * k, 0.01 * k, 0.1) for k in range(50)]
    return cy.depolymerise(
        at=at, where=from_table({"shape": "union", "parts": [r.as_table() for r in parts]})
    )


BAD = {
    "time": (lambda: cy.change(at=-1.0, alpha_p=0.0), "at = -1.0 .* from 0 to 1e"),
    "no time": (lambda: cy.change(at=None, alpha_p=0.0), "there is no default"),
    "nothing": (lambda: cy.change(at=1.0), "at least one parameter"),
    "unknown": (lambda: cy.change(at=1.0, alfa_p=0.0), "did you mean alpha_p"),
    "range": (lambda: cy.change(at=1.0, alpha_p=-1.0), "from 0 to 1000"),
    "field": (lambda: cy.change(at=1.0, alpha_p=np.ones(GRID.shape)), "one number"),
    "patch of d_s": (lambda: cy.change(at=1.0, where=DISC, d_s=0.1), "only alpha_p, alpha_u, kappa"),
    "no region": (lambda: cy.change(at=1.0, where="disc", alpha_p=0.1), "a region of cyclosis.regions"),
    "ramp of a flag": (lambda: cy.change(at=1.0, over=1.0, zero_theta_flux=True), "at once"),
    "short ramp": (lambda: cy.change(at=1.0, over=1e-9, alpha_p=1.0), "0 or at least"),
    "keep": (lambda: cy.depolymerise(at=1.0, keep=2.0), "from 0 to 1"),
    "size": (lambda: cy.noise(at=1.0, size=-1.0), "from 0 to 10"),
    "seed": (lambda: cy.noise(at=1.0, size=0.1, seed=-1), "a whole number from 1"),
    "no step": (lambda: cy.Protocol("change"), "made of steps"),
    "too many": (lambda: cy.Protocol(*[cy.wash_out(at=1.0)] * (MOST_STEPS + 1)), "at most 1000 steps"),
    "too long": (lambda: cy.Protocol(*[intricate(at=1.0)] * 20), "at most 50000 characters"),
    "protocol seed": (lambda: cy.Protocol(seed=-1), "a whole number from 0"),
    "no protocol": (lambda: final("change"), "a Protocol"),
    "overlap": (
        lambda: cy.Protocol(cy.change(at=1.0, over=2.0, alpha_p=0.0), cy.change(at=2.5, alpha_p=1.0)),
        r"at of change = 2.5 .* at least 3, the end of the ramp of alpha_p",
    ),
    "overlapping wash out": (
        lambda: cy.Protocol(cy.change(at=1.0, over=2.0, mu=0.0), cy.wash_out(at=2.0)),
        "the ramp of mu",
    ),
    "off the cell": (
        lambda: final([cy.noise(at=1.0, size=0.1, where=cy.regions.disc(1.0, 9.0, 1.0))]),
        "on the cell",
    ),
    "field of another grid": (
        lambda: final(
            [cy.change(at=1.0, where=DISC, alpha_p=0.1)], params=cy.Parameters(alpha_p=np.ones((8, 8)))
        ),
        "that of the grid",
    ),
    "no point": (
        lambda: final([cy.noise(at=1.0, size=0.1, where=cy.regions.disc(0.2, 0.2, 0.001))]),
        "at least one point of the grid",
    ),
}


@pytest.mark.parametrize(("wrong", "words"), BAD.values(), ids=BAD)
def test_mistakes_get_one_sentence(wrong, words):
    with pytest.raises(cy.InputError, match=words):
        wrong()


BAD_TABLES = {
    "no list": ({"at": 1.0}, r"write \[\[protocol\]\]"),
    "no table": ([3], "step in step 1 of the protocol = 3"),
    "no action": ([{"at": 1.0}], "one of change, fragment"),
    "unknown action": ([{"at": 1.0, "action": "cut"}], "one of change, fragment"),
    "no time": ([{"action": "wash_out"}], "add at"),
    "no size": ([{"at": 1.0, "action": "noise"}], "add size"),
    "unknown key": ([{"at": 1.0, "action": "fragment", "sed": 1}], "did you mean seed"),
    "parameter elsewhere": ([{"at": 1.0, "action": "wash_out", "alpha_p": 1}], "a key of action wash_out"),
    "where of wash_out": ([{"at": 1.0, "action": "wash_out", "where": {}}], "a key of action wash_out"),
    "range": ([{"at": 1.0, "action": "change", "alpha_p": "x"}], "alpha_p in step 1 of the protocol"),
    "where": ([{"at": 1.0, "action": "noise", "size": 1, "where": 3}], "a table with a shape"),
}


@pytest.mark.parametrize(("tables", "words"), BAD_TABLES.values(), ids=BAD_TABLES)
def test_mistakes_in_tables_name_the_step(tables, words):
    with pytest.raises(cy.InputError, match=words):
        cy.Protocol.from_tables(tables)


def test_a_flag_that_is_washed_out_has_no_ramp():
    flag, out = cy.change(at=0.0, zero_theta_flux=True), cy.wash_out(at=1.0, over=3.0)
    assert len(cy.Protocol(flag, out, cy.change(at=2.0, zero_theta_flux=True))) == 3
    with pytest.raises(cy.InputError, match="the end of the ramp of kappa"):
        cy.Protocol(cy.change(at=0.0, kappa=0.1), out, cy.change(at=2.0, kappa=0.3))
