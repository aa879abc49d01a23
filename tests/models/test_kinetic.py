"""The kinetic model: a reference, closed forms, growth rates, conservation, symmetries, files, refusals."""

import itertools

import h5py
import numpy as np
import pytest

import cyclosis as cy
from cyclosis import config
from cyclosis.model.regions import disc
from cyclosis.models.kinetic.model import kinetic_model
from measure import check, kinetic
from measure.kinetic import GENERAL, GRID, KINETIC, MODES, right_hand_side, run, smooth


@pytest.mark.slow
def test_the_reference_of_an_independent_program():
    """Two programs made the file: see the README beside it."""
    check(kinetic.reference(32, 24, (0.5,)))


@pytest.mark.slow
def test_the_reference_at_all_times():
    check(kinetic.reference(48, 32, (0.5, 2.0, 6.0)))


def test_moments_of_a_density_and_back():
    psi = cy.kinetic.density(smooth(modes=40))
    assert np.abs(cy.kinetic.moments(psi, 40) - smooth(modes=40)).max() < 1e-14
    phi = 2 * np.pi / psi.shape[2] * np.arange(psi.shape[2])
    c = psi.mean(axis=2) * 2 * np.pi
    assert np.abs(c - 1).max() < 1e-14
    P = 2 * np.pi * np.mean(psi[None] * np.array([np.cos(phi), np.sin(phi)])[:, None, None], axis=3)
    assert np.abs(cy.kinetic.order(smooth(modes=40)) - P).max() < 1e-14


def test_states_that_are_steady():
    """Uniform states and the nematic one do not change."""
    for direction in ("z", "theta", "nematic"):
        params = GENERAL.replace(repulsion_angle=0.0, alpha_p=0.9)
        m = cy.kinetic.uniform_state(params, direction, 40)
        whole = np.broadcast_to(m[:, None, None], (41, *GRID.shape)).copy()
        assert np.abs(right_hand_side(params, GRID, whole)).max() < 1e-10, direction
    fields = GENERAL.replace(alpha_p=0.0, alpha_u=0.0, d_s=0.0, kappa=0.3 * np.ones(GRID.shape))
    assert np.abs(right_hand_side(fields, GRID, cy.kinetic.nematic(fields, GRID, 40))).max() < 1e-12


@pytest.mark.slow
def test_order_without_repulsion_is_that_of_von_mises():
    check(kinetic.uniform_orders())
    found = abs(cy.kinetic.uniform_state(cy.Parameters(alpha_p=0.5, d_r=0.05, kappa=0.0))[1])
    assert found == pytest.approx(0.945542186423298, abs=1e-13)


def test_thresholds_are_where_growth_rates_vanish():
    check(kinetic.thresholds())


@pytest.mark.parametrize("case", kinetic.WAVES, ids=str)
def test_waves_grow_in_runs_as_the_matrix_says(case):
    check(kinetic.wave(*case))


def test_the_concentration_is_conserved_and_becomes_even():
    check(kinetic.conserved())
    uneven = smooth() * (1 + 0.3 * np.cos(GRID.theta)[:, None])
    frames = run(uneven, 4.0, stepper="etdrk4", dt=0.02, save_every=1.0).frames
    assert all(np.ptp(b[0].real) < np.ptp(a[0].real) for a, b in itertools.pairwise(frames))


@pytest.mark.slow
@pytest.mark.parametrize("stepper", ["etdrk4", "rk4"])
def test_orders_in_time(stepper):
    check(kinetic.order_in_time(stepper))


def test_rotating_the_cell_or_turning_it_over_changes_nothing():
    m = smooth()
    rate = right_hand_side(GENERAL, GRID, m)
    shifted = right_hand_side(GENERAL, GRID, np.roll(m, (3, 5), axis=(1, 2)))
    assert np.abs(shifted - np.roll(rate, (3, 5), axis=(1, 2))).max() < 1e-14
    # A half turn: (theta, z) -> (-theta, -z) and p -> -p, so that m_n -> (-1)^n m_n.
    sign = (-1.0) ** np.arange(len(m))[:, None, None]

    def turned(field):
        return sign * np.roll(field[:, ::-1, ::-1], (1, 1), axis=(1, 2))

    assert np.abs(right_hand_side(GENERAL, GRID, turned(m)) - turned(rate)).max() < 1e-13


