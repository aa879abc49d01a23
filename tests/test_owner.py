"""A file has one writer at a time: two processes, two threads, and what dead ones leave."""

import json
import os
import signal
import socket
import subprocess
import sys
import threading
from dataclasses import asdict, replace

import psutil
import pytest

import cyclosis as cy
from cyclosis.dataset import owner, parts
from measure.files import SETTINGS, call, differences, started, wait_for_parts

GRID = cy.CylinderGrid(16, 16)
STATE = cy.initial.stripes(GRID)
LONG = ["run", *SETTINGS, "--t-end", "100000", "--checkpoint-seconds", "0", "--out", "run.nc"]


def simulated(**settings):
    return cy.simulate(cy.Parameters(), GRID, STATE, 2.0, 1.0, **settings)


@pytest.fixture
def living(tmp_path):
    """A run that goes on, and its file."""
    target = tmp_path / "run.nc"
    process = started(tmp_path, *LONG)
    try:
        wait_for_parts(process, target)
        yield process, target
    finally:
        process.kill()
        process.communicate()


@pytest.mark.slow
def test_a_living_run_is_left_alone_by_all_others(living, tmp_path):
    process, target = living
    named = f"process {process.pid} on {socket.gethostname()}"
    other = ["run", "--n-theta", "24", "--n-z", "8", "--t-end", "1", "--quiet", "--out", "run.nc"]
    for arguments in ([*other, "--force"], other, ["resume", "run.nc", "--quiet"]):
        refused = call(tmp_path, *arguments)
        assert refused.returncode == 2, arguments
        assert named in refused.stderr
        assert "wait until it ends" in refused.stderr
        assert "Traceback" not in refused.stderr
        assert "--force" not in refused.stderr, "that would not help"
    run = simulated()
    for use in (
        lambda: cy.RunWriter(target),
        lambda: cy.RunWriter(target, force=True),
        lambda: cy.RunWriter(target, continues=True),
        lambda: cy.resume_file(target),
        lambda: cy.write(run, target),
        lambda: cy.write(run, target, force=True),
    ):
        with pytest.raises(cy.InputError, match=named):
            use()
    standing = len(parts.stored(target))
    wait_for_parts(process, target, standing + 2)
    process.send_signal(signal.SIGINT)
    out, err = process.communicate(timeout=300)
    assert process.returncode == 130, err
    whole = cy.load(target)
    assert whole.grid.shape == (32, 24)
    assert whole.times.tolist() == [2.0 * k for k in range(whole.times.size)], out
    assert not parts.folder_of(target).exists()


@pytest.mark.slow
def test_of_two_runs_started_at_once_one_is_refused(tmp_path):
    sizes = {"24": None, "32": None}
    for size in sizes:
        options = ["--n-theta", size, "--n-z", "16", "--t-end", "30", "--d-s", "0.1"]
        sizes[size] = started(tmp_path, "run", *options, "--out", "run.nc", "--checkpoint-seconds", "0")
    said = {size: process.communicate(timeout=300) for size, process in sizes.items()}
    codes = {size: process.returncode for size, process in sizes.items()}
    assert sorted(codes.values()) == [0, 2], said
    (winner,) = [size for size, code in codes.items() if code == 0]
    (loser,) = set(sizes) - {winner}
    assert "saved" in said[winner][0]
    assert "cannot be used" in said[loser][1]
    stored = cy.load(tmp_path / "run.nc")
    assert stored.grid.n_theta == int(winner)
    assert stored.times.size == 31
    assert [path.name for path in tmp_path.iterdir()] == ["run.nc"]


@pytest.mark.slow
def test_a_killed_owner_is_in_nobodys_way(tmp_path):
    target = tmp_path / "run.nc"
    process = started(tmp_path, "run", *SETTINGS, "--out", "run.nc", "--checkpoint-seconds", "0")
    wait_for_parts(process, target)
    process.kill()
    process.communicate()
    assert json.loads((parts.folder_of(target) / owner.NAME).read_text())["pid"] == process.pid
    finished = call(tmp_path, "resume", "run.nc", "--quiet")
    assert finished.returncode == 0, finished.stderr
    assert not parts.folder_of(target).exists()
    call(tmp_path, "run", *SETTINGS, "--out", "straight.nc")
    assert differences(tmp_path / "straight.nc", target) == []


@pytest.fixture
def asleep():
    """Another process that lives."""
    process = subprocess.Popen([sys.executable, "-c", "input()"], stdin=subprocess.PIPE)
    yield process
    process.kill()
    process.communicate()


def left_by(folder, **changes):
    """Put down the owner's file of another process."""
    who = replace(owner._myself(), **changes)
    folder.mkdir(exist_ok=True)
    (folder / owner.NAME).write_text(json.dumps(asdict(who)))
    return who


def test_an_owner_on_another_machine_is_named_and_not_taken_for_dead(tmp_path):
    target = tmp_path / "run.nc"
    folder = parts.folder_of(target)
    left_by(folder, pid=4711, host="node17", boot="another")
    for force in (False, True):
        with pytest.raises(cy.InputError, match="process 4711 on node17") as refused:
            cy.RunWriter(target, force=force)
        assert f"remove {folder / owner.NAME}" in str(refused.value)
    (folder / owner.NAME).unlink()
    cy.RunWriter(target).finish(simulated())


