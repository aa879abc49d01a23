"""Sweeps on clusters: of our own, and of others with workers started apart."""

import json
import os
import signal
import subprocess
import sys
import time
import warnings
from contextlib import contextmanager

import numpy as np
import psutil
import pytest

from cyclosis.model.errors import InputError
from cyclosis.sweep.cluster import environment as surroundings
from cyclosis.sweep.cluster import running_cluster
from cyclosis.sweep.cluster.local_cluster import local_client, places
from cyclosis.sweep.cluster.queue import ATTEMPTS, BlockQueue, spread
from cyclosis.sweep.cluster.running_cluster import WorkerReport, guest_client, obstacle, remarks
from cyclosis.sweep.cluster.task import BlockTask
from cyclosis.sweep.execute import run_sweep
from cyclosis.sweep.store.store import Store, versions
from measure.faults import environment
from measure.sweeps import made_up, slow, sweep


@pytest.mark.parametrize("count", [0, 1, 2, 3, 10, 400, 1597, 6765])
def test_blocks_are_passed_once_and_evenly(count):
    order = list(spread(count, 7))
    assert sorted(order) == list(range(count))
    for part in (20, 50, 200):
        if part < count / 2:
            gaps = np.diff(np.sort(order[:part]))
            assert gaps.max() <= 4 * count / part


def test_a_failing_block_is_tried_again_and_then_given_up():
    queue = BlockQueue([0, 1])
    assert [queue.next(), queue.next(), queue.next()] == [0, 1, None]
    for _ in range(ATTEMPTS - 1):
        assert not queue.failed(1)
        assert queue.next() == 1
    assert queue.failed(1)
    assert not queue


def test_a_block_is_blamed_for_dead_workers_only_if_it_was_alone():
    queue = BlockQueue([0])
    for _ in range(ATTEMPTS - 1):
        assert queue.next() == 0
        assert not queue.died(0, 1, alone=False)
    assert queue.next() == 0
    assert not queue.died(0, 1, alone=False)
    assert queue.next() is None
    assert queue
    assert queue.next_suspect() == 0
    assert queue.died(0, 1, alone=True)
    assert not queue


def test_a_sweep_is_computed_and_then_nothing_is_left_to_do(client, tmp_path):
    plan, seen = sweep(), []
    summary = run_sweep(plan, tmp_path / "s", client, progress=seen.append, compute=slow(0.02))
    assert summary.ok
    assert (summary.done, summary.total, summary.computed) == (48, 48, 48)
    assert summary.regimes == {"disordered": 16, "unidirectional": 16, "cyclosis": 16}
    assert sum(summary.statuses.values()) == 48
    assert summary.core_seconds >= 12 * 0.02
    assert summary.workers == 2
    store = Store(tmp_path / "s")
    for index in range(plan.blocks):
        for name, values in made_up(plan, index).items():
            np.testing.assert_array_equal(store.read(index)[name], values)
    assert [now.done for now in seen] == sorted(now.done for now in seen)
    assert seen[-1].done == seen[-1].total == 48
    assert seen[-1].left in (None, 0.0)
    again = run_sweep(plan, tmp_path / "s")
    assert again.ok
    assert again.computed == 0
    assert again.seconds < 1.0


def test_only_what_is_missing_is_computed(client, tmp_path):
    plan = sweep()
    store = Store.create(tmp_path / "s", plan)
    for index in (0, 3, 11):
        store.write(index, made_up(plan, index))
    before = {index: store.path_of(index).stat().st_mtime_ns for index in (0, 3, 11)}
    summary = run_sweep(plan, tmp_path / "s", client, compute=slow(0.0))
    assert summary.ok
    assert summary.computed == 36
    assert {index: store.path_of(index).stat().st_mtime_ns for index in before} == before


@pytest.mark.slow
def test_a_script_needs_neither_a_guard_nor_a_folder_it_can_write_to(tmp_path):
    """Workers do not import the script that starts them, and leave nothing where it runs."""
    here = tmp_path / "here"
    here.mkdir()
    (here / "script.py").write_text(
        "from measure.sweeps import slow, sweep\n"
        "from cyclosis.sweep.execute import run_sweep\n"
        "summary = run_sweep(sweep(), '../store', workers=1, compute=slow(0.0))\n"
        "print(summary.status, summary.workers, flush=True)\n"
    )
    here.chmod(0o555)
    out = subprocess.run(
        [sys.executable, "script.py"],
        cwd=here,
        env=environment(),
        capture_output=True,
        text=True,
        timeout=120,
    )
    assert out.stdout == "complete 1\n"
    assert out.stderr == ""
    assert [path.name for path in here.iterdir()] == ["script.py"]


