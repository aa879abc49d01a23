"""cyclosis measure and cyclosis compare."""

import numpy as np
import pytest
import xarray

import cyclosis as cy
from measure.commandline import said
from measured import LENGTH, SAMPLES, run_of

RAW = SAMPLES / "openpiv_transient_raw_pixels_y_down.txt"
UNITS = ("--y", "down", "--speed", "px/s", "--pixel-um", "5", "--frame-s", "0.3")
CELL = ("--radius-um", "500", "--axis", "17", "--centre", "30,225", "--not-mirrored")


@pytest.fixture(autouse=True)
def here(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)


def test_what_a_file_holds_is_shown():
    code, out, err = said("measure", RAW, *UNITS)
    assert (code, err) == (0, "")
    assert "openpiv" in out
    assert "22 x 13" in out
    assert "--radius-um" in out


def test_what_is_missing_is_asked_for():
    for left_out, word in (("--y", "--y down"), ("--speed", "--speed UNIT")):
        given = [w for k in range(0, len(UNITS), 2) if UNITS[k] != left_out for w in UNITS[k : k + 2]]
        code, _, err = said("measure", RAW, *given)
        assert code == 2
        assert word in err
    for left_out, word in (("--axis", "--axis DEGREES"), ("--centre", "--centre X,Y")):
        at = CELL.index(left_out)
        code, _, err = said("measure", RAW, *UNITS, *CELL[:at], *CELL[at + 2 :])
        assert code == 2
        assert word in err
    assert "SystemExit" not in said("measure", "nowhere.txt")[2]
    assert said("measure", RAW, *UNITS, *CELL, "--out", "cell.txt")[0] == 2


def test_a_measurement_becomes_a_file_and_pictures():
    code, out, err = said(
        "measure", RAW, *UNITS, *CELL, "--out", "cell.nc", "-o", "cell.png", "--depth-um", "120"
    )
    assert (code, err) == (0, "")
    assert "saved cell.nc" in out
    with xarray.open_dataset("cell.nc", engine="h5netcdf") as data:  # as anybody would
        assert data["u"].dims == ("time", "component", "theta", "z")
        assert data["time"].dtype == float
        assert data["u"].attrs["units"] == "s-1"
        for name in (
            "source_file",
            "format",
            "view",
            "radius_um",
            "pixel_um",
            "frame_s",
            "noise_px",
            "Conventions",
        ):
            assert name in data.attrs
    assert said("measure", RAW, *UNITS, *CELL, "--out", "cell.nc")[0] == 2  # it exists
    again = cy.observations.read("cell.nc")
    assert again.on_surface()["u"].sizes == {
        "time": 1,
        "component": 2,
        "theta": again.on_surface().sizes["theta"],
        "z": again.on_surface().sizes["z"],
    }
    code, out, _ = said("measure", "cell.nc")
    assert code == 0
    assert "surface" in out


def test_compare_a_file_with_a_run(tmp_path):
    assert said("measure", RAW, *UNITS, *CELL, "--out", "cell.nc")[0] == 0
    grid = cy.CylinderGrid(16, 16, LENGTH)
    cy.write(cy.simulate(cy.Parameters(), grid, cy.initial.stripes(grid), 1.0), "run.nc")
    code, out, err = said("compare", "cell.nc", "run.nc", "--out", "fit.png", "--out", "fit.nc")
    assert (code, err) == (0, "")
    assert "rotation" in out
    with xarray.open_dataset("fit.nc", engine="h5netcdf") as data:
        assert {"measured", "model", "residual"} <= set(data)
    assert said("compare", "run.nc", "run.nc")[0] == 2
    assert said("compare", "cell.nc", "cell.nc")[0] == 2


def test_units_of_a_run():
    code, _, err = said(
        "measure", RAW, *UNITS, *CELL, "--speed-um-per-s", "100", "--out", "cell.nc", "--quiet"
    )
    assert (code, err) == (0, "")
    found = cy.observations.compare("cell.nc", run_of("u_transient"))
    assert found.speed == 1.0
    assert found.rms_of_peak < 0.035
    assert np.isfinite(found.rms)
