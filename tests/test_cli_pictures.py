"""Every command that draws or exports leaves a file that can be opened, and says where."""

import re
from pathlib import Path

import numpy as np
import PIL.Image
import pytest
import xarray

import cyclosis as cy
from cyclosis.cli import app

ROOT = Path(__file__).parents[1]


@pytest.fixture
def cyclosis(capsys, monkeypatch, tmp_path):
    monkeypatch.chdir(tmp_path)

    def call(*arguments):
        app(list(map(str, arguments)), standalone_mode=False)
        return capsys.readouterr().out

    return call


@pytest.fixture
def stored(tmp_path):
    grid = cy.CylinderGrid(32, 16, 5.0)
    run = cy.simulate(cy.Parameters(), grid, cy.initial.disordered(grid, 100), 20.0, 5.0)
    return cy.write(run, tmp_path / "run.nc")


def drawn(name):
    """Check that a picture has colours, and return how many frames."""
    with PIL.Image.open(name) as picture:
        assert len(np.unique(np.asarray(picture.convert("RGB")).reshape(-1, 3), axis=0)) > 10
        return getattr(picture, "n_frames", 1)


@pytest.mark.slow
def test_a_movie(cyclosis, stored):
    told = cyclosis("movie", stored, "--out", "run.gif", "--frames", 6, "--seconds", 0.5)
    assert "saved run.gif" in told
    assert cyclosis("movie", stored, "--out", "again.gif", "--frames", 2, "--seconds", 0.5, "--quiet") == ""
    assert drawn("run.gif") == 6
    with pytest.raises(cy.InputError, match="force"):
        cyclosis("movie", stored, "--out", "run.gif")


def test_an_export_for_paraview(cyclosis, stored):
    collection = Path(re.search(r"saved (\S+)", cyclosis("export", stored, "--out", "surface"))[1])
    pieces = re.findall(r'file="([^"]+)"', collection.read_text())
    assert len(pieces) == 5
    assert all((collection.parent / piece).exists() for piece in pieces)


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["share", "regimes"])
def test_the_phase_diagram_from_its_table(cyclosis, kind):
    table = ROOT / "docs" / "data" / "figure5.nc"
    cyclosis("figure", "phase-diagram", table, "--kind", kind, "--out", "plane.png")
    drawn("plane.png")


def test_mistakes_about_the_phase_diagram_get_one_sentence(cyclosis):
    table = ROOT / "docs" / "data" / "figure5.nc"
    with pytest.raises(cy.InputError, match="kind = share"):
        cyclosis("figure", "phase-diagram", table, "--kind", "regimes", "--cuts", "0.5")
    with pytest.raises(cy.InputError, match=r"kappa=0\.5"):
        cyclosis("figure", "phase-diagram", table, "--select", "kappa")


THEORY = {
    "profile": ("--points", 64),
    "spectrum": ("--points", 64, "--count", 4),
    "threshold": ("--over", "mu=0.04:0.06:2"),
}


@pytest.mark.slow
@pytest.mark.parametrize("name", THEORY)
@pytest.mark.parametrize("suffix", ["png", "nc"])
def test_theory(cyclosis, name, suffix):
    """As a picture and as data, by the name of the file."""
    out = Path(f"found.{suffix}")
    cyclosis("stability", name, *THEORY[name], "--out", out)
    if suffix == "png":
        drawn(out)
        assert re.fullmatch("configuration_sha256 [0-9a-f]{64}", mark(out))
    else:
        with xarray.open_dataset(out, engine="h5netcdf") as data:
            assert data.data_vars


@pytest.mark.slow
def test_an_experiment(cyclosis):
    assert "timescales" in cyclosis("experiment", "list")
    told = cyclosis("experiment", "timescales", "--quick", "--out", "out")
    assert re.search("AGREES|IN PART|DOES NOT", told)
    drawn("out/timescales.png")
    with xarray.open_dataset("out/timescales.nc", engine="h5netcdf") as data:
        assert mark("out/timescales.png") == f"configuration_sha256 {data.attrs['configuration_sha256']}"
        assert data.attrs["measured"].split()[0] in told


def test_the_digest_of_a_picture_is_that_of_what_determines_it(cyclosis):
    asked = {"a": [], "b": [], "c": ["--alpha-u", 0.4]}
    for name, options in asked.items():
        cyclosis("stability", "dispersion", *options, "--out", f"{name}.png")
    marks = [mark(f"{name}.png") for name in asked]
    assert marks[0] == marks[1] != marks[2]


def mark(path):
    """What a picture says it was drawn from."""
    with PIL.Image.open(path) as picture:
        return picture.text["Description"]