def test_every_worker_has_its_own_core_and_one_thread(client):
    assert set(client.nthreads().values()) == {1}
    cores = client.run(os.sched_getaffinity, 0)
    assert all(len(own) == 1 for own in cores.values())
    if len(os.sched_getaffinity(0)) > 1:
        assert len(set.union(*cores.values())) == 2
    found = client.run(lambda: dict(os.environ))
    for own in found.values():
        assert surroundings.lacking(own) == ()
        assert "xla_cpu_multi_thread_eigen=false" in own["XLA_FLAGS"]


def test_what_the_user_has_set_stays():
    wanted = surroundings.wanted({"XLA_FLAGS": "--xla_dump_to=/x", "OMP_NUM_THREADS": "4"})
    assert wanted["XLA_FLAGS"] == "--xla_dump_to=/x --xla_cpu_multi_thread_eigen=false"
    assert "OMP_NUM_THREADS" not in wanted
    assert "XLA_FLAGS" not in surroundings.wanted({"XLA_FLAGS": "--xla_cpu_multi_thread_eigen=true"})
    assert surroundings.lacking(surroundings.wanted({})) == ()
    assert "XLA_FLAGS" in surroundings.lacking({})


def test_gpus_have_a_worker_each_and_share_only_if_asked_to(monkeypatch):
    assert surroundings.accelerators({"JAX_PLATFORMS": "cpu"}) == []
    monkeypatch.setattr("cyclosis.sweep.cluster.local_cluster.accelerators", lambda found: ["0", "1"])
    assert [(core, own["CUDA_VISIBLE_DEVICES"]) for core, own in places(None)] == [(None, "0"), (None, "1")]
    assert all("XLA_PYTHON_CLIENT_PREALLOCATE" not in own for _, own in places(2))
    assert [own["XLA_PYTHON_CLIENT_PREALLOCATE"] for _, own in places(3)] == ["false"] * 3


def free_port():
    import socket

    with socket.socket() as found:
        found.bind(("127.0.0.1", 0))
        return found.getsockname()[1]


QUIET = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}


@contextmanager
def scheduled(folder):
    """A scheduler, a command of its own; its process, address and file."""
    file = folder / "scheduler.json"
    command = [sys.executable, "-m", "distributed.cli.dask_scheduler", "--no-dashboard", "--port", "0"]
    command += ["--host", "127.0.0.1", "--dashboard-address", "127.0.0.1:0", "--scheduler-file", str(file)]
    with ended(subprocess.Popen(command, **QUIET, cwd=folder)) as process:
        wait_until(file.exists)
        yield process, json.loads(file.read_text())["address"], file


@pytest.fixture(scope="module")
def scheduler(tmp_path_factory):
    """The address and the file of a scheduler that outlives its workers."""
    with scheduled(tmp_path_factory.mktemp("scheduler")) as (_, address, file):
        yield address, file


def worker(address, folder, **environ):
    """Start a worker, a command of its own."""
    command = [sys.executable, "-m", "distributed.cli.dask_worker", address, "--no-nanny", "--no-dashboard"]
    command += ["--nthreads", "1", "--memory-limit", "0", "--local-directory", str(folder)]
    return subprocess.Popen(command, **QUIET, cwd=folder, env=environment(**environ))


@contextmanager
def ended(process):
    """End a process in the end."""
    try:
        yield process
    finally:
        process.kill()
        process.wait()


def wait_until(true, seconds=30.0):
    deadline = time.monotonic() + seconds
    while not true():
        assert time.monotonic() < deadline, "waited too long"
        time.sleep(0.02)


@pytest.mark.slow
def test_workers_started_apart_compute_though_one_is_killed(scheduler, tmp_path):
    address, _ = scheduler
    lacking = {"OMP_NUM_THREADS": "2", "XLA_FLAGS": ""}
    first, second = (worker(address, tmp_path, **lacking) for _ in range(2))
    plan, store = sweep(), tmp_path / "s"

    def kill_one(now):
        if now.workers == 2 and now.done >= 8 and first.poll() is None:
            first.send_signal(signal.SIGKILL)

    with (
        ended(first),
        ended(second),
        guest_client(address) as guest,
        warnings.catch_warnings(record=True) as said,
    ):
        warnings.simplefilter("always")
        guest.wait_for_workers(2, timeout=30)
        summary = run_sweep(plan, store, guest, progress=kill_one, compute=slow(0.3))
    assert first.poll() is not None
    assert summary.ok
    assert summary.workers == 2
    kept = Store(store)
    assert kept.verify() == []
    assert all((kept.read(i)["order"] == made_up(plan, i)["order"]).all() for i in range(plan.blocks))
    assert len(said) == 1
    for word in ("OMP_NUM_THREADS", "XLA_FLAGS", "docs/sweeps.md"):
        assert word in str(said[0].message)
    assert not list(store.glob(".greeting*"))


