"""Travelling states of the kinetic model: residual, drift, symmetry, spectra, branches, refusals."""

import numpy as np
import pytest

import cyclosis as cy
import kinetic_oracle
from cyclosis.models.kinetic.theory import growth_rates, uniform_state
from cyclosis.stability.kinetic.line import Line, mirrored
from cyclosis.stability.kinetic.linear import Inverse, Linearised
from cyclosis.stability.kinetic.modes import leading
from measure import check, kinetic, kinetic_states
from measure.kinetic_states import FIGURE_4, MILD, state

GENERAL = kinetic.GENERAL


def random_state(line, size=0.3, seed=0):
    rng = np.random.default_rng(seed)
    a = rng.normal(size=(line.modes, line.k.size)) + 1j * rng.normal(size=(line.modes, line.k.size))
    return size * a / (np.arange(1, line.modes + 1)[:, None] ** 2 * (1 + line.k**2))


def dense(operator):
    shape = operator.columns.shape[:3]
    units = np.eye(np.prod(shape), dtype=complex).reshape(-1, *shape)
    return np.stack([operator(unit).ravel() for unit in units], axis=1)


@pytest.mark.slow
def test_the_state_moves_in_a_run_at_its_drift():
    check(kinetic_states.drift())


@pytest.mark.slow
def test_the_residual_vanishes_on_a_grid_of_angles():
    check(kinetic_states.oracle())
    wrong = kinetic_oracle.rate(state(48, 32).density(128)[:, None, :], dict(MILD.items()), 5.0)
    assert np.abs(wrong).max() > 1e-3, "without its drift the state is not at rest"


@pytest.mark.slow
def test_the_state_at_the_parameters_of_figure_4():
    check(kinetic_states.known())
    check(kinetic_states.drift(FIGURE_4, 96, 48, 1.0))
    found = state(64, 48, FIGURE_4)
    for axial_mode, slowest in ((0, -0.06189167), (1, -0.10333885)):
        spectrum = found.spectrum(4, axial_mode)
        assert spectrum.stable
        rest = [v for k, v in enumerate(spectrum.eigenvalues) if k != spectrum.rotation]
        assert rest[0].real == pytest.approx(slowest, abs=1e-7)


@pytest.mark.slow
def test_points_and_modes_converge():
    errors = []
    best = state(48, 32)
    for n, modes in ((16, 12), (24, 16), (32, 20)):
        found = state(n, modes)
        errors.append(abs(found.drift - best.drift))
        assert found.residual < 1e-11
        assert best.between < found.between
    assert errors[0] > 30 * errors[1] > 900 * errors[2], errors
    assert errors[2] < 1e-9


@pytest.mark.slow
def test_mirror_images_travel_the_other_way():
    right = state(24, 16)
    left = cy.kinetic.travelling_state(MILD, 24, 16, hand="left")
    assert right.P[0].mean() > 0.5 > -0.5 > left.P[0].mean()
    assert left.drift == pytest.approx(-right.drift, abs=1e-12)
    image = right.mirrored
    again = cy.kinetic.travelling_state(MILD, 24, 16, start=image)
    assert np.abs(again.moments - image.moments).max() < 1e-10
    assert again.u == pytest.approx(image.u, abs=1e-10)
    assert again.drift == pytest.approx(-right.drift, abs=1e-12)


@pytest.mark.slow
def test_a_start_that_is_given_is_used():
    right = state(24, 16)
    whole = right.state(cy.CylinderGrid(24, 8))
    again = cy.kinetic.travelling_state(MILD, 24, 16, start=whole, duration=0.5)
    assert again.drift == pytest.approx(right.drift, abs=1e-11)
    finer = cy.kinetic.travelling_state(MILD, 32, 20, start=right)
    assert finer.drift == pytest.approx(state().drift, abs=1e-11)


def test_torques_by_rates_are_doubled_couplings():
    half = MILD.replace(alpha_p=0.5 * MILD.alpha_p, alpha_u=0.5 * MILD.alpha_u)
    found = cy.kinetic.travelling_state(half, 24, 16, torques="rate")
    assert found.drift == pytest.approx(state(24, 16).drift, abs=1e-12)
    assert found.growth_rates(3) == pytest.approx(state(24, 16).growth_rates(3), abs=1e-9)


