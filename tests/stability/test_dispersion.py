"""Closed forms of growth about uniform states, against the derivative of the simulation's right-hand side."""

import jax
import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

import cyclosis as cy
from cyclosis.model.spectral import unpack
from cyclosis.model.system import system
from cyclosis.stability.dispersion_table import dispersion_table
from cyclosis.stability.uniform import dispersion, uniform

GRID = cy.CylinderGrid(16, 12, 5.0)
MODES = ((0, 0), (1, 0), (2, 0), (0, 1), (0, -2), (1, 1), (1, -1), (2, 3), (3, -2))
CELLS = {
    "paper": cy.Parameters(),
    "fast flow, weak order": cy.Parameters(
        alpha_p=0.12, alpha_u=0.8, epsilon=0.7, d_s=0.02, d_r=0.04, kappa=0.3, mu=0.2
    ),
    "zero mean u_theta": cy.Parameters(alpha_p=0.9, alpha_u=2.0, d_r=0.1, zero_theta_flux=True),
    "another force": cy.Parameters(alpha_p=0.6, alpha_u=0.3, d_r=0.05, force_exponent=3.0),
    "linear force": cy.Parameters(alpha_p=0.6, alpha_u=0.3, d_r=0.05, force_exponent=0.0),
    "root of a force": cy.Parameters(alpha_p=0.6, alpha_u=0.3, d_r=0.05, force_exponent=0.5),
    "no repulsion, any angle": cy.Parameters(kappa=0.0, repulsion_angle=1.0, alpha_p=0.3),
    "repulsion along the cell": cy.Parameters(repulsion_angle=np.pi / 2, alpha_p=0.7, kappa=0.2),
}


def numbers(low, high):
    """Numbers from low to high; none but 0 so small that the difference of two is subnormal and rounds."""
    near = st.just(0.0) if low == 0 else st.nothing()
    return near | st.floats(max(low, 1e-12), high, allow_nan=False)


CELL = st.builds(
    cy.Parameters,
    alpha_p=numbers(0.0, 2.0),
    alpha_u=numbers(0.0, 3.0),
    epsilon=numbers(0.0, 2.0),
    d_s=numbers(0.0, 0.5),
    d_r=st.just(0.0) | numbers(1e-3, 0.5),
    kappa=numbers(0.0, 1.5),
    mu=numbers(0.0, 2.0),
    repulsion_angle=st.sampled_from([0.0, np.pi / 2, np.pi, -np.pi / 2]),
    zero_theta_flux=st.booleans(),
    force_exponent=st.just(2.0) | st.sampled_from([0.0, 1.0, 3.0, 4.0]) | numbers(0.5, 6.0),
)


@jax.jit
def _answer(cell, base, direction):
    def rate(P):
        now = cell.at(jax.numpy.fft.fft2(jax.lax.complex(*P)))
        return unpack(jax.numpy.fft.ifft2(cell.rate(now)))

    return jax.jvp(rate, (base,), (direction,))[1]


def measured(params, base, m, j, grid=GRID):
    """The 2 x 2 matrix of one mode, from the derivative of the whole model about a uniform state."""
    q = 2 * np.pi * j / grid.length
    phase = m * grid.theta[:, None] + q * grid.z
    cell = system(params, grid)
    with jax.enable_x64(True):
        columns = []
        for component in (0, 1):
            answer = 0
            # The derivative is real and linear, so that a complex wave takes two of them.
            for wave, unit in ((np.cos(phase), 1), (np.sin(phase), 1j)):
                direction = np.zeros((2, *grid.shape))
                direction[component] = wave
                answer = answer + unit * np.asarray(_answer(cell, base, direction))
            columns.append(np.mean(answer * np.exp(-1j * phase), axis=(1, 2)))
    return np.stack(columns, axis=1)


def state(params, base, root=None, grid=GRID):
    """The uniform state of a kind as an array; the largest |dP/dt| there must be rounding."""
    found = uniform.uniform(params, base, root)
    P = np.zeros((2, *grid.shape))
    P[found.axis] = found.order
    assert np.abs(cy.rate_of_change(params, grid, P)).max() < 1e-14
    return P


def roots(params, base):
    return range(uniform.orders(params, base).size)


@pytest.mark.parametrize("base", uniform.BASES)
@pytest.mark.parametrize("name", CELLS)
def test_matrices_are_derivatives_of_the_model(name, base):
    params = CELLS[name]
    m, j = np.array(MODES).T
    assert len(roots(params, base)) > 0
    for root in roots(params, base):
        found = dispersion.growth_matrix(params, base, m, 2 * np.pi * j / GRID.length, root)
        assert found.shape == (len(MODES), 2, 2)
        for k, mode in enumerate(MODES):
            assert np.abs(measured(params, state(params, base, root), *mode) - found[k]).max() < 1e-13


