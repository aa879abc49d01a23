"""Rates of uptake and mixing, and exchange between bands, against closed forms and stored values."""

import numpy as np
import pytest
from scipy.optimize import brentq
from scipy.special import iv, j0, j1, jn_zeros, jnp_zeros

import cyclosis as cy
from measure.vacuole_flows import bands, twisted

SH = jn_zeros(0, 1)[0] ** 2


@pytest.mark.parametrize("peclet", [1e-3, 100.0, 1e5])
def test_a_straight_flow_does_not_help_a_uniform_wall(peclet):
    assert cy.vacuole.uptake(twisted(0.0), peclet) == pytest.approx(SH, abs=1e-9)
    assert cy.vacuole.mixing_rate(twisted(0.0), peclet) == pytest.approx(jnp_zeros(1, 1)[0] ** 2, abs=1e-9)


@pytest.mark.parametrize("biot", [0.01, 1.0, 50.0])
def test_exchange_without_flow(biot):
    x = brentq(lambda x: x * j1(x) - biot * j0(x), 1e-6, jn_zeros(0, 1)[0])
    assert cy.vacuole.uptake(bands(np.sin), 10.0, cy.vacuole.Exchange(biot)) == pytest.approx(x**2, rel=1e-9)


@pytest.mark.parametrize(
    ("q", "peclet", "stored"),  # by finite volumes with fluxes from the stream function, and Richardson
    [
        (2.0, 1000.0, 10.58715),
        (0.4 * np.pi, 1000.0, 9.60404),
        (0.4 * np.pi, 100.0, 6.23998),
        (0.5, 1e4, 9.67227),
    ],
)
def test_uptake_with_a_twist(q, peclet, stored):
    assert cy.vacuole.uptake(twisted(q), peclet) == pytest.approx(stored, rel=1e-6)


@pytest.mark.parametrize(
    ("q", "peclet", "stored"),
    [(2.0, 1000.0, 13.88739), (0.4 * np.pi, 1000.0, 10.43049), (0.4 * np.pi, 100.0, 5.25829)],
)
def test_mixing_with_a_twist(q, peclet, stored):
    assert cy.vacuole.mixing_rate(twisted(q), peclet) == pytest.approx(stored, rel=1e-6)


def test_without_flow_a_twisted_pattern_mixes_by_diffusion_alone():
    assert cy.vacuole.mixing_rate(twisted(0.5), 1e-3) == pytest.approx(
        jnp_zeros(1, 1)[0] ** 2 + 0.25, rel=1e-6
    )


@pytest.mark.slow
def test_bands_of_the_wall():
    q = 0.4 * np.pi
    flow = twisted(0.0)
    assert cy.vacuole.band_exchange(flow, 1e-4, q) == pytest.approx(q * iv(1, q) / iv(0, q), rel=1e-8)
    peclets = np.array([300.0, 1000.0, 3000.0])
    found = [cy.vacuole.band_exchange(flow, pe, q) for pe in peclets]
    slopes = np.diff(np.log(found)) / np.diff(np.log(peclets))
    assert 0.5 < slopes[1] < slopes[0] < 0.54
    assert found[1] / (q * iv(1, q) / iv(0, q)) == pytest.approx(30.98, abs=0.01)


@pytest.mark.slow
def test_the_steady_field_in_the_whole_vacuole_exchanges_as_much():
    q, flow = 0.4 * np.pi, bands(lambda phi: np.sin(phi) + 0.2 * np.sin(3 * phi), n=48, n_z=8)
    wall = cy.vacuole.Held(lambda theta, z: np.cos(q * z) + 0 * theta)
    found = cy.vacuole.steady(flow, 30.0, wall, n_r=16)
    along = np.abs(np.fft.rfft(found.wall_slope.mean(axis=0), norm="forward")[1]) * 2
    assert along == pytest.approx(cy.vacuole.band_exchange(flow, 30.0, q), rel=1e-8)
    # What diffusion destroys comes in through the wall: <|∇c|²> = 2 <c c_r> on it.
    wall_values = np.cos(q * found.z)
    assert found.gradient == pytest.approx(2 * np.mean(wall_values * found.wall_slope), rel=1e-6)


