"""The polar model with a concentration: oracle, kinetic model, conservation, files, starts, refusals."""

import itertools
import json

import numpy as np
import pytest
from typer.testing import CliRunner

import closure_oracle
import cyclosis as cy
import oracle
from cyclosis import config
from cyclosis.cli import app
from cyclosis.explorer import setup as explorer_setup
from cyclosis.model.definitions import TERM_NAMES
from cyclosis.model.precision import double
from cyclosis.model.regions import disc
from cyclosis.models import of_tables, polar_model

UNEVEN = polar_model(concentration=True)
POWER = polar_model(concentration=True, force_density="power")
GRID, ODD = cy.CylinderGrid(16, 12, 4.0), cy.CylinderGrid(15, 11, 4.0)
"""Two grids, the second without Nyquist modes."""
GENERAL = cy.Parameters(
    alpha_p=0.7, alpha_u=0.6, kappa=0.3, epsilon=0.2, d_s=0.03, d_r=0.08, mu=0.07, repulsion_angle=0.4
)


def smooth(grid=GRID, size=0.6):
    """Return a state of few modes in P and c."""
    theta, z = grid.theta[:, None], 2 * np.pi * grid.z[None, :] / grid.length
    P = size * np.stack([0.6 * np.cos(theta - z) + 0.2 * np.sin(z), np.sin(theta) + 0.5 * np.cos(z + 0.3)])
    return cy.initial.with_concentration(P, 1 + 0.3 * np.cos(theta - 0.4) + 0.2 * np.sin(z + theta))


def right_hand_side(params, grid, state, model=UNEVEN, terms=None):
    """Return d/dt of P and c, shape (3, n_theta, n_z)."""
    system = model.system(model.problem(params, grid, terms), True)
    with double():
        return model.state(grid, np.asarray(system.rate(system.at(model.modes(system, state)))))


def run(state, t_end, params=GENERAL, grid=GRID, model=UNEVEN, **settings):
    return cy.simulate(params, grid, state, t_end, model=model, **settings)


@pytest.mark.parametrize("closure", ["paper", "von_mises", "weak"])
@pytest.mark.parametrize("law", ["linear", "power"])
@pytest.mark.parametrize("exponent", [2.0, 1.0])
def test_one_right_hand_side_against_plain_array_code(monkeypatch, closure, law, exponent):
    params, state = GENERAL.replace(force_exponent=exponent), smooth()
    P, c = state[:2], state[2]
    weight = c if law == "linear" else c ** (1 + exponent)
    monkeypatch.setattr(oracle, "force", lambda p, Q: weight * np.hypot(*Q) ** exponent * Q)
    source = oracle if closure == "paper" else closure_oracle
    own = () if closure == "paper" else (closure,)
    expected = source.rate(params, GRID.length, P, *own)
    slopes = oracle.gradient(c, GRID.length)
    each = [oracle.gradient(P[i], GRID.length) for i in (0, 1)]
    more = [2 * params.d_s / c * (slopes[0] * one[0] + slopes[1] * one[1]) for one in each]
    expected = expected + oracle.both(np.stack(more), GRID.shape)
    u = oracle.flow(params, GRID.length, P)
    carried = [oracle.resampled(u[i] * c, GRID.shape) for i in (0, 1)]
    outflow = oracle.gradient(carried[0], GRID.length)[0] + oracle.gradient(carried[1], GRID.length)[1]
    change = params.d_s * oracle.laplacian(c, GRID.length) - params.epsilon * outflow
    model = polar_model(closure, concentration=True, force_density=law)
    found = right_hand_side(params, GRID, state, model)
    assert np.abs(more).max() > 1e-2
    assert np.abs(found[:2] - expected).max() < 1e-10
    assert np.abs(found[2] - oracle.resampled(change, GRID.shape)).max() < 1e-12


def of_kinetic(params, grid, state, terms=None):
    """Return d/dt of P and c by the kinetic model, of von Mises densities of angles."""
    m = state[2] * cy.kinetic.dressed(state[:2], 8)
    kinetic = cy.models.kinetic
    system = kinetic.system(kinetic.problem(params, grid, terms, shape=m.shape), True)
    with double():
        rate = np.fft.ifft2(np.asarray(system.rate(system.at(kinetic.modes(system, m)))))
    p = (rate[1] - m[1] / m[0] * rate[0]) / m[0]
    return np.stack([p.real, p.imag, rate[0].real])


