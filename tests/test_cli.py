"""The commands as a user starts them."""

import subprocess

import pytest

import cyclosis as cy
from measure.commandline import said
from measure.files import COMMAND


def cyclosis(*arguments, cwd=None):
    command = [*COMMAND, *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True, cwd=cwd, timeout=300)


@pytest.fixture(scope="module")
def finished(tmp_path_factory):
    folder = tmp_path_factory.mktemp("cli")
    (folder / "run.toml").write_text(
        "[parameters]\nalpha_p = 0.9\n[grid]\nn_theta = 48\nn_z = 32\n[run]\nt_end = 30.0\nsave_every = 3.0\n"
    )
    out = cyclosis("run", "--config", "run.toml", "--alpha-u", "0.6", "--out", "run.nc", cwd=folder)
    assert out.returncode == 0, out.stderr
    return folder, out


def test_a_run_prints_its_outcome_and_writes_its_file(finished):
    folder, out = finished
    for word in (
        "status",
        "regime",
        "indifferent zones",
        "stripe widths",
        "peak speed",
        "wall time",
        "run.nc",
    ):
        assert word in out.stdout
    with cy.open_dataset(folder / "run.nc") as data:
        assert data.sizes["time"] == 11
        assert '"alpha_p": 0.9' in data.attrs["configuration"]
        assert '"alpha_u": 0.6' in data.attrs["configuration"]


def test_the_same_run_in_python_gives_the_same_data(finished):
    folder, _ = finished
    grid = cy.CylinderGrid(48, 32, 5.0)
    run = cy.simulate(
        cy.Parameters(alpha_p=0.9, alpha_u=0.6), grid, cy.initial.disordered(grid), t_end=30.0, save_every=3.0
    )
    with cy.open_dataset(folder / "run.nc") as data:
        assert (data.P.values[-1] == run.final_state).all()


def test_info_prints_a_tree(finished):
    folder, _ = finished
    out = cyclosis("info", folder / "run.nc")
    assert out.returncode == 0
    assert "48 x 32" in out.stdout
    assert "P(time, component, theta, z)" in out.stdout


@pytest.mark.slow
def test_the_emergence_figure_is_drawn(finished):
    folder, _ = finished
    out = cyclosis("figure", "emergence", folder / "run.nc", "--times", "0,3,6,12,21,30")
    assert out.returncode == 0, out.stderr
    assert (folder / "run.png").read_bytes().startswith(b"\x89PNG")
    again = cyclosis("figure", "emergence", folder / "run.nc")
    assert again.returncode == 2
    assert "--force" in again.stderr


def test_nothing_is_overwritten_unless_forced(finished):
    folder, _ = finished
    before = (folder / "run.nc").read_bytes()
    out = cyclosis("run", "--t-end", "0", "--out", "run.nc", cwd=folder)
    assert out.returncode == 2
    assert "--force" in out.stderr
    assert (folder / "run.nc").read_bytes() == before


def test_exit_codes_tell_whether_the_run_did_what_was_asked(tmp_path):
    out = cyclosis(
        "run",
        "--stepper",
        "rk4",
        "--dt",
        "0.5",
        "--n-theta",
        "32",
        "--n-z",
        "32",
        "--out",
        "d.nc",
        cwd=tmp_path,
    )
    assert out.returncode == 1
    assert "Diverged" in out.stdout
    assert (tmp_path / "d.nc").exists(), "what was computed is kept"


def test_doctor_and_version():
    out = cyclosis("doctor")
    assert out.returncode == 0
    for word in ("jax", "devices", "threads", "float64 works", "disk"):
        assert word in out.stdout
    assert cyclosis("--version").stdout.strip() == cy.__version__


def test_unknown_commands_and_options_fail_without_a_traceback():
    out = cyclosis("run", "--nonsense")
    assert out.returncode == 2
    assert "Traceback" not in out.stderr
    for arguments in (["nonsense"], ["figure", "nonsense", "x"]):
        code, _, errors = said(*arguments)
        assert code == 2
        assert "Traceback" not in errors


@pytest.mark.parametrize(
    "words",
    [
        "info .",
        "resume .",
        "export .",
        "movie .",
        "figure emergence .",
        "figure phase-diagram .",
        "run --t-end 1 --out .",
        f"run --t-end 1 --out {'long' * 80}.nc",
        "stability threshold --out x.png",
        "stability branch kappa --from 0.45 --to 0.5 --measures max_Q --out b.png",
    ],
)
def test_places_and_figures_that_cannot_be_are_refused_in_a_sentence(words, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    code, out, errors = said(*words.split())
    assert code == 2, errors
    assert "cannot be used: it must be" in errors
    assert len(errors.strip().splitlines()) == 1
    assert out == ""
