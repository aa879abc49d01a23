"""Conservation laws and symmetries, for random states and parameters."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import cyclosis as cy
import oracle
from measure import furthest, laws

few = settings(max_examples=12, derandomize=True, deadline=None)
fewer = settings(max_examples=4, derandomize=True, deadline=None)
seeds = st.integers(0, 2**32 - 1)
kinds = st.sampled_from(["smooth", "rough"])
cubic = st.just(2.0)
oblique = st.floats(0.2, 1.3)
axes = st.sampled_from([0, 1])


@st.composite
def cells(draw, angle=oblique, exponent=cubic):
    """Parameters with all terms at work."""
    between = {
        "alpha_p": (0.1, 1.0), "alpha_u": (0.1, 1.0), "d_s": (0.04, 0.1), "d_r": (0.0, 0.2),
        "kappa": (0.1, 1.0), "mu": (0.01, 1.0), "epsilon": (0.05, 1.0),
    }  # fmt: skip
    values = {name: draw(st.floats(*range_)) for name, range_ in between.items()}
    return cy.Parameters(
        **values, repulsion_angle=draw(angle), zero_theta_flux=draw(st.booleans()),
        force_exponent=draw(exponent),
    )  # fmt: skip


@few
@given(cells(exponent=st.sampled_from([0.0, 1.0, 1.7, 2.0, 4.0])), seeds, kinds)
def test_flow_is_incompressible_balanced_and_closed(p, seed, kind):
    """∇·u = 0, <F·u> = μ <|∇u|²> + <|u|²>, <u_z> = 0, and <u_theta> as chosen; on any state."""
    P = laws.state(seed, kind)
    assert laws.divergence(p, P) < laws.ROUNDING
    assert laws.budget_defect(p, P) < laws.ROUNDING
    assert laws.reported_budget_defect(p, P) < laws.ROUNDING
    assert laws.axial_flux(p, P) < laws.ROUNDING
    assert laws.theta_flux_defect(p, P) < laws.ROUNDING


def test_flux_options_differ_by_a_uniform_flow_around_the_axis():
    P = laws.state(0)
    free = cy.flow(laws.parameters(), laws.GRID, P)
    held = cy.flow(laws.parameters(zero_theta_flux=True), laws.GRID, P)
    F = oracle.force(laws.parameters(), P)
    assert abs(F[0].mean()) > 1e-3
    np.testing.assert_allclose(free[0] - held[0], F[0].mean(), atol=1e-14)
    np.testing.assert_allclose(free[1], held[1], atol=1e-15)


@few
@given(cells(), seeds, kinds, st.tuples(st.integers(0, 31), st.integers(0, 27)))
def test_translations_by_grid_points(p, seed, kind, by):
    P = laws.state(seed, kind)
    assert laws.flow_covariance(p, P, lambda f: laws.shifted(f, by)) < laws.ROUNDING
    assert laws.rate_covariance(p, P, lambda f: laws.shifted(f, by)) < laws.ROUNDING


@few
@given(cells(), seeds, st.tuples(st.floats(-3, 3), st.floats(-3, 3)))
def test_translations_by_any_distance(p, seed, by):
    """Between grid points too, where the state is resolved."""
    P = laws.state(seed)
    assert laws.flow_covariance(p, P, lambda f: laws.slid(f, by)) < laws.ROUNDING
    assert laws.rate_covariance(p, P, lambda f: laws.slid(f, by)) < laws.ROUNDING


@few
@given(cells(angle=st.sampled_from([0.0, np.pi / 2])), seeds, kinds, axes)
def test_reflections_hold_for_d_along_an_axis(p, seed, kind, axis):
    P = laws.state(seed, kind)
    assert laws.flow_covariance(p, P, laws.mirror(axis)) < laws.ROUNDING
    assert laws.rate_covariance(p, P, laws.mirror(axis)) < laws.ROUNDING


@few
@given(cells(), seeds, kinds, axes)
def test_reflections_fail_for_tilted_d(p, seed, kind, axis):
    """A tilted d has a handedness: only with d reflected as well is it the same physics."""
    P = laws.state(seed, kind)
    image = p.replace(repulsion_angle=-p.repulsion_angle)
    assert laws.rate_covariance(p, P, laws.mirror(axis)) > 1e-4
    assert laws.rate_covariance(p, P, laws.mirror(axis), image) < laws.ROUNDING
    assert laws.flow_covariance(p, P, laws.mirror(axis)) < laws.ROUNDING


@few
@given(cells(), seeds, kinds)
def test_half_turn_of_the_surface(p, seed, kind):
    """x -> -x with P -> -P: a line d has no sign, so that this holds for every d."""
    P = laws.state(seed, kind)
    assert laws.flow_covariance(p, P, laws.turned) < laws.ROUNDING
    assert laws.rate_covariance(p, P, laws.turned) < laws.ROUNDING


@few
@given(cells(), seeds, kinds)
def test_reversal_of_polarity_alone_is_no_symmetry(p, seed, kind):
    """P -> -P reverses the flow, but not advection and shear, which are even in P."""
    P = laws.state(seed, kind)
    assert laws.flow_covariance(p, P, np.negative) < laws.ROUNDING
    assert laws.rate_covariance(p, P, np.negative) > 1e-4
    assert laws.rate_covariance(p.replace(epsilon=0.0), P, np.negative) < laws.ROUNDING


@fewer
@given(cells(angle=st.just(0.0)), seeds)
def test_runs_commute_with_the_symmetries(p, seed):
    P = laws.state(seed)
    for change in (lambda f: laws.shifted(f, (5, 3)), laws.mirror(0), laws.mirror(1), laws.turned):
        assert laws.run_covariance(p, P, change) < 1e-11


@fewer
@given(cells(), seeds)
@pytest.mark.slow
def test_runs_by_the_default_stepper_commute_with_translations(p, seed):
    """Step control sees norms only, so that the same steps are taken."""
    P = laws.state(seed)
    first = cy.simulate(p, laws.GRID, P, t_end=4.0, save_at=(4.0,)).final_state
    second = cy.simulate(p, laws.GRID, laws.shifted(P, (5, 3)), t_end=4.0, save_at=(4.0,)).final_state
    assert furthest(second, laws.shifted(first, (5, 3))) < 1e-11


@fewer
@given(cells(), seeds, st.sampled_from([0.0, 0.05]))
def test_order_never_exceeds_one(p, seed, d_r):
    """|P| <= 1 is invariant: (I - PP) removes all growth along P where |P| = 1."""
    P = laws.state(seed, largest=1.0)
    assert laws.overshoot(p.replace(d_r=d_r), P) < 1e-7


@few
@given(cells(), seeds)
def test_a_torque_turns_full_order_and_leaves_its_length(p, seed):
    """Where |P| = 1 no torque has a part along P: only the rates add to the budget of order."""
    phases = laws.state(seed)[0]
    budget = cy.diagnose(p, laws.GRID, np.stack([np.cos(phases), np.sin(phases)]))["budget"]
    sizes = {name: abs(budget[name]) for name in ("shear", "bundling", "flow_alignment", "repulsion")}
    assert max(sizes.values()) < 1e-12, sizes
    assert budget["rotational_diffusion"] == pytest.approx(-p.d_r, abs=1e-12)


@few
@given(cells(), seeds)
def test_term_budget_adds_up(p, seed):
    """The terms' contributions to d/dt <|P|²>/2 add up to <P·dP/dt>, and to what a run shows."""
    P = laws.state(seed)
    assert laws.term_budget_defect(p, P) < laws.ROUNDING
    assert laws.growth_of_order_defect(p, P) < 1e-5