def test_steady_exchange_with_a_pattern_outside():
    flow, biot = bands(np.sin, n=16, n_z=8), 0.5
    found = cy.vacuole.steady(
        flow, 1e-4, cy.vacuole.Exchange(biot, lambda theta, z: np.cos(theta) + 0 * z), n_r=8
    )
    expected = biot / (1 + biot) * found.r[:, None] * np.cos(found.theta)
    assert np.allclose(found.c, expected[:, :, None], atol=1e-5)
    assert np.allclose(found.wall_slope, biot / (1 + biot) * np.cos(found.theta)[:, None], atol=1e-5)
    assert found.gradient == pytest.approx((biot / (1 + biot)) ** 2, rel=1e-4)  # of c = x biot/(1 + biot)


def test_bands_across_a_helix_exchange_as_the_field_in_the_whole_vacuole():
    flow, q = bands(np.sin, 0.4 * np.pi, n=16), 0.4 * np.pi
    wall = cy.vacuole.Held(lambda theta, z: np.cos(q * z) + 0 * theta)
    found = cy.vacuole.steady(flow, 20.0, wall, n_r=12, shape=(32, 32))
    along = np.abs(np.fft.rfft(found.wall_slope.mean(axis=0), norm="forward")[1]) * 2
    assert along == pytest.approx(cy.vacuole.band_exchange(flow, 20.0, q), rel=1e-5)


def test_other_walls_and_flows_are_refused():
    flow = bands(np.sin, n=16)
    with pytest.raises(cy.InputError, match="wall"):
        cy.vacuole.uptake(flow, 10.0, cy.vacuole.Sealed())
    with pytest.raises(cy.InputError, match="wall"):
        cy.vacuole.steady(flow, 10.0, cy.vacuole.Sealed())
    with pytest.raises(cy.InputError, match="wavenumber"):
        cy.vacuole.band_exchange(flow, 10.0, 0.0)
    grid = cy.CylinderGrid(16, 16)
    other = cy.vacuole.flow(grid, cy.flow(cy.Parameters(), grid, cy.initial.disordered(grid, seed=0)))
    for rate in (cy.vacuole.uptake, cy.vacuole.mixing_rate):
        with pytest.raises(cy.InputError, match="straight, or helical"):
            rate(other, 10.0)
    # One that is helical with half a turn does not close.
    half = np.sin(2 * grid.theta[:, None] - 2 * np.pi * grid.z / grid.length)
    with pytest.raises(cy.InputError, match="whole number of turns"):
        cy.vacuole.uptake(cy.vacuole.flow(grid, np.stack([half, half])), 10.0)


def test_scales():
    assert cy.Scales(500.0, 100.0).peclet(1000.0) == 50.0
    with pytest.raises(cy.InputError, match="diffusivity"):
        cy.Scales().peclet(0.0)


def test_a_coarse_flow_exchanges_and_disperses_as_the_same_on_more_points():
    """Waves that the points of a flow do not resolve are 0, not those of the other end."""
    coarse, fine = cy.CylinderGrid(16, 16), cy.CylinderGrid(64, 16)
    u = cy.flow(cy.Parameters(), coarse, cy.initial.stripes(coarse))
    flows = cy.vacuole.flow(coarse, u), cy.vacuole.flow(fine, cy.interpolate(u, fine.shape))
    for solve in (
        lambda flow: cy.vacuole.band_exchange(flow, 300.0, 1.2566),
        lambda flow: cy.vacuole.uptake(flow, 300.0),
    ):
        one, other = map(solve, flows)
        assert one == pytest.approx(other, rel=1e-9)