def test_a_sweep_waits_for_workers_and_outlives_them(scheduler, tmp_path):
    address, file = scheduler
    seen, workers = [], []

    def send_a_worker(now):
        seen.append(now.workers)
        if len(seen) == 3:
            workers.append(worker(address, tmp_path))

    with guest_client(file=file) as guest, warnings.catch_warnings():
        warnings.simplefilter("ignore")
        wait_until(lambda: not guest.scheduler_info()["workers"])
        summary = run_sweep(sweep(), tmp_path / "s", guest, progress=send_a_worker, compute=slow(0.0))
    with ended(workers[0]):
        assert summary.ok
        assert seen[0] == 0
        assert seen[-1] == 1


@pytest.mark.slow
def test_a_lost_scheduler_stops_the_sweep_with_a_sentence(tmp_path, monkeypatch):
    monkeypatch.setattr(running_cluster, "CONNECT_SECONDS", 1.0)

    def kill_it(now):
        if now.done >= 4 and process.poll() is None:
            process.kill()

    with (
        scheduled(tmp_path) as (process, address, _),
        ended(worker(address, tmp_path)),
        guest_client(address) as guest,
        warnings.catch_warnings(),
    ):
        warnings.simplefilter("ignore")
        summary = run_sweep(sweep(), tmp_path / "s", guest, progress=kill_it, compute=slow(0.3))
    assert summary.status == "stopped"
    assert "scheduler cannot be reached" in summary.message
    assert 4 <= summary.done < 48


def test_clusters_that_cannot_be_reached_are_refused(tmp_path, monkeypatch):
    monkeypatch.setattr(running_cluster, "CONNECT_SECONDS", 0.5)
    with pytest.raises(InputError, match="scheduler"), guest_client(f"tcp://127.0.0.1:{free_port()}"):
        pass
    with pytest.raises(InputError, match="scheduler"), guest_client("nonsense://x"):
        pass
    with pytest.raises(InputError, match="scheduler_file"), guest_client(file=tmp_path / "absent.json"):
        pass
    (tmp_path / "bad.json").write_text("{}")
    with pytest.raises(InputError, match="scheduler_file"), guest_client(file=tmp_path / "bad.json"):
        pass


def test_arguments_that_contradict_each_other_are_refused(client, tmp_path):
    with pytest.raises(InputError, match="workers"):
        run_sweep(sweep(), tmp_path / "s", client, workers=2)
    with pytest.raises(InputError, match="workers"):
        run_sweep(sweep(), tmp_path / "s", workers=0)


def test_unfit_workers_are_named():
    fit = WorkerReport(versions(), (), 1, "token", "")
    assert obstacle({"a": fit}) == remarks({"a": fit}) == ""
    other = WorkerReport(versions() | {"cyclosis": "0.0"}, (), 1, "token", "")
    assert "the worker at b" in obstacle({"a": fit, "b": other})
    assert "0.0" in obstacle({"b": other})
    assert "install" in obstacle({"c": ModuleNotFoundError("No module named 'cyclosis'")})
    assert "reach the store" in obstacle({"d": WorkerReport(versions(), (), 1, "", "no such folder")})
    older = WorkerReport(versions() | {"jax": "0.0"}, ("XLA_FLAGS",), 4, "token", "")
    for word in ("jax 0.0", "XLA_FLAGS", "--nthreads 1"):
        assert word in remarks({"a": fit, "e": older})


def test_a_task_refuses_another_store_and_another_version(tmp_path):
    plan = sweep()
    Store.create(tmp_path / "s", plan)
    assert "one folder" in BlockTask(str(tmp_path / "s"), "other digest")(0).obstacle
    assert "version" in BlockTask(str(tmp_path / "s"), plan.digest, version="0.0")(0).obstacle
    assert "store" in BlockTask(str(tmp_path / "absent"), plan.digest)(0).obstacle


def test_nothing_of_a_cluster_is_left_when_it_is_closed():
    before = set(psutil.Process().children(recursive=True))
    with local_client(1) as client:
        client.wait_for_workers(1)
        assert set(psutil.Process().children(recursive=True)) > before
    assert set(psutil.Process().children(recursive=True)) <= before