def test_the_kinetic_model_has_the_same_equations_for_its_first_two_moments():
    model = polar_model("von_mises", concentration=True)
    still = [name for name in TERM_NAMES if name != "advection"]
    found = right_hand_side(GENERAL, ODD, smooth(ODD), model, still)
    assert np.abs(found - of_kinetic(GENERAL, ODD, smooth(ODD), still)).max() < 1e-12
    without = GENERAL.replace(d_s=0.0)
    found -= right_hand_side(without, ODD, smooth(ODD), model, still)
    assert np.abs(found).max() > 1e-2, "diffusion is a part of what is compared"
    # Both carry P and c with the flow, one by fluxes: the same where the grid resolves their products.
    fine = cy.CylinderGrid(41, 41, 4.0)
    found = right_hand_side(GENERAL, fine, smooth(fine, 0.4), model)
    assert np.abs(found - of_kinetic(GENERAL, fine, smooth(fine, 0.4))).max() < 1e-11


def test_an_even_concentration_changes_nothing():
    P = cy.initial.disordered(GRID, seed=1)
    even = run(cy.initial.with_concentration(P), 5.0).final_state
    plain = cy.simulate(GENERAL, GRID, P, 5.0).final_state
    assert np.abs(even[:2] - plain).max() < 1e-13
    assert np.abs(even[2] - 1).max() < 1e-14


@pytest.mark.parametrize("height", [1.0, -0.7])
def test_filaments_are_conserved_and_stay_between_their_extremes(height):
    grid = cy.CylinderGrid(32, 32)
    P = cy.initial.stripes(grid, magnitude=0.8) + cy.initial.circumferential(grid, 0.2)
    c = cy.initial.bump(grid, height, theta=2.0, z=1.0, width=0.8)
    found = run(cy.initial.with_concentration(P, c), 5.0, cy.Parameters(), grid, save_every=0.5)
    frames = np.array(list(found.frames))[:, 2]
    assert np.abs(frames.mean(axis=(1, 2)) - 1).max() < 1e-13
    assert np.abs(found.records["mean_concentration"] - 1).max() < 1e-13
    assert all(b.max() < a.max() for a, b in itertools.pairwise(frames))
    assert all(b.min() > a.min() for a, b in itertools.pairwise(frames))
    assert found.records["max_concentration"] == pytest.approx(frames.max(axis=(1, 2)), abs=1e-12)
    assert found.records["min_concentration"] == pytest.approx(frames.min(axis=(1, 2)), abs=1e-12)
    still = run(cy.initial.with_concentration(P, c), 5.0, cy.Parameters(epsilon=0.0), grid)
    assert np.abs(still.final_state[2] - frames[-1]).max() > 1e-2, "the flow carries filaments"


def test_a_wave_of_concentration_decays_by_diffusion():
    theta, z = GRID.theta[:, None], 2 * np.pi * GRID.z / GRID.length
    c = 1 + 0.4 * np.cos(2 * theta + z)
    state = cy.initial.with_concentration(cy.initial.disordered(GRID), c)
    found = run(state, 3.0, GENERAL.replace(epsilon=0.0)).final_state[2]
    decay = np.exp(-3.0 * GENERAL.d_s * (4 + (2 * np.pi / GRID.length) ** 2))
    assert np.abs(found - 1 - decay * (c - 1)).max() < 1e-13


@pytest.mark.slow
@pytest.mark.parametrize("stepper", ["etdrk4", "rk4"])
def test_fourth_order_in_time(stepper):
    def end(stepper, dt):
        return run(smooth(size=0.5), 1.0, stepper=stepper, dt=dt).final_state

    exact = end("etdrk4", 0.005)
    coarse, fine = (np.abs(end(stepper, dt) - exact).max(axis=(1, 2)) for dt in (0.1, 0.05))
    assert np.log2(coarse / fine) == pytest.approx(4.0, abs=0.35)


