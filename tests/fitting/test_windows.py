"""Vectors of windows: the mean over a square of the image, and its inverse."""

import json

import numpy as np
import pytest
import xarray

import cyclosis as cy
from cyclosis.fitting.film import film_of
from cyclosis.fitting.windows import Window, averaging, sharpened, window_of

FACING, LENGTH = 2.0, 5.0
M, Q = np.arange(-3, 4), 2 * np.pi / LENGTH * np.arange(0, 4)


def wave(theta, z, m, q):
    return np.exp(1j * (m * theta + q * z))


def brute(side, angle, theta, z, m, q, n=200):
    """Return the mean over a turned square of points of the image, with the density 1/cos φ of particles."""
    t = side * ((np.arange(n) + 0.5) / n - 0.5)
    a, b = np.meshgrid(t, t, indexing="ij")
    along, across = np.cos(angle) * a + np.sin(angle) * b, np.sin(angle) * a - np.cos(angle) * b
    phi = np.arcsin(np.sin(theta - FACING) + across)
    weight = 1 / np.cos(phi)
    values = wave(FACING + phi, z + along, m, q)
    mean = [(weight * f * values).sum() / weight.sum() for f in (np.cos(phi), 1.0)]
    return mean[0] / np.cos(theta - FACING), mean[1]


@pytest.mark.parametrize("angle", [0.0, 0.3, np.pi / 2, -1.2])
def test_the_mean_over_a_square_of_the_image(angle):
    theta, window = FACING + np.array([-0.9, 0.0, 0.5]), Window(0.3, angle)
    found = averaging(window, theta, FACING, M, Q)
    for k, at in enumerate(theta):
        for i, m in enumerate(M):
            for j, q in enumerate(Q):
                expected = brute(window.side, angle, at, 0.0, m, q)
                assert found[:, k, i, j] == pytest.approx(np.array(expected), abs=2e-3)


def test_no_window_is_the_value_at_the_point():
    theta = np.array([1.5, 2.5])
    point = averaging(None, theta, FACING, M, Q)
    assert point[1, :, :, 2] == pytest.approx(wave(theta[:, None], 0.0, M, 0.0))
    assert averaging(Window(1e-4), theta, FACING, M, Q) == pytest.approx(point, abs=1e-6)


@pytest.mark.parametrize(("angle", "mirrored"), [(17.0, False), (60.0, True), (-100.0, False)])
def test_the_microscope_and_the_fit_agree_on_windows(angle, mirrored):
    """Vectors of the synthetic microscope are what the operator makes of the waves of the run."""
    grid = cy.CylinderGrid(24, 24, LENGTH)
    run = cy.simulate(cy.Parameters(), grid, cy.initial.disordered(grid, 40.0, 2), t_end=4.0)
    view = cy.observations.View(100.0, angle, facing=FACING, mirrored=mirrored)
    shot = cy.observations.observe(run, view, "piv", window_px=40, step_px=8, noise_px=1e-9, times=[4.0])
    data, camera = shot.data, shot.camera
    x, y = np.meshgrid(data["x"], data["y"])
    theta, z, cos_phi = camera.view.to_surface(x, y)
    good = (cos_phi > 0.75) & np.isfinite(data["vx"][0].values)
    vx, vy = (data[name][0].values[good] for name in ("vx", "vy"))
    seen = np.stack(camera.view.velocity_to_surface(x[good], y[good], vx, vy))
    seen /= camera.step
    theta, z = theta[good], z[good]
    waves = np.fft.fft2(run.to_dataset()["u"].isel(time=-1).values, norm="forward")
    attributes = {"window_px": 40.0, "radius_px": 100.0, "view": json.dumps(view.to_dict())}
    known = xarray.Dataset(
        {"u": (("component", "theta", "z"), np.ones((2, 1, 1)))}, {"theta": [FACING], "z": [0.0]}
    )
    window = window_of(film_of(known.assign_attrs(attributes), None), None)
    assert window.side == pytest.approx(0.4)
    operator = averaging(window, theta, FACING, grid.m, grid.q)
    model = np.einsum("camn,cmn,an->ca", operator, waves, np.exp(1j * np.outer(z, grid.q))).real
    point = averaging(None, theta, FACING, grid.m, grid.q)
    plain = np.einsum("camn,cmn,an->ca", point, waves, np.exp(1j * np.outer(z, grid.q))).real
    size = np.sqrt(np.mean(plain**2))
    assert np.sqrt(np.mean((model - seen) ** 2)) < 0.01 * size
    assert np.sqrt(np.mean((plain - seen) ** 2)) > 0.04 * size


@pytest.mark.parametrize(("axis", "mirrored"), [(20.0, False), (20.0, True), (-110.0, True), (250.0, False)])
def test_the_ends_of_strips_lie_on_the_square_of_the_image(axis, mirrored):
    view = cy.observations.View(100.0, axis, (7.0, 9.0), FACING, mirrored)
    attributes = {"window_px": 30.0, "radius_px": 100.0, "view": json.dumps(view.to_dict())}
    known = xarray.Dataset(
        {"u": (("component", "theta", "z"), np.ones((2, 1, 1)))}, {"theta": [FACING], "z": [0.0]}
    )
    x, *ends = window_of(film_of(known.assign_attrs(attributes), None), None).strips()
    inside = ends[1] > ends[0]
    assert inside.sum() > 20
    for z in ends:
        right, down, _ = view.to_image(FACING + np.arcsin(x[inside]), z[inside])
        assert np.maximum(np.abs(right - 7.0), np.abs(down - 9.0)) == pytest.approx(15.0, abs=1e-9)


def test_the_mean_is_undone_to_fourth_order():
    """A window of half the side leaves a sixteenth of the error."""
    theta, z = FACING + np.linspace(-0.9, 0.9, 181), np.linspace(0, 2, 201)
    errors = []
    for side in (0.3, 0.15):
        window = Window(side, 0.3)
        operator = averaging(window, theta, FACING, M, Q)[:, :, 5, 2]
        u = np.einsum("ca,b->cab", operator, np.exp(1j * Q[2] * z)).real
        data = xarray.Dataset(
            {"u": (("component", "theta", "z"), u)}, {"theta": theta, "z": z}, {"facing": FACING}
        )
        found = sharpened(film_of(data, None), window)
        exact = wave(found.theta[:, None], found.z, M[5], Q[2]).real
        inner = found.seen & (np.abs(found.theta - FACING) < 0.6)[:, None]
        errors.append([np.abs(found.u[0, c] - exact)[inner].max() for c in range(2)])
        plain = np.abs(u[1] - wave(theta[:, None], z, M[5], Q[2]).real)[np.abs(theta - FACING) < 0.5]
        assert plain.max() > 6 * errors[-1][1]
    assert np.all(np.array(errors[0]) > 10 * np.array(errors[1]))
