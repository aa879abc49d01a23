"""Runs on closed cells: symmetry, order in time, files, protocols, ensembles, sweeps, custom terms."""

import jax.numpy as jnp
import numpy as np
import pytest

import cyclosis as cy
from cyclosis.ensemble import Member, follow

GRID = cy.ClosedGrid(cy.Capsule(2.0, 0.4), k_max=8)
PARAMS = cy.Parameters(d_s=0.05)
RESOLVED = {"stepper": "etdrk4", "dt": 0.1}
SLOW = pytest.mark.slow


def smooth(grid=GRID, size=0.4, turn=None):
    """The tangent part of a field in space, turned with the body by a rotation matrix."""
    x = grid.xyz if turn is None else np.einsum("ji,j...->i...", turn, grid.xyz)
    field = size * np.stack([np.sin(1 + x[1]), np.cos(x[0] - x[2]), 0.5 * x[0] * x[1]])
    if turn is not None:
        field = np.einsum("ij,j...->i...", turn, field)
    return cy.closed.from_vectors(grid, field)


def rotation(angle, axis):
    """The matrix of a rotation (Rodrigues)."""
    x, y, z = np.array(axis) / np.linalg.norm(axis)
    K = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + np.sin(angle) * K + (1 - np.cos(angle)) * K @ K


def test_runs_turn_with_the_sphere():
    """Poles are points like others: a turned state ends as the turned end of the run."""
    small = cy.ClosedGrid(cy.Sphere(), k_max=8)
    assert turned_difference(small) < 5e-6


@pytest.mark.slow
def test_runs_turn_with_the_sphere_to_many_digits():
    assert turned_difference(cy.ClosedGrid(cy.Sphere(), k_max=20)) < 1e-9


def turned_difference(grid):
    turn = rotation(1.1, (1.0, 2.0, 0.5))
    x = np.random.default_rng(0).normal(size=(100, 3))
    x /= np.linalg.norm(x, axis=1)[:, None]
    ends = []
    for matrix, points in ((None, x), (turn, x @ turn.T)):
        run = cy.simulate(PARAMS, grid, smooth(grid, 0.25, matrix), 5.0, 5.0, **RESOLVED)
        ends.append(grid.cartesian(run.final_state, points))
    return np.abs(ends[1] - ends[0] @ turn.T).max()


@pytest.mark.slow
def test_a_capsule_turned_about_its_axis():
    """By a whole number of points, to rounding."""
    P = smooth()
    ends = [
        cy.simulate(PARAMS, GRID, np.roll(P, shift, axis=1), 3.0, 3.0, **RESOLVED).final_state
        for shift in (0, 7)
    ]
    np.testing.assert_allclose(ends[1], np.roll(ends[0], 7, axis=1), rtol=0, atol=1e-12)


@pytest.mark.parametrize(("stepper", "dt"), [("etdrk4", 0.1), pytest.param("rk4", 0.1, marks=SLOW)])
def test_order_in_time(stepper, dt):
    exact = cy.simulate(PARAMS, GRID, smooth(), 4.0, 4.0, stepper="etdrk4", dt=0.0125).final_state
    errors = [
        np.abs(
            cy.simulate(PARAMS, GRID, smooth(), 4.0, 4.0, stepper=stepper, dt=step).final_state - exact
        ).max()
        for step in (dt, dt / 2)
    ]
    assert np.log2(errors[0] / errors[1]) == pytest.approx(4.0, abs=0.2), errors


@pytest.mark.parametrize(
    "settings", [RESOLVED, *(pytest.param(given, marks=SLOW) for given in ({}, {"precision": "float32"}))]
)
def test_a_run_goes_on_from_its_file_bit_for_bit(settings, tmp_path):
    whole = cy.simulate(PARAMS, GRID, cy.closed.disordered(GRID, seed=2), 4.0, 1.0, **settings)
    half = cy.simulate(PARAMS, GRID, cy.closed.disordered(GRID, seed=2), 2.0, 1.0, **settings)
    loaded = cy.load(cy.write(half, tmp_path / "half.nc"))
    assert loaded.grid == GRID
    rest = cy.resume(loaded, 4.0)
    np.testing.assert_array_equal(rest.final_state, whole.final_state)
    assert rest.records["order"][-1] == whole.records["order"][-1]


@pytest.mark.slow
def test_single_precision_follows_double():
    ends = [
        cy.simulate(PARAMS, GRID, smooth(), 5.0, 5.0, precision=p, **RESOLVED).final_state
        for p in ("float64", "float32")
    ]
    assert 0 < np.abs(ends[1] - ends[0]).max() < 1e-5