@settings(max_examples=150, deadline=None)
@given(
    CELL,
    st.sampled_from(uniform.BASES),
    st.integers(-7, 7),
    st.integers(-5, 5),
    numbers(0.5, 20.0),
    st.integers(0, 2),
)
def test_matrices_are_derivatives_of_the_model_anywhere(params, base, m, j, length, root):
    assume(root < len(roots(params, base)))
    grid = cy.CylinderGrid(16, 12, length)
    exact = measured(params, state(params, base, root, grid), m, j, grid)
    found = dispersion.growth_matrix(params, base, m, 2 * np.pi * j / length, root)
    assert np.abs(found - exact).max() < 1e-9
    # The eigenvalues of a matrix that is nearly defective are less exact than its entries.
    rates, eigenvalues = dispersion.growth_rates(params, base, m, 2 * np.pi * j / length, root), 0
    eigenvalues = np.linalg.eigvals(exact)
    for rate in rates:
        assert np.prod(np.abs(rate - eigenvalues)) < 1e-9 * (1 + np.abs(exact).max())
    assert rates.sum() == pytest.approx(np.trace(exact), abs=1e-9)
    assert rates[0].real >= rates[1].real


@settings(max_examples=20, deadline=None)
@given(CELL, numbers(-7, 7), st.integers(-7, 7), st.integers(-5, 5))
def test_disorder_with_repulsion_in_any_direction(params, angle, m, j):
    params = params.replace(repulsion_angle=angle)
    found = dispersion.growth_matrix(params, "disorder", m, 2 * np.pi * j / GRID.length)
    assert np.abs(measured(params, state(params, "disorder"), m, j) - found).max() < 1e-9


def test_disorder_is_free_of_the_flow():
    """Rates α_p - d_r - d_s k² across d, and that less κ along d."""
    params, m, q = cy.Parameters(repulsion_angle=0.4), np.arange(4)[:, None], np.linspace(-3, 3, 5)
    rates = dispersion.growth_rates(params, "disorder", m, q)
    assert rates.shape == (4, 5, 2)
    across = 0.975 - 0.025 * (m**2 + q**2)
    np.testing.assert_allclose(rates, np.stack([across, across - 0.5], axis=-1), atol=1e-15)


def test_unidirectional_matrix_of_the_model_s_source():
    """The matrix on (P_theta, P_z) as it is usually written, with a = α_p - d_r."""
    p, m, q = cy.Parameters(alpha_p=0.3, alpha_u=0.7, epsilon=0.4), 2, 1.3
    P0 = np.sqrt(1 - p.d_r / p.alpha_p)
    k2, a, weak = m**2 + q**2, p.alpha_p - p.d_r, p.d_r / p.alpha_p
    W = (p.alpha_u + 1j * p.epsilon * P0 * q) / (1 + p.mu * k2) * P0**2 / k2
    written = [
        [-p.d_s * k2 - p.kappa + W * q**2, -3 * m * q * W],
        [-weak * m * q * W, -p.d_s * k2 - 2 * a + 3 * weak * m**2 * W],
    ]
    found = dispersion.growth_matrix(p, "unidirectional", m, q)
    np.testing.assert_allclose(found, written, atol=1e-15)
    uniform_wave = dispersion.growth_matrix(p, "unidirectional", 0, 0)
    np.testing.assert_allclose(uniform_wave, np.diag([-p.kappa + p.alpha_u * P0**2, -2 * a]), atol=1e-15)


@settings(max_examples=200, deadline=None)
@given(CELL)
def test_all_circumferential_states_are_found(params):
    """Their squares against the quadratic formula for n = 2, and against sampling in general."""
    found = uniform.orders(params, "circumferential") ** 2
    assert np.all(np.diff(found) < 0)
    beta = params.alpha_p - params.kappa * (abs(np.cos(params.repulsion_angle)) > 0.5)
    push = 0.0 if params.zero_theta_flux else params.alpha_u
    x = np.linspace(0, 1, 20001)[1:-1]
    with np.errstate(over="ignore"):
        excess = (1 - x) * (beta + push * x ** (params.force_exponent / 2)) - params.d_r
    places = x[:-1][np.sign(excess[:-1]) != np.sign(excess[1:])]
    inside = found[(found > 1e-4) & (found < 1 - 1e-4)]
    seen = places[(places > 1e-4) & (places < 1 - 1e-4)]
    assert all(np.abs(inside - place).min() < 1e-4 for place in seen)
    if params.force_exponent == 2 and push > 1e-3 and params.d_r > 0:
        inner = (push + beta) ** 2 - 4 * push * params.d_r
        assume(abs(inner) > 1e-6)
        both = (push - beta + np.array([1, -1]) * np.sqrt(complex(inner))) / (2 * push)
        expected = [v.real for v in both if inner > 0 and 1e-9 < v.real < 1]
        np.testing.assert_allclose(found[found > 1e-9], expected, atol=1e-9)


