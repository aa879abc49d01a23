"""Bands that wind around the cell, and the stream function of the circulation they drive."""

import numpy as np
import pytest

import cyclosis as cy
from cyclosis.vacuole.helix import radial_stream

GRID = cy.CylinderGrid(48, 40, 5.0)


def profile(phi):
    return np.sin(phi) + 0.3 * np.cos(2 * phi + 1) + 0.04 * np.sin(5 * phi) + 0.2


@pytest.mark.parametrize("pitch", [5.0, 2.5, -5.0, np.inf])
def test_bands_follow_the_helix(pitch):
    u = cy.vacuole.helical_bands(GRID, profile, pitch)
    Q = 2 * np.pi / pitch
    f = profile(GRID.theta[:, None] - Q * GRID.z)
    np.testing.assert_allclose(u[0], f * Q / np.hypot(1, Q), rtol=0, atol=1e-14)
    np.testing.assert_allclose(u[1], f / np.hypot(1, Q), rtol=0, atol=1e-14)
    sampled = cy.vacuole.helical_bands(GRID, profile(GRID.theta), pitch)
    np.testing.assert_allclose(sampled, u, rtol=0, atol=1e-14)
    assert cy.vacuole.flow(GRID, u).solenoidal


@pytest.mark.parametrize("closure", cy.vacuole.CLOSURES)
@pytest.mark.parametrize("pitch", [5.0, 2.5, -5.0])
def test_the_stream_function_has_the_flow_as_its_slopes(pitch, closure):
    flow = cy.vacuole.flow(GRID, cy.vacuole.helical_bands(GRID, profile, pitch), closure=closure)
    psi = cy.vacuole.stream_function(flow)
    assert psi.pitch == pytest.approx(pitch)
    rng = np.random.default_rng(0)
    points = rng.uniform([0.05, 0, 0], [0.95, 6, 5], (40, 3))
    r, (v_r, v_theta, v_z) = points[:, 0], flow.at(points).T
    h = 1e-4

    def slope(axis):
        step = h * np.eye(3)[axis]
        at = [psi.at(points + k * step) for k in (-2, -1, 1, 2)]
        return (at[0] - 8 * at[1] + 8 * at[2] - at[3]) / (12 * h)

    np.testing.assert_allclose(slope(1), r * v_r, rtol=0, atol=1e-12)
    np.testing.assert_allclose(slope(2), -psi.Q * r * v_r, rtol=0, atol=1e-12)
    np.testing.assert_allclose(-slope(0), v_theta - psi.Q * r * v_z, rtol=0, atol=1e-12)
    phi = np.array([0.0, 1.0])
    own = psi.at([[0.4, 0.0, 0.0], [0.4, 1.0, 0.0]])
    np.testing.assert_allclose(psi.on([0.4], phi)[0], own, rtol=0, atol=1e-16)
    assert np.abs(psi.on([1.0], phi)).max() == 0.0


def test_slow_twist_loses_no_digits():
    """The circulation is of the third power of Q, which a difference of velocities would lose."""
    r = np.array([0.25, 0.75])
    for Q in (1e-3, 1e-6, 1e-9):
        found = radial_stream(4, Q, r) * Q
        for n in range(1, 5):
            law = -(Q**3) * n / (4 * (n + 1) * (n + 2)) * r**n * (1 - r**2) ** 2
            np.testing.assert_allclose(found[:, n - 1], law, rtol=3 * (4 * Q) ** 2 + 1e-13)


def test_the_axis_has_the_speed_of_the_flow_there():
    for pitch in (5.0, 2.5, -2.5, 1.25):
        flow = cy.vacuole.flow(GRID, cy.vacuole.helical_bands(GRID, np.sin, pitch))
        across = np.hypot(*flow.cartesian_at([[0.0, 0.0, 1.0]])[0, :2])
        assert float(cy.vacuole.axis_speed(pitch)) == pytest.approx(across, rel=1e-12)
    assert float(cy.vacuole.axis_speed(np.inf)) == 0.0
    assert float(cy.vacuole.axis_speed(1e-3)) == 0.0


def test_straight_bands_have_no_circulation():
    flow = cy.vacuole.flow(GRID, cy.vacuole.helical_bands(GRID, profile, np.inf))
    psi = cy.vacuole.stream_function(flow)
    assert psi.pitch == np.inf
    assert np.abs(psi.on([0.2, 0.7], [0.0, 2.0])).max() == 0.0


def twice():
    u = cy.vacuole.helical_bands(GRID, np.sin, 5.0) + cy.vacuole.helical_bands(GRID, np.sin, 2.5)
    return cy.vacuole.flow(GRID, u)


def rings():
    u = np.zeros((2, *GRID.shape))
    u[0] = np.sin(2 * np.pi * GRID.z / GRID.length)
    return cy.vacuole.flow(GRID, u)


def compressible():
    u = cy.vacuole.helical_bands(GRID, np.sin, 5.0)
    return cy.vacuole.flow(GRID, u * np.array([1.0, 0.5])[:, None, None])


@pytest.mark.parametrize(
    ("message", "wrong"),
    [
        ("helical", lambda: cy.vacuole.stream_function(twice())),
        ("helical", lambda: cy.vacuole.stream_function(rings())),
        ("without divergence", lambda: cy.vacuole.stream_function(compressible())),
        ("fits the length", lambda: cy.vacuole.helical_bands(GRID, np.sin, 3.0)),
        ("pitch = 0.0", lambda: cy.vacuole.helical_bands(GRID, np.sin, 0.0)),
        ("pitch = ", lambda: cy.vacuole.helical_bands(GRID, np.sin, [5.0, 2.5])),
        ("profile = ", lambda: cy.vacuole.helical_bands(GRID, [1.0, np.nan, 0.0], 5.0)),
        ("profile = ", lambda: cy.vacuole.helical_bands(GRID, np.ones((3, 3)), 5.0)),
        ("pitch = ", lambda: cy.vacuole.axis_speed([1.0, 0.0])),
    ],
)
def test_what_is_not_helical_is_refused(message, wrong):
    with pytest.raises(cy.InputError) as caught:
        wrong()
    assert message in str(caught.value)
    assert "\n" not in str(caught.value)
