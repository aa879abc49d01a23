"""Disks that fail, writers that die, writers that meet: a block is whole or it is not there."""

import errno
import os
import threading
import time

import numpy as np
import pytest

import cyclosis as cy
from cyclosis.dataset.whole import STALE_SECONDS, host
from cyclosis.sweep.store.block_file import pack
from cyclosis.sweep.store.store import Store
from sweep import fakes

CALLS = ("open", "write", "fsync", "replace", "mkdir")


@pytest.fixture
def planned():
    return fakes.sweep()


@pytest.fixture
def store(planned, tmp_path):
    return Store.create(tmp_path / "store", planned)


def leftovers(store):
    return [path.name for path in store.path.rglob("*") if path.name.endswith(".new")]


class Disk:
    """Makes the n-th call to the system that writes fail."""

    def __init__(self, monkeypatch, number, error=errno.ENOSPC, short=False):
        self.number, self.error, self.short, self.calls = number, error, short, 0
        for name in CALLS:
            monkeypatch.setattr(os, name, self.faulty(getattr(os, name), name))

    def faulty(self, real, name):
        def call(*arguments, **options):
            if name == "open" and not arguments[1] & os.O_WRONLY:
                return real(*arguments, **options)
            self.calls += 1
            if self.calls == self.number:
                if self.short and name == "write":
                    return real(arguments[0], arguments[1][: len(arguments[1]) // 2])
                raise OSError(self.error, os.strerror(self.error))
            return real(*arguments, **options)

        return call


def each_failure(action, **options):
    """Yield for every call of `action` to the system: what was raised when that call failed."""
    for number in range(1, 100):
        with pytest.MonkeyPatch.context() as patch:
            disk = Disk(patch, number, **options)
            error = None
            try:
                action()
            except cy.InputError as refused:
                error = refused
        if disk.calls < number:
            assert error is None
            assert number > 3, "there were calls to make fail"
            return
        yield number, error


@pytest.mark.parametrize("error", [errno.ENOSPC, errno.EDQUOT, errno.EIO, errno.EROFS])
@pytest.mark.parametrize("again", [False, True])
def test_a_write_that_fails_leaves_nothing_and_loses_nothing(store, planned, error, again):
    fakes.filled(store, 1, 2, 3, 4)
    before = fakes.arrays(planned, 0)
    if again:
        store.write(4, before | {name: values[:4] for name, values in before.items()})
    old = store.path_of(4).read_bytes() if again else None
    new = pack(planned, 4, fakes.arrays(planned, 4))
    outcomes = []
    for _, raised in each_failure(lambda: store.write(4, fakes.arrays(planned, 4)), error=error):
        assert raised is not None
        assert "\n" not in str(raised)
        assert ("free some disk space" in str(raised)) == (error in (errno.ENOSPC, errno.EDQUOT))
        assert not leftovers(store)
        stands = store.path_of(4).read_bytes() if store.has(4) else None
        assert stands in (old, new), "the block is whole, old or new"
        outcomes.append(stands == new)
        fakes.same(store.read(0), before)
        store.discard(4)
        if again:
            store.path_of(4).write_bytes(old)
    assert outcomes.count(True) == 1, "only where it was renamed and its folder could not be synced"
    assert len(outcomes) >= 4


def test_a_short_write_is_gone_on_with(store, planned):
    fakes.filled(store, 1)
    cut_short = 0
    for _, error in each_failure(lambda: store.write(1, fakes.arrays(planned, 1)), short=True):
        if error is None:
            cut_short += 1
            fakes.same(store.read(1), fakes.arrays(planned, 1))
    assert cut_short == 1, "the call of os.write"


def test_a_store_that_cannot_be_begun_is_refused(planned, tmp_path):
    folders = (tmp_path / str(number) for number in range(100))
    failures = list(each_failure(lambda: Store.create(next(folders), planned)))
    assert len(failures) >= 5
    assert None not in [error for _, error in failures]
    assert not list(tmp_path.rglob("*.new"))


def test_setting_aside_on_a_full_disk_is_refused(store):
    store.set_aside(3, "because")
    store.discard(3)
    for number, error in each_failure(lambda: store.set_aside(2, "because")):
        assert error is not None, number
        assert store.failed() in ({}, {2: "because"})
        assert not leftovers(store)


def test_a_folder_that_cannot_be_written(store, planned, monkeypatch):
    def refuse(*_, **__):
        raise PermissionError(errno.EACCES, "Permission denied")

    monkeypatch.setattr(os, "open", refuse)
    with pytest.raises(cy.InputError, match="Permission denied"):
        store.write(0, fakes.arrays(planned, 0))


def test_ctrl_c_while_writing_leaves_nothing(store, planned, monkeypatch):
    def interrupt(*_):
        raise KeyboardInterrupt

    monkeypatch.setattr(os, "fsync", interrupt)
    with pytest.raises(KeyboardInterrupt):
        store.write(0, fakes.arrays(planned, 0))
    monkeypatch.undo()
    assert store.present() == set()
    assert not leftovers(store)


def test_two_writers_of_one_block_and_a_reader_never_meet(store, planned):
    """Whatever the order, every reader finds the block of one of the two, whole."""
    wrote, read, ends = [], [], time.monotonic() + 1.0
    results = [fakes.arrays(planned, 2) | {"seconds": np.full(5, value)} for value in (1.0, 2.0)]
    store.write(2, results[0])

    def write(mine):
        own = Store(store.path)
        while time.monotonic() < ends:
            own.write(2, mine)
            wrote.append(1)

    threads = [threading.Thread(target=write, args=(mine,)) for mine in results]
    for thread in threads:
        thread.start()
    while time.monotonic() < ends:
        read.append(float(store.read(2)["seconds"][0]))
    for thread in threads:
        thread.join()
    assert len(wrote) > 10
    assert set(read) <= {1.0, 2.0}
    assert not leftovers(store)
    assert store.present() == {2}


def test_what_killed_writers_left_is_cleaned_and_living_ones_are_left_alone(store, planned):
    fakes.filled(store)
    folder = store.path_of(0).parent
    mine, here = os.getpid(), host()
    dead = 2**22 + 1  # above the largest number of a process
    living, killed = f".000000001.nc.{here}.{mine}.ab.new", f".000000001.nc.{here}.{dead}.ab.new"
    far, old = ".000000001.nc.elsewhere.17.ab.new", ".000000002.nc.elsewhere.17.ab.new"
    for name in (living, killed, far, old):
        (folder / name).write_bytes(b"half")
    (store.path / f".sweep.json.{here}.{dead}.ab.new").write_bytes(b"half")
    past = time.time() - STALE_SECONDS - 10
    os.utime(folder / old, (past, past))
    assert store.clean() == 3
    assert sorted(leftovers(store)) == sorted([living, far])
    assert store.verify() == []
    assert store.clean() == 0