@pytest.mark.parametrize("loss", [1e-10, 1e-30, 1e-40, 1e-300])
def test_the_last_root_is_found_however_weak_rotational_diffusion_is(loss):
    params = cy.Parameters(alpha_p=0.0, alpha_u=0.5, kappa=0.3, d_r=loss)
    np.testing.assert_allclose(uniform.orders(params, "circumferential") ** 2, [1.0, 0.6], rtol=1e-8)


def test_full_order_is_not_found_twice_where_the_gain_ends_there():
    kappa = np.nextafter(0.9061385527067806, 0.0)
    params = cy.Parameters(alpha_p=0.0, alpha_u=0.9061385527067806, kappa=kappa, d_r=0.0, force_exponent=3.0)
    assert uniform.orders(params, "circumferential").tolist() == [1.0]


def test_a_steep_force_has_three_circumferential_states():
    params = cy.Parameters(alpha_p=0.06, alpha_u=1.0, d_r=0.05, kappa=0.0, force_exponent=8.0)
    assert uniform.orders(params, "circumferential").size == 3
    params = params.replace(alpha_p=0.04)
    assert uniform.orders(params, "circumferential").size == 2
    rates = [dispersion.growth_rates(params, "circumferential", 0, 0, root=k)[0].real for k in (0, 1)]
    assert rates[0] < 0 < rates[1]
    with pytest.raises(cy.InputError, match="from 0 to 1"):
        dispersion.growth_rates(params, "circumferential", 0, 0, root=2)


def test_the_flow_around_holds_circumferential_order_against_repulsion():
    """It tilts as a whole where κ > α_u P0ⁿ, the mirror of the unidirectional state's condition."""
    for kappa, stable in ((0.48, True), (0.49, False)):
        params = cy.Parameters(kappa=kappa)
        order = uniform.orders(params, "circumferential")[0]
        assert (kappa < params.alpha_u * order**2) == stable
        assert (dispersion.growth_rates(params, "circumferential", 0, 0)[0].real < 0) == stable


@pytest.mark.parametrize("base", ["unidirectional", "circumferential"])
def test_a_small_perturbation_of_a_run_grows_at_the_rate(base):
    """An oblique wave turns and grows; half the difference of two signs cancels even orders."""
    params = cy.Parameters(alpha_p=0.3, alpha_u=0.6, epsilon=0.5, kappa=0.1)
    m, j = 1, 1
    phase = m * GRID.theta[:, None] + 2 * np.pi * j / GRID.length * GRID.z
    rates = dispersion.growth_rates(params, base, m, 2 * np.pi * j / GRID.length)
    values, vectors = np.linalg.eig(dispersion.growth_matrix(params, base, m, 2 * np.pi * j / GRID.length))
    first = np.argmin(np.abs(values - rates[0]))
    small = 1e-6 * np.real(vectors[:, first, None, None] * np.exp(1j * phase))
    ends = []
    for sign in (1, -1):
        P = state(params, base) + sign * small
        ends.append(cy.simulate(params, GRID, P, 4.0, 4.0, stepper="etdrk4", dt=0.02).final_state)
    answer = np.mean((ends[0] - ends[1]) / 2 * np.exp(-1j * phase), axis=(1, 2))
    began = np.mean(small * np.exp(-1j * phase), axis=(1, 2))
    growth = np.vdot(began, answer) / np.vdot(began, began)
    assert abs(rates[0].imag) > 1e-3
    assert np.abs(np.log(growth) / 4 - rates[0]) < 1e-7


@pytest.mark.parametrize("name", ["paper", "fast flow, weak order", "zero mean u_theta", "another force"])
@pytest.mark.parametrize("threshold", ["tilt", "stripes"])
def test_rates_change_sign_at_the_thresholds(name, threshold):
    params = CELLS[name]
    value = float(getattr(dispersion, f"{threshold}_threshold")(params))
    if threshold == "tilt" and params.zero_theta_flux:
        assert value == np.inf
        return
    component = ("tilt", "stripes").index(threshold)
    for factor, sign in ((1 - 1e-6, -1), (1 + 1e-6, 1)):
        matrix = dispersion.growth_matrix(
            params.replace(alpha_u=factor * value), "unidirectional", component, 0.0
        )
        assert np.sign(matrix[component, component].real) == sign