@pytest.mark.slow
def test_diffusion_that_changes_in_time_is_followed_by_two_steppers_alike():
    protocol = cy.Protocol(cy.change(at=0.2, over=0.6, d_s=0.2, d_r=0.02))
    one, two = (
        run(smooth(size=0.5), 1.0, protocol=protocol, stepper=stepper, dt=0.01).final_state
        for stepper in ("etdrk4", "rk4")
    )
    assert np.abs(one - two).max() < 1e-7
    assert np.abs(one - run(smooth(size=0.5), 1.0).final_state).max() > 1e-2


def test_the_budget_is_what_each_term_does_to_order():
    model = polar_model("wrapped_normal", concentration=True)
    system = model.system(model.problem(GENERAL, ODD), True)
    with double():
        found = model.measure(system, model.modes(system, smooth(ODD)), 0.0)
    rate = right_hand_side(GENERAL, ODD, smooth(ODD), model)[:2]
    assert np.asarray(found["budget"]).sum() == pytest.approx(
        np.mean(np.sum(smooth(ODD)[:2] * rate, 0)), abs=1e-13
    )
    assert float(found["rate_of_change"]) == pytest.approx(np.sqrt(np.mean(np.sum(rate**2, 0))), abs=1e-13)


PROTOCOL = cy.Protocol(
    cy.change(at=0.5, over=1.0, alpha_p=0.2, d_s=0.1),
    cy.align(at=2.0, angle=1.0, magnitude=0.8, where=disc(theta=1.0, z=2.0, radius=0.8)),
    cy.noise(at=2.0, size=0.02),
    cy.depolymerise(at=2.5, keep=0.3),
    seed=3,
)


@pytest.mark.slow
@pytest.mark.parametrize("t_half", [1.0, 2.0])
def test_a_run_goes_on_bit_for_bit_through_a_file(tmp_path, t_half):
    how = {"protocol": PROTOCOL, "save_every": 0.5, "model": POWER}
    whole = run(smooth(), 3.0, **how)
    with cy.RunWriter(tmp_path / "half.nc") as writer:
        writer.finish(run(smooth(), t_half, checkpoint=writer, checkpoint_seconds=0.0, **how))
    cy.resume_file(tmp_path / "half.nc", 3.0)
    stored = cy.load(tmp_path / "half.nc")
    assert stored.model is POWER
    assert np.array_equal(stored.final_state, whole.final_state)
    assert all(np.array_equal(a, b) for a, b in zip(stored.frames, whole.frames, strict=True))
    for one, other in zip(stored.interventions, whole.interventions, strict=True):
        assert np.array_equal(one.after, other.after)
        assert np.array_equal(one.after[2], one.before[2]), "steps act on P alone"
        assert not np.array_equal(one.after[:2], one.before[:2])


@pytest.mark.slow
def test_a_file_holds_the_concentration_and_starts_further_runs(tmp_path):
    found = run(smooth(), 1.0, save_every=0.5)
    path = cy.write(found, tmp_path / "uneven.nc")
    with cy.open_dataset(path) as data:
        assert data["concentration"].dims == ("time", "theta", "z")
        assert np.array_equal(data["concentration"][-1], found.final_state[2])
        assert np.array_equal(data["P"][-1], found.final_state[:2])
        assert json.loads(data.attrs["configuration"])["model"] == {
            "kind": "polar", "closure": "paper", "concentration": True, "force_density": "linear",
        }  # fmt: skip
        force = found.final_state[2] * np.sum(found.final_state[:2] ** 2, axis=0) * found.final_state[:2]
        u = oracle.driven_flow(GENERAL, GRID.length, oracle.both(force, GRID.shape))
        assert np.abs(data["u"][-1].values - u).max() < 1e-13
        assert np.isfinite(data["budget"]).all()
    cell = {"n_theta": 16, "n_z": 12, "length": 4.0}
    tables = {"model": {"concentration": True}, "grid": cell, "initial": {"kind": "file", "path": str(path)}}
    assert np.abs(config.setup(config.check(tables)).state - found.final_state).max() < 1e-14
    finer = config.setup(config.check(tables | {"grid": cell | {"n_theta": 32}})).state
    assert np.abs(finer[:, ::2] - found.final_state).max() < 1e-13
    kinetic = cy.simulate(
        GENERAL, GRID, smooth()[2] * cy.kinetic.dressed(smooth()[:2], 8), 0.5, model=cy.models.kinetic
    )
    tables["initial"]["path"] = str(cy.write(kinetic, tmp_path / "kinetic.nc"))
    again = config.setup(config.check(tables)).state
    assert np.abs(again[2] - kinetic.final_state[0].real).max() < 1e-14
    plain = cy.write(cy.simulate(GENERAL, GRID, smooth()[:2], 0.5), tmp_path / "plain.nc")
    tables["initial"]["path"] = str(plain)
    assert np.array_equal(config.setup(config.check(tables)).state[2], np.ones(GRID.shape))