def test_aligned_filaments_follow_the_polar_model():
    """In the limit of full alignment the closure is exact: the difference goes with 1 - |P|."""
    differences = []
    for width in (0.1, 0.05, 0.025):
        angle = 0.5 * np.pi + 0.3 * np.cos(GRID.theta)[:, None] * np.ones(GRID.shape)
        n = np.arange(81)[:, None, None]
        m = np.exp(1j * n * angle - 0.5 * n**2 * width**2)  # wrapped normal
        params = GENERAL.replace(d_r=0.0, d_s=0.0)
        P = cy.kinetic.order(m)
        kinetic = right_hand_side(params, GRID, m)[1]
        polar = cy.rate_of_change(params, GRID, P)
        differences.append(np.abs(kinetic - (polar[0] + 1j * polar[1])).max())
        assert differences[-1] < 6 * (1 - np.hypot(*P)).max()
    ratios = np.array(differences[:-1]) / differences[1:]
    assert ratios[1] == pytest.approx(4.0, rel=0.01), "1 - |P| goes with the square of the width"
    assert abs(ratios[1] - 4) < abs(ratios[0] - 4)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("rest", "expected"), [(0.1, 0.24804), (0.025, 0.17702), (0.00625, 0.05260), (0.003125, 0.02680)]
)
def test_the_curve_of_the_aligned_limit(rest, expected):
    """The difference of dP/dt from the closure's, over that: docs/theory_kinetic.md has the curve."""
    grid, params = cy.CylinderGrid(24, 24), cy.Parameters(d_s=0.0, d_r=0.0)
    wave = grid.theta[:, None] - 2 * np.pi / 5 * grid.z
    angle = 1.2 + 0.4 * np.sin(grid.theta)[:, None] + 0.3 * np.cos(wave)
    P = (1 - rest) * np.stack([np.cos(angle), np.sin(angle)])
    m = cy.kinetic.dressed(P, int(16 / np.sqrt(rest)) + 32)
    polar = cy.rate_of_change(params, grid, P)
    change = right_hand_side(params, grid, m)[1] - (polar[0] + 1j * polar[1])
    found = np.sqrt(np.mean(np.abs(change) ** 2) / np.mean(np.sum(polar**2, axis=0)))
    assert found == pytest.approx(expected, abs=2e-5)


@pytest.mark.slow
def test_torques_by_rates_grow_from_isotropy_as_the_paper_s_words_say():
    params = cy.Parameters(alpha_p=0.4, d_r=0.05, kappa=0.0)
    m = cy.kinetic.dressed(cy.initial.unidirectional(GRID, 1e-5), 12)
    for torques, rate in (("literal", 0.5 * 0.4 - 0.05), ("rate", 0.4 - 0.05)):
        found = cy.simulate(params, GRID, m, 2.0, model=kinetic_model(12, torques), rtol=1e-9, atol=1e-16)
        grown = np.log(found.records["order"][-1] / found.records["order"][0]) / 2
        assert grown == pytest.approx(rate, rel=1e-6)


def test_all_moments_of_a_few_filaments_vary_alike():
    """m_n of N independent angles: real and imaginary parts have the variance 1/(2N), and no covariance."""
    m = cy.kinetic.disordered(cy.CylinderGrid(64, 64), 50, seed=4)
    for n in range(1, 9):
        for part in (m[n].real, m[n].imag):
            assert part.var() == pytest.approx(0.01, rel=0.1), n
        assert abs(np.mean(m[n] ** 2)) < 1.5e-3
        assert abs(np.mean(m[n] * np.conj(m[n % 8 + 1]))) < 1.5e-3


