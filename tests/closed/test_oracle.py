"""The closed cell against an oracle in three-dimensional space that shares nothing with it."""

from types import SimpleNamespace

import jax
import numpy as np
import pytest
from numpy.polynomial import legendre

import closed_oracle as oracle
import cyclosis as cy
from cyclosis.model.precision import double
from measure import closed as measured
from measure.closed import FIELD, PARAMS, errors, state

RATE = jax.jit(lambda system, modes: system.rate(system.at(modes, 0.0)))
SURFACES = {
    "sphere": (cy.Sphere(), oracle.ellipse(1.0), (14, 44)),
    "spheroid": (cy.Spheroid(2.0), oracle.ellipse(2.0), (14, 44)),
    "flat": (cy.Spheroid(0.6), oracle.ellipse(0.6), (16, 48)),
    "capsule": (cy.Capsule(5.0, 0.4), oracle.capsule(5.0, 0.4), (14, 80)),
}


@pytest.fixture(scope="module")
def exact():
    """The oracle at scattered points, both poles and two close to one, computed once for a surface."""
    known = {}

    def at(name):
        if name not in known:
            _, shape, resolution = SURFACES[name]
            known[name] = measured.exact(shape, resolution)
        return known[name]

    return at


@pytest.mark.parametrize(
    ("name", "bounds"),
    [
        ("sphere", {8: (1e-3, 2e-5), 12: (2e-6, 3e-9), 16: (4e-9, 3e-12), 20: (1e-11, 3e-12)}),
        ("spheroid", {8: (0.1, 4e-4), 16: (8e-3, 5e-6), 24: (5e-4, 2e-7)}),
        ("capsule", {12: (1e-3, 1e-6), 20: (3e-6, 2e-9)}),
        pytest.param("capsule", {24: (1e-7, 1e-10), 28: (4e-9, 1e-11)}, marks=pytest.mark.slow),
    ],
)
def test_the_right_hand_side_converges_to_the_oracle(name, bounds, exact):
    """Spectrally fast: on the pointed spheroid slowly, because its ends repel filaments sharply."""
    found = {k_max: errors(SURFACES[name][0], k_max, exact(name)) for k_max in bounds}
    for k_max, bound in bounds.items():
        assert np.all(np.array(found[k_max]) < bound), found


@pytest.mark.parametrize(
    ("repulsion", "bounds"),
    [("principal", (3e-6, 4e-9)), ("polynomial", (4e-6, 1.5e-8)), ("bounded", (4e-5, 1.5e-6))],
)
def test_repulsions(repulsion, bounds, exact):
    known = exact("capsule")
    for k_max, bound in zip((20, 28), bounds, strict=True):
        grid = cy.ClosedGrid(SURFACES["capsule"][0], k_max=k_max)
        model = cy.models.closed_model(repulsion)
        with double():
            system = model.system(model.problem(PARAMS, grid), True)
            rate = system.state(RATE(system, system.spectrum(state(grid))))
        assert np.abs(grid.cartesian(rate, known.here.x) - known.rate[repulsion]).max() < bound


def test_positions_and_vectors_in_space(exact):
    known = exact("capsule")
    grid = cy.ClosedGrid(SURFACES["capsule"][0], k_max=16)
    assert np.abs(grid.cartesian(state(grid), known.here.x) - known.P).max() < 1e-12


@pytest.mark.parametrize("name", SURFACES)
def test_the_oracle_itself(name):
    """Its Laplacian is minus the square of its gradient by parts, and a rigid rotation has no strain."""
    shape = SURFACES[name][1]
    nodes, weight = legendre.leggauss(120)
    t, theta = 0.5 * shape[1] * (nodes[:, None] + 1), 2 * np.pi * np.arange(24) / 24
    at, here = shape[0](t), oracle.surface(shape[0], t, theta)
    area = (np.pi * shape[1] / 24 * weight[:, None] * at.r * at.speed) * np.ones(len(theta))
    P, gradient, laplacian = oracle.order(FIELD, here)
    work = np.sum(area * np.sum(P * laplacian, -1))
    assert work == pytest.approx(-np.sum(area * np.sum(gradient**2, (-1, -2))), rel=1e-12)
    assert np.sum(area * at.k_t * at.k_s) == pytest.approx(4 * np.pi, rel=1e-12)
    turn = lambda here: np.cross([0, 0, 1.0], here.x)  # noqa: E731
    flow = oracle.Flow(shape, turn, mu=0.3, most=2, degree=100)
    places = oracle.surface(shape[0], np.array([0.0, 0.3, 1.5]), np.array([0.0, 2.0, 4.0]))
    u, slope = flow.at(places)
    assert np.abs(u - turn(places)).max() < 1e-12
    assert np.abs(slope + np.swapaxes(slope, -1, -2)).max() < 1e-10


def test_the_oracle_has_the_eigenvalues_of_a_sphere():
    """Of a constant vector the tangent part is a vector harmonic of l = 1: Lap_B P = -P."""
    here = oracle.surface(oracle.ellipse(1.0)[0], np.array([0.0, 1.0]), np.array([0.0, 2.0]))
    constant = SimpleNamespace(
        value=lambda x: np.ones((2, 3)),
        slope=lambda x: np.zeros((2, 3, 3)),
        second=lambda x: np.zeros((2, 3, 3, 3)),
    )
    P, _, laplacian = oracle.order(constant, here)
    np.testing.assert_allclose(laplacian, -P, rtol=0, atol=1e-14)
