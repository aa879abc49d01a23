"""The commands of sweeps as a user starts them, with real members of a very small grid."""

import csv
import json
import shutil
import subprocess
import sys

import pytest

from cyclosis.cli import main
from cyclosis.sweep.store.store import Store
from measure.files import COMMAND

TINY = """
[grid]
n_theta = 16
n_z = 16
[initial]
filaments_per_square = 50.0
[axes]
alpha_p = { values = [0.5, 1.0] }
alpha_u = { values = [0.1, 0.9] }
[ensemble]
seeds = 2
block = 2
[run]
t_end = 40.0
"""


def started(*arguments, cwd):
    command = [*COMMAND, "sweep", *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True, cwd=cwd, timeout=300)


@pytest.fixture
def cyclosis(monkeypatch, capsys):
    """Call a command in this process; return its exit code, and what it printed and complained of."""

    def call(*arguments):
        monkeypatch.setattr(sys, "argv", ["cyclosis", "sweep", *map(str, arguments)])
        try:
            main()
            code = 0
        except SystemExit as end:
            code = end.code or 0
        printed = capsys.readouterr()
        return code, printed.out, printed.err

    return call


@pytest.fixture(scope="module")
def computed(tmp_path_factory):
    """A folder with a configuration, a store computed from it, and what the command printed."""
    folder = tmp_path_factory.mktemp("sweep")
    (folder / "tiny.toml").write_text(TINY)
    out = started("run", "tiny.toml", "--out", "store", "--workers", "1", "--json", cwd=folder)
    return folder, out


@pytest.mark.slow
def test_a_sweep_is_run_and_tells_other_programs_how_it_goes(computed):
    folder, out = computed
    assert out.returncode == 0, out.stderr
    assert out.stderr == ""
    events = [json.loads(line) for line in out.stdout.splitlines()]
    assert [item["event"] for item in events] == ["progress"] * (len(events) - 1) + ["end"]
    assert events[-2]["done"] == events[-2]["total"] == 8
    end = events[-1]
    assert end["status"] == "complete"
    assert end["computed"] == sum(end["regimes"].values()) == 8
    assert end["aside"] == {}
    assert (folder / "store" / "sweep.json").exists()


def test_a_member_that_diverges_is_a_result(computed):
    end = json.loads(computed[1].stdout.splitlines()[-1])
    assert end["status"] == "complete"
    assert end["statuses"].get("diverged", 0) > 0


def test_run_again_has_nothing_to_do(computed, cyclosis):
    folder, _ = computed
    code, out, err = cyclosis("run", folder / "tiny.toml", "--out", folder / "store")
    assert code == 0
    assert "all 8 runs" in out
    assert err == ""


@pytest.mark.slow
def test_a_plan_is_based_on_members_computed_now(computed):
    folder, _ = computed
    out = started("plan", "tiny.toml", "--workers", "10", cwd=folder)
    assert out.returncode == 0, out.stderr
    for text in ("alpha_p 2 x alpha_u 2 x seed 2", "4 of 2 runs", "10 workers", "computes", "B a worker"):
        assert text in out.stdout
    assert "4 files" in out.stdout


def test_status_counts_what_members_have_become(computed, cyclosis):
    folder, out = computed
    regimes = json.loads(out.stdout.splitlines()[-1])["regimes"]
    code, said, _ = cyclosis("status", folder / "store")
    assert code == 0
    assert "8 of 8 (100 %)" in said
    assert "4 of 4" in said
    for name, count in regimes.items():
        assert f"{name} {count}" in said


def test_an_export_is_written_once(computed, cyclosis):
    folder, _ = computed
    assert cyclosis("export", folder / "store", "--out", folder / "runs.csv")[0] == 0
    with open(folder / "runs.csv") as file:
        assert len(list(csv.DictReader(file))) == 8
    code, _, err = cyclosis("export", folder / "store", "--out", folder / "runs.csv")
    assert code == 2
    assert "--force" in err
    assert cyclosis("export", folder / "store", "--out", folder / "runs.csv", "--force")[0] == 0