def test_thresholds_of_the_paper_s_cell():
    """κ/P0² and α_p² (1 + μ)(2a + d_s)/(3 d_r a), by hand."""
    params = cy.Parameters()
    assert float(dispersion.tilt_threshold(params)) == pytest.approx(0.5 / 0.975, rel=1e-14)
    assert float(dispersion.tilt_threshold(params, 0.1)) == pytest.approx(0.5 / 0.75, rel=1e-14)
    assert float(dispersion.stripes_threshold(params, 0.1)) == pytest.approx(
        0.1**2 * 1.05 * 0.175 / (3 * 0.025 * 0.075), rel=1e-14
    )


def test_the_first_stripes_are_two():
    """No other wave of a whole number m, and with ε = 0 none at all, grows below both thresholds."""
    params = cy.Parameters(alpha_p=0.1, epsilon=0.0)
    below = min(float(dispersion.tilt_threshold(params)), float(dispersion.stripes_threshold(params)))
    m, q = np.arange(0, 9)[:, None], np.linspace(-9, 9, 181)
    rates = dispersion.growth_rates(params.replace(alpha_u=0.999 * below), "unidirectional", m, q)
    assert rates.shape == (9, 181, 2)
    assert rates.real.max() < 0


def test_thresholds_of_many_parameter_points():
    params = cy.Parameters()
    alpha_p = np.array([[0.0, 0.02, 0.025], [0.03, 0.1, 1.0]])
    for threshold in (dispersion.tilt_threshold, dispersion.stripes_threshold):
        found = threshold(params, alpha_p)
        assert found.shape == (2, 3)
        assert np.isnan(found[0]).all()
        for value, alone in zip(alpha_p[1], found[1], strict=True):
            assert alone == float(threshold(params.replace(alpha_p=value)))
    assert np.isinf(dispersion.stripes_threshold(params.replace(d_r=0.0)))
    assert float(dispersion.tilt_threshold(params.replace(d_r=0.0))) == params.kappa
    held = dispersion.tilt_threshold(params.replace(zero_theta_flux=True), alpha_p)
    assert np.isnan(held[0]).all()
    assert np.isinf(held[1]).all()


@pytest.mark.parametrize(
    ("change", "base", "m", "q", "root", "named"),
    [
        ({"alpha_p": 0.025}, "unidirectional", 1, 0, None, "the parameter point"),
        ({"alpha_u": 0.0, "kappa": 1.0}, "circumferential", 1, 0, None, "the parameter point"),
        ({"repulsion_angle": 0.5}, "unidirectional", 1, 0, None, "repulsion_angle"),
        ({"repulsion_angle": 0.5}, "circumferential", 1, 0, None, "repulsion_angle"),
        ({"kappa": np.ones(GRID.shape)}, "disorder", 1, 0, None, "kappa"),
        ({}, "oblique", 1, 0, None, "base"),
        ({}, "unidirectional", 1, 0, 1, "root"),
        ({}, "disorder", 1, 0, -1, "root"),
        ({}, "disorder", 1, 0, 0.5, "root"),
        ({}, "disorder", np.nan, 0, None, "m"),
        ({}, "disorder", 0, "one", None, "q"),
    ],
)
def test_what_no_closed_form_covers_is_refused(change, base, m, q, root, named):
    with pytest.raises(cy.InputError) as refused:
        dispersion.growth_rates(cy.Parameters(**change), base, m, q, root)
    assert refused.value.field == named
    assert "\n" not in str(refused.value)


def test_tilt_threshold_of_an_oblique_repulsion_is_refused():
    with pytest.raises(cy.InputError, match="repulsion_angle"):
        dispersion.tilt_threshold(cy.Parameters(repulsion_angle=0.5))


def test_waves_either_way_are_listed_where_repulsion_is_oblique():
    params = cy.Parameters(force_exponent=0.0, repulsion_angle=0.5, alpha_u=0.5)
    table = dispersion_table(params, "disorder", 1)
    both = table.rates[(table.m == 1) & (table.j != 0), 0].real
    assert both.size == 2
    assert both[0] - both[1] > 0.1
    assert dispersion_table(params.replace(repulsion_angle=0.0), "disorder", 1).m.size == 4
