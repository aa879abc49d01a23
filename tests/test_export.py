"""Runs as tables and arrays for other programs: every number in them is one of the run."""

import csv
import io
import json
from functools import cache
from importlib.util import find_spec

import h5netcdf
import numpy as np
import pytest
import xarray

import cyclosis as cy
from cyclosis.dataset import export_run, run_table, with_scales
from cyclosis.dataset.run_tables import as_text, run_tables
from measure.commandline import said

GRID = cy.CylinderGrid(16, 16)
CLOSED = cy.ClosedGrid(cy.Spheroid(1.5), k_max=8)


MODELS = ["polar", *(pytest.param(name, marks=pytest.mark.slow) for name in ("kinetic", "closed"))]
"""Programs of the other two take long to compile."""


@cache
def made(name):
    """A run of a model; that of the polar one has fewer frames than records."""
    if name == "polar":
        state = cy.initial.stripes(GRID)
        return cy.simulate(cy.Parameters(), GRID, state, t_end=2.0, save_every=1.0, record_every=0.5)
    if name == "closed":
        return cy.simulate(cy.Parameters(), CLOSED, cy.closed.swirl(CLOSED, 0.5), t_end=0.2, save_every=0.1)
    state = cy.kinetic.dressed(cy.initial.stripes(GRID, magnitude=0.5), modes=6)
    params, model = cy.Parameters(d_r=0.1), cy.models.kinetic
    return cy.simulate(params, GRID, state, t_end=0.2, save_every=0.1, model=model)


@pytest.fixture(scope="module")
def stored(tmp_path_factory):
    """The file of the run of a model."""
    folder = tmp_path_factory.mktemp("exported")
    return cache(lambda name: cy.write(made(name), folder / f"{name}.nc"))


def read(text):
    """A table of text as columns of numbers; NaN where a field is empty."""
    head, *rows = list(csv.reader(io.StringIO(text)))
    return {
        name: np.array([float(value or "nan") for value in column])
        for name, column in zip(head, zip(*rows, strict=True), strict=True)
    }


@pytest.mark.parametrize("name", MODELS)
def test_records_are_those_of_the_run_to_the_last_digit(name):
    run = made(name)
    table = read("".join(as_text(run_table(run.to_dataset(), "records"))))
    times = table.pop("record_time" if name == "polar" else "time")
    assert np.array_equal(times, run.record_times)
    labels = {label for key in run.records for label in table if label == key or label.startswith(f"{key}_")}
    assert labels == set(table)
    for key, values in run.records.items():
        if values.ndim == 1:
            assert np.array_equal(table[key], values, equal_nan=True)
        else:
            columns = [column for label, column in table.items() if label.startswith(f"{key}_")]
            assert np.array_equal(np.array(columns).T, values, equal_nan=True)


@pytest.mark.parametrize("name", MODELS)
def test_profiles_are_means_of_the_frames(name):
    data = made(name).to_dataset()
    table = run_table(data, "profiles")
    kept, lost = ("s", 1) if name == "closed" else ("theta", 2)
    count = data.sizes[kept]
    assert np.array_equal(table["time"], np.repeat(data["time"].values, count))
    assert np.array_equal(table[kept][:count], data[kept].values)
    last = data["P"].values[-1].mean(axis=lost)
    for k, label in enumerate(data["component"].values):
        assert np.allclose(table[f"P_{label}"][-count:], last[k], rtol=0, atol=1e-14)
        assert np.allclose(
            table[f"u_{label}"][-count:], data["u"].values[-1, k].mean(axis=lost - 1), rtol=0, atol=1e-14
        )
    if name == "closed":
        assert np.array_equal(table["r"][:count], CLOSED.r)


def test_zones_are_listed_one_a_row():
    data = made("polar").to_dataset()
    table = run_table(data, "zones")
    assert table["time"].tolist() == [0.0, 0.0, 1.0, 1.0, 2.0, 2.0]
    assert table["zone"].tolist() == [0, 1] * 3
    found = cy.regime(made("polar").params, GRID, made("polar").final_state)
    assert np.allclose(table["zone_angle"][-2:], found.zones)
    assert np.allclose(table["stripe_width"][-2:], found.widths)


def test_a_run_without_zones_has_no_table_of_them():
    data = made("polar").to_dataset().drop_vars(["zone_angle", "stripe_width"])
    assert set(run_tables(data)) == {"records", "profiles", "about"}
    with pytest.raises(cy.InputError, match="for a run without zones"):
        run_table(data, "zones")


def test_what_is_told_of_the_run_is_its_configuration_and_origin():
    table = run_table(made("polar").to_dataset(), "about")
    told = dict(zip(table["name"], table["value"], strict=True))
    assert told["parameters.d_r"] == "0.025"
    assert told["run.terms"].startswith('["advection", ')
    assert told["outcome.status"] == "completed"
    assert len(told["configuration_sha256"]) == 64


@pytest.mark.parametrize("name", MODELS)
def test_arrays_in_all_formats_are_those_of_the_run(name, stored, tmp_path):
    with cy.open_dataset(stored(name)) as data:
        paths = [export_run(data, tmp_path / f"run{end}") for end in (".nc", ".npz", ".zarr")]
        whole = data.load()
    arrays = np.load(paths[1])
    with xarray.open_dataset(paths[0], engine="h5netcdf") as plain, xarray.open_zarr(paths[2]) as store:
        for found in (plain, store):
            assert set(found.variables) == set(whole.variables)
        for key, item in whole.variables.items():
            for values in (plain[key].values, store[key].values, arrays[key]):
                assert values.astype(item.dtype).tobytes() == item.values.tobytes(), key
        assert plain.attrs["configuration"] == store.attrs["configuration"] == whole.attrs["configuration"]
    assert json.loads(str(arrays["attributes"]))["configuration"] == whole.attrs["configuration"]
    with h5netcdf.File(paths[0], "r") as file:
        assert not file.groups, "nothing that only a resumed run needs"


