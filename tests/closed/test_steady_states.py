"""Steady states: the circulation of a droplet, and a long capsule whose middle is the periodic cylinder."""

import numpy as np
import pytest
from scipy.optimize import fsolve
from scipy.spatial.transform import Rotation
from scipy.special import lpmv

import cyclosis as cy
from cyclosis.stability.cell.whole import whole_cell
from measure import check
from measure.closed import middle

PARAMS = cy.Parameters()


def droplet(params, count=30):
    """Return order, speed and circulation of P = f e_φ on a sphere, of polar angle τ about the axis.

        d_s L f - d_r f + (1 - f²)(α_p f + α_u v) = 0,   -μ (L v + v) + v = f³

    with L f = f'' + cot τ f' - cot² τ f. By collocation in associated Legendre functions of odd degree l and
    order 1, of which L is -(l (l + 1) - 1), and Newton's method.
    """
    x, weight = np.polynomial.legendre.leggauss(4 * count)
    x, weight = x[2 * count :], 2 * weight[2 * count :]  # the state is symmetric about the equator
    l = 2 * np.arange(count) + 1  # noqa: E741
    values = np.stack([-lpmv(1, degree, x) / degree for degree in l], axis=1)
    inner = lambda f: np.linalg.lstsq(np.sqrt(weight)[:, None] * values, np.sqrt(weight) * f, rcond=None)[0]  # noqa: E731

    def flow(f):
        return values @ (inner(f**3) / (1 + params.mu * (l * (l + 1) - 2)))

    def residual(a):
        f = values @ a
        drive = (1 - f**2) * (params.alpha_p * f + params.alpha_u * flow(f))
        return inner(drive) - (params.d_s * (l * (l + 1) - 1) + params.d_r) * a

    a, _, flag, _ = fsolve(residual, 0.9 * (l == 1), xtol=1e-13, full_output=True)
    assert flag == 1
    assert np.abs(residual(a)).max() < 1e-11
    f = values @ a
    v = flow(f)
    mean = lambda g: 0.5 * np.sum(weight * g)  # noqa: E731
    return np.sqrt(mean(f**2)), np.sqrt(mean(v**2)), 1.5 * mean(np.sqrt(1 - x**2) * v)


def test_the_circulation_of_a_droplet_in_one_dimension():
    """Resolved, and the numbers of an earlier program by another method."""
    found = droplet(PARAMS)
    np.testing.assert_allclose(found, droplet(PARAMS, 40), rtol=0, atol=1e-9)
    np.testing.assert_allclose(found, (0.966793, 0.915540, 1.114358), rtol=0, atol=1e-6)


def test_a_vector_has_the_size_of_its_state_and_rotations_are_what_they_say():
    """On a sphere, turned by a small angle about each axis: the field moves and turns with the surface."""
    grid = cy.ClosedGrid(cy.Sphere(), k_max=6)
    cell = whole_cell(PARAMS, grid, None, "none", "principal")
    vector = cell.noise(1)[0]
    state = cell.state(vector)
    assert np.linalg.norm(vector) == pytest.approx(np.sqrt(grid.mean(np.sum(state**2, axis=0))), rel=1e-12)
    points = np.moveaxis(grid.xyz, 0, -1).reshape(-1, 3)
    for axis, slope in zip(np.eye(3), cell.slopes(vector), strict=True):
        turned = []
        for angle in (1e-3, -1e-3):
            turn = Rotation.from_rotvec(angle * axis).as_matrix()
            moved = grid.cartesian(state, points @ turn) @ turn.T  # the field at x is R P(R⁻¹ x)
            field = np.moveaxis(moved.reshape(*grid.shape, 3), -1, 0)
            turned.append(cell.vector(cy.closed.from_vectors(grid, field)))
        # A rotation by a positive angle moves P along ω × x: the change is minus the Lie derivative.
        np.testing.assert_allclose((turned[1] - turned[0]) / 2e-3, slope, rtol=0, atol=1e-5)


@pytest.mark.slow
def test_a_state_from_pole_to_pole_has_the_modes_of_its_azimuthal_rates():
    params, grid = cy.Parameters(alpha_p=0.5, alpha_u=0.05), cy.ClosedGrid(cy.Capsule(2.0), k_max=8)
    axial = cy.stability.source_to_sink(params, grid)
    found = cy.stability.steady_state(params, grid, 0.98 * axial.P)
    np.testing.assert_allclose(found.state, axial.P, rtol=0, atol=1e-10)
    modes = cy.stability.leading_modes(params, grid, found, count=3)
    rates = [cy.stability.azimuthal_rates(params, grid, axial.P, m).real for m in (0, 1, 2)]
    expected = np.sort(np.concatenate(rates))[:-4:-1]
    np.testing.assert_allclose(modes.eigenvalues.real, expected, rtol=0, atol=1e-9)