def test_one_seed_starts_both_models_alike():
    P = cy.initial.disordered(GRID, seed=7, noise_grid=(16, 16))
    m = cy.kinetic.disordered(GRID, seed=7, noise_grid=(16, 16))
    assert np.array_equal(cy.kinetic.order(m), P)
    m = cy.kinetic.disordered(GRID, seed=7)
    assert not np.any(m[9:])
    assert np.std(m[2:9].real) == pytest.approx(np.sqrt(0.5 / 1000), rel=0.1)


PROTOCOL = cy.Protocol(
    cy.change(at=1.0, over=1.0, alpha_p=0.2, d_r=0.1),
    cy.depolymerise(at=2.5, where=disc(theta=3.0, z=2.0, radius=0.8), keep=0.3),
    cy.align(at=3.0, angle=1.0, magnitude=0.8, where=disc(theta=1.0, z=2.0, radius=0.8)),
    cy.noise(at=3.5, size=0.02),
    cy.fragment(at=4.0, where=disc(theta=5.0, z=1.0, radius=0.8)),
    seed=3,
)


LATER = pytest.mark.slow


@pytest.mark.parametrize("t_half", [pytest.param(1.0, marks=LATER), 3.0, pytest.param(4.0, marks=LATER)])
@pytest.mark.slow
def test_a_run_goes_on_bit_for_bit_through_a_file(tmp_path, t_half):
    whole = run(smooth(), 5.0, protocol=PROTOCOL, save_every=0.5)
    with cy.RunWriter(tmp_path / "half.nc") as writer:
        half = run(
            smooth(), t_half, protocol=PROTOCOL, save_every=0.5, checkpoint=writer, checkpoint_seconds=0.0
        )
        writer.finish(half)
    cy.resume_file(tmp_path / "half.nc", 5.0)
    stored = cy.load(tmp_path / "half.nc")
    assert stored.model is KINETIC
    assert np.array_equal(stored.final_state, whole.final_state)
    assert all(np.array_equal(a, b) for a, b in zip(stored.frames, whole.frames, strict=True))
    assert all(
        np.array_equal(a.after, b.after)
        for a, b in zip(stored.interventions, whole.interventions, strict=True)
    )


def test_actions_do_to_P_what_they_do_in_the_polar_model():
    found = run(smooth(), 5.0, protocol=PROTOCOL)
    scar, cable, _, broken = found.interventions
    assert np.allclose(np.abs(scar.after[0]), 1.0)
    inside = disc(theta=3.0, z=2.0, radius=0.8).mask(GRID)
    assert np.allclose(scar.after[1:, inside], 0.3 * scar.before[1:, inside])
    assert np.array_equal(scar.after[:, ~inside], scar.before[:, ~inside])
    inside = disc(theta=1.0, z=2.0, radius=0.8).mask(GRID)
    assert np.allclose(cable.after[1, inside], 0.8 * np.exp(1j))
    inside = disc(theta=5.0, z=1.0, radius=0.8).mask(GRID)
    assert not np.any(broken.after[9:, inside])


def test_a_file_holds_what_is_asked_of_it(tmp_path):
    found = run(smooth(), 2.0, save_every=1.0)
    path = cy.write(found, tmp_path / "kinetic.nc")
    with cy.open_dataset(path) as data:
        assert data["moments"].dims == ("time", "part", "moment", "theta", "z")
        P = cy.kinetic.order(found.final_state)
        assert np.array_equal(data["P"][-1], P)
        m = data["moments"][-1].values
        assert np.array_equal(m[0] + 1j * m[1], found.final_state)
        assert np.allclose(data["Q"][-1].values, [m[0, 2], m[1, 2]])
        assert np.allclose(data["c"], 1.0)
        flow = cy.flow(GENERAL, GRID, P)
        assert np.abs(data["u"][-1].values - flow).max() < 1e-13
        assert data["P"].values.shape[1:] == (2, *GRID.shape)
    tables = {
        "model": {"kind": "kinetic", "modes": MODES},
        "grid": {"n_theta": 16, "n_z": 12, "length": 4.0},
        "initial": {"kind": "file", "path": str(path)},
    }
    again = config.setup(config.check(tables))
    assert np.allclose(again.state, found.final_state, atol=1e-14)
    assert again.model.options == {"modes": MODES, "torques": "literal"}


