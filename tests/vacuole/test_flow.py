"""What the flow in the vacuole is, as one value: points, tables, sections, files, closures and symmetries."""

import re
import subprocess
import sys

import numpy as np
import pytest
import xarray

import cyclosis as cy
from cyclosis.model import bessel
from cyclosis.vacuole.tables import Table, spectrum_of
from measure import band_limited

GRID = cy.CylinderGrid(20, 17, 3.0)
RADII = np.array([0.0, 0.2, 0.7, 1.0])


def wall(seed=2, grid=GRID, mean=0.4):
    """A smooth velocity with divergence and a mean along z."""
    u = band_limited(seed, grid.shape, (6, 5))
    u[1] += mean - u[1].mean()
    return u


def flow(closure="zero_flux", **changes):
    return cy.vacuole.flow(GRID, wall(**changes), closure=closure)


def places(radii, grid, shape):
    theta, z = 2 * np.pi / shape[0] * np.arange(shape[0]), grid.length / shape[1] * np.arange(shape[1])
    return np.stack([part.ravel() for part in np.meshgrid(radii, theta, z, indexing="ij")], axis=1)


@pytest.mark.parametrize("closure", cy.vacuole.CLOSURES)
@pytest.mark.parametrize("shape", [None, (40, 32)])
def test_tables_are_the_sums_over_waves(closure, shape):
    found = flow(closure)
    points = places(RADII, GRID, shape or GRID.shape)
    summed = found.at(points).T.reshape(3, RADII.size, *(shape or GRID.shape))
    np.testing.assert_allclose(found.volume(RADII, shape), summed, rtol=0, atol=1e-14)
    pressure = found.pressure_at(points).reshape(summed.shape[1:])
    np.testing.assert_allclose(found.pressure_volume(RADII, shape), pressure, rtol=0, atol=2e-13)


@pytest.mark.parametrize("closure", cy.vacuole.CLOSURES)
def test_the_wall_moves_as_it_was_told(closure):
    found = flow(closure)
    np.testing.assert_allclose(found.volume([1.0])[1:, 0], wall(), rtol=0, atol=1e-15)
    assert np.abs(found.volume([1.0])[0]).max() < 1e-16
    np.testing.assert_allclose(found.surface, wall(), rtol=0, atol=1e-15)


@pytest.mark.parametrize("closure", cy.vacuole.CLOSURES)
def test_sections_are_the_flow_at_their_points(closure):
    found = flow(closure)
    pixels = found.section(1.1, points=9)
    x, y = (axis.ravel() for axis in np.meshgrid(pixels["x"], pixels["y"], indexing="ij"))
    inside = np.hypot(x, y) <= 1
    points = np.stack([np.hypot(x, y), np.arctan2(y, x), np.full(x.size, 1.1)], axis=1)[inside]
    for name, values in zip(("v_x", "v_y", "v_z"), found.cartesian_at(points).T, strict=True):
        drawn = pixels[name].values.ravel()
        np.testing.assert_allclose(drawn[inside], values, rtol=0, atol=1e-14)
        assert np.isnan(drawn[~inside]).all()
    polar = found.section(1.1, radii=RADII, n_theta=7)
    angles = 2 * np.pi / 7 * np.arange(7)
    points = np.stack([np.repeat(RADII, 7), np.tile(angles, 4), np.full(28, 1.1)], axis=1)
    for name, values in zip(("v_r", "v_theta", "v_z"), found.at(points).T, strict=True):
        np.testing.assert_allclose(polar[name].values.ravel(), values, rtol=0, atol=1e-14)
    np.testing.assert_allclose(
        polar["pressure"].values.ravel(), found.pressure_at(points), rtol=0, atol=1e-13
    )