def test_starts_with_a_bump_or_a_gap():
    tables = {
        "model": {"concentration": True},
        "grid": {"n_theta": 32, "n_z": 32},
        "initial": {"kind": "stripes", "bump": -0.8, "bump_theta": 1.0, "bump_z": 2.0, "bump_width": 0.6},
    }
    state = config.setup(config.check(tables)).state
    grid = cy.CylinderGrid(32, 32)
    assert np.array_equal(state[:2], cy.initial.stripes(grid))
    assert state[2].mean() == pytest.approx(1.0, abs=1e-14)
    at = np.unravel_index(state[2].argmin(), grid.shape)
    assert abs(grid.theta[at[0]] - 1.0) < 0.11
    assert abs(grid.z[at[1]] - 2.0) < 0.09
    bump = cy.initial.bump(grid, 1.0, theta=grid.theta[5], z=grid.z[7], width=0.5)
    level = bump.min()
    assert bump[5, 7] / level == pytest.approx(2.0, rel=1e-5)
    far = 2 - 2 * np.cos(grid.theta[2]) + 2 * (5 / 2 / np.pi) ** 2 * (1 - np.cos(2 * np.pi * 3 / 32))
    assert bump[7, 10] / level - 1 == pytest.approx(np.exp(-far / 0.5), rel=1e-3)


@pytest.mark.slow
def test_the_command_line_makes_and_shows_such_a_run(tmp_path):
    path = tmp_path / "run.nc"
    cell = ["--n-theta", "8", "--n-z", "8", "--t-end", "0.2", "--quiet", "--out", str(path)]
    found = CliRunner().invoke(
        app, ["run", "--concentration", "--bump", "0.5", "--force-density", "power", *cell]
    )
    assert found.exit_code == 0, found.output
    stored = cy.load(path)
    assert stored.model is POWER
    assert np.ptp(stored.frames[0][2]) > 0.3
    shown = CliRunner().invoke(app, ["info", str(path)])
    assert "concentration = True" in shown.output
    assert "concentration(time, theta, z)" in shown.output
    refused = CliRunner().invoke(app, ["run", "--bump", "0.5", *cell, "--force"])
    assert "used only where [model] concentration is true" in str(refused.exception)


@pytest.mark.slow
def test_members_of_an_ensemble_share_lanes():
    grid = cy.CylinderGrid(16, 8)
    starts = [
        cy.initial.with_concentration(
            cy.initial.disordered(grid, seed=s), cy.initial.bump(grid, 0.5 + 0.3 * s)
        )
        for s in range(3)
    ]
    params = [cy.Parameters(d_s=0.1, alpha_p=a) for a in (0.3, 0.45, 0.6)]
    members = [
        cy.ensemble.Member(p, grid, lambda state=state: state, model=UNEVEN)
        for p, state in zip(params, starts, strict=True)
    ]
    how = cy.ensemble.EnsembleSettings(t_end=10.0, finish="t_end", lanes=3)
    for member, found in zip(members, cy.ensemble.follow(members, how), strict=True):
        alone = run(member.state(), 10.0, member.params, grid)
        assert found.status == "completed"
        assert found.state.shape == (3, 16, 8)
        assert np.abs(found.state - alone.final_state).max() < 1e-3
    with pytest.raises(cy.InputError, match="t_end with the model polar with closure = paper, concentration"):
        cy.ensemble.follow(members, cy.ensemble.EnsembleSettings(t_end=20.0))