def test_too_few_modes_are_noticed_by_name():
    params = cy.Parameters(d_s=0.2, d_r=0.01, alpha_p=2.0)
    state = cy.kinetic.dressed(cy.initial.unidirectional(GRID, 0.9), 8)
    found = run(state, 30.0, params, save_every=1.0)
    assert found.status == "underresolved", found.message
    assert "angular" in found.message or "density" in found.message


@pytest.mark.slow
def test_the_step_does_not_blow_up_where_fixed_steps_did():
    grid = cy.CylinderGrid(32, 8)
    state = cy.kinetic.dressed(cy.initial.stripes(grid, magnitude=0.9), 40)
    for values in ({"alpha_p": 1.0, "alpha_u": 1.0}, {"alpha_p": 2.0, "alpha_u": 1.0}):
        found = run(state, 20.0, cy.Parameters(**values), grid, save_every=20.0)
        assert found.status != "diverged", found.message
        assert np.all(np.isfinite(found.final_state))


@pytest.mark.slow
def test_members_of_an_ensemble():
    starts = [lambda s=s: cy.kinetic.disordered(GRID, seed=s, modes=16) for s in (0, 1)]
    members = [cy.ensemble.Member(GENERAL, GRID, start, model=KINETIC) for start in starts]
    how = cy.ensemble.EnsembleSettings(t_end=3.0, finish="t_end", rtol=1e-3)
    outcomes = cy.ensemble.follow(members, how)
    assert [outcome.status for outcome in outcomes] == ["completed", "completed"]
    assert outcomes[0].regime in cy.REGIMES
    assert outcomes[0].state.shape == (17, *GRID.shape)


@pytest.mark.slow
def test_a_sweep_of_the_kinetic_model():
    tables = {
        "model": {"kind": "kinetic", "modes": 12},
        "axes": {"alpha_p": {"values": [0.2, 0.9]}},
        "grid": {"n_theta": 8, "n_z": 8},
        "parameters": {"d_r": 0.1, "d_s": 0.1},
        "run": {"t_end": 4.0},
        "ensemble": {"seeds": 2},
    }
    from cyclosis.sweep.store.block import compute

    sweep = cy.Sweep.from_tables(tables)
    assert sweep.settings.finish == "t_end"
    assert sweep.tables["model"] == {"kind": "kinetic", "modes": 12, "torques": "literal"}
    arrays = compute(sweep, 0)
    assert arrays["order"].shape == (4,)
    assert np.all(np.isfinite(arrays["profile"]))
    with pytest.raises(cy.InputError, match="t_end with the model kinetic"):
        cy.Sweep.from_tables(tables | {"run": {"finish": "certified"}})


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda m: cy.kinetic.order(m), "complex"),
        (lambda m: m[:2], "complex"),
        (lambda m: m[:, :-1], "complex"),
        (lambda m: np.where(np.arange(len(m))[:, None, None] == 1, 1.5, m), "at most 1"),
        (lambda m: m * np.nan, "finite"),
        (lambda m: -m, "real and positive"),
    ],
)
def test_states_that_are_not_kinetic_are_refused_in_a_sentence(change, words):
    with pytest.raises(cy.InputError, match=words):
        run(change(smooth()), 1.0)


def test_a_state_of_the_other_model_is_refused_either_way():
    with pytest.raises(cy.InputError, match="real numbers"):
        cy.simulate(GENERAL, GRID, smooth(), 1.0)


def test_densities_that_are_none_are_refused():
    psi = cy.kinetic.density(smooth())
    with pytest.raises(cy.InputError, match="at least 0 everywhere"):
        cy.kinetic.moments(psi - psi.max(), 8)
    with pytest.raises(cy.InputError, match="more than 100 angles"):
        cy.kinetic.moments(psi, 50)
    with pytest.raises(cy.InputError, match=r"at most 0\.999999"):
        cy.kinetic.dressed(cy.initial.unidirectional(GRID, 1.0))


