"""A model that is not in the package runs, is stored, resumed, integrated as an ensemble, and drawn."""

import json

import numpy as np
import pytest
from scipy.optimize import brentq
from scipy.special import iv

import cyclosis as cy
from cyclosis import config
from cyclosis.dynamics.live import Live
from cyclosis.figures.history import history
from models.ring import Alignment, Ring, ring

GRID = Ring(48)
PARAMS = Alignment(alpha_p=1.0, d_r=0.2)
PROTOCOL = cy.Protocol(cy.change(at=3.0, over=2.0, alpha_p=0.6), cy.depolymerise(at=8.0, keep=0.5))


def start(order=1e-3, angle=0.7):
    """A density with a little order in one direction."""
    return (1 + 2 * order * np.cos(GRID.phi - angle)) / (2 * np.pi)


def lasting(params):
    """|P| = I_1(k)/I_0(k) with k = α_p |P|/d_r, found without this package."""
    ratio = params.alpha_p / params.d_r
    return brentq(lambda P: iv(1, ratio * P) / iv(0, ratio * P) - P, 1e-3, 1.0, xtol=1e-14)


def run(t_end=60.0, save_every=1.0, params=PARAMS, state=None, **settings):
    state = start() if state is None else state
    return cy.simulate(params, GRID, state, t_end, save_every, model=ring, **settings)


@pytest.mark.slow
def test_order_grows_at_its_rate_and_ends_in_a_von_mises_distribution():
    found = run(rtol=1e-8)
    assert found.status == "completed", found.message
    early = found.records["order"][:8]  # the correction is of the order of |P|²
    rates = np.diff(np.log(early))
    assert rates == pytest.approx(0.5 * PARAMS.alpha_p - PARAMS.d_r, abs=2e-4)
    P = lasting(PARAMS)
    assert found.records["order"][-1] == pytest.approx(P, abs=1e-6)
    k = PARAMS.alpha_p * P / PARAMS.d_r
    exact = np.exp(k * np.cos(GRID.phi - 0.7)) / (2 * np.pi * iv(0, k))
    assert np.abs(found.final_state - exact).max() < 1e-6


@pytest.mark.parametrize(("stepper", "dt"), [("etdrk4", 0.04), ("rk4", 0.02)])
def test_steppers_of_fixed_steps_converge_to_one_solution_at_their_order(stepper, dt):
    def end(stepper, dt):
        return run(6.0, state=start(0.3), stepper=stepper, dt=dt).final_state

    exact = end("etdrk4", 0.0025)
    coarse, fine = (np.abs(end(stepper, step) - exact).max() for step in (dt, dt / 2))
    assert np.log2(coarse / fine) == pytest.approx(4.0, abs=0.2)


def test_a_run_that_settles_is_steady():
    found = run(500.0, steady_rate=1e-4)
    assert found.status == "steady"
    assert found.t_final < 400.0


def test_a_step_that_is_too_long_diverges_with_a_remedy():
    found = run(stepper="rk4", dt=10.0, state=start(0.4))
    assert found.status == "diverged"
    assert "smaller dt" in found.message


def test_it_is_stored_and_read_back(tmp_path):
    found = run(12.0, protocol=PROTOCOL)
    path = cy.write(found, tmp_path / "ring.nc")
    again = cy.load(path, model=ring)
    assert again.model is ring
    assert again.params == PARAMS
    assert np.array_equal(again.final_state, found.final_state)
    assert all(np.array_equal(a, b) for a, b in zip(again.frames, found.frames, strict=True))
    assert np.array_equal(again.interventions[0].after, found.interventions[0].after)
    with cy.open_dataset(path, model=ring) as data:
        assert data.drop_attrs().identical(found.to_dataset().drop_attrs())
        assert data["psi"].dims == ("time", "phi")
        order = np.hypot(*data["P"].values.T)
        assert order == pytest.approx(data["order"].values, abs=1e-12)


def test_a_file_of_an_unknown_model_says_so(tmp_path):
    path = cy.write(run(2.0), tmp_path / "ring.nc")
    with pytest.raises(cy.InputError, match="model = 'ring' cannot be used: it must be one of polar"):
        cy.load(path)
    with pytest.raises(
        cy.InputError, match="model = 'polar' cannot be used: it must be that of the file, ring"
    ):
        cy.load(path, model=cy.models.polar)