@few
@given(cells(), seeds)
def test_diagnostics_are_what_they_say(p, seed):
    """Every quantity from its definition, by plain means over the surface."""
    grid, P = laws.GRID, laws.state(seed)
    found = cy.diagnose(p, grid, P)
    u, F, each = oracle.flow(p, grid.length, P), oracle.force(p, P), oracle.terms(p, grid.length, P)
    expected = {
        "order": np.sqrt(np.mean(np.sum(P**2, axis=0))),
        "max_P": np.hypot(*P).max(),
        "peak_speed": np.hypot(*u).max(),
        "rms_speed": np.sqrt(np.mean(np.sum(u**2, axis=0))),
        "pressure_gradient": F[1].mean(),
        "power_input": np.mean(np.sum(F * u, axis=0)),
        "viscous_dissipation": p.mu * sum(np.mean(s**2) for c in u for s in oracle.gradient(c, grid.length)),
        "friction_dissipation": np.mean(np.sum(u**2, axis=0)),
        "rate_of_change": np.sqrt(np.mean(np.sum(sum(each.values()) ** 2, axis=0))),
    }
    for name, value in expected.items():
        assert found[name] == pytest.approx(value, rel=1e-11, abs=1e-13), name
    np.testing.assert_allclose(found["mean_P"], P.mean(axis=(1, 2)), atol=1e-14)
    assert abs(found["net_flux"]) < 1e-15
    assert found["spectral_tail"] < 1e-13
    for name, term in each.items():
        assert found["budget"][name] == pytest.approx(np.mean(np.sum(P * term, axis=0)), abs=1e-13), name
    spectra = cy.spectra(grid, P)
    assert spectra["azimuthal"].sum() == pytest.approx(expected["order"] ** 2, rel=1e-13)
    assert spectra["axial"].sum() == pytest.approx(expected["order"] ** 2, rel=1e-13)


