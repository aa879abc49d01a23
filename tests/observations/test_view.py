"""The image and the surface: there and back, signs, mirrors."""

from itertools import pairwise

import numpy as np
import pytest

import cyclosis as cy
from cyclosis.observations import View

VIEWS = [
    View(100.0, axis, (30.0, 225.0), facing, mirrored)
    for axis in (0.0, 17.0, 90.0, -63.0, 180.0, 245.5)
    for facing in (np.pi, 0.3)
    for mirrored in (False, True)
]
each = pytest.mark.parametrize(
    "view", VIEWS, ids=lambda v: f"{v.axis_deg:g}-{v.facing:.1f}-{'mirrored' if v.mirrored else 'plain'}"
)


def seen(view, count=500):
    """Points (theta, z) on the side that faces the camera, up to 84 degrees."""
    rng = np.random.default_rng(3)
    phi = np.arcsin(rng.uniform(-0.995, 0.995, count))
    return np.mod(view.facing + phi, 2 * np.pi), rng.uniform(-1, 6, count)


@each
def test_there_and_back(view):
    theta, z = seen(view)
    x, y, cos_phi = view.to_image(theta, z)
    back = view.to_surface(x, y)
    np.testing.assert_allclose(back, (theta, z, cos_phi), rtol=0, atol=1e-12)
    np.testing.assert_allclose(view.to_image(*back[:2])[:2], (x, y), rtol=0, atol=1e-12 * 1000)
    assert np.all(cos_phi > 0)


@each
def test_the_jacobian_is_the_derivative(view):
    theta, z = seen(view)
    step = 1e-5
    around = [
        np.subtract(*pair) / (2 * step)
        for pair in zip(view.to_image(theta + step, z)[:2], view.to_image(theta - step, z)[:2], strict=True)
    ]
    along = [
        np.subtract(*pair) / (2 * step)
        for pair in zip(view.to_image(theta, z + step)[:2], view.to_image(theta, z - step)[:2], strict=True)
    ]
    found = view.jacobian(theta, z)
    assert found.shape == (2, 2, theta.size)
    np.testing.assert_allclose(found / 100, np.stack([around, along], axis=1) / 100, rtol=0, atol=1e-7)
    determinant = np.linalg.det(np.moveaxis(found, -1, 0))
    sign = 1 if view.mirrored else -1  # of (x, y down) against (theta, z)
    np.testing.assert_allclose(determinant, sign * 100**2 * view.to_image(theta, z)[2], rtol=1e-9)


@each
def test_velocities_there_and_back(view):
    theta, z = seen(view)
    u = np.random.default_rng(4).normal(size=(2, theta.size))
    x, y, _ = view.to_image(theta, z)
    v = view.velocity_to_image(theta, z, *u)
    np.testing.assert_allclose(view.velocity_to_surface(x, y, *v), u, rtol=0, atol=1e-12)
    moved = np.einsum("ij...,j...->i...", view.jacobian(theta, z), u)
    np.testing.assert_allclose(v, moved, rtol=0, atol=1e-9)


@each
def test_angles_of_lines(view):
    theta, z = seen(view)
    psi = np.random.default_rng(5).uniform(-np.pi / 2, np.pi / 2, theta.size)
    x, y, cos_phi = view.to_image(theta, z)
    angle = view.angle_to_image(theta, z, psi)
    for turn in (0, np.pi, -np.pi):  # a line has no polarity
        off = view.angle_to_surface(x, y, angle + turn) - psi
        np.testing.assert_allclose(np.sin(off), 0.0, atol=1e-10)
    # The end of a short line along psi, seen in the image.
    ahead = view.to_image(theta + 1e-6 * np.sin(psi), z + 1e-6 * np.cos(psi))
    drawn = np.arctan2(-(ahead[1] - y), ahead[0] - x)
    np.testing.assert_allclose(np.sin(drawn - angle), 0.0, atol=2e-4 / cos_phi.min())


