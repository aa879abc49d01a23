"""The power fails: what a writer said was stored is there afterwards, whole.

A disk keeps of a file what was synced, of a folder the names that it had when it was synced; renames may
reach it at any time before that. `Disk` remembers both, and makes what would be found after a cut.
"""

import os
import shutil

import numpy as np
import pytest

import cyclosis as cy
from cyclosis.dataset import writer as writers
from cyclosis.sweep.store.store import Store
from measure.files import differences
from sweep import fakes

GRID = cy.CylinderGrid(16, 12, 5.0)
STATE = cy.initial.disordered(GRID, 100)


class Disk:
    """Everything under `root` (which stands), as a disk without power would show it."""

    def __init__(self, patch, root):
        self.root, self.synced, self.names = root, {}, {}
        self.sync = os.fsync
        patch.setattr(os, "fsync", self.fsync)

    def fsync(self, handle):
        self.sync(handle)
        number = os.fstat(handle).st_ino
        for path in [self.root, *self.root.rglob("*")]:
            if path.stat().st_ino == number:
                if path.is_dir():
                    self.names[number] = {entry.name: entry for entry in path.iterdir()}
                else:
                    self.synced[number] = path.read_bytes()

    def after_a_cut(self, copy, renames_kept):
        """Make the folder `copy` of what is left; a rename that was not synced is kept or not."""
        self._left(self.root, copy, renames_kept)
        return copy

    def _left(self, folder, copy, renames_kept):
        copy.mkdir()
        synced = self.names.get(folder.stat().st_ino, {})
        for path in folder.iterdir():
            if path.name not in synced and not renames_kept:
                continue
            if path.is_dir():
                self._left(path, copy / path.name, renames_kept)
            else:
                (copy / path.name).write_bytes(self.synced.get(path.stat().st_ino, b""))


@pytest.fixture
def disk(monkeypatch, tmp_path):
    (tmp_path / "disk").mkdir()
    return Disk(monkeypatch, tmp_path / "disk")


@pytest.mark.parametrize("renames_kept", [True, False])
def test_blocks_of_a_sweep_are_whole_after_a_power_cut(disk, tmp_path, renames_kept):
    planned = fakes.sweep()
    fakes.filled(Store.create(disk.root / "far" / "store", planned), 2)
    left = Store(disk.after_a_cut(tmp_path / "left", renames_kept) / "far" / "store")
    assert left.missing() == [2]
    for index in left.present():
        fakes.same(left.read(index), fakes.arrays(planned, index))


@pytest.mark.parametrize("renames_kept", [True, False])
def test_a_file_is_whole_after_a_power_cut(disk, tmp_path, renames_kept):
    run = cy.simulate(cy.Parameters(), GRID, STATE, 2.0, 1.0)
    path = cy.write(run, disk.root / "run.nc")
    left = disk.after_a_cut(tmp_path / "left", renames_kept)
    assert differences(path, left / "run.nc") == []


@pytest.mark.parametrize("renames_kept", [True, False])
def test_a_checkpoint_is_whole_after_a_power_cut(disk, tmp_path, renames_kept):
    writer = cy.RunWriter(disk.root / "run.nc")
    run = cy.simulate(cy.Parameters(), GRID, STATE, 2.0, 1.0)
    writer(run)
    left = disk.after_a_cut(tmp_path / "left", renames_kept)
    assert np.array_equal(cy.load(left / "run.nc").final_state, run.final_state)


def test_a_cut_between_joining_parts_and_removing_them_changes_nothing(tmp_path, monkeypatch):
    """The parts of a run that went on stand beside the file that holds them already: none counts twice."""
    path = tmp_path / "run.nc"
    cy.write(cy.simulate(cy.Parameters(), GRID, STATE, 2.0, 1.0), path)
    monkeypatch.setattr(writers, "clear", lambda target: None)
    cy.resume_file(path, 4.0)
    assert (tmp_path / "run.nc.unfinished").exists()
    monkeypatch.undo()
    assert cy.open_dataset(path)["time"].values.tolist() == [0.0, 1.0, 2.0, 3.0, 4.0]
    shutil.copy(path, tmp_path / "alone.nc")
    cy.resume_file(path, 6.0)
    cy.resume_file(tmp_path / "alone.nc", 6.0)
    assert differences(path, tmp_path / "alone.nc") in ([], ["wall_time"], ["restart/wall_time"])