@pytest.mark.parametrize("t_half", [2.0, 4.0, 8.0])
def test_it_goes_on_bit_for_bit_through_files(tmp_path, t_half):
    whole = run(12.0, protocol=PROTOCOL)
    with cy.RunWriter(tmp_path / "half.nc") as writer:
        writer.finish(run(t_half, protocol=PROTOCOL, checkpoint=writer, checkpoint_seconds=0.0))
    onward = cy.resume_file(tmp_path / "half.nc", 12.0, model=ring)
    assert np.array_equal(onward.final_state, whole.final_state)
    stored = cy.load(tmp_path / "half.nc", model=ring)
    assert np.array_equal(stored.times, whole.times)
    assert all(np.array_equal(a, b) for a, b in zip(stored.frames, whole.frames, strict=True))


def test_a_run_that_is_cut_off_leaves_parts_that_go_on(tmp_path):
    def stop(now):
        if now.t > 5.0:
            raise KeyboardInterrupt

    with cy.RunWriter(tmp_path / "cut.nc") as writer, pytest.raises(KeyboardInterrupt):
        run(12.0, protocol=PROTOCOL, checkpoint=writer, checkpoint_seconds=0.0, progress=stop)
    cy.resume_file(tmp_path / "cut.nc", model=ring)
    whole = run(12.0, protocol=PROTOCOL)
    assert np.array_equal(cy.load(tmp_path / "cut.nc", model=ring).final_state, whole.final_state)


def test_a_live_run_is_the_same():
    live = Live(PARAMS, GRID, start(), 1.0, PROTOCOL, ring)
    while live.t < 12.0:
        live.forward()
    assert np.array_equal(live.state, run(12.0, protocol=PROTOCOL).final_state)
    with pytest.raises(cy.InputError, match="one with a flow"):
        live.flow()


def test_an_ensemble_over_a_parameter_ends_where_theory_says():
    values = (0.3, 0.5, 0.8, 1.2)
    members = [cy.ensemble.Member(Alignment(v, 0.2), GRID, start, model=ring) for v in values]
    outcomes = cy.ensemble.follow(
        members, cy.ensemble.EnsembleSettings(t_end=300.0, finish="t_end", rtol=1e-6)
    )
    for value, outcome in zip(values, outcomes, strict=True):
        assert outcome.status == "completed"
        order = np.hypot(*ring.derive(ring.problem(PARAMS, GRID))(PARAMS, outcome.state)["P"])
        assert order == pytest.approx(lasting(Alignment(value, 0.2)) if value > 0.4 else 0.0, abs=1e-5)
    with pytest.raises(cy.InputError, match="t_end with the model ring"):
        cy.ensemble.follow(members)


def test_its_history_is_drawn(tmp_path):
    figure = history(run(40.0).to_dataset())
    labels = [ax.get_ylabel() for ax in figure.axes]
    assert any("P" in label for label in labels)
    lines = [line.get_ydata() for ax in figure.axes for line in ax.lines]
    assert any(np.max(values) == pytest.approx(lasting(PARAMS), abs=1e-3) for values in lines)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ((cy.Parameters(), GRID, start()), "params"),
        ((PARAMS, cy.CylinderGrid(16, 16), start()), "grid"),
        ((PARAMS, GRID, np.ones(3)), "a density of shape"),
    ],
)
def test_what_does_not_belong_to_the_model_is_refused(arguments, words):
    with pytest.raises(cy.InputError, match=words):
        cy.simulate(*arguments, 1.0, model=ring)


def test_the_model_of_a_configuration_is_chosen_by_name(tmp_path):
    tables = {"grid": {"n_theta": 16, "n_z": 16}, "initial": {"kind": "stripes"}}
    for given in (tables, tables | {"model": {"kind": "polar"}}):
        assert config.setup(config.check(given)).model is cy.models.polar
    axes = {"axes": {"alpha_p": {"values": [0.1, 0.2]}}}
    one, other = (cy.Sweep.from_tables(axes | given) for given in ({}, {"model": {"kind": "polar"}}))
    assert one == other
    assert "model" not in one.tables, "stores of before are those of now"
    for read in (config.check, lambda given: cy.Sweep.from_tables(axes | given)):
        with pytest.raises(cy.InputError, match="kind = 'ring' cannot be used: it must be one of polar"):
            read({"model": {"kind": "ring"}})


def test_a_polar_file_names_no_model(tmp_path):
    grid = cy.CylinderGrid(16, 16)
    run = cy.simulate(cy.Parameters(), grid, cy.initial.stripes(grid), 1.0, model=cy.models.polar)
    assert "model" not in json.loads(run.to_dataset().attrs["configuration"])
    assert cy.load(cy.write(run, tmp_path / "polar.nc")).model is cy.models.polar