def test_closures_differ_by_a_poiseuille_flow():
    closed, open_ = flow("zero_flux"), flow("no_pressure_drop")
    points = places(RADII, GRID, (5, 4))
    difference = open_.at(points) - closed.at(points)
    np.testing.assert_allclose(difference[:, 2], 0.4 * 2 * (1 - points[:, 0] ** 2), rtol=0, atol=1e-15)
    assert np.abs(difference[:, :2]).max() < 1e-16
    np.testing.assert_allclose(
        closed.pressure_at(points) - open_.pressure_at(points), 8 * 0.4 * points[:, 2], rtol=0, atol=1e-13
    )
    assert (closed.flux, open_.pressure_gradient) == (0.0, 0.0)
    assert open_.flux == pytest.approx(0.4 * np.pi)
    assert closed.pressure_gradient == pytest.approx(3.2)
    # ∫ 2 e:e of v_z = 2b(1 - r²), whose stress at the wall is 4b
    area = 2 * np.pi * GRID.length
    assert closed.dissipation - open_.dissipation == pytest.approx(4 * 0.4**2 * area, rel=1e-12)


def test_the_axis_is_no_special_place():
    found = flow()
    near = found.cartesian_at([[1e-12, theta, 0.3] for theta in np.arange(6)])
    on = found.cartesian_at([[0.0, theta, 0.3] for theta in np.arange(6)])
    assert np.ptp(on, axis=0).max() < 1e-15
    np.testing.assert_allclose(near, on, rtol=0, atol=1e-11)


def test_symmetries():
    """A wall that is turned, shifted or mirrored drives the flow that is."""
    found, points = flow(), places([0.3, 0.9], GRID, (4, 3))
    turned = cy.vacuole.flow(GRID, np.roll(wall(), (3, 5), (1, 2)))
    move = [0.0, 3 * 2 * np.pi / GRID.n_theta, 5 * GRID.length / GRID.n_z]
    np.testing.assert_allclose(turned.at(points + move), found.at(points), rtol=0, atol=1e-15)
    mirrored = wall()[:, -np.arange(GRID.n_theta)] * np.array([-1.0, 1.0])[:, None, None]
    other = cy.vacuole.flow(GRID, mirrored).at(points * [1, -1, 1])
    np.testing.assert_allclose(other * [1, -1, 1], found.at(points), rtol=0, atol=1e-15)
    upside_down = wall()[:, :, -np.arange(GRID.n_z)] * np.array([1.0, -1.0])[:, None, None]
    other = cy.vacuole.flow(GRID, upside_down).at(points * [1, 1, -1])
    np.testing.assert_allclose(other * [1, 1, -1], found.at(points), rtol=0, atol=1e-15)


def test_the_response_is_symmetric():
    """∫ τ(u)·w = ∫ τ(w)·u, which holds for Stokes flow."""
    one, other = flow(seed=2, mean=0.0), flow(seed=3, mean=0.0)
    forth, back = (np.sum(a.wall_traction * b.surface) for a, b in ((one, other), (other, one)))
    assert forth == pytest.approx(back, rel=1e-12)
    assert abs(forth) > 1.0


def test_nyquist_modes_are_dropped():
    grid = cy.CylinderGrid(8, 10, 2.0)
    u = np.ones((2, *grid.shape))
    jagged = u + (-1.0) ** np.arange(8)[:, None] + 0.5 * (-1.0) ** np.arange(10)
    np.testing.assert_allclose(cy.vacuole.flow(grid, jagged).surface, u, rtol=0, atol=1e-14)
    assert spectrum_of(u).shape == (2, 7, 5)


def test_high_waves_in_short_and_long_cells_are_finite():
    """Where I_n itself underflows or overflows."""
    for length in (0.2, 1000.0):
        grid = cy.CylinderGrid(600, 64, length)
        radii = np.array([0.0, 1e-9, 0.1, 0.5, 0.999, 1.0])
        found = Table(grid, radii).radial
        assert all(np.all(np.isfinite(part)) for part in found)
        assert np.abs(found.theta_a[-1] - 1).max() < 1e-12
    assert np.all(np.isfinite(bessel.ratios(500, [0.0, 1e-8, 1e4])))