def test_an_exported_file_is_not_taken_for_a_run(stored, tmp_path):
    with cy.open_dataset(stored("polar")) as data:
        path = export_run(data, tmp_path / "plain.nc")
    code, _, errors = said("info", path)
    assert code == 2
    assert "a NetCDF file of a cyclosis run" in errors


@pytest.mark.skipif(find_spec("openpyxl") is None, reason="Excel files need openpyxl")
def test_sheets_are_the_tables(tmp_path):
    import openpyxl

    data = made("polar").to_dataset()
    book = openpyxl.load_workbook(export_run(data, tmp_path / "run.xlsx"))
    assert book.sheetnames == ["records", "zones", "profiles", "about"]
    for name, table in run_tables(data).items():
        head, *rows = book[name].values
        assert list(head) == list(table)
        for column, values in zip(zip(*rows, strict=True), table.values(), strict=True):
            missing = [value is None for value in column]
            assert missing == [value != value or value == "" for value in values.tolist()]
            told = [value for value in column if value is not None]
            given = [value for value in values.tolist() if value == value and value != ""]
            if isinstance(given[0], str):
                assert told == given
            else:
                assert np.allclose(told, given, rtol=1e-14, atol=0), "Excel keeps 15 digits"


def test_without_openpyxl_one_sentence_says_so(stored, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("cyclosis.dataset.run_export.find_spec", lambda name: None)
    code, out, errors = said("export", stored("polar"), "--as", "xlsx", "--out", "run.xlsx")
    assert (code, out) == (2, "")
    assert "openpyxl is not installed" in errors
    assert 'pip install "cyclosis[excel]"' in errors
    assert list(tmp_path.iterdir()) == []


def test_a_sheet_holds_no_more_than_excel_reads(tmp_path, monkeypatch):
    monkeypatch.setattr("cyclosis.dataset.run_export.find_spec", lambda name: True)
    monkeypatch.setattr("cyclosis.dataset.run_export.MOST_ROWS", 10)
    with pytest.raises(cy.InputError, match="the number of rows of profiles = 48"):
        export_run(made("polar").to_dataset(), tmp_path / "run.xlsx")


def test_the_command_line_puts_tables_where_they_are_wanted(stored, tmp_path):
    file = tmp_path / "run.nc"
    file.write_bytes((stored("polar")).read_bytes())
    for words, name in (
        (("--as", "csv"), "run-tables"),
        (("--table", "zones"), "run-zones.csv"),
        (("--out", tmp_path / "mine.npz"), "mine.npz"),
    ):
        code, out, errors = said("export", file, *words)
        assert (code, errors) == (0, "")
        assert out == f"saved {tmp_path / name}\n"
        if name == "run-tables":
            assert said("export", file, *words)[0] == 2, "nothing is overwritten"
            assert said("export", file, *words, "--force")[0] == 0
    tables = sorted(path.name for path in (tmp_path / "run-tables").iterdir())
    assert tables == ["about.csv", "profiles.csv", "records.csv", "zones.csv"]
    code, out, errors = said("export", file, "--table", "zones", "--out", "-")
    assert (code, errors) == (0, "")
    assert out == (tmp_path / "run-zones.csv").read_text()


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ("--as xls", "did you mean xlsx"),
        ("--table widths", "one of records, zones, profiles, about"),
        ("--as npz --table zones", "given with --as csv"),
        ("--as zarr --out -", "only csv goes to standard output"),
        ("--as npz --out run.xlsx", "a name that ends in .npz"),
        ("--out run.mat", "ends in .csv, .xlsx, .nc, .npz, .zarr"),
        ("--as vtk --out run.vts", "the name of a folder"),
        ("--table zones --out folder", "given for one file .csv"),
    ],
)
def test_mistakes_are_named_in_one_sentence(words, message, stored, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    code, out, errors = said("export", stored("polar"), *words.split())
    assert (code, out) == (2, "")
    assert message in errors
    assert len(errors.strip().splitlines()) == 1
    assert list(tmp_path.iterdir()) == []


def test_columns_in_units_stand_beside_those_without(stored):
    code, out, errors = said(
        "export", stored("polar"), "--table", "profiles", "--out", "-", "--radius-um", 500, "--speed-um-s", 75
    )
    assert (code, errors) == (0, "")
    plain, table = run_table(made("polar").to_dataset(), "profiles"), read(out)
    assert all(np.array_equal(table.pop(name), column) for name, column in plain.items())
    assert set(table) == {"time_s", "u_theta_um_per_s", "u_z_um_per_s"}
    assert np.allclose(table["time_s"], plain["time"] * 500 / 75, rtol=1e-14)
    assert np.allclose(table["u_z_um_per_s"], plain["u_z"] * 75, rtol=1e-14)
    code, out, _ = said("export", stored("polar"), "--table", "zones", "--out", "-", "--radius-um", 500)
    assert (code, out) == (2, "")


def test_arrays_in_units_are_further_coordinates(tmp_path):
    data = with_scales(made("polar").to_dataset(), cy.Scales(500.0, 75.0))
    arrays = np.load(export_run(data, tmp_path / "run.npz"))
    assert np.allclose(arrays["z_um"], 500 * GRID.z)
    assert np.allclose(arrays["time_s"], data["time"].values * 500 / 75)
    assert json.loads(str(arrays["attributes"]))["scales"] == data.attrs["scales"]