def test_the_hand():
    """With z to the right and e_out to the viewer, e_z x e_out points down; with z up, to the right."""
    right, up = View(1.0), View(1.0, axis_deg=90.0)
    np.testing.assert_allclose(right.e_across, [0, 1], atol=1e-15)
    np.testing.assert_allclose(up.e_across, [1, 0], atol=1e-15)
    np.testing.assert_allclose(up.e_z, [0, -1], atol=1e-15)
    for view in VIEWS:
        e_z, across = (np.array([*each, 0.0]) * [1, -1, 1] for each in (view.e_z, view.e_across))
        expected = np.cross(e_z, [0, 0, 1]) * (-1 if view.mirrored else 1)
        np.testing.assert_allclose(across, expected, atol=1e-15)


def test_a_right_handed_helix_looks_left_handed_in_a_mirror():
    """On the near side a right-handed helix about an upright axis rises to the right."""
    view, mirror = View(100.0, 90.0), View(100.0, 90.0, mirrored=True)
    at = np.pi + np.array([0.0, 0.1])
    for camera, sign in ((view, 1), (mirror, -1)):
        x, y, _ = camera.to_image(at, np.array([0.0, 0.1]))
        assert y[1] < y[0]
        assert np.sign(x[1] - x[0]) == sign


def test_outside_the_rim_there_is_nothing():
    view = View(50.0, 30.0, (10.0, 20.0))
    x, y = np.meshgrid(np.arange(-80.0, 100.0, 7), np.arange(-90.0, 120.0, 7))
    found = view.to_surface(x, y)
    distance = np.abs((x - 10) * view.e_across[0] + (y - 20) * view.e_across[1])
    for part in (*found, *view.velocity_to_surface(x, y, 1.0, 1.0), view.angle_to_surface(x, y, 0.5)):
        np.testing.assert_array_equal(np.isnan(part), distance > 50.0)


def test_the_far_side_is_told_by_the_cosine():
    view = View(100.0)
    assert view.to_image(np.pi + 2.0, 0.0)[2] < 0
    np.testing.assert_allclose(view.phi(np.array([np.pi - 0.2, 3 * np.pi + 0.2])), [-0.2, 0.2], atol=1e-14)


@pytest.mark.parametrize(
    ("radius_um", "depth_um", "degrees"), [(500, 9, 11), (500, 60, 28), (500, 120, 40.5), (20, 1.2, 20)]
)
def test_the_sharp_cap(radius_um, depth_um, degrees):
    least, most = View(radius_um / 5).sharp(depth_um / 5)
    assert least == 0.0
    assert np.degrees(most) == pytest.approx(degrees, abs=0.6)


def test_a_focal_stack_covers_the_half_in_rings():
    view = View(100.0)
    rings = [view.sharp(25.0, focus) for focus in (0.0, 25.0, 50.0, 75.0)]
    assert rings[0][0] == 0.0
    assert rings[-1][1] == pytest.approx(np.pi / 2)
    assert all(a[1] == pytest.approx(b[0]) for a, b in pairwise(rings))
    assert np.isnan(view.sharp(10.0, 120.0)).all()


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ({"radius_px": 0.0}, "radius_px = 0.0"),
        ({"radius_px": np.nan}, "radius_px"),
        ({"radius_px": 10.0, "axis_deg": "17"}, "axis_deg = '17'"),
        ({"radius_px": 10.0, "centre_px": 3.0}, "centre_px = 3.0"),
        ({"radius_px": 10.0, "centre_px": (1.0, np.inf)}, "centre_px"),
        ({"radius_px": 10.0, "facing": None}, "facing"),
        ({"radius_px": 10.0, "mirrored": 1}, "mirrored = 1"),
    ],
)
def test_settings_that_cannot_be_used(settings, message):
    with pytest.raises(cy.InputError, match=message):
        View(**settings)


def test_kept_in_a_file():
    view = View(100.0, 17.0, (30.0, 225.0), 0.4, True)
    assert View.from_dict(view.to_dict() | {"pixel_um": 5.0}) == view
    with pytest.raises(cy.InputError, match="radius_px"):
        View.from_dict({"axis_deg": 3.0})
