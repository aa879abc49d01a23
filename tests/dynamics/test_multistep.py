"""The multistep stepper: its weights, the local Jacobian, what it remembers, and where it is refused."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

import cyclosis as cy
from cyclosis.dynamics import multistep
from cyclosis.dynamics.advance import Control, advance, start
from cyclosis.dynamics.steppers import METHODS
from cyclosis.model import filaments, relaxation
from cyclosis.model.precision import double
from cyclosis.model.system import system

GRID = cy.CylinderGrid(24, 16, 4.0)
PARAMS = cy.Parameters(kappa=0.3, repulsion_angle=0.4, epsilon=0.3)
METHOD = METHODS["multistep"]


def state(seed=3, size=0.9):
    return size * cy.initial.disordered(GRID, 100, seed=seed)


def moment(cell, P):
    return cell.at(cell.spectrum(P))


def test_weights_are_exact_for_polynomials():
    """On uneven times: the derivative at the new time and the value extrapolated to it."""
    x = np.array([-1.0, -1.7, -3.1, -3.9])
    with double():
        for k in (3, 4):
            lead, earlier, ahead = map(np.asarray, multistep.weights(jnp.asarray(x[:k])))
            for power in range(k + 1):
                found = lead * (power == 0) + earlier @ x[:k] ** power
                assert found == pytest.approx(float(power == 1), abs=1e-12)
            for power in range(k):
                assert ahead @ x[:k] ** power == pytest.approx(float(power == 0), abs=1e-12)


def test_even_steps_give_the_backward_differentiation_formulas():
    with double():
        lead, earlier, _ = multistep.weights(jnp.asarray([-1.0, -2.0, -3.0, -4.0]))
    assert float(lead) == pytest.approx(25 / 12)
    assert np.asarray(earlier) == pytest.approx([-4, 3, -4 / 3, 1 / 4])


@pytest.mark.parametrize("closure", ["paper", "von_mises"])
def test_the_local_jacobian_is_that_of_the_torques_at_fixed_flow(closure):
    cell = system(PARAMS, GRID, closure=closure)
    torques = [term for term in cell.terms if term.kind == "torque" and term.name != "shear"]
    change = 1e-6 * np.exp(1j * np.linspace(0.0, 9.0, GRID.n_theta * GRID.n_z)).reshape(GRID.shape)
    with double():
        now = moment(cell, 0.5 * state())
        c, m = relaxation.jacobian(now, cell.terms)
        ends = [filaments.turned_by(now.beside(now.p + sign * change), torques) for sign in (1, -1)]
        found = np.asarray(c * change + m * jnp.conj(change))
        expected = np.asarray(0.5 * (ends[0] - ends[1]))
    assert np.abs(found - expected).max() < 1e-9 * np.abs(found).max()


def test_the_decaying_part_has_no_growth_and_keeps_what_has_none():
    """As 2 x 2 matrices: the symmetric part loses its positive eigenvalues, the rotation stays."""
    rng = np.random.default_rng(0)
    given = rng.normal(size=(50, 2, 2))
    c = 0.5 * (given[:, 0, 0] + given[:, 1, 1] + 1j * (given[:, 1, 0] - given[:, 0, 1]))
    m = 0.5 * (given[:, 0, 0] - given[:, 1, 1] + 1j * (given[:, 1, 0] + given[:, 0, 1]))
    with double():
        c, m = np.asarray(relaxation.decaying(jnp.asarray(c), jnp.asarray(m)))
    found = np.array([[(c + m).real, (m - c).imag], [(c + m).imag, (c - m).real]]).transpose(2, 0, 1)
    values, vectors = np.linalg.eigh(0.5 * (given + given.transpose(0, 2, 1)))
    kept = (vectors * np.minimum(values, 0.0)[:, None, :]) @ vectors.transpose(0, 2, 1)
    assert found == pytest.approx(kept + 0.5 * (given - given.transpose(0, 2, 1)), abs=1e-13)
    assert (values > 0).any(axis=1).any()
    assert (values < 0).all(axis=1).any()


@pytest.mark.parametrize("dealias", ["none", "cubic"])
def test_relaxed_inverts_both_factors(dealias):
    """(1 - τ D)(1 - τ L) of the result is what was given; a D that does not vary leaves no aliasing."""
    cell, tau = system(PARAMS, GRID, dealias=dealias), 3.0
    with double():
        local = jnp.asarray([[[-1.5 + 0.7j]], [[0.4 - 0.6j]]]) * jnp.ones((2, *cell.space.fine))
        given = jnp.asarray(cell.spectrum(state()))
        found = cell.relaxed(given, local, tau)
        field = cell.space.to_physical((1.0 - tau * cell.linear()) * found)
        back = field - tau * (local[0] * field + local[1] * jnp.conj(field))
        assert float(cell.size(cell.space.to_spectrum(back) * cell.space.keep - given)) < 1e-14


@pytest.mark.slow
def test_a_steady_state_is_kept():
    """At the fixed point α_p (1 - P²) = d_r steps grow beyond 300, and rounding stays near `atol`."""
    params = cy.Parameters(alpha_p=1.0, alpha_u=0.0, kappa=0.0, d_r=0.19)
    cell, P = system(params, GRID), cy.initial.unidirectional(GRID, 0.9)
    with double():
        now = start(cell, cell.spectrum(P), np.float64(0.0), METHOD)
        now = advance(cell, Control.of(1e-4, 1e-10, 1.01), now, np.float64(1e4), np.int64(200), METHOD)
        assert float(now.t) == 1e4
        assert float(now.h) > 300
        assert float(cell.size(now.spectrum - cell.spectrum(P))) < 1e-9


def run(t_end=6.0, **how):
    how = {"stepper": "multistep", "save_every": 2.0} | how
    return cy.simulate(cy.Parameters(), GRID, cy.initial.disordered(GRID, 100, seed=1), t_end, **how)


@pytest.mark.slow
def test_it_agrees_with_the_default_stepper_and_counts_its_right_hand_sides():
    found, exact = run(12.0, rtol=1e-6), run(12.0, stepper="adaptive", rtol=1e-8)
    assert np.abs(found.final_state - exact.final_state).max() < 1e-4
    effort = found.effort
    # Three steps of ETDRK4 begin, then one each; and one for the first N.
    assert effort.evaluations == 1 + effort.accepted + effort.rejected + 3 * 3


@pytest.mark.slow
def test_a_stopped_run_continues_bit_for_bit(tmp_path):
    whole = run(12.0)
    again = cy.resume(cy.load(cy.write(run(6.0), tmp_path / "half.nc")), t_end=12.0)
    assert np.array_equal(whole.final_state, again.final_state)
    assert whole.effort.evaluations == again.effort.evaluations
    assert whole.restart.progress.keys() >= {"past_times", "past_modes", "past_local"}


def test_runs_of_other_steppers_remember_nothing():
    assert not [name for name in run(1.0, stepper="adaptive").restart.progress if name.startswith("past")]


def test_an_event_leaves_no_past():
    """Earlier states of another right-hand side say nothing about the next step."""
    whole, changed = run(1.0), run(1.0, protocol=cy.Protocol(cy.change(at=1.0, alpha_u=0.9)))
    assert np.isfinite(whole.restart.progress["past_times"]).all()
    assert (changed.restart.progress["past_times"] == -np.inf).all()


@pytest.mark.slow
def test_events_and_ramps_are_those_of_the_default_stepper():
    """A cut, a jump and a ramp: the past is forgotten, and the run agrees with a finer one of ETDRK4."""
    protocol = cy.Protocol(
        cy.depolymerise(at=1.5, keep=0.4, where=cy.regions.disc(theta=3.0, z=2.0, radius=1.2)),
        cy.change(at=3.0, alpha_u=0.9),
        cy.change(at=4.0, over=1.0, d_s=0.1, alpha_p=0.6),
    )
    found, exact = (run(6.0, protocol=protocol, **how) for how in (
        {"rtol": 1e-6}, {"stepper": "adaptive", "rtol": 1e-9}
    ))  # fmt: skip
    assert np.abs(found.final_state - exact.final_state).max() < 3e-5
    assert [note.time for note in found.interventions] == [1.5]


def test_a_step_far_shorter_than_the_last_begins_anew():
    """N' has the error of the longer steps: without a new beginning no step were ever short enough."""
    cell = system(cy.Parameters(), GRID)
    with double():
        loose, strict = (Control.of(rtol, 1e-14, 1.01) for rtol in (1e-2, 1e-9))
        now = start(cell, cell.spectrum(cy.initial.disordered(GRID, 100, seed=1)), np.float64(0.0), METHOD)
        now = advance(cell, loose, now, np.float64(20.0), np.int64(1000), METHOD)
        later = advance(cell, strict, now, np.float64(20.5), np.int64(1000), METHOD)
    assert float(later.t) == 20.5
    assert not bool(later.failed)
    assert int(later.evaluations - now.evaluations) > int(later.accepted + later.rejected) - int(
        now.accepted + now.rejected
    )