@pytest.mark.slow
def test_damage_is_found_and_mended(computed, cyclosis, tmp_path):
    shutil.copytree(computed[0] / "store", tmp_path / "store")
    store = Store(tmp_path / "store")
    before = store.path_of(2).read_bytes()
    assert cyclosis("verify", store.path) == (
        0,
        f"{'status':>18}  all 4 blocks of {store.path} are whole\n",
        "",
    )
    store.path_of(2).write_bytes(before[:-1] + bytes([before[-1] ^ 1]))
    store.path_of(3).unlink()
    code, out, _ = cyclosis("verify", store.path)
    assert code == 1
    assert "block 2" in out
    assert "missing  block 3" in out
    assert "sweep repair" in out
    code, out, _ = cyclosis("status", store.path)
    assert code == 0
    assert "damaged  block 2;" in out
    out = started("repair", "store", "--workers", "1", cwd=tmp_path)
    assert out.returncode == 0, out.stderr
    assert "all 8 runs" in out.stdout
    assert "for 4 runs, 1 worker" in out.stdout
    assert "8 of 8 runs" in out.stderr, "no terminal: a line tells how far it is"
    assert cyclosis("verify", store.path)[0] == 0


def test_blocks_that_are_set_aside_show_in_the_exit_code(computed, cyclosis, tmp_path):
    folder, _ = computed
    whole = Store(folder / "store")
    store = Store.create(tmp_path / "store", whole.sweep)
    for index in (0, 1, 3):
        store.write(index, {item.name: whole.read(index)[item.name] for item in whole.sweep.variables})
    store.set_aside(2, "ZeroDivisionError: by nothing")
    code, out, _ = cyclosis("run", folder / "tiny.toml", "--out", store.path)
    assert code == 1
    for text in ("6 of 8 runs", "1 block is set aside", "by nothing", f"sweep repair {store.path}"):
        assert text in out
    code, out, _ = cyclosis("status", store.path)
    assert code == 0
    assert "block 2  ZeroDivisionError: by nothing" in out


def test_another_configuration_is_refused_with_the_difference(computed, cyclosis, tmp_path):
    folder, _ = computed
    (tmp_path / "other.toml").write_text(TINY.replace("t_end = 40.0", "t_end = 41.0"))
    code, out, err = cyclosis("run", tmp_path / "other.toml", "--out", folder / "store")
    assert code == 2
    assert out == ""
    for text in ("t_end", "40.0", "41.0"):
        assert text in err


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        (["status", "absent"], "absent"),
        (["verify", "absent"], "absent"),
        (["repair", "absent"], "absent"),
        (["export", "absent", "--out", "x.csv"], "absent"),
        (["run", "absent.toml", "--out", "x"], "absent.toml"),
        (["plan", "absent.toml"], "absent.toml"),
        (["run", "tiny.toml"], "--out"),
        (["run", "tiny.toml", "--out", "x", "--workers", "0"], "--workers"),
        (["run", "tiny.toml", "--out", "x", "--scheduler", "nonsense://x"], "scheduler"),
        (["run", "tiny.toml", "--out", "x", "--scheduler-file", "absent.json"], "scheduler_file"),
        (["run", "tiny.toml", "--out", "x", "--scheduler", "a", "--scheduler-file", "b"], "scheduler_file"),
        (["run", "tiny.toml", "--out", "x", "--scheduler-file", "b", "--workers", "2"], "workers"),
        (["nonsense"], "nonsense"),
    ],
    ids=lambda value: " ".join(value) if isinstance(value, list) else "",
)
def test_mistakes_get_one_sentence(arguments, told, computed, cyclosis, monkeypatch):
    folder, _ = computed
    monkeypatch.chdir(folder)
    monkeypatch.setattr("cyclosis.sweep.cluster.environment.settle", lambda core: None)
    monkeypatch.setattr("cyclosis.sweep.cluster.environment.wanted", lambda found: {})
    code, out, err = cyclosis(*arguments)
    assert code == 2
    assert out == ""
    assert told in err
    assert "Traceback" not in err
    assert not (folder / "x").exists()
