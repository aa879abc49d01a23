import xml.etree.ElementTree as ET

import numpy as np
import pytest
import xarray

import cyclosis as cy
from cyclosis.dataset import export_vtk

GRID = cy.CylinderGrid(16, 12, 3.0)


@pytest.fixture(scope="module")
def data():
    run = cy.simulate(cy.Parameters(), GRID, cy.initial.stripes(GRID), t_end=1.0, save_every=0.5)
    return run.to_dataset()


def read(path):
    """Return the points and point data of a .vts file with appended raw data, read by its own rules."""
    raw = path.read_bytes()
    head, _, tail = raw.partition(b'<AppendedData encoding="raw">')
    start = tail.index(b"_") + 1
    root = ET.fromstring(head + b"</VTKFile>")
    out = {}
    for array in root.iter("DataArray"):
        offset = start + int(array.get("offset"))
        size = int(np.frombuffer(tail, np.uint64, 1, offset)[0])
        values = np.frombuffer(tail, np.float64, size // 8, offset + 8)
        parts = int(array.get("NumberOfComponents", "1"))
        out[array.get("Name")] = values.reshape(-1, parts) if parts > 1 else values
    return out


def test_vectors_lie_on_the_surface_and_keep_their_length(data, tmp_path):
    collection = export_vtk(data, tmp_path / "run")
    times = [float(item.get("timestep")) for item in ET.parse(collection).iter("DataSet")]
    assert times == [0.0, 0.5, 1.0]
    stored = read(tmp_path / "run" / "frame-00002.vts")
    points, P = stored["points"], stored["P"]
    assert points.shape == (17 * 13, 3)
    assert np.hypot(points[:, 0], points[:, 1]) == pytest.approx(np.ones(17 * 13))
    assert points[:, 2].max() == pytest.approx(3.0)
    assert np.sum(P[:, :2] * points[:, :2], axis=1) == pytest.approx(np.zeros(17 * 13), abs=1e-15)
    assert P[:, 2] == pytest.approx(stored["P_z"])
    state = data.P.values[-1]
    closed = np.pad(state, ((0, 0), (0, 1), (0, 1)), mode="wrap")
    assert np.linalg.norm(P, axis=1) == pytest.approx(np.hypot(*closed).ravel(order="F"))


def test_a_folder_in_use_is_left_alone(data, tmp_path):
    (tmp_path / "run").mkdir()
    (tmp_path / "run" / "precious").write_text("x")
    with pytest.raises(cy.InputError, match="force"):
        export_vtk(data, tmp_path / "run")
    export_vtk(data, tmp_path / "run", force=True)
    with pytest.raises(cy.InputError, match="folder"):
        export_vtk(data, tmp_path / "no" / "run")


def test_a_part_of_a_cell_is_not_closed_to_a_whole_one(data, tmp_path):
    with pytest.raises(cy.InputError, match=r"z in the dataset .* the whole cell"):
        export_vtk(data.isel(z=slice(0, 4)), tmp_path / "part")
    assert list(tmp_path.iterdir()) == []


def test_a_closed_surface_has_its_shape_and_its_poles(tmp_path):
    """A rotation about the y axis is one field in space, e_y x (x, y, z) but for its size, poles included."""
    grid = cy.ClosedGrid(cy.Sphere(), k_max=6)
    state = cy.closed.rotation(grid)
    dims = ("time", "component", "theta", "s")
    fields = dict.fromkeys(("P", "u"), (dims, state[None]))
    shape = {name: (item.dims, item.values) for name, item in cy.models.closed.geometry(grid).items()}
    coords = {"time": [0.0], "theta": grid.theta, "s": grid.s, "component": ["theta", "s"]}
    data = xarray.Dataset(fields | shape, coords)
    export_vtk(data, tmp_path / "run")
    stored = read(tmp_path / "run" / "frame-00000.vts")
    points, found = stored["points"], stored["P"]
    assert points.shape == ((grid.n_theta + 1) * (grid.n_s + 2), 3)
    assert np.linalg.norm(points, axis=1) == pytest.approx(np.ones(len(points)), abs=1e-4)
    assert np.abs(points[:, 2]).max() == pytest.approx(1.0, abs=1e-4)
    size = np.hypot(*state).max() / np.hypot(grid.xyz[2], grid.xyz[0]).max()
    expected = size * np.stack([points[:, 2], 0 * points[:, 2], -points[:, 0]], axis=1)
    assert found == pytest.approx(expected, abs=1e-3)
    tangent = stored["P_theta"] ** 2 + stored["P_s"] ** 2
    assert np.sum(found**2, axis=1) == pytest.approx(tangent)
    with pytest.raises(cy.InputError, match=r"s in the dataset .* from pole to pole"):
        export_vtk(data.isel(s=slice(0, 10)), tmp_path / "part")
