"""The commands of the theory as a user starts them."""

import csv

import numpy as np
import pytest
import xarray
from typer.testing import CliRunner

import cyclosis as cy
from cyclosis.cli import app


def run(*arguments):
    return CliRunner().invoke(app, ["stability", *map(str, arguments)])


def said(*arguments):
    result = run(*arguments)
    assert result.exit_code == 0, result.exception
    return result.stdout


def test_dispersion_lists_the_fastest_waves_first(tmp_path):
    out = said(
        "dispersion",
        "--alpha-p",
        0.1,
        "--alpha-u",
        0.5,
        "--out",
        tmp_path / "waves.nc",
        "--out",
        tmp_path / "w.png",
    )
    head = out.splitlines()[0]
    assert head.startswith("disorder (|P| = 0, cell of length 5)")
    assert "unidirectional (|P| = 0.866025" in out
    with xarray.open_dataset(tmp_path / "waves.nc", engine="h5netcdf") as data:
        assert np.all(np.diff(data["growth_stronger"]) <= 0)
        rates = cy.stability.growth_rates(cy.Parameters(alpha_p=0.1), "disorder", data["m"], data["q"])
        assert data["growth_stronger"].values == pytest.approx(rates[:, 0].real)
    assert (tmp_path / "w.png").stat().st_size > 10_000


def test_profile_prints_the_known_digits(tmp_path):
    out = said("profile", "--out", tmp_path / "profile.csv")
    for digits in ("0.9915720522", "0.9714276568", "0.8182985977", "0.7122318317"):
        assert digits in out
    with open(tmp_path / "profile.csv") as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == 256
    assert max(float(row["P"]) for row in rows) == pytest.approx(0.99157, abs=1e-4)


def test_tilted_profile_prints_its_drift():
    assert "0.0054012" in said("profile", "--tilted", "--kappa", 0.1, "--points", 96)


def test_spectrum_prints_the_known_eigenvalues():
    out = said("spectrum", "--components", "z", "--count", 3)
    assert "the rotation" in out
    assert "-0.0640694705" in out
    assert "-1.841275" in out


def test_threshold_at_a_point_and_as_a_curve(tmp_path):
    out = said("threshold", "--alpha-p", 0.1, "--full")
    assert "0.00747213366" in out
    assert "stripes of unequal widths" in out
    said("threshold", "--over", "alpha_p=0.04:0.1:3", "--out", tmp_path / "curve.csv")
    with open(tmp_path / "curve.csv") as file:
        rows = list(csv.DictReader(file))
    assert float(rows[0]["exists"]) == pytest.approx(cy.stability.fold(cy.Parameters(alpha_p=0.04)), rel=1e-9)


def test_a_branch_says_what_happens_on_it(tmp_path):
    out = said(
        "branch", "kappa", "--from", 0.45, "--to", 0.5, "--points", 64, "--longest", 0.3,
        "--out", tmp_path / "branch.nc",
    )  # fmt: skip
    assert "stripes: " in out
    assert "Branch point at kappa = 0.47069" in out
    with xarray.open_dataset(tmp_path / "branch.nc", engine="h5netcdf") as data:
        assert data["stable"].values[-1] == 1
        assert data["kappa"].values[0] == pytest.approx(0.45)


@pytest.mark.slow
def test_a_map_counts_points_and_keeps_them(tmp_path):
    out = said(
        "map", "--x", "kappa=0.03:0.5:2", "--y", "alpha_u=0.5:0.7:2", "--quiet",
        "--out", tmp_path / "map.nc", "--out", tmp_path / "map.png",
    )  # fmt: skip
    assert "circumferential" in out
    assert "cyclosis" in out
    with xarray.open_dataset(tmp_path / "map.nc", engine="h5netcdf") as data:
        assert data["stable"].sel(state="circumferential").values[0].all()


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["profile", "--alpha-p", "0.04", "--alpha-u", "0.01"], "two stripes|2 stripes"),
        (["profile", "--alpha-p", "many"], "alpha_p = 'many'"),
        (["profile", "--out", "profile.txt"], ".png, .pdf, .svg, .eps, .nc or .csv"),
        (["profile", "--out", "nowhere/profile.png"], "folder that exists"),
        (["profile", "--stripes", "3"], "even"),
        (["spectrum", "--components", "x"], "both, z, theta"),
        (["spectrum", "--components", "z", "--axial-mode", "1"], "axial_mode 0"),
        (["threshold", "--over", "alpha_p=0.1"], "NAME=START:STOP:COUNT"),
        (["threshold", "--over", "kappa=0.1:1:3"], "alpha_p, d_s, d_r, mu"),
        (["threshold", "--over", "alpha_p=0.1:0.2:3", "--full"], "full"),
        (["branch", "seed", "--from", "0", "--to", "1"], "one of alpha_p"),
        (["branch", "kappa", "--from", "0.6", "--to", "1"], "kappa = 0.5 of the start"),
        (["map", "--x", "kappa=0:1:2", "--y", "kappa=0:1:2"], "another parameter"),
        (["map", "--x", "kappa=0:1:2:log", "--y", "alpha_u=0:1:2"], "START < STOP"),
        (["dispersion", "--base", "striped"], "one of disorder"),
    ],
)
def test_bad_input_gets_one_sentence(arguments, words):
    import re

    result = run(*arguments)
    assert isinstance(result.exception, cy.InputError), result.exception
    assert re.search(words, str(result.exception))
    assert "\n" not in str(result.exception)


def test_a_standing_file_is_not_overwritten_unasked(tmp_path):
    target = tmp_path / "profile.csv"
    target.write_text("mine")
    assert isinstance(run("profile", "--out", target).exception, cy.InputError)
    assert target.read_text() == "mine"
    said("profile", "--out", target, "--force")
    assert target.read_text() != "mine"
