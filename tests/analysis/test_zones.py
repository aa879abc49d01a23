import json

import numpy as np
import pytest

import cyclosis as cy
from cyclosis.analysis.zones import indifferent_zones, stripe_widths, zone_angles
from measure import contrast

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


def steady(grid, **parameters):
    """Steady cyclosis on a grid, the same all along the cell, with a zone next to a point of the grid."""
    P_z, _ = cy.stability.cyclosis(cy.Parameters(**parameters)).at(grid.theta, zone=grid.theta[10] + 1e-3)
    return state(np.broadcast_to(P_z[:, None], grid.shape))


def drawn(grid, P):
    """How plainly the lines P_z = 0 of a state are drawn, at all of their points."""
    around = cy.zones.weight(cy.zones.contrast(grid, P))
    places = [(line.theta, line.z) for line in indifferent_zones(grid, P)]
    theta, z = np.concatenate(places, axis=1)
    i = np.rint(theta * grid.n_theta / (2 * np.pi)).astype(int) % grid.n_theta
    return around[i, np.rint(z * grid.n_z / grid.length).astype(int) % grid.n_z]


@pytest.mark.parametrize("parameters", [{}, {"alpha_u": 0.05}, {"alpha_p": 0.1}, {"alpha_p": 0.06}])
def test_lines_between_steady_streams_are_drawn_in_full(parameters):
    """|P| vanishes on them, so that its size there says nothing of the streams beside them."""
    P = steady(GRID, **parameters)
    assert np.abs(P[1, 10, 0]) < 0.01
    assert len(indifferent_zones(GRID, P)) == 2
    assert np.all(drawn(GRID, P) == 1)


@pytest.mark.parametrize("grid", [GRID, cy.CylinderGrid(16, 16, 5.0), cy.CylinderGrid(48, 128, 13.0)])
@pytest.mark.parametrize("filaments", [400, 1000, 4000])
def test_no_line_is_drawn_in_disorder(grid, filaments):
    P = cy.initial.disordered(grid, seed=3, filaments_per_square=filaments)
    assert len(indifferent_zones(grid, P)) > 4
    assert np.all(drawn(grid, P) == 0)


def test_nor_where_all_filaments_run_around_the_axis():
    P = cy.initial.disordered(GRID, seed=1)
    P[0] = 0.9
    assert np.all(drawn(GRID, P) == 0)


def test_a_line_is_drawn_as_far_as_there_is_order_around_it():
    """Two streams in the lower half of the cell, nearly nothing in the upper."""
    P = state(np.where(Z < 2.5, 0.9, 1e-3) * np.sin(THETA - 0.3))
    plain = cy.zones.weight(cy.zones.contrast(GRID, P))
    beside = np.argmin(np.abs(GRID.theta - 0.3))
    assert np.all(plain[beside, (GRID.z > 0.6) & (GRID.z < 1.9)] == 1)
    assert np.all(plain[beside, (GRID.z > 3.3) & (GRID.z < 4.2)] == 0)
    assert np.all(plain[np.argmin(np.abs(GRID.theta - 0.3 - np.pi / 2))] == 0)  # within a stream


def test_contrast_of_a_straight_line_is_the_order_beside_it():
    P = state(0.4 * np.where((THETA > 1.0) & (THETA < 4.0), 1.0, -1.0))
    middle = [np.argmin(np.abs(GRID.theta - at)) for at in (1.0, 4.0)]
    assert cy.zones.contrast(GRID, P)[middle] == pytest.approx(0.4)


def test_no_line_is_drawn_in_a_wound_within_a_stream():
    """Filaments in a disc are in disorder: P_z changes sign there, but nothing streams the other way."""
    P = cy.initial.disordered(GRID, seed=2)
    P[1, np.hypot(THETA - np.pi, Z - 2.5) > 1.2] = 0.9
    assert len(indifferent_zones(GRID, P)) > 2
    assert np.all(drawn(GRID, P) == 0)


def test_a_line_goes_on_where_two_streams_are_about_to_merge():
    """Downward patches whose borders nearly touch: what parts them there is narrow, but drawn."""
    narrow = np.minimum(np.hypot(THETA - 2.2, Z - 2.5), np.hypot(THETA - 4.1, Z - 2.5)) - 0.9
    P = state(np.tanh(8 * narrow))
    assert 0 < P[1, 32, 24] < 0.5
    assert np.all(drawn(GRID, P) == 1)


def test_the_page_is_tested_with_the_same_numbers():
    """The page's own `contrast` is compared with this file; `tests/measure/contrast.py` writes it anew."""
    stored, now = json.loads(contrast.TARGET.read_text()), contrast.numbers()
    for name in ("reach", "grain", "faint", "plain"):
        assert stored[name] == now[name]
    for cell, again in zip(stored["cells"], now["cells"], strict=True):
        for name in ("P_z", "contrast"):
            assert cell[name] == pytest.approx(again[name], abs=2e-6)
