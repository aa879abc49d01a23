import json

import numpy as np
import psutil
import pytest
import xarray

import cyclosis as cy

GRID = cy.CylinderGrid(48, 16, 2.0)


@pytest.fixture(scope="module")
def result():
    params = cy.Parameters(alpha_p=np.full(GRID.shape, 0.9))
    return cy.simulate(
        params, GRID, cy.initial.disordered(GRID, 50), t_end=12.0, save_every=4.0, record_every=1.0
    )


def same(a, b):
    for name in ("created", "wall_time_seconds"):
        a.attrs.pop(name, None), b.attrs.pop(name, None)
    xarray.testing.assert_identical(a, b)


def test_a_dataset_from_disk_equals_one_from_memory(result, tmp_path):
    path = cy.write(result, tmp_path / "run.nc")
    with cy.open_dataset(path) as stored:
        same(stored.load(), result.to_dataset())


def test_fields_and_scalars_are_those_of_the_run(result):
    data = result.to_dataset()
    assert data.P.dims == data.u.dims == ("time", "component", "theta", "z")
    assert data.P.values[2] == pytest.approx(result.frames[2])
    assert data.u.values[2] == pytest.approx(cy.flow(result.params, GRID, result.frames[2]), abs=1e-14)
    assert data.order.sizes == {"record_time": 13}
    assert data.zone_angle.sel(time=12.0).values[: int(data.zone_count[-1])] == pytest.approx(
        cy.zones.zone_angles(result.final_state[1].mean(axis=1))
    )
    for name, variable in data.variables.items():
        assert variable.attrs["units"] == "1", name
        assert variable.attrs["long_name"], name


def test_scalars_share_the_time_of_fields_recorded_together():
    run = cy.simulate(cy.Parameters(), GRID, cy.initial.disordered(GRID), t_end=2.0)
    assert run.to_dataset().order.dims == ("time",)


def test_provenance_says_what_was_asked_and_what_happened(result):
    attributes = result.to_dataset().attrs
    asked, happened = json.loads(attributes["configuration"]), json.loads(attributes["outcome"])
    assert asked["grid"] == {"n_theta": 48, "n_z": 16, "length": 2.0}
    assert asked["parameters"]["alpha_p"] == "field"
    assert happened["status"] == str(result.status)
    assert len(attributes["configuration_sha256"]) == 64


def test_nothing_is_overwritten_unless_forced(result, tmp_path):
    path = tmp_path / "run.nc"
    path.write_text("precious")
    with pytest.raises(cy.InputError, match="force"):
        cy.write(result, path)
    assert path.read_text() == "precious"
    cy.write(result, path, force=True)
    assert cy.open_dataset(path).sizes["time"] == 4
    assert [p.name for p in tmp_path.iterdir()] == ["run.nc"], "no temporary file is left behind"


@pytest.mark.parametrize("place", ["missing/run.nc", "."])
def test_places_that_cannot_be_written_are_named(result, tmp_path, place):
    with pytest.raises(cy.InputError, match="out"):
        cy.write(result, tmp_path / place)


@pytest.mark.parametrize("content", [None, b"", b"nonsense", b"\x89HDF\r\n\x1a\nbroken"])
def test_other_files_are_refused(tmp_path, content):
    path = tmp_path / "x.nc"
    if content is not None:
        path.write_bytes(content)
    with pytest.raises(cy.InputError, match="file"):
        cy.open_dataset(path)


def test_foreign_netcdf_is_refused(tmp_path):
    xarray.Dataset({"a": ("x", [1.0])}).to_netcdf(tmp_path / "x.nc", engine="h5netcdf")
    with pytest.raises(cy.InputError, match="cyclosis run"):
        cy.open_dataset(tmp_path / "x.nc")


def test_a_stored_state_is_a_valid_initial_state(result, tmp_path):
    path = cy.write(result, tmp_path / "run.nc")
    assert np.array_equal(cy.initial.from_file(str(path), GRID), result.final_state)
    assert np.array_equal(cy.initial.from_file(str(path), GRID, frame=1), result.frames[1])
    with pytest.raises(cy.InputError, match="frame"):
        cy.initial.from_file(str(path), GRID, frame=4)


def test_leaving_a_dataset_closes_its_file(result, tmp_path):
    path = cy.write(result, tmp_path / "closed.nc")

    def is_open():
        return str(path) in [file.path for file in psutil.Process().open_files()]

    with cy.open_dataset(path) as data:
        assert data["order"].size
        assert is_open()
    assert not is_open()


def test_force_begins_anew_over_what_is_damaged(result, tmp_path):
    folder = tmp_path / "run.nc.unfinished"
    folder.mkdir()
    (folder / "000000.nc").write_bytes(b"garbage")
    with pytest.raises(cy.InputError):
        cy.RunWriter(tmp_path / "run.nc")
    cy.RunWriter(tmp_path / "run.nc", force=True).finish(result)
    assert cy.load(tmp_path / "run.nc").t_final == result.t_final


def test_a_packed_file_is_no_state(tmp_path):
    (tmp_path / "state.npy").write_bytes(b"PK\x03\x04 and so on")
    with pytest.raises(cy.InputError, match="readable"):
        cy.initial.from_file(str(tmp_path / "state.npy"), cy.CylinderGrid(16, 16))
