"""Shapes and harmonics: exact eigenvalues, those of the oracle and stored ones, orthonormality, embedding."""

import numpy as np
import pytest
from scipy.integrate import quad

import closed_oracle as oracle
import cyclosis as cy
from cyclosis.closed.space import closed_space
from cyclosis.closed.system import closed_system
from measure import check
from measure import closed as measured

SURFACES = measured.SURFACES
SHAPES = {
    "sphere": (oracle.ellipse(1.0), 30),
    "spheroid": (oracle.ellipse(2.0), 50),
    "capsule": (oracle.capsule(5.0, 0.4), 90),
}


def grid(name, k_max=16, **points):
    return cy.ClosedGrid(SURFACES[name], k_max=k_max, **points)


def test_eigenvalues_of_the_sphere():
    """Vector harmonics: l (l + 1) - 1 of Bochner's Laplacian; flows: l (l + 1) - 2, 0 for rotations."""
    check(measured.of_sphere())
    tables = grid("sphere", 24).tables
    for m, modes in enumerate(tables.modes):
        last = max(m, 1) + modes - 1  # all harmonics up to k_max are there, and no other
        assert last * (last + 1) - 1 <= 24**2 < (last + 1) * (last + 2) - 1


@pytest.mark.parametrize(
    ("name", "k_max", "flow"), [("sphere", 16, 1e-10), ("spheroid", 24, 5e-8), ("capsule", 20, 1e-10)]
)
@pytest.mark.parametrize("m", [0, 1, 3])
def test_eigenvalues_are_those_of_the_oracle(name, k_max, flow, m):
    """Of flows they converge with k_max, of diffusion they are exact at every k_max."""
    tables = grid(name, k_max).tables
    diffusion, viscous = oracle.eigenvalues(SHAPES[name][0], m, SHAPES[name][1])
    np.testing.assert_allclose(diffusion[:24:2], diffusion[1:24:2], rtol=0, atol=1e-10)
    np.testing.assert_allclose(tables.rate[m, :12], diffusion[:24:2], rtol=0, atol=1e-10)
    np.testing.assert_allclose(tables.viscous[m, :12], viscous[:12], rtol=0, atol=flow)


@pytest.mark.slow
@pytest.mark.parametrize(("name", "k_max"), [("sphere", 26), ("spheroid", 32), ("capsule", 26)])
def test_stored_eigenvalues(name, k_max):
    check(measured.eigenvalues(name, k_max))


@pytest.mark.parametrize("name", SURFACES)
def test_stored_areas(name):
    with np.load(measured.REFERENCE / f"closed_{name}.npz") as stored:
        assert grid(name).area == pytest.approx(float(stored["area"]), rel=1e-12)


@pytest.mark.parametrize("name", SURFACES)
def test_areas_lengths_and_curvatures(name):
    """Against adaptive quadrature of the oracle's meridian, and Gauss and Bonnet: ∫ K = 4π."""
    own, (at, stop, half) = grid(name), SHAPES[name][0]
    surface, points = own.surface, own.meridian

    def integral(f):
        return quad(lambda t: float(f(at(np.array([t])))[0]), 0, stop, epsabs=1e-11, limit=200)[0]

    assert own.area == pytest.approx(integral(lambda p: 2 * np.pi * p.r * p.speed), rel=1e-11)
    assert surface.meridian_length == pytest.approx(integral(lambda p: p.speed), rel=1e-11)
    assert surface.half_height == pytest.approx(half, abs=1e-12)
    assert own.area * own.mean(points.k_s * points.k_theta * np.ones(own.shape)) == pytest.approx(
        4 * np.pi, rel=1e-12
    )
    np.testing.assert_allclose(own.normal[2, 0], -points.slope, rtol=0, atol=1e-14)
    tau = np.arctan2(np.sqrt(1 - own.points.x**2), own.points.x)
    other = at(stop * tau / np.pi)
    for mine, exact in (("r", "r"), ("z", "z"), ("slope", "er"), ("k_s", "k_s"), ("k_theta", "k_t")):
        np.testing.assert_allclose(getattr(points, mine), getattr(other, exact), rtol=0, atol=1e-11)


