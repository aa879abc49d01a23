"""What `info` and `--json` say of a run, and that the run can be made again from it."""

import io
import json
import shlex
from functools import cache
from types import SimpleNamespace

import numpy as np
import pytest

import cyclosis as cy
from measure.commandline import said
from measure.files import differences, everything

GRID = cy.CylinderGrid(16, 16)
SMALL = "--n-theta 16 --n-z 16 --save-every 0.5 --t-end 1"
RUNS = {
    "polar": f"{SMALL} --alpha-u 0.6 --seed 3",
    "options": "--n-theta 16 --n-z 16 --t-end 1 --save-at 0,0.25,1 --stepper etdrk4 --dt 0.1 "
    "--zero-theta-flux --kind stripes --terms bundling,diffusion",
    "kinetic": f"{SMALL} --model kinetic --modes 6 --d-r 0.1",
    "closed": "--model closed --shape spheroid --aspect 1.5 --k-max 8 --t-end 0.2 --save-every 0.1",
}
"""Options of runs of every model."""


def run(folder, name):
    code, out, errors = said("run", *RUNS[name].split(), "--out", folder / f"{name}.nc", "--json")
    assert code in (0, 1), errors  # 1: a coarse grid may be found under-resolved
    return json.loads(out)


MODELS = ["polar", *(pytest.param(name, marks=pytest.mark.slow) for name in RUNS if name != "polar")]
"""Programs of the others take long to compile."""


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """The folder of runs, and what is told of each."""
    folder = tmp_path_factory.mktemp("made")
    return folder, cache(lambda name: run(folder, name))


def same(first, second):
    """Whether all that two files hold is the same, apart from how long it took."""
    one, other = everything(first), everything(second)
    assert one.keys() == other.keys()
    return all(np.array_equal(one[name], other[name], equal_nan=one[name].dtype.kind == "f") for name in one)


@pytest.mark.parametrize("name", MODELS)
def test_one_line_tells_a_script_what_became_of_a_run(name, made):
    folder, told = made
    said_of, run = told(name), cy.load(folder / f"{name}.nc")
    assert said_of["file"] == str(folder / f"{name}.nc")
    assert (said_of["status"], said_of["ok"], said_of["t_final"]) == (run.status, run.ok, run.t_final)
    assert said_of["order"] == pytest.approx(float(run.records["order"][-1]), rel=1e-12)
    assert said_of["regime"]
    assert "NaN" not in json.dumps(said_of)


@pytest.mark.parametrize("name", MODELS)
def test_the_command_that_info_names_makes_the_same_run(name, made, tmp_path, monkeypatch):
    folder, told = made
    told(name)
    code, out, errors = said("info", folder / f"{name}.nc", "--json")
    assert (code, errors) == (0, "")
    words = shlex.split(json.loads(out)["command"])
    assert words[:2] == ["cyclosis", "run"]
    monkeypatch.chdir(tmp_path)
    assert said(*words[1:], "--quiet")[0] in (0, 1)
    assert same(folder / f"{name}.nc", tmp_path / "again.nc")
    with cy.open_dataset(folder / f"{name}.nc") as one, cy.open_dataset("again.nc") as other:
        # The seed that was not given, 0, is given now.
        first, second = (json.loads(data.attrs["configuration"]) for data in (one, other))
        first["initial"].setdefault("seed", second["initial"].get("seed"))
        second["initial"].setdefault("seed", None)
        assert first == second


def test_info_names_the_regime_the_start_and_the_command(made):
    folder, told = made
    regime = told("polar")["regime"]
    code, out, errors = said("info", folder / "polar.nc")
    assert (code, errors) == (0, "")
    assert f"regime      {regime} (" in out
    assert "indifferent zones" in out
    assert "initial     kind = disordered, seed = 3" in out
    assert "again       cyclosis run --alpha-u 0.6 --n-theta 16 --n-z 16 --kind disordered --seed 3" in out


