"""Budgets and laws of the closed cell that hold exactly, whatever the state."""

import numpy as np
import pytest

import cyclosis as cy

GRIDS = {
    "sphere": cy.ClosedGrid(cy.Sphere(), k_max=12),
    "spheroid": cy.ClosedGrid(cy.Spheroid(2.0), k_max=16),
    "capsule": cy.ClosedGrid(cy.Capsule(5.0, 0.4), k_max=16),
}
SMALL = {name: cy.ClosedGrid(grid.surface, k_max=8) for name, grid in GRIDS.items()}
PARAMS = cy.Parameters(mu=0.3)
SLOW = pytest.mark.slow


def rough(grid, seed=0):
    """A state with all harmonics of the grid, of largest magnitude 1."""
    P = cy.closed.noise(grid, 10, seed)
    return P / np.hypot(*P).max()


def in_space(grid, field):
    return grid.e_theta * field[0] + grid.e_s * field[1]


@pytest.mark.parametrize("name", GRIDS)
def test_power_is_dissipated(name):
    found = cy.diagnose(PARAMS, GRIDS[name], rough(GRIDS[name]))
    out = found["viscous_dissipation"] + found["friction_dissipation"]
    assert found["power_input"] == pytest.approx(out, rel=1e-12)
    assert found["viscous_dissipation"] > 0.1 * out


@pytest.mark.parametrize(
    ("name", "k_max", "bound"), [("sphere", 12, 1e-15), ("spheroid", 24, 2e-12), ("capsule", 16, 2e-13)]
)
def test_torques_balance(name, k_max, bound):
    """A rigid rotation costs no viscosity: <x × u> = <x × F>, about every axis of symmetry.

    Spheroids and capsules need some harmonics for a rotation: the error is the square of that of r e_theta.
    """
    grid = cy.ClosedGrid(GRIDS[name].surface, k_max=k_max)
    around = np.cross(np.array([0.2, -0.3, 0.25]), grid.xyz, axisa=0, axisb=0, axisc=0)
    P = cy.closed.from_vectors(grid, around + 0.2 * np.cos(grid.xyz + 0.3))
    u, F = cy.flow(PARAMS, grid, P), np.sum(P**2, axis=0) * P
    moments = [grid.mean(np.cross(grid.xyz, in_space(grid, field), axis=0)) for field in (u, F)]
    axes = slice(0, 3) if name == "sphere" else slice(2, 3)
    assert np.abs(moments[1][axes]).min() > 1e-3
    assert np.abs(moments[0] - moments[1])[axes].max() < bound


@pytest.mark.parametrize("name", GRIDS)
def test_no_flux_passes_any_circle(name):
    u = cy.flow(PARAMS, GRIDS[name], rough(GRIDS[name]))
    assert np.abs(u[1]).max() > 1e-3
    assert np.abs(u[1].mean(axis=0)).max() < 1e-14
    assert abs(GRIDS[name].mean(in_space(GRIDS[name], u))[2]) < 1e-14


@pytest.mark.parametrize("name", GRIDS)
def test_indices_of_defects_sum_to_two(name):
    """Poincaré and Hopf: of order vectors and flows alike."""
    grid = SMALL[name]
    for seed in range(2):
        P = rough(grid, seed)
        found = cy.closed.defects(grid, P)
        assert sum(defect.index for defect in found) == 2
        assert len(found) > 8
        assert sum(defect.index for defect in cy.closed.defects(grid, cy.flow(PARAMS, grid, P))) == 2
    for defect in found[1:-1]:  # and each is where P vanishes
        place = grid.position(defect.theta, defect.s)
        assert np.linalg.norm(grid.cartesian(P, place[None])) < 0.2


def test_what_one_harmonic_does_under_diffusion():
    """It decays at its eigenvalue; on a sphere, that of a constant vector's tangent part is 1."""
    grid, terms = SMALL["sphere"], ("diffusion",)
    run = cy.simulate(cy.Parameters(d_s=0.3), grid, cy.closed.source_to_sink(grid), t_end=2.0, terms=terms)
    exact = np.exp(-0.3 * 2.0) * cy.closed.source_to_sink(grid)
    np.testing.assert_allclose(run.final_state, exact, rtol=0, atol=1e-12)


@pytest.mark.parametrize("name", ["sphere", *(pytest.param(n, marks=SLOW) for n in ("spheroid", "capsule"))])
def test_magnitudes_never_grow_under_diffusion(name):
    """|P| <= 1 stays so, because Lap |P|²/2 = P·Lap_B P + |grad P|²: the maximum principle."""
    grid = SMALL[name]
    wave = np.sin(1.5 * grid.xyz + np.array([0.2, 1.0, 2.0])[:, None, None])[[2, 0, 1]]
    P = cy.closed.from_vectors(grid, wave)
    P = P / np.hypot(*P).max()
    run = cy.simulate(cy.Parameters(d_s=0.2), grid, P, t_end=2.0, save_every=0.5, terms=("diffusion",))
    largest = np.array([np.hypot(*frame).max() for frame in run.frames])
    assert np.all(np.diff(largest) < 0)
    assert largest[1] < 1
    assert run.t_final == 2.0


@pytest.mark.parametrize("name", GRIDS)
def test_the_budget_is_the_change_of_order(name):
    """The terms' shares of d/dt <|P|²>/2 add up to <P·dP/dt>."""
    grid, P = GRIDS[name], cy.closed.rotation(GRIDS[name])
    rate = cy.rate_of_change(PARAMS, grid, P)
    change = float(grid.mean(np.sum(P * rate, axis=0)))
    assert sum(cy.diagnose(PARAMS, grid, P)["budget"].values()) == pytest.approx(change, rel=1e-4)


def test_a_source_and_a_sink_drive_no_flow():
    """|P|²P is a gradient there: the counterpart of the cylinder's unidirectional state."""
    u = cy.flow(PARAMS, GRIDS["capsule"], cy.closed.source_to_sink(GRIDS["capsule"]))
    assert np.abs(u).max() < 1e-14


@pytest.mark.parametrize(("name", "bound"), [("sphere", 1e-13), ("spheroid", 4e-5), ("capsule", 2e-7)])
def test_a_rigid_rotation_is_its_own_flow(name, bound):
    """With a force exponent of 0, F = P: a rotation drives itself, as far as the grid resolves it."""
    grid = GRIDS[name]
    P = cy.closed.swirl(grid, 0.5)
    u = cy.flow(PARAMS.replace(force_exponent=0.0), grid, P)
    np.testing.assert_allclose(u, P, rtol=0, atol=bound)