@pytest.mark.parametrize("same_boot", [True, False], ids=["killed", "before a restart"])
def test_a_number_given_anew_is_no_living_owner(tmp_path, asleep, same_boot):
    """The process of that number lives, but it is another: the lock of the owner is gone."""
    target = tmp_path / "run.nc"
    changes = {} if same_boot else {"boot": "an earlier one"}
    left_by(parts.folder_of(target), pid=asleep.pid, **changes)
    assert cy.RunWriter(target).finish(simulated()) == target


@pytest.mark.parametrize("content", [b"", b"{", b"[]", b'{"pid": 1}', b"\xff"])
def test_a_damaged_file_of_an_owner_is_in_nobodys_way(tmp_path, content):
    target = tmp_path / "run.nc"
    parts.folder_of(target).mkdir()
    (parts.folder_of(target) / owner.NAME).write_bytes(content)
    assert cy.RunWriter(target).finish(simulated()) == target


def test_without_locks_the_process_and_its_start_decide(tmp_path, asleep, monkeypatch):
    monkeypatch.setattr(owner, "_locked", lambda handle: None)
    target = tmp_path / "run.nc"
    folder = parts.folder_of(target)
    began = psutil.Process(asleep.pid).create_time()
    left_by(folder, pid=asleep.pid, started=began)
    with pytest.raises(cy.InputError, match=f"process {asleep.pid}"):
        cy.RunWriter(target)
    left_by(folder, pid=asleep.pid, started=began - 100.0)
    cy.RunWriter(target).close()
    left_by(folder, pid=2**22 + 1)
    assert cy.RunWriter(target).finish(simulated()) == target


def test_two_threads_do_not_share_a_file(tmp_path):
    target, opened, go, failed = tmp_path / "run.nc", threading.Event(), threading.Event(), []

    def other():
        writer = cy.RunWriter(target)
        opened.set()
        go.wait()
        try:
            writer.finish(simulated(checkpoint=writer))
        except BaseException as error:
            failed.append(error)

    thread = threading.Thread(target=other)
    thread.start()
    opened.wait()
    for force in (False, True):
        with pytest.raises(cy.InputError, match="another thread"):
            cy.RunWriter(target, force=force)
    go.set()
    thread.join()
    assert failed == []
    assert cy.load(target).t_final == 2.0


def test_what_a_thread_left_behind_is_in_nobodys_way(tmp_path):
    target, kept = tmp_path / "run.nc", []
    thread = threading.Thread(target=lambda: kept.append(cy.RunWriter(target)))
    thread.start()
    thread.join()
    run = simulated()
    assert cy.RunWriter(target).finish(run) == target
    with pytest.raises(cy.InputError, match="make a new RunWriter"):
        kept[0](run)


def test_in_one_thread_a_new_writer_takes_the_place_of_an_older_one(tmp_path):
    """As when a cell of a notebook is run again."""
    target = tmp_path / "run.nc"
    older = cy.RunWriter(target)
    writer = cy.RunWriter(target)
    run = simulated(checkpoint=writer)
    with pytest.raises(cy.InputError, match="make a new RunWriter"):
        older(run)
    older.close()
    newer = cy.RunWriter(target, force=True)
    with pytest.raises(cy.InputError, match="make a new RunWriter"):
        writer.finish(run)
    assert newer.finish(simulated(checkpoint=newer)) == target
    assert not parts.folder_of(target).exists()


def test_a_writer_that_is_closed_or_forgotten_leaves_nothing(tmp_path):
    target = tmp_path / "run.nc"
    with cy.RunWriter(target):
        assert parts.folder_of(target).is_dir()
    assert list(tmp_path.iterdir()) == []
    writer = cy.RunWriter(target)
    del writer
    assert list(tmp_path.iterdir()) == []
    with pytest.raises(cy.InputError), cy.RunWriter(target) as writer:
        cy.simulate(cy.Parameters(), GRID, 2 * STATE / abs(STATE).max(), checkpoint=writer)
    assert list(tmp_path.iterdir()) == []


FORKED = """
import os, sys
from pathlib import Path
from cyclosis.dataset import owner
mine = owner.claim(Path("run.nc.unfinished"), Path("run.nc"))
if os.fork() == 0:
    mine.release()
    print(mine._holds(), flush=True)
    sys.stdin.read()
os._exit(0)
"""


@pytest.mark.skipif(not hasattr(os, "fork"), reason="only where processes can fork")
def test_a_forked_process_owns_nothing_and_keeps_nothing(tmp_path):
    """It lives on when its parent has died, and the file is free."""
    command = [sys.executable, "-c", FORKED]
    pipe = subprocess.PIPE
    with subprocess.Popen(command, cwd=tmp_path, stdin=pipe, stdout=pipe, text=True) as process:
        assert process.stdout.readline() == "False\n"
        process.wait()
        assert (tmp_path / "run.nc.unfinished" / owner.NAME).exists()
        owner.claim(tmp_path / "run.nc.unfinished", tmp_path / "run.nc").release()
        process.stdin.close()