@pytest.mark.slow
def test_a_drug_a_wound_and_a_new_direction(tmp_path):
    wound = cy.regions.disc(1.0, 0.3, 0.6)
    protocol = cy.Protocol(
        cy.change(at=1.0, alpha_p=0.0),
        cy.fragment(at=2.0, filaments_per_square=50, where=wound),
        cy.wash_out(at=3.0),
        cy.align(at=4.0, angle=0.5 * np.pi, magnitude=0.6, where=cy.regions.band("z", 2.0, 4.0)),
    )
    run = cy.simulate(PARAMS, GRID, smooth(), 5.0, 0.5, protocol=protocol)
    plain = cy.simulate(PARAMS, GRID, smooth(), 5.0, 0.5)
    by_time = dict(zip(run.times.tolist(), run.frames, strict=True))
    np.testing.assert_array_equal(by_time[0.5], plain.frames[1])
    assert np.hypot(*by_time[1.5]).mean() < np.hypot(*plain.frames[3]).mean()
    assert run.params_at(1.5).alpha_p == 0.0
    assert run.params_at(3.5).alpha_p == PARAMS.alpha_p
    mask = wound.mask(GRID)
    before = cy.simulate(PARAMS, GRID, smooth(), 2.0, 1.0, protocol=[cy.change(at=1.0, alpha_p=0.0)])
    hurt = np.hypot(*(by_time[2.0] - before.final_state))
    far = ~cy.regions.disc(1.0, 0.3, 2.5).mask(GRID)
    assert hurt[mask].mean() > 20 * hurt[far].mean()
    loaded = cy.load(cy.write(run, tmp_path / "run.nc"))
    assert loaded.protocol == protocol
    for mine, stored in zip(run.frames, loaded.frames, strict=True):
        np.testing.assert_array_equal(mine, stored)
    data = loaded.to_dataset()
    for name in ("x", "y", "z", "r", "area_weight"):
        assert name in data.coords or name in data
    u = cy.flow(run.params_at(5.0), GRID, run.final_state)
    np.testing.assert_allclose(data["u"].values[-1], u, rtol=0, atol=1e-14)


def test_aligning_everything_gives_a_swirl_or_a_source_and_a_sink():
    for angle, made in ((0.0, cy.closed.swirl), (0.5 * np.pi, None)):
        run = cy.simulate(
            PARAMS, GRID, smooth(), 1.0, 1.0, protocol=[cy.align(at=1.0, angle=angle, magnitude=0.6)]
        )
        P = run.final_state
        if made is not None:
            assert np.abs(P - made(GRID, 0.6)).max() < 2e-3
        else:
            assert np.abs(P[1] - 0.6 * GRID.r).max() < 2e-2
        assert np.abs(P[1 if made is not None else 0]).max() < 1e-12


@pytest.mark.slow
def test_a_ramp_of_the_viscosity():
    """At every time of it power is dissipated by the viscosity of that time, and steppers agree."""
    protocol = [cy.change(at=1.0, over=2.0, mu=0.55)]
    run = cy.simulate(PARAMS, GRID, smooth(), 4.0, 0.5, protocol=protocol, rtol=1e-9)
    records = run.records
    out = records["viscous_dissipation"] + records["friction_dissipation"]
    np.testing.assert_allclose(records["power_input"], out, rtol=1e-11)
    assert run.params_at(2.0).mu == pytest.approx(0.5 * (0.05 + 0.55))
    middle = list(run.record_times).index(2.0)
    own = cy.diagnose(PARAMS.replace(mu=0.3), GRID, run.frames[list(run.times).index(2.0)])
    assert records["viscous_dissipation"][middle] == pytest.approx(own["viscous_dissipation"], rel=1e-9)
    other = cy.simulate(PARAMS, GRID, smooth(), 4.0, 0.5, protocol=protocol, stepper="rk4", dt=0.025)
    assert np.abs(run.final_state - other.final_state).max() < 1e-6


@pytest.mark.slow
def test_members_of_an_ensemble_are_runs():
    states = [cy.closed.disordered(GRID, seed=seed) for seed in (1, 2)]
    how = cy.ensemble.EnsembleSettings(t_end=3.0, finish="t_end")
    outcomes = follow(
        [Member(PARAMS, GRID, lambda state=state: state, model=cy.models.closed) for state in states], how
    )
    for state, outcome in zip(states, outcomes, strict=True):
        alone = cy.simulate(PARAMS, GRID, state, 3.0, 3.0)
        assert np.abs(outcome.state - alone.final_state).max() < 1e-6


@pytest.mark.slow
def test_a_sweep_over_the_shape(tmp_path):
    from cyclosis.sweep.store.block import compute

    tables = {
        "model": {"kind": "closed"},
        "axes": {"aspect": {"values": [1.0, 2.0]}},
        "grid": {"shape": "spheroid", "k_max": 6},
        "run": {"t_end": 2.0, "finish": "t_end"},
        "ensemble": {"seeds": 1},
    }
    sweep = cy.Sweep.from_tables(tables)
    arrays = [compute(sweep, block) for block in range(sweep.blocks)]
    order = np.concatenate([block["order"] for block in arrays])
    for aspect, found in zip((1.0, 2.0), order.ravel(), strict=True):
        grid = cy.ClosedGrid(cy.Spheroid(aspect), k_max=6)
        state = cy.closed.disordered(grid, seed=sweep.seeds[0])
        run = cy.simulate(cy.Parameters(), grid, state, 2.0, 2.0)
        assert found == pytest.approx(run.records["order"][-1], rel=1e-4)


@pytest.mark.slow
def test_a_term_of_the_user():
    """Filaments that all turn at one rate: a rotation of P in the tangent plane, with all modes alike."""

    def turning(t, P, u, params, grid):
        assert grid == GRID
        return 0.7 * jnp.stack([-P[1], P[0]])

    P = smooth()
    start = cy.simulate(PARAMS, GRID, P, 0.0).final_state
    end = cy.simulate(PARAMS, GRID, P, 2.0, 2.0, terms=[turning], rtol=1e-10).final_state
    cos, sin = np.cos(1.4), np.sin(1.4)
    exact = np.stack([cos * start[0] - sin * start[1], sin * start[0] + cos * start[1]])
    np.testing.assert_allclose(end, exact, rtol=0, atol=1e-8)
