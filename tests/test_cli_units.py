"""Every command that shows a quantity shows it in units if it knows the cell. Results stay the same."""

import json
import shutil

import numpy as np
import pandas
import pytest
import xarray

import cyclosis as cy
from cyclosis.sweep.plan.sweep import Sweep
from cyclosis.sweep.store.store import Store
from measure.commandline import COMMANDS, said
from sweep import fakes

SCALES = ("--radius-um", 500, "--speed-um-s", 75)
SECONDS = 500 / 75
WITHOUT = {"doctor", *(f"sweep {name}" for name in ("plan", "run", "status", "verify", "repair"))}
"""Commands that show no quantity of a cell; a sweep has its scales in its configuration."""


@pytest.fixture(scope="module")
def stored(tmp_path_factory):
    grid = cy.CylinderGrid(16, 16, 5.0)
    run = cy.simulate(cy.Parameters(), grid, cy.initial.stripes(grid), t_end=4.0, save_every=1.0)
    return cy.write(run, tmp_path_factory.mktemp("run") / "run.nc")


@pytest.fixture
def here(tmp_path, monkeypatch, stored):
    monkeypatch.chdir(tmp_path)
    return shutil.copy(stored, tmp_path / "run.nc")


def test_every_command_that_shows_a_quantity_has_both_scales():
    both = {"--radius-um", "--speed-um-s"}
    named = {name: {o for part in command.params for o in part.opts} for name, command in COMMANDS.items()}
    assert {name for name, options in named.items() if not both <= options} == WITHOUT


def test_a_resumed_run_gets_scales_and_keeps_its_numbers(here):
    assert said("resume", here, "--t-end", 6, "--quiet")[0] == 0
    with xarray.open_dataset(here) as plain:
        plain = plain.load()
    again = shutil.copy(here, "again.nc")
    assert said("resume", again, *SCALES)[0] == 2, "the run has reached its end"
    code, out, _ = said("resume", here, "--t-end", 8, *SCALES)
    assert code == 0
    assert f"{8 * SECONDS:.4g} s" in out
    with xarray.open_dataset(here) as scaled:
        assert json.loads(scaled.attrs["scales"])["radius_um"] == 500.0
        assert scaled["P"].values[: plain.sizes["time"]].tobytes() == plain["P"].values.tobytes()


@pytest.mark.parametrize(
    ("words", "text", "factor"),
    [
        (("profile", "--points", 64), "largest u", 75.0),
        (("profile", "--points", 64), "rms u", 75.0),
    ],
)
def test_the_theory_tells_both(here, words, text, factor):
    line = next(row for row in said("stability", *words, *SCALES)[1].splitlines() if text in row)
    plain, scaled = line.split(text)[1].split(" = ")
    assert float(scaled.split()[0]) == pytest.approx(factor * float(plain.split()[0]), rel=1e-3)
    assert scaled.split()[1] == "µm/s"


def test_growth_rates_in_units(here):
    _, out, _ = said("stability", "dispersion", "--base", "disorder", *SCALES, "--out", "rates.nc")
    head, *rows = out.splitlines()[1:6]
    assert head.split()[-3:] == ["1/mm", "1/s", "1/s"]
    for row in rows:
        _, _, q, growth, _, wave, rate, _ = map(float, row.split())
        assert wave == pytest.approx(2 * q, rel=1e-3)
        assert rate == pytest.approx(growth / SECONDS, rel=1e-3, abs=1e-12)
    assert said("stability", "dispersion", "--base", "disorder", "--out", "plain.nc")[0] == 0
    with xarray.open_dataset("rates.nc") as scaled, xarray.open_dataset("plain.nc") as plain:
        assert json.loads(scaled.attrs["scales"])["speed_um_s"] == 75.0
        assert "scales" not in plain.attrs
        assert scaled.drop_attrs().identical(plain.drop_attrs())


def test_one_scale_alone_is_refused(here):
    for words in (("stability", "profile"), ("experiment", "timescales", "--quick")):
        code, _, err = said(*words, "--radius-um", 500)
        assert code == 2
        assert "speed_um_s" in err


def test_a_sweep_has_its_scales_in_its_configuration_and_its_tables_have_columns(here):
    tables = fakes.tables()
    scaled = Sweep.from_tables(tables | {"scales": {"radius_um": 500.0, "speed_um_s": 75.0}})
    assert scaled.digest == Sweep.from_tables(tables).digest, "results do not depend on them"
    with pytest.raises(cy.InputError, match="speed_um_s"):
        Sweep.from_tables(tables | {"scales": {"radius_um": 500.0}})
    fakes.filled(Store.create("store", scaled))
    assert json.loads(cy.open_sweep("store").attrs["scales"]) == {"radius_um": 500.0, "speed_um_s": 75.0}
    assert said("sweep", "export", "store", "--out", "own.csv")[0] == 0
    assert said("sweep", "export", "store", "--out", "other.csv", "--speed-um-s", 50)[0] == 0
    own, other = pandas.read_csv("own.csv"), pandas.read_csv("other.csv")
    assert np.allclose(own["t_final_s"], SECONDS * own["t_final"], rtol=1e-14, equal_nan=True)
    assert np.allclose(other["t_final_s"], 10.0 * own["t_final"], rtol=1e-14, equal_nan=True)
    plain = own[[name for name in own if not name.endswith(("_s", "_um"))]]
    fakes.filled(Store.create("plain", Sweep.from_tables(tables)))
    assert said("sweep", "export", "plain", "--out", "plain.csv")[0] == 0
    assert plain.equals(pandas.read_csv("plain.csv"))


def test_an_experiment_in_units_computes_the_same(here):
    assert said("experiment", "timescales", "--quick", "--quiet", "--out", "plain")[0] == 0
    code, out, _ = said(
        "experiment", "timescales", "--quick", "--quiet", "--out", "um", *SCALES, "--as", "svg"
    )
    assert code == 0
    assert "R/U = 6.667 s" in out
    with (
        xarray.open_dataset("um/timescales.nc") as scaled,
        xarray.open_dataset("plain/timescales.nc") as plain,
    ):
        assert json.loads(scaled.attrs["scales"])["radius_um"] == 500.0
        assert scaled.drop_attrs().identical(plain.drop_attrs())
        assert scaled.attrs["configuration_sha256"] == plain.attrs["configuration_sha256"]
    with open("um/timescales.svg") as picture:
        assert plain.attrs["configuration_sha256"] in picture.read()


def test_the_vacuole_in_units_and_formats(here):
    code, out, _ = said("vacuole", here, "--out", "inside", "--as", "svg", *SCALES)
    assert code == 0
    assert f"t = 4 = {4 * SECONDS:.4g} s" in out
    with open("inside/section.svg") as picture:
        told = picture.read()
    assert all(text in told for text in ("(µm/s)", "mm", "configuration_sha256"))


def test_an_observed_run_has_its_own_scales(here):
    run = cy.load(here)
    scaled = cy.simulate(run.params, run.grid, run.frames[0], t_end=1.0, scales=cy.Scales(400.0, 60.0))
    view = cy.observations.View(radius_px=40.0)
    seen = cy.observations.observe(scaled, view, "piv", window_px=16, step_px=8)
    assert (seen.camera.pixel_um, seen.camera.speed_um_per_s) == (10.0, 60.0)
    plain = cy.observations.observe(run, view, "piv", window_px=16, step_px=8)
    assert (plain.camera.pixel_um, plain.camera.speed_um_per_s) == (5.0, 100.0)