def test_steps_rise_only_after_even_ones_and_at_most_by_half():
    with double():
        even, uneven, none = (
            multistep.Past(jnp.asarray(times), None, None)
            for times in ([0.0, -1.0, -2.0], [0.0, -0.7, -1.4], [0.0, -0.7, -np.inf])
        )
        assert [int(multistep.rise(past, 1.0, 1.0)) for past in (even, uneven, none)] == [1, 0, 1]
        assert float(multistep.longest(even, 1.0)) == 1.5
        assert float(multistep.longest(multistep.forget(even), 1.0)) == np.inf
        assert not bool(multistep.stale(multistep.forget(even), 1.0, 1e-6))


@pytest.mark.slow
def test_float32_runs_and_landing_on_uneven_times():
    times = (0.1, 0.13, 0.9, 2.0, 2.001, 5.0)
    found = run(5.0, save_at=times, precision="float32")
    exact = run(5.0, save_at=times, stepper="adaptive", rtol=1e-8)
    assert found.ok
    assert found.times.tolist() == list(times)
    assert np.abs(found.final_state - exact.final_state).max() < 2e-3


def test_models_without_a_local_part_refuse_it_in_a_sentence():
    grid = cy.CylinderGrid(16, 12, 5.0)
    for model in (cy.models.kinetic, cy.models.polar_model(concentration=True)):
        P = model.starts.make({"kind": "disordered", "seed": 1}, grid)
        with pytest.raises(cy.InputError, match="adaptive, etdrk4, rk4"):
            cy.simulate(model.parameters(), grid, P, 1.0, model=model, stepper="multistep")


@pytest.mark.slow
def test_it_can_be_mapped_over_cells():
    """Under vmap both kinds of step are computed and one is chosen: each cell as by itself."""
    cell, control = system(cy.Parameters(), GRID), Control.of(1e-4, 1e-10, 1.01)
    states = [cell.spectrum(cy.initial.disordered(GRID, 100, seed=seed)) for seed in (1, 2)]

    def end(Z):
        now = start(cell, Z, 0.0, METHOD)
        now = advance(cell, control, now, 1.0, 100, METHOD)
        return now.spectrum, now.evaluations

    with double():
        together = jax.vmap(end)(jnp.stack(states))
        for k, Z in enumerate(states):
            spectrum, evaluations = end(Z)
            assert int(evaluations) == int(together[1][k])
            assert float(cell.size(spectrum - together[0][k])) < 1e-12
