"""Killed, damaged or full: a sweep ends with the store of one left in peace, or says why not."""

import os
import random
import signal
import time
from functools import partial

import pytest

from cyclosis.model.errors import InputError
from cyclosis.sweep.execute import repair, run_sweep
from cyclosis.sweep.store.store import Store
from measure.faults import Blow, disturbed, made_up_command, offspring, orphaned, start
from measure.sweeps import ODD, differences, half_written, made_up, slow, sweep


@pytest.fixture(scope="module")
def straight(tmp_path_factory):
    """A store that was computed in peace."""
    plan = sweep()
    store = Store.create(tmp_path_factory.mktemp("straight") / "s", plan)
    for index in range(plan.blocks):
        store.write(index, made_up(plan, index))
    return store.path


def test_a_block_that_raises_is_set_aside_and_the_rest_is_computed(client, straight, tmp_path):
    summary = run_sweep(sweep(), tmp_path / "s", client, compute=slow(0.0, "raising"))
    assert summary.status == "incomplete"
    assert not summary.ok
    assert summary.done == 44
    assert summary.aside == {ODD: "ZeroDivisionError: nothing can be divided by nothing"}
    assert "44 of 48 runs" in summary.message
    assert "divided" in summary.message
    assert Store(tmp_path / "s").failed() == summary.aside
    again = run_sweep(sweep(), tmp_path / "s", client, compute=slow(0.0, "raising"))
    assert again.status == "incomplete"
    assert again.computed == 0, "it stays aside"
    mended = repair(tmp_path / "s", client, compute=slow(0.0))
    assert mended.ok
    assert mended.computed == 4
    assert differences(straight, tmp_path / "s") == []
    assert Store(tmp_path / "s").failed() == {}


@pytest.mark.slow
def test_a_block_that_kills_its_worker_is_set_aside_and_nobody_else_is_blamed(tmp_path):
    summary = run_sweep(sweep(), tmp_path / "s", workers=2, compute=slow(0.02, "deadly"))
    assert summary.status == "incomplete"
    assert list(summary.aside) == [ODD]
    assert "worker died" in summary.aside[ODD]
    assert summary.done == 44
    assert sorted(Store(tmp_path / "s").present()) == [i for i in range(12) if i != ODD]


def test_if_nothing_can_be_computed_it_stops_soon(client, tmp_path):
    summary = run_sweep(sweep(), tmp_path / "s", client, compute=slow(0.0, "hopeless"))
    assert summary.status == "stopped"
    assert "a library is missing" in summary.message


def test_a_full_disk_stops_with_a_sentence_and_loses_nothing(client, straight, tmp_path):
    """Nor do its workers leave half-written files, though one is still writing when they are ended."""
    store = Store.create(tmp_path / "s", sweep())
    summary = run_sweep(sweep(), store.path, workers=1, compute=partial(half_written, store=store.path))
    assert summary.status == "stopped"
    assert "free some disk space" in summary.message
    assert summary.aside == {}
    assert len(store.present()) * 4 == summary.done
    assert not list(store.path.rglob("*.new"))
    assert run_sweep(sweep(), tmp_path / "s", client, compute=slow(0.0)).ok
    assert differences(straight, tmp_path / "s") == []


def test_only_damaged_blocks_are_repaired(client, straight, tmp_path):
    plan = sweep()
    store = Store.create(tmp_path / "s", plan)
    for index in range(plan.blocks):
        store.write(index, made_up(plan, index))
    flipped, cut, gone = (store.path_of(index) for index in (1, 6, 11))
    content = bytearray(flipped.read_bytes())
    content[len(content) // 2] ^= 1
    flipped.write_bytes(content)
    os.truncate(cut, 1000)
    gone.unlink()
    assert [index for index, _ in store.verify()] == [1, 6, 11]
    before = {i: store.path_of(i).stat().st_mtime_ns for i in range(12) if i not in (1, 6, 11)}
    summary = repair(store.path, client, compute=slow(0.0))
    assert summary.ok
    assert summary.computed == 12
    assert {i: store.path_of(i).stat().st_mtime_ns for i in before} == before
    assert store.verify() == []
    assert differences(straight, store.path) == []


def test_another_configuration_is_refused_with_the_difference(client, straight):
    with pytest.raises(InputError, match="alpha_u"):
        run_sweep(sweep(axes={"alpha_u": {"values": [0.1, 0.5]}}), straight, client, compute=slow(0.0))
    with pytest.raises(InputError, match="seeds"):
        run_sweep(sweep(ensemble={"seeds": 8}), straight, client, compute=slow(0.0))


@pytest.mark.slow
def test_a_sweep_that_was_killed_again_and_again_ends_with_the_same_store(straight, tmp_path):
    blows = [Blow("worker", blocks=2), Blow("client", blocks=4), Blow("everything", blocks=7)]
    found = disturbed(made_up_command(0.25), straight, tmp_path / "s", blows, random.Random(0))
    assert found.wrong == ""
    assert found.standing[-1] < 12
    assert found.outlived < 5.0


@pytest.mark.parametrize("number", [signal.SIGINT, pytest.param(signal.SIGTERM, marks=pytest.mark.slow)])
def test_interrupted_it_says_how_far_it_is_and_goes_on(number, client, straight, tmp_path):
    process = start([*made_up_command(0.3), "--workers", "1"], tmp_path / "s")
    wait_until(lambda: any((tmp_path / "s" / "blocks").rglob("*.nc")))
    workers = offspring(process)
    process.send_signal(number)
    said, complaints = process.communicate(timeout=30)
    assert process.returncode == 130
    assert "interrupted" in said
    assert complaints == ""
    assert orphaned(workers) < 5.0
    assert 0 < len(Store(tmp_path / "s").present()) < 12
    assert run_sweep(sweep(), tmp_path / "s", client, compute=slow(0.0)).ok
    assert differences(straight, tmp_path / "s") == []


@pytest.mark.slow
@pytest.mark.parametrize("number", [signal.SIGINT, pytest.param(signal.SIGTERM, marks=pytest.mark.slow)])
def test_a_script_that_loops_over_sweeps_ends_with_the_first(number, tmp_path):
    process = start([*made_up_command(0.3), "--workers", "1", "--script"], tmp_path / "s")
    wait_until(lambda: any((tmp_path / "s-0" / "blocks").rglob("*.nc")))
    workers = offspring(process)
    process.send_signal(number)
    complaints = process.communicate(timeout=120)[1]
    assert process.returncode == -number
    assert ("KeyboardInterrupt" in complaints) is (number == signal.SIGINT)
    assert orphaned(workers) < 5.0
    assert 0 < len(Store(tmp_path / "s-0").present()) < 12
    assert not (tmp_path / "s-1").exists()


@pytest.mark.slow
def test_two_clients_may_work_on_one_store_at_once(straight, tmp_path):
    both = [start([*made_up_command(0.2), "--workers", "1"], tmp_path / "s") for _ in range(2)]
    for process in both:
        said, complaints = process.communicate(timeout=60)
        assert process.returncode == 0, complaints
        assert "all 48 runs" in said
    store = Store(tmp_path / "s")
    assert store.verify() == []
    assert differences(straight, store.path) == []
    assert not list(store.path.rglob("*.new"))


def wait_until(true, seconds=30.0):
    deadline = time.monotonic() + seconds
    while not true():
        assert time.monotonic() < deadline, "waited too long"
        time.sleep(0.02)