@pytest.mark.slow
def test_a_run_with_a_protocol_is_made_again_from_its_configuration(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "run.toml").write_text(
        "[grid]\nn_theta = 16\nn_z = 16\n[initial]\nkind = 'stripes'\nseed = 5\n[run]\nt_end = 1.0\n"
        "[[protocol]]\nat = 0.5\naction = 'noise'\nsize = 0.1\n"
    )
    assert said("run", "--config", "run.toml", "--out", "run.nc", "--quiet")[0] in (0, 1)
    command = json.loads(said("info", "run.nc", "--json")[1])["command"]
    assert command == "cyclosis info run.nc --toml | cyclosis run --config - --out again.nc"
    toml = said("info", "run.nc", "--toml")[1]
    monkeypatch.setattr("sys.stdin", SimpleNamespace(buffer=io.BytesIO(toml.encode())))
    assert said("run", "--config", "-", "--out", "again.nc", "--quiet")[0] in (0, 1)
    assert same(tmp_path / "run.nc", tmp_path / "again.nc")


@pytest.mark.slow
def test_what_only_python_can_make_again_is_said(tmp_path):
    def own(t, P, u, params, grid):
        return -0.1 * P

    run = cy.simulate(
        cy.Parameters(), GRID, cy.initial.stripes(GRID), 0.2, terms=[*cy.models.polar.terms(None), own]
    )
    path = cy.write(run, tmp_path / "own.nc")
    out = said("info", path)[1]
    assert "regime      not known without the terms that were given in Python" in out
    assert "again       not from the command line: it has terms of its own, given in Python" in out
    given = cy.simulate(cy.Parameters(), GRID, cy.initial.stripes(GRID), 0.2)
    path = cy.write(given, tmp_path / "given.nc")
    told = json.loads(said("info", path, "--json")[1])
    assert (told["command"], told["start"], told["regime"]) == (None, {}, "cyclosis")
    code, _, errors = said("info", path, "--toml")
    assert code == 2
    assert "its initial state was given in Python" in errors
    assert said("info", path, "--toml", "--json")[0] == 2


def test_units_change_no_result_and_are_kept(tmp_path, monkeypatch):
    """P and everything else is the same, byte for byte; only the file says what its units are."""
    monkeypatch.chdir(tmp_path)
    words = ("run", "--n-theta", 16, "--n-z", 16, "--t-end", 0.5, "--quiet", "--out")
    scales = ("--radius-um", 500, "--speed-um-s", 75)
    assert said(*words, "plain.nc")[0] == said(*words, "scaled.nc", *scales)[0] == 0
    assert differences("plain.nc", "scaled.nc") == []
    with cy.open_dataset("plain.nc") as plain, cy.open_dataset("scaled.nc") as scaled:
        assert "scales" not in plain.attrs
        assert json.loads(scaled.attrs["scales"])["speed_um_s"] == 75.0
        assert plain.attrs["configuration_sha256"] == scaled.attrs["configuration_sha256"]
    told = json.loads(said("info", "scaled.nc", "--json")[1])
    assert told["units"]["t_final_s"] == pytest.approx(0.5 * 500 / 75)
    assert told["units"]["peak_speed_um_per_s"] == pytest.approx(75 * told["peak_speed"])
    assert "--radius-um 500.0 --speed-um-s 75.0" in told["command"]
    again = cy.resume_file("scaled.nc", 1.0)
    assert again.scales == cy.Scales(500.0, 75.0) == cy.load("scaled.nc").scales
    out = said("info", "plain.nc", *scales)[1]
    assert "units       R = 500 µm, U = 75 µm/s, R/U = 6.667 s" in out
    assert "t = 0 to 0.5 (0 to 3.333 s)" in out


def test_one_unit_alone_is_refused(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "half.toml").write_text("[scales]\nradius_um = 500.0\n")
    for words in (("run", "--radius-um", 500), ("run", "--config", "half.toml")):
        code, out, errors = said(*words)
        assert (code, out) == (2, "")
        assert "speed_um_s = None cannot be used: it must be given together with radius_um" in errors
    with pytest.raises(cy.InputError, match=r"a cyclosis\.Scales"):
        cy.simulate(cy.Parameters(), GRID, cy.initial.stripes(GRID), 0.1, scales={"radius_um": 500.0})
