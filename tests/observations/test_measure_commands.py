"""cyclosis measure and cyclosis compare."""

import re

import numpy as np
import pytest
import xarray

import cyclosis as cy
from cyclosis.observations.films import reading
from cyclosis.observations.microscope.files import WRITERS
from measure.commandline import said
from measured import LENGTH, SAMPLES, run_of
from observed import RUN, velocity

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


def test_all_that_is_missing_is_asked_for_at_once():
    assert "--y up and --speed UNIT." in said("measure", RAW)[2]
    err = said("measure", RAW, *UNITS, "--out", "cell.nc")[2]
    assert all(option in err for option in ("--radius-um or --radius-px", "--axis DEGREES", "--centre X,Y"))
    assert "*.txt" in said("measure", RAW.parent)[2]


def test_a_pattern_is_expanded_where_the_shell_did_not(tmp_path):
    for k in (2, 1):
        (tmp_path / f"field_{k}.txt").write_bytes(RAW.read_bytes())
    code, out, _ = said("measure", "field_*.txt", *UNITS, "--every-s", "1")
    assert code == 0
    assert "field_1.txt, field_2.txt" in out
    assert said("measure", "nothing_*.txt", *UNITS)[0] == 2


def test_the_largest_speed_is_told_in_micrometres_a_second():
    out = said("measure", RAW, *UNITS, *CELL)[1]
    radii, um = (float(word) for word in re.search(r"speed (\S+) R/s, (\S+) um/s", out).groups())
    assert um == pytest.approx(500 * radii, rel=5e-3)


@pytest.mark.slow
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


@pytest.mark.slow
def test_compare_a_file_with_a_run(tmp_path):
    assert said("measure", RAW, *UNITS, *CELL, "--out", "cell.nc")[0] == 0
    grid = cy.CylinderGrid(16, 16, LENGTH)
    cy.write(cy.simulate(cy.Parameters(), grid, cy.initial.stripes(grid), 1.0), "run.nc")
    code, out, err = said("compare", "cell.nc", "run.nc", "--out", "fit.png", "--out", "fit.nc")
    assert (code, err) == (0, "")
    assert "rotation" in out
    (line,) = (row for row in out.splitlines() if "speed U" in row)
    inverse_seconds, um_per_s = map(float, re.findall(r"([0-9.]+) (?:R/s|µm/s)", line))
    assert um_per_s == pytest.approx(500.0 * inverse_seconds, rel=1e-3)
    assert re.search(r"shift +\S+ R = \S+ µm", out)
    known = said("compare", "cell.nc", "run.nc", "--speed-um-s", "120")[1]
    assert "speed U   0.24 R/s = 120 µm/s" in known
    assert said("compare", "cell.nc", "run.nc", "--speed-um-s", "120", "--speed", "1")[0] == 2
    assert said("compare", "cell.nc", "run.nc", "--radius-um", "300")[0] == 2
    with xarray.open_dataset("fit.nc", engine="h5netcdf") as data:
        assert {"measured", "model", "residual"} <= set(data)
    assert said("compare", "run.nc", "run.nc")[0] == 2
    assert said("compare", "cell.nc", "cell.nc")[0] == 2


def test_units_of_a_run():
    code, _, err = said("measure", RAW, *UNITS, *CELL, "--speed-um-s", "100", "--out", "cell.nc", "--quiet")
    assert (code, err) == (0, "")
    found = cy.observations.compare("cell.nc", run_of("u_transient"))
    assert found.speed == 1.0
    assert found.rms_of_peak < 0.035
    assert np.isfinite(found.rms)


@pytest.fixture(scope="module")
def shots(tmp_path_factory):
    """A short film of a run, as video and as stack, with where the cell lies in it."""
    folder = tmp_path_factory.mktemp("films")
    view = cy.observations.View(60.0, 0.0)
    options = {"frames": 3, "start": 1.0, "size_px": (150, 130)}
    shot = cy.observations.observe(RUN, view, "film", pixel_um=500 / 60, **options)
    for (kind, name), put in WRITERS.items():
        if kind == "film" and name != "mp4":
            for file, write in put(shot).items():
                write(folder / file)
    x, y = shot.camera.view.centre_px
    cell = ("--radius-px", "60", "--axis", "0", "--centre", f"{x:g},{y:g}", "--not-mirrored")
    return folder, cell, shot


def test_a_film_is_measured(shots):
    pytest.importorskip("skimage")
    folder, cell, shot = shots
    given = (
        "--frame-s",
        "0.3",
        "--pixel-um",
        f"{500 / 60:g}",
        "--speed-um-s",
        "100",
        "--max-angle",
        "60",
    )
    code, out, err = said("measure", folder / "film.avi", *given, *cell, "-o", "cell.nc", "-o", "cell.png")
    assert (code, err) == (0, "")
    assert "film" in out
    assert "saved cell.png" in out
    with xarray.open_dataset("cell.nc", engine="h5netcdf") as data:
        assert data["u"].attrs["units"] == "1"
        assert data.attrs["format"] == "film"
        u, theta, z = data["u"].isel(time=0).values, data["theta"].values, data["z"].values
    true = velocity(theta[:, None], z[None, :], 1.0 + 0.5 * shot.camera.step)
    off = (u - true)[:, np.isfinite(u).all(axis=0)]
    assert off.shape[1] > 100
    assert np.sqrt((off**2).mean(axis=1)).max() < 0.06 * np.hypot(*true).max()


def test_a_line_of_a_film_is_a_kymograph(shots):
    folder, _, shot = shots
    code, out, err = said("measure", folder / "film.avi", "--frame-s", "0.3", "--line", "10,94,130,94")
    assert (code, err) == (0, "")
    assert "kymograph" in out
    seen = cy.observations.film(folder / "film.avi", frame_s=0.3, line_px=[(10, 94), (130, 94)])
    frames = shot.data["frames"].values.astype(float)
    np.testing.assert_allclose(seen.image, frames[:, 92:97, 10:131].mean(axis=1), atol=6.0)  # compressed
    code, _, err = said("measure", folder / "film.avi", "--frame-s", "0.3", "--line", "0,0,900,0")
    assert code == 2
    assert "in the picture" in err


def test_films_and_files_have_their_own_options(shots):
    folder = shots[0]
    for file, option, word in (
        (folder / "film.avi", ("--y", "down"), "--y"),
        (RAW, ("--every", "2"), "--every"),
        (folder / "film.avi", ("--format", "openpiv"), "it is a film"),
    ):
        code, _, err = said("measure", file, *option)
        assert code == 2
        assert word in err
    with pytest.raises(cy.InputError, match=r"cyclosis\.observations\.film"):
        cy.observations.read(folder / "film.avi")
    pytest.importorskip("tifffile")
    with pytest.raises(cy.InputError, match=r"cyclosis\.observations\.film"):
        cy.observations.read(folder / "film.tif", "kymograph")
    assert reading.is_film(folder / "film.tif")
    assert not reading.is_film(SAMPLES / "kymograph_imagej.tif")