def test_the_linearisation_is_the_derivative_of_the_right_hand_side():
    line, h = Line(GENERAL, 16, 10), 1e-6
    a, d = random_state(line), random_state(line, seed=1)
    numbers = (line.rate(a + h * d) - line.rate(a - h * d)) / (2 * h) + 0.13 * line.slope(d)
    found = Linearised(line, a, 0.13)(np.stack([d, mirrored(d)]))
    assert np.abs(found[0] - numbers).max() < 1e-9
    assert np.abs(found[1] - mirrored(numbers)).max() < 1e-9


@pytest.mark.parametrize(
    "values", [{}, {"zero_theta_flux": True}, {"force_exponent": 1.0}], ids=["plain", "no flux", "force"]
)
def test_waves_along_the_cell_are_linearised_as_a_run_does(values):
    params, length, h = GENERAL.replace(**values), 4.0, 1e-6
    line, grid = Line(params, 16, 10), cy.CylinderGrid(16, 8, length)
    q = 2 * np.pi / length
    a, pair = random_state(line), np.stack([random_state(line, seed=1), random_state(line, seed=2)])
    found = Linearised(line, a, 0.0, q)(pair) @ line.waves.T
    wave = np.exp(1j * q * grid.z)
    plus, minus = (part @ line.waves.T for part in pair)
    change = np.zeros((11, *grid.shape), dtype=complex)
    change[1:] = plus[:, :, None] * wave + np.conj(minus[:, :, None] * wave)
    base = line.moments(a)[:, :, None] * np.ones(8)
    ends = [kinetic.right_hand_side(params, grid, base + sign * h * change) for sign in (1, -1)]
    rate = (ends[0] - ends[1])[1:] / (2 * h)
    assert np.abs((rate * np.conj(wave)).mean(axis=2) - found[0]).max() < 1e-8
    assert np.abs(np.conj((rate * wave).mean(axis=2)) - found[1]).max() < 1e-8


@pytest.mark.parametrize("q", [0.0, 0.7])
def test_the_solver_inverts_the_operator(q):
    line = Line(GENERAL, 16, 10)
    operator = Linearised(line, random_state(line), 0.13, q)
    pair = np.stack([random_state(line, seed=3), random_state(line, seed=4)])
    rows = [np.stack([random_state(line, seed=5), random_state(line, seed=6)])]
    for shift in (0.3, 0.3 + 0.2j):
        value = operator(pair) - shift * pair
        assert np.abs(Inverse(operator, shift)(value)[0] - pair).max() < 1e-12
        inverse = Inverse(operator, shift, rows, rows, [[0.4]])
        x, y = inverse(value + 0.5 * rows[0], [np.sum(rows[0] * pair) + 0.4 * 0.5])
        assert np.abs(x - pair).max() < 1e-11
        assert y[0] == pytest.approx(0.5, abs=1e-11)


@pytest.mark.parametrize("q", [0.0, 1.2])
def test_the_leading_growth_rates_are_those_of_the_whole_matrix(q):
    line = Line(MILD, 16, 8)
    operator = Linearised(line, random_state(line, 0.2), 0.1, q)
    every = np.linalg.eigvals(dense(operator))
    every = every[np.lexsort((-every.imag, -np.round(every.real, 9)))]
    found, vectors, reach = leading(operator, 8)
    assert np.abs(found - every[:8]).max() < 1e-9
    assert reach > np.abs(every[:8].imag).max()
    for value, vector in zip(found, vectors, strict=True):
        assert np.abs(operator(vector) - value * vector).max() < 1e-9


def test_without_the_answer_of_P_and_the_flow_everything_decays():
    """T is dissipative in the norm Σ|δ_n|²/n: its couplings are skew."""
    line, q = Line(GENERAL, 16, 10), 0.7
    operator = Linearised(line, random_state(line, 1.0), 0.3, q)
    operator.columns = np.zeros_like(operator.columns)
    weight = np.tile(np.repeat(np.arange(1, 11.0) ** -0.5, line.k.size), 2)
    matrix = weight[:, None] * dense(operator) / weight
    highest = np.linalg.eigvalsh(0.5 * (matrix + matrix.conj().T)).max()
    assert highest == pytest.approx(-GENERAL.d_r - GENERAL.d_s * q**2, abs=1e-12)