def test_a_file_that_was_cut_is_refused(tmp_path):
    path = cy.write(run(smooth(), 1.0), tmp_path / "cut.nc")
    with h5py.File(path, "a") as file:
        del file["Q"]
    with pytest.raises(cy.InputError):
        cy.load(path)


@pytest.mark.parametrize("name", kinetic.CASES)
def test_one_right_hand_side_against_the_density_on_a_grid_of_angles(name):
    check(kinetic.against_the_oracle(name))


def test_a_sweep_refuses_a_file_that_changed_since_it_was_planned(tmp_path):
    grid, path = cy.CylinderGrid(8, 8), tmp_path / "state.npy"
    np.save(path, cy.initial.stripes(grid, magnitude=0.5))
    sweep = cy.Sweep.from_tables(
        {
            "model": {"kind": "kinetic", "modes": 12},
            "axes": {"alpha_p": {"values": [0.2, 0.9]}},
            "grid": {"n_theta": 8, "n_z": 8},
            "initial": {"kind": "file", "path": str(path)},
        }
    )
    assert sweep.build(0).state().shape == (13, 8, 8)
    np.save(path, cy.initial.stripes(grid, magnitude=0.4))
    with pytest.raises(cy.InputError, match="the file with which the sweep was planned"):
        sweep.build(0).state()


def test_a_term_of_the_user_acts_on_the_moments():
    """Tumbling at a rate r, as if every filament took a new direction: m_n decays by r for n >= 1."""
    rate = 0.3

    def tumbling(t, m, u, params, grid):
        return m.at[0].set(0.0) * -rate

    params = cy.Parameters(alpha_p=0.0, alpha_u=0.0, kappa=0.0, epsilon=0.0)
    m = cy.kinetic.dressed(cy.initial.unidirectional(GRID, 0.5), 8)
    terms = [*cy.TERMS, tumbling]
    found = cy.simulate(params, GRID, m, 1.0, rtol=1e-9, terms=terms, model=KINETIC).final_state
    n = np.arange(9)[:, None, None]
    expected = m * np.where(n == 0, 1.0, np.exp(-(rate + params.d_r * n**2)))
    assert np.abs(found - expected).max() < 1e-9


def test_a_term_of_another_shape_is_refused():
    def order_only(t, m, u, params, grid):
        return m[1]

    m = cy.kinetic.disordered(GRID, modes=8)
    with pytest.raises(cy.InputError, match=r"the term order_only = .* one for every m_n"):
        cy.simulate(cy.Parameters(), GRID, m, 1.0, terms=[order_only], model=KINETIC)


@pytest.mark.slow
def test_too_few_angular_modes_call_for_more_modes():
    grid = cy.CylinderGrid(48, 1)
    m = cy.kinetic.dressed(cy.initial.stripes(grid), 12)
    run = cy.simulate(cy.Parameters(), grid, m, 12.0, model=KINETIC)
    assert run.status == "underresolved"
    assert run.message.endswith("; use more angular modes.")


@pytest.mark.slow
def test_the_default_number_of_modes_is_enough_at_the_papers_parameters():
    """Steps of the default accuracy leave 1e-4 in the last mode, which is not too few modes."""
    grid = cy.CylinderGrid(48, 1)
    ends = []
    for modes in (48, 64):
        m = cy.kinetic.disordered(grid, filaments_per_square=1e5, seed=0, modes=modes)
        run = cy.simulate(cy.Parameters(), grid, m, 40.0, rtol=1e-7, model=KINETIC)
        assert run.status == "completed", run.message
        ends.append(cy.kinetic.order(run.final_state))
    assert np.abs(ends[0] - ends[1]).max() < 1e-7
    assert np.hypot(*ends[0]).mean() > 0.9
