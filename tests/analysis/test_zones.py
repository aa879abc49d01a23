import numpy as np
import pytest

import cyclosis as cy
from cyclosis.analysis.zones import indifferent_zones, stripe_widths, zone_angles

GRID = cy.CylinderGrid(64, 48, 5.0)
THETA, Z = np.meshgrid(GRID.theta, GRID.z, indexing="ij")


def state(P_z):
    return np.stack([np.zeros_like(P_z), P_z])


def test_angles_of_a_resolved_profile_are_exact():
    angles = zone_angles(np.sin(GRID.theta - 0.3) + 0.4)
    exact = np.sort(np.mod([0.3 - np.arcsin(0.4), 0.3 + np.pi + np.arcsin(0.4)], 2 * np.pi))
    assert angles == pytest.approx(exact, abs=1e-13)
    assert stripe_widths(angles).sum() == pytest.approx(1)
    assert sorted(stripe_widths(angles)) == pytest.approx(
        [0.5 - np.arcsin(0.4) / np.pi, 0.5 + np.arcsin(0.4) / np.pi]
    )


def test_no_zone_where_the_sign_stays():
    assert zone_angles(1 + 0.5 * np.sin(GRID.theta)).size == 0
    assert stripe_widths([]).size == 0
    assert indifferent_zones(GRID, state(1 + 0 * THETA)) == []


def test_straight_zones_wind_along_the_cell():
    zones = indifferent_zones(GRID, state(np.sin(THETA - 0.3)))
    assert sorted(zone.winding for zone in zones) == [(0, -1), (0, 1)]
    for zone in zones:
        assert zone.arc_length == pytest.approx(5.0)
        assert zone.straightness == pytest.approx(1.0)


def test_wavy_zones_are_longer_than_straight_ones():
    """θ = a sin(2πz/l): the arc length is an elliptic integral; here by quadrature."""
    a, k = 0.4, 2 * np.pi / 5
    zones = indifferent_zones(GRID, state(np.sin(THETA - a * np.sin(k * Z))))
    z = np.linspace(0, 5, 20001)
    arc = np.trapezoid(np.sqrt(1 + (a * k * np.cos(k * z)) ** 2), z)
    assert [zone.arc_length for zone in zones] == pytest.approx([arc, arc], rel=2e-3)
    assert zones[0].straightness == pytest.approx(5 / arc, rel=2e-3)


def test_loops_do_not_wind_and_helices_do():
    blob = indifferent_zones(GRID, state(np.cos(THETA - 3) + np.cos(2 * np.pi * (Z - 2) / 5) - 1))
    assert [zone.winding for zone in blob] == [(0, 0)]
    assert blob[0].straightness == pytest.approx(0.0, abs=1e-9)
    # A patch that straddles both edges of the fundamental domain is still one loop.
    corner = indifferent_zones(GRID, state(np.cos(THETA) + np.cos(2 * np.pi * Z / 5) - 1))
    assert [zone.winding for zone in corner] == [(0, 0)]
    assert corner[0].arc_length == pytest.approx(blob[0].arc_length, rel=1e-2)
    helix = indifferent_zones(GRID, state(np.sin(THETA - 2 * np.pi * Z / 5)))
    assert {tuple(np.abs(zone.winding)) for zone in helix} == {(1, 1)}
    assert helix[0].straightness == pytest.approx(1.0, abs=1e-6)