def test_the_half_height_of_the_default_capsule():
    capsule = cy.Capsule(5.0, 0.4)
    assert capsule.half_height == pytest.approx(oracle.half_height(5.0, 0.4, capsule.half_width), abs=1e-10)
    assert capsule.half_height == pytest.approx(3.4542628434, abs=1e-9)


@pytest.mark.parametrize("name", SURFACES)
def test_harmonics_are_orthonormal_on_the_points(name):
    own = grid(name)
    tables, area = own.tables, own.points.area
    for m, (modes, flows) in enumerate(zip(tables.modes, tables.flows, strict=True)):
        vectors, flow = tables.vector[m, :, :modes], tables.flow[m, :, :flows]
        product = vectors.T @ (area[:, None] * vectors)
        np.testing.assert_allclose(product, np.eye(modes), rtol=0, atol=1e-11)
        parity = tables.parity[m, :flows]
        product = flow.T @ (area[:, None] * flow) * (1 + np.outer(parity, parity)) / 2  # both of ±m
        np.testing.assert_allclose(product, np.eye(flows), rtol=0, atol=1e-11)


@pytest.mark.parametrize("name", SURFACES)
def test_harmonics_are_those_of_a_larger_grid(name):
    """With the same signs: states are carried from one grid to another by copying their modes."""
    small, large = grid(name, 8, n_s=72), grid(name, 12, n_s=72)
    for m, modes in enumerate(small.tables.modes):
        for table in ("vector", "rate"):
            few, many = (getattr(own.tables, table)[m, ..., :modes] for own in (small, large))
            np.testing.assert_allclose(few, many, rtol=0, atol=1e-9)


def projected(own, P):
    system = closed_system(cy.Parameters(), own)
    return system.state(system.spectrum(P))


@pytest.mark.parametrize("name", SURFACES)
def test_projections_change_nothing_twice(name):
    own = grid(name, 12)
    once = projected(own, np.random.default_rng(0).normal(size=(2, *own.shape)))
    np.testing.assert_allclose(projected(own, once), once, rtol=0, atol=1e-11)


def test_a_seed_is_one_state_at_every_resolution():
    small, large = (cy.ClosedGrid(cy.Capsule(3.0), k_max=k_max) for k_max in (8, 12))
    modes = [
        closed_system(cy.Parameters(), own).spectrum(cy.closed.noise(own, seed=5)) for own in (small, large)
    ]
    _, rows, columns = modes[0].shape
    keep = closed_space(small).keep
    np.testing.assert_allclose(keep * modes[1][:, :rows, :columns], modes[0], rtol=0, atol=1e-12)
    assert np.abs(modes[1]).sum() > 1.5 * np.abs(modes[0]).sum()


def test_noise_has_the_variance_of_filaments():
    """N of them in every 0.00767 radii squared: their mean has <|P|²> = 1/N there, half in each component.

    Of each harmonic, of unit norm, the mean square is then 0.00767/2N for each real one.
    """
    own, N = grid("sphere", 8), 500.0
    system = closed_system(cy.Parameters(), own)
    squares = [np.abs(system.spectrum(cy.closed.noise(own, N, seed))) ** 2 for seed in range(40)]
    count = int(closed_space(own).keep.sum())
    exact = 2 * np.pi / 64 * 5 / 64 / N  # of real and imaginary part together
    # Amplitudes are those of functions normalised without their 2π.
    found = 2 * np.pi * np.sum(squares) / (40 * count)
    assert found == pytest.approx(exact, rel=4 / np.sqrt(40 * count))
    for part in (squares[0].shape[1] // 2, 1):  # neither few nor many waves around the axis are favoured
        share = (
            2 * np.pi * np.array(squares)[:, :, :part].sum() / (40 * closed_space(own).keep[:, :part].sum())
        )
        assert share == pytest.approx(exact, rel=0.25)