@pytest.mark.slow
def test_cyclosis_on_a_capsule_may_turn_about_its_axis_and_has_its_slowest_modes():
    """One neutral mode; the next one decays in a simulation as fast as its eigenvalue says."""
    params, grid = cy.Parameters(alpha_p=0.5, alpha_u=0.05), cy.ClosedGrid(cy.Capsule(2.0), k_max=10)
    found = cy.stability.steady_state(params, grid, cy.closed.rotation(grid))
    assert cy.regime(params, grid, found.state).name == "cyclosis"
    np.testing.assert_allclose(found.drift, 0, atol=1e-10)
    modes = cy.stability.leading_modes(params, grid, found, count=3)
    assert abs(modes.eigenvalues[0]) < 1e-9
    assert modes.shifts[0] == pytest.approx(1)
    assert modes.eigenvalues[1].real < -1e-3
    assert modes.eigenvalues[1].imag == 0
    bent = found.state + 1e-6 * modes.modes[1].real
    run = cy.simulate(params, grid, bent, 20.0, 10.0, stepper="etdrk4", dt=0.1)
    sizes = [np.sqrt(grid.mean(np.sum((P - found.state) ** 2, axis=0))) for P in run.frames[-2:]]
    rate = np.log(sizes[1] / sizes[0]) / 10.0
    assert rate == pytest.approx(modes.eigenvalues[1].real, abs=1e-4)


@pytest.mark.slow
def test_the_circulation_of_a_droplet_is_a_steady_state_about_any_axis():
    """Order and speed are those in one dimension; the axis may tilt in two directions."""
    grid = cy.ClosedGrid(cy.Sphere(), k_max=12)
    params = cy.Parameters(alpha_p=0.2, alpha_u=0.2)
    x = np.moveaxis(np.cross([0.6, 0.0, 0.8], np.moveaxis(grid.xyz, 0, -1)), -1, 0)
    found = cy.stability.steady_state(params, grid, cy.closed.from_vectors(grid, 0.9 * x))
    order, speed, circulation = droplet(params)
    known = cy.diagnose(params, grid, found.state)
    assert known["order"] == pytest.approx(order, abs=1e-5)
    assert known["rms_speed"] == pytest.approx(speed, abs=1e-5)
    assert np.linalg.norm(known["circulation"]) == pytest.approx(circulation, abs=1e-5)
    np.testing.assert_allclose(found.drift, 0, atol=1e-9)
    modes = cy.stability.leading_modes(params, grid, found, count=3)
    assert np.abs(modes.eigenvalues[:2]).max() < 1e-6
    np.testing.assert_allclose(modes.shifts[:2], 1, atol=1e-3)
    assert modes.eigenvalues[2].real < -1e-3


def test_repulsion_of_a_whole_cell_is_for_closed_surfaces_alone():
    grid = cy.CylinderGrid(16, 16)
    with pytest.raises(cy.InputError, match="principal on a cylinder"):
        cy.stability.steady_state(PARAMS, grid, cy.initial.stripes(grid), repulsion="bounded")


@pytest.mark.slow
def test_a_droplet_circulates():
    """About an axis through no pole of the grid, so that every azimuthal mode takes part."""
    grid = cy.ClosedGrid(cy.Sphere(), k_max=24)
    x = np.moveaxis(np.cross([0.6, 0.0, 0.8], np.moveaxis(grid.xyz, 0, -1)), -1, 0)
    run = cy.simulate(PARAMS, grid, cy.closed.from_vectors(grid, 0.9 * x), 60.0, 60.0, rtol=1e-5)
    order, speed, circulation = droplet(PARAMS)
    found = cy.diagnose(PARAMS, grid, run.final_state)
    assert found["order"] == pytest.approx(order, abs=1e-5)
    assert found["rms_speed"] == pytest.approx(speed, abs=1e-5)
    np.testing.assert_allclose(found["circulation"], circulation * np.array([0.6, 0, 0.8]), rtol=0, atol=1e-5)
    regime = cy.regime(PARAMS, grid, run.final_state)
    assert regime.name == "circulation"
    assert [defect.index for defect in regime.defects] == [1, 1]
    places = [grid.position(defect.theta, defect.s) for defect in regime.defects]
    np.testing.assert_allclose(places, [[-0.6, 0, -0.8], [0.6, 0, 0.8]], rtol=0, atol=1e-3)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("length", "k_max", "of_order", "of_flow"), [(10, 20, 3e-3, 2e-3), (16, 32, 5e-5, 1e-4)]
)
def test_the_middle_of_a_long_capsule_is_the_periodic_cylinder(length, k_max, of_order, of_flow):
    """With the same profile around the cell. At a length of 5 the ends change the flow there by 0.012."""
    check(middle(length, k_max, of_order, of_flow))