def test_spectral_tail_is_the_share_of_amplitude_beyond_two_thirds():
    grid = laws.GRID
    theta, z = grid.theta[:, None], 2 * np.pi * grid.z[None, :] / grid.length
    for m, j, counted in ((10, 0, False), (11, 0, True), (0, 8, False), (0, 9, True), (11, 9, True)):
        P = np.zeros((2, *grid.shape))
        P[1] = 0.4 * np.cos(theta) + 0.3 * np.cos(m * theta + j * z)
        tail = cy.diagnose(cy.Parameters(), grid, P)["spectral_tail"]
        assert tail == pytest.approx(0.6 if counted else 0.0, abs=1e-12), (m, j)


@pytest.mark.slow
@fewer
@given(cells(), seeds)
def test_single_precision_follows_double_precision(p, seed):
    assert laws.precision_defect(p, laws.state(seed)) < 1e-5


def test_exact_steady_states_stay_and_do_not_end_a_run():
    """Total disorder and the uniform ordered state do not change; a run ends early only where asked to."""
    p, order = laws.parameters(), np.sqrt(1 - 0.05 / 0.7)
    for P in (np.zeros((2, *laws.GRID.shape)), cy.initial.unidirectional(laws.GRID, order)):
        run = cy.simulate(p, laws.GRID, P, **laws.RUN)
        assert (run.status, run.t_final) == ("completed", laws.RUN["t_end"])
        np.testing.assert_allclose(run.final_state, P, atol=1e-14)


@pytest.mark.parametrize("dealias", ["none", "full"])
def test_nyquist_modes_stay_empty(dealias):
    """In either direction, whatever the wavenumber in the other: fused transport feeds none of them."""
    P = laws.state(0, "rough")
    rate = cy.rate_of_change(laws.parameters(), laws.GRID, P, dealias=dealias)
    spectrum = np.fft.fft2(rate, norm="forward")
    n_theta, n_z = laws.GRID.shape
    largest = np.abs(spectrum).max()
    assert np.abs(spectrum[:, n_theta // 2]).max() < 1e-14 * largest
    assert np.abs(spectrum[:, :, n_z // 2]).max() < 1e-14 * largest