def test_about_a_uniform_state_the_growth_rates_are_those_of_its_matrix():
    params = GENERAL.replace(repulsion_angle=0.0)
    base, line = uniform_state(params, "z", 12), Line(params, 16, 12)
    a = np.where(line.k == 0, 1.0, 0.0) * base[1:, None]
    for q in (0.0, 0.9):
        exact = np.concatenate([growth_rates(params, base, int(m), q) for m in line.k])
        exact = exact[np.argsort(-exact.real)][:6]
        found = leading(Linearised(line, a, 0.0, q), 6)[0]
        assert np.sort(found.real) == pytest.approx(np.sort(exact.real), abs=1e-9)


@pytest.mark.slow
@pytest.mark.parametrize(("axial_mode", "number"), [(0, 0), (0, 2), (1, 0)])
def test_modes_grow_in_runs_as_the_spectrum_says(axial_mode, number):
    check(kinetic_states.mode(axial_mode, number))


def test_the_rotation_is_named_and_is_neutral():
    spectrum = state(32, 20).spectrum(4)
    assert abs(spectrum.eigenvalues[spectrum.rotation]) < 1e-11
    assert spectrum.stable
    slope = state(32, 20).spectrum(4).P[spectrum.rotation]
    assert np.abs(slope.imag).max() < 1e-6, "the derivative of the state is real"
    assert state().spectrum(2, axial_mode=1).rotation is None


def test_a_branch_ends_where_uniform_order_becomes_unstable():
    check(kinetic_states.vanishing())


def test_a_branch_goes_through_its_start_and_to_its_bounds():
    start = state(24, 16)
    branch = cy.kinetic.continuation(start, "alpha_u", (0.45, 0.55), count=2, longest=0.3)
    assert branch.parameter[branch.start] == MILD.alpha_u
    assert branch.states[branch.start].drift == pytest.approx(start.drift, abs=1e-11)
    assert sorted(branch.parameter[[0, -1]]) == pytest.approx([0.45, 0.55], abs=1e-9)
    assert all(found.residual < 1e-11 for found in branch.states)
    last = branch.states[-1]
    again = cy.kinetic.travelling_state(last.params, 24, 16)
    assert again.drift == pytest.approx(last.drift, abs=1e-10)
    assert branch.eigenvalues[-1] == pytest.approx(
        [v for k, v in enumerate(again.spectrum(3).eigenvalues) if k != again.spectrum(3).rotation], abs=1e-8
    )
    assert "End at alpha_u = 0.55: this is the end of the range." in str(branch)


REFUSED = [
    ({"d_r": 0.0}, {}, "d_r = 0.0 .* above 0"),
    ({"alpha_p": 0.01, "alpha_u": 0.01}, {"duration": 300.0}, "do not stay polarised"),
    ({"alpha_p": 0.5, "d_s": 0.1}, {"duration": 300.0}, "relax to a uniform state"),
    ({"alpha_p": np.ones((16, 8))}, {}, "alpha_p .* one number"),
    ({}, {"torques": "both"}, "one of literal, rate"),
    ({}, {"hand": "up"}, "one of left, right"),
    ({}, {"start": np.ones(3)}, "TravellingState or moments"),
    ({}, {"start": "stripes"}, "TravellingState or moments"),
    ({}, {"n_theta": 8}, "from 16"),
]


@pytest.mark.parametrize(("values", "settings", "words"), REFUSED, ids=[str(row[2]) for row in REFUSED])
def test_what_cannot_be_is_refused(values, settings, words):
    params = MILD.replace(**values)
    with pytest.raises(cy.InputError, match=words):
        cy.kinetic.travelling_state(params, **{"n_theta": 16, "modes": 12} | settings)


def test_what_a_branch_cannot_follow_is_refused():
    start = state(24, 16)
    for arguments, words in (
        ((start.P, "kappa", (0.0, 1.0)), "TravellingState"),
        ((start, "seed", (0.0, 1.0)), "one of alpha_p"),
        ((start, "kappa", (0.5, 1.0)), "a range that holds kappa = 0.1"),
        ((start, "kappa", (1.0, 0.0)), "low < high"),
        ((start, "kappa", 1.0), "two numbers"),
    ):
        with pytest.raises(cy.InputError, match=words):
            cy.kinetic.continuation(*arguments)