@pytest.mark.slow
def test_a_sweep_with_a_bump(tmp_path):
    from cyclosis.sweep.store.block import compute

    tables = {
        "model": {"concentration": True},
        "axes": {"alpha_p": {"values": [0.2, 0.5]}},
        "grid": {"n_theta": 8, "n_z": 8},
        "initial": {"bump": 0.5},
        "parameters": {"d_s": 0.1},
        "run": {"t_end": 2.0},
        "ensemble": {"seeds": 2},
        "record": {"quantities": ["max_concentration"], "fields": True},
    }
    sweep = cy.Sweep.from_tables(tables)
    assert sweep.tables["initial"]["bump"] == 0.5
    assert sweep.tables["model"]["force_density"] == "linear"
    found = compute(sweep, 0)
    assert found["state"].shape == (4, 3, 8, 8)
    assert found["profile"].shape == (4, 2, 8)
    assert found["max_concentration"] == pytest.approx(found["state"][:, 2].max(axis=(1, 2)), abs=1e-12)
    assert np.all(found["max_concentration"] > 1.001)
    np.save(tmp_path / "state.npy", cy.initial.stripes(cy.CylinderGrid(8, 8), magnitude=0.5))
    of_file = tables | {"initial": {"kind": "file", "path": str(tmp_path / "state.npy")}, "ensemble": {}}
    state = cy.Sweep.from_tables(of_file).build(0).state()
    assert np.array_equal(state[2], np.ones((8, 8)))


def test_regimes_are_those_of_P():
    grid = cy.CylinderGrid(16, 16)
    state = cy.initial.with_concentration(cy.initial.stripes(grid), cy.initial.bump(grid, 0.5))
    found = UNEVEN.regime(UNEVEN.problem(cy.Parameters(), grid), state)
    assert found.name == "cyclosis"
    P = cy.initial.unidirectional(grid, np.sqrt(1 - 0.025))
    assert UNEVEN.regime(UNEVEN.problem(cy.Parameters(), grid), cy.initial.with_concentration(P)).settled


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda s: s[:2], "P_theta, P_z and the concentration"),
        (lambda s: s + 0j, "P_theta, P_z and the concentration"),
        (lambda s: np.stack([*s[:2], 0 * s[2]]), "above 0 everywhere"),
        (lambda s: np.stack([*s[:2], np.nan * s[2]]), "finite"),
        (lambda s: 3 * s, "at most 1"),
    ],
)
def test_states_that_do_not_fit_are_refused_in_a_sentence(change, words):
    with pytest.raises(cy.InputError, match=words):
        run(change(smooth()), 1.0)


def test_mistakes_are_refused_in_a_sentence():
    for table, words in (
        ({"kind": "kinetic", "concentration": True}, "used only where .model. kind is polar"),
        ({"kind": "kinetic", "force_density": "power"}, "used only where .model. kind is polar"),
        ({"force_density": "power"}, "used only where .model. concentration is true"),
        ({"concentration": "yes"}, "true or false"),
        ({"force_density": "square"}, "one of linear, power"),
    ):
        with pytest.raises(cy.InputError, match=words):
            of_tables(config.check({"model": table}))
    on = {"model": {"concentration": True}, "grid": {"n_theta": 8, "n_z": 8}}
    for tables, words in (
        ({"initial": {"bump": 0.5}}, "used only where .model. concentration is true"),
        (on | {"initial": {"bump_width": 0.5}}, "used only with bump"),
        (on | {"initial": {"bump": -1.5}}, "from -0.999"),
    ):
        with pytest.raises(cy.InputError, match=words):
            config.setup(config.check(tables))
    with pytest.raises(cy.InputError, match=r"used only where \[model\] concentration is true"):
        cy.Sweep.from_tables({"axes": {"alpha_p": {"values": [0.2, 0.5]}}, "initial": {"bump": 0.5}})
    with pytest.raises(cy.InputError, match="above 0"):
        cy.initial.with_concentration(smooth()[:2], -1.0)
    with pytest.raises(cy.InputError, match="positive"):
        cy.initial.with_concentration(smooth()[:2], np.ones((3, 3)))
    with pytest.raises(cy.InputError, match=r"shape \(2, n_theta, n_z\)"):
        cy.initial.with_concentration(smooth())
    with pytest.raises(cy.InputError, match="left out in the explorer"):
        explorer_setup.from_tables({"model": {"concentration": True}})
    with pytest.raises(cy.InputError, match="left out in the explorer"):
        explorer_setup.from_tables({"model": {"force_density": "power"}})