def test_datasets_and_vtk_files_hold_the_volume(tmp_path):
    found = flow()
    data = found.to_dataset(RADII)
    np.testing.assert_array_equal(data["v"].values, found.volume(RADII))
    assert data.attrs["dissipation"] == found.dissipation
    data.to_netcdf(tmp_path / "volume.nc", engine="h5netcdf")
    with xarray.open_dataset(tmp_path / "volume.nc", engine="h5netcdf") as again:
        np.testing.assert_array_equal(again["pressure"].values, found.pressure_volume(RADII))
    path = found.to_vtk(tmp_path / "volume.vts", RADII)
    points, vectors = vtk_arrays(path, "points"), vtk_arrays(path, "v")
    assert points.shape == (18 * 21 * 4, 3)
    r, theta = np.hypot(points[:, 0], points[:, 1]), np.arctan2(points[:, 1], points[:, 0])
    expected = found.cartesian_at(np.stack([r, theta, points[:, 2]], axis=1))
    away = r > 0  # on the axis the angle is lost, and any gives the same
    np.testing.assert_allclose(vectors[away], expected[away], rtol=0, atol=1e-13)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["volume.nc", "volume.vts"]


def vtk_arrays(path, name):
    """Return an array (n, 3) of a VTK file whose data are appended in raw form."""
    raw = path.read_bytes()
    head, _, data = raw.partition(b'<AppendedData encoding="raw">')
    start = data.index(b"_") + 1
    offset = int(re.search(rf'Name="{name}"[^>]*offset="(\d+)"'.encode(), head)[1])
    size = int(np.frombuffer(data, np.uint64, 1, start + offset)[0])
    return np.frombuffer(data, np.float64, size // 8, start + offset + 8).reshape(-1, 3)


@pytest.mark.parametrize(
    ("message", "wrong"),
    [
        ("r of points = 1.1 cannot be used", lambda: flow().at([[1.1, 0.0, 0.0]])),
        ("r of points = -0.1 cannot be used", lambda: flow().at([[-0.1, 0.0, 0.0]])),
        ("points = an array of shape", lambda: flow().at([0.1, 0.0, 0.0])),
        ("finite everywhere", lambda: flow().at([[0.1, np.nan, 0.0]])),
        ("radii = 2.0 cannot be used", lambda: flow().volume([0.5, 2.0])),
        ("shape = ", lambda: flow().volume([0.5], (8, 8))),
        ("u = an array of shape", lambda: cy.vacuole.flow(GRID, np.ones((2, 3, 4)))),
        ("finite everywhere", lambda: cy.vacuole.flow(GRID, np.full((2, *GRID.shape), np.inf))),
        ("closure = 'open'", lambda: flow("open")),
        ("interpolation = 'spline'", lambda: cy.vacuole.flow(GRID, wall(), interpolation="spline")),
        ("u = None cannot be used", lambda: cy.vacuole.flow(GRID)),
        ("t = 1.0 cannot be used", lambda: cy.vacuole.flow(GRID, wall(), t=1.0)),
        ("source = ", lambda: cy.vacuole.flow(wall())),
        ("m = 0.5 cannot be used", lambda: cy.vacuole.drag(0.5, 1.0)),
        ("broadcasts", lambda: cy.vacuole.drag([1, 2], [1.0, 2.0, 3.0])),
        ("points = 9 cannot be used", lambda: flow().section(0.0, points=9, radii=[0.5])),
        ("path = 'v.vtk'", lambda: flow().to_vtk("v.vtk")),
        ("path = 'nowhere/v.vts'", lambda: flow().to_vtk("nowhere/v.vts")),
    ],
)
def test_what_cannot_be_used_is_refused_in_one_sentence(message, wrong):
    with pytest.raises(cy.InputError) as caught:
        wrong()
    assert message in str(caught.value)
    assert "\n" not in str(caught.value)


def test_special_functions_load_only_when_a_flow_is_evaluated():
    code = (
        "import cyclosis as cy, sys, numpy as np; cy.vacuole; cy.vacuole.drag(1, 1.0); "
        "assert not {'scipy.special', 'pyevtk'} & set(sys.modules), 'loaded'"
    )
    subprocess.run([sys.executable, "-c", code], check=True)
