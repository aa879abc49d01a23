"""What overwriting leaves is of the new run alone, and nothing is overwritten that nobody asked for."""

import errno
import re
import shutil
import threading
import xml.etree.ElementTree as ET
from pathlib import Path

import numpy as np
import pytest
import xarray

import cyclosis as cy
from cyclosis.dataset import check_writable, export_vtk, netcdf, parts, write_table
from cyclosis.dataset import convert as converting
from cyclosis.dataset import writer as writing
from cyclosis.experiments import perform
from cyclosis.figures import style
from cyclosis.sweep.export import export
from cyclosis.sweep.store.store import Store
from measure.files import call, differences, everything
from sweep import fakes

GRID = cy.CylinderGrid(16, 16)
STATE = cy.initial.stripes(GRID)


def simulated(t_end=2.0, **settings):
    return cy.simulate(cy.Parameters(), GRID, STATE, t_end, 1.0, **settings)


def continued(target):
    """Leave a finished run and, beside it, the parts of its continuation to t = 3."""
    cy.write(simulated(), target)
    with cy.RunWriter(target, continues=True) as writer:
        run = cy.load(target, fields=False)
        writer.stands(run)
        writer(cy.resume(run, 3.0, checkpoint=writer))


@pytest.fixture(scope="module")
def parts_left(tmp_path_factory):
    """The parts of a run of another grid, as after a kill."""
    target, grid = tmp_path_factory.mktemp("cut") / "run.nc", cy.CylinderGrid(24, 16)
    with cy.RunWriter(target) as writer:
        writer(cy.simulate(cy.Parameters(), grid, cy.initial.stripes(grid), 2.0, checkpoint=writer))
    return parts.folder_of(target)


@pytest.fixture
def cut_off(parts_left, tmp_path):
    """The place of a run that was cut off and has left its parts."""
    target = tmp_path / "run.nc"
    shutil.copytree(parts_left, parts.folder_of(target))
    assert parts.is_unfinished(target)
    return target


@pytest.fixture(scope="module")
def finished():
    return simulated()


TABLE = xarray.Dataset({"a": ("x", [1.0])}, {"x": [0.0]})
WAYS = {
    "write": lambda run, target: cy.write(run, target, force=True),
    "RunWriter": lambda run, target: cy.RunWriter(target, force=True).finish(run),
    "write_table": lambda run, target: write_table(TABLE, target),
    "export": lambda run, target: export(
        fakes.filled(Store.create(target.parent / "store", fakes.sweep())), target, force=True
    ),
}


@pytest.mark.parametrize("way", WAYS.values(), ids=WAYS)
def test_overwriting_leaves_no_part_of_an_unfinished_run(cut_off, tmp_path, way):
    target = cut_off
    way(simulated(), target)  # a writer takes the frames of a run away
    assert target.is_file()
    assert [path.name for path in tmp_path.iterdir() if path.name != "store"] == ["run.nc"]


def test_a_forced_run_that_is_cut_short_is_not_mixed_with_the_one_before(tmp_path):
    target = tmp_path / "run.nc"
    for size in (24, 16):
        grid = cy.CylinderGrid(size, 16)
        with cy.RunWriter(target, force=True) as writer:
            state, often = cy.initial.stripes(grid), size == 24
            pause = 0.0 if often else 1e9
            cy.simulate(cy.Parameters(), grid, state, 5.0, checkpoint=writer, checkpoint_seconds=pause)
        assert (len(parts.stored(target)) > 1) is often
        assert cy.load(target).grid.n_theta == size


def test_parts_that_are_removed_only_in_part_are_still_a_run(tmp_path, monkeypatch):
    """The process that removes them is killed after some of them."""
    target = tmp_path / "run.nc"
    with cy.RunWriter(target) as writer:
        simulated(5.0, checkpoint=writer, checkpoint_seconds=0.0)
    whole, left, remove = cy.load(target), [3], Path.unlink

    def unlink(path, missing_ok=False):
        left[0] -= 1
        if left[0] < 0:
            raise KeyboardInterrupt
        remove(path, missing_ok)

    monkeypatch.setattr(Path, "unlink", unlink)
    with pytest.raises(KeyboardInterrupt):
        parts.clear(target)
    monkeypatch.undo()
    some = cy.load(target)
    assert 0 < some.times.size < whole.times.size
    assert some.times.tolist() == whole.times[: some.times.size].tolist()


def test_overwriting_a_file_and_its_continuation(tmp_path):
    target = tmp_path / "run.nc"
    continued(target)
    assert cy.load(target).t_final == 3.0
    cy.write(simulated(1.0), target, force=True)
    assert [path.name for path in tmp_path.iterdir()] == ["run.nc"]
    assert cy.load(target).t_final == 1.0


def test_unfinished_runs_are_in_the_way_of_every_other_file(finished, cut_off):
    target = cut_off
    for use in (lambda: cy.write(finished, target), lambda: check_writable(target, False)):
        with pytest.raises(
            cy.InputError, match=r"resume_file\('.*run.nc'\), or overwrite it with force=True"
        ):
            use()
    assert parts.is_unfinished(target)


def test_a_run_that_does_not_begin_removes_nothing(cut_off):
    target = cut_off
    with pytest.raises(cy.InputError), cy.RunWriter(target, force=True) as writer:
        cy.simulate(cy.Parameters(), GRID, STATE, t_end=-1.0, checkpoint=writer)
    assert parts.is_unfinished(target)
    assert cy.load(target).t_final == 2.0


def test_parts_whose_beginning_is_missing_are_not_removed_unless_forced(tmp_path):
    target = tmp_path / "run.nc"
    continued(target)
    target.rename(tmp_path / "elsewhere.nc")
    with pytest.raises(cy.InputError, match="whose beginning is missing"):
        cy.RunWriter(target)
    (tmp_path / "elsewhere.nc").rename(target)
    assert cy.load(target).t_final == 3.0


def test_a_file_that_appears_while_a_run_goes_on_stays_and_so_does_the_run(finished, tmp_path):
    target = tmp_path / "run.nc"
    for content in (b"precious", None):
        with cy.RunWriter(target) as writer:
            run = simulated(checkpoint=writer)
            other = cy.write(simulated(1.0), tmp_path / "other.nc", force=True)
            appeared = other.read_bytes() if content is None else content
            target.write_bytes(appeared)
            with pytest.raises(cy.InputError, match="the run is kept in") as refused:
                writer.finish(run)
        assert "`cyclosis resume " in refused.value.at_terminal
        assert target.read_bytes() == appeared
        if content is None:
            with pytest.raises(cy.InputError, match="move one of the two elsewhere"):
                cy.resume_file(target, 5.0)
        target.unlink()
        assert cy.resume_file(target).t_final == 2.0
        assert differences(target, cy.write(finished, tmp_path / "whole.nc", force=True)) == []
        target.unlink()


def test_a_file_that_appears_at_the_last_moment_stays(tmp_path, monkeypatch):
    target = tmp_path / "run.nc"
    with cy.RunWriter(target) as writer:
        run = simulated(checkpoint=writer)
        monkeypatch.setattr(writer, "_check_place", lambda: target.write_bytes(b"precious"))
        with pytest.raises(cy.InputError, match="the run is kept in"):
            writer.finish(run)
    assert target.read_bytes() == b"precious"
    target.unlink()
    assert cy.resume_file(target).t_final == 2.0


def test_a_file_that_was_changed_while_it_was_continued_stays(tmp_path):
    target = tmp_path / "run.nc"
    cy.write(simulated(), target)
    run = cy.load(target, fields=False)
    with cy.RunWriter(target, continues=True) as writer:
        writer.stands(run)
        onward = cy.resume(run, 3.0, checkpoint=writer)
        (tmp_path / "new.nc").write_bytes(cy.write(simulated(1.0), tmp_path / "x.nc").read_bytes())
        (tmp_path / "new.nc").rename(target)
        with pytest.raises(cy.InputError, match="no other file has appeared"):
            writer.finish(onward)
    assert cy.load(target).t_final == 1.0


def test_a_run_that_went_on_elsewhere_is_not_continued_from_before(tmp_path):
    target = tmp_path / "run.nc"
    cy.write(simulated(), target)
    old = cy.load(target, fields=False)
    cy.resume_file(target, 3.0)
    with cy.RunWriter(target, continues=True) as writer, pytest.raises(cy.InputError, match="load it again"):
        writer.stands(old)


def test_a_folder_that_is_removed_under_a_run_is_noticed(tmp_path):
    target = tmp_path / "run.nc"
    with cy.RunWriter(target) as writer:
        run = simulated(checkpoint=writer)
        for path in parts.folder_of(target).iterdir():
            path.unlink()
        parts.folder_of(target).rmdir()
        with pytest.raises(cy.InputError, match="its folder was removed"):
            writer(run)


def test_of_two_files_written_at_once_the_second_is_refused_or_forced(finished, tmp_path, monkeypatch):
    """Both find the place free; the other file is there when this one is to be renamed."""
    target = tmp_path / "run.nc"
    monkeypatch.setattr(converting, "check_writable", lambda target, force: None)
    target.write_bytes(b"precious")
    with pytest.raises(cy.InputError, match="force=True"):
        cy.write(finished, target)
    assert target.read_bytes() == b"precious"
    assert [path.name for path in tmp_path.iterdir()] == ["run.nc"]


def test_a_file_system_without_hard_links_is_no_hindrance(finished, tmp_path, monkeypatch):
    def refuse(*_):
        raise OSError(errno.EPERM, "no hard links here")

    monkeypatch.setattr("os.link", refuse)
    assert cy.load(cy.write(finished, tmp_path / "run.nc")).t_final == 2.0
    monkeypatch.setattr(converting, "check_writable", lambda target, force: None)
    with pytest.raises(cy.InputError, match="force=True"):
        cy.write(finished, tmp_path / "run.nc")


def test_tables_and_figures_written_at_once_are_whole(tmp_path):
    """Several threads write other content to one name: what stands is what one of them wrote."""
    table, picture, failed = tmp_path / "table.csv", tmp_path / "picture.png", []

    def work(number):
        try:
            for _ in range(5):
                values = np.full(5000 * number, float(number))
                write_table(xarray.Dataset({"a": ("x", values)}, {"x": values}), table)
                style.save(style.blank(20.0 * number, 10.0), picture)
        except Exception as error:
            failed.append(error)

    threads = [threading.Thread(target=work, args=(number,)) for number in (1, 2, 3)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert failed == []
    rows = table.read_text().split()[1:]
    assert len(set(rows)) == 1
    assert len(rows) == 5000 * float(rows[0].split(",")[0])
    assert picture.read_bytes().endswith(b"IEND\xaeB`\x82")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["picture.png", "table.csv"]


def test_a_figure_whose_writing_fails_leaves_the_one_before(tmp_path):
    picture = style.save(style.blank(20.0, 10.0), tmp_path / "a.png")
    before = picture.read_bytes()
    broken = style.blank(20.0, 10.0)

    def half(file, **_):
        file.write(before[:100])
        raise OSError(errno.ENOSPC, "No space left on device")

    broken.savefig = half
    with pytest.raises(cy.InputError, match="No space left"):
        style.save(broken, picture)
    assert picture.read_bytes() == before
    assert [path.name for path in tmp_path.iterdir()] == ["a.png"]


def test_exporting_over_a_longer_run_leaves_its_frames_nowhere(tmp_path):
    folder = tmp_path / "surface"
    export_vtk(simulated(5.0).to_dataset(), folder)
    folder.rename(tmp_path / "renamed")
    folder = tmp_path / "renamed"
    (folder / "notes.txt").write_text("precious")
    (folder / "mine.pvd").write_text("precious")
    collection = export_vtk(simulated(1.0).to_dataset(), folder, force=True)
    frames = ["frame-00000.vts", "frame-00001.vts"]
    assert sorted(path.name for path in folder.iterdir()) == [*frames, "mine.pvd", "notes.txt", "renamed.pvd"]
    assert [item.get("file") for item in ET.parse(collection).iter("DataSet")] == frames
    assert [path.name for path in tmp_path.iterdir()] == ["renamed"]


def test_an_experiment_that_is_cut_off_leaves_no_old_figure_beside_new_data(tmp_path, monkeypatch):
    done = perform("timescales", tmp_path, quick=True)

    def stop(*_):
        raise KeyboardInterrupt

    monkeypatch.setattr(style, "save", stop)
    with pytest.raises(KeyboardInterrupt):
        perform("timescales", tmp_path, quick=True, force=True)
    assert done.file.exists()
    assert not done.figure.exists()


@pytest.mark.slow
def test_python_is_told_of_arguments_and_the_command_line_of_options(finished, tmp_path):
    target = cy.write(finished, tmp_path / "run.nc")
    export_vtk(finished.to_dataset(), tmp_path / "run")
    store = fakes.filled(Store.create(tmp_path / "store", fakes.sweep()))
    export(store, tmp_path / "runs.csv")
    for use, command in (
        (lambda: cy.write(finished, target), ("run", "--t-end", "1", "--out", "run.nc")),
        (lambda: export_vtk(finished.to_dataset(), tmp_path / "run"), ("export", "run.nc")),
        (lambda: export(store, tmp_path / "runs.csv"), ("sweep", "export", "store", "--out", "runs.csv")),
    ):
        with pytest.raises(cy.InputError) as refused:
            use()
        assert "force=True" in str(refused.value)
        assert "--" not in str(refused.value)
        said = call(tmp_path, *command)
        assert said.returncode == 2
        assert "--force" in said.stderr
        assert "force=True" not in said.stderr


def test_a_run_that_fits_is_written_once_and_in_blocks(tmp_path, monkeypatch):
    """One assignment a block and field, and no second copy at the end, however many frames."""
    assigned, written = [], []
    original, write = netcdf.h5netcdf.Variable.__setitem__, writing.write_contents

    def assign(variable, key, values):
        assigned.append(variable.name)
        original(variable, key, values)

    def spy(contents, target, *others):
        written.append(re.sub(r".*/", "", str(target)))
        write(contents, target, *others)

    monkeypatch.setattr(netcdf.h5netcdf.Variable, "__setitem__", assign)
    monkeypatch.setattr(writing, "write_contents", spy)
    counts = {}
    for t_end in (4.0, 40.0):
        target = tmp_path / f"{t_end:g}.nc"
        assigned.clear()
        written.clear()
        with cy.RunWriter(target) as writer:
            writer.finish(simulated(t_end, checkpoint=writer))
        assert written == ["000000.nc", target.name]
        counts[t_end] = len(assigned)
        assert cy.open_dataset(target).sizes["time"] == t_end + 1
    assert counts[4.0] == counts[40.0]


@pytest.mark.slow
def test_blocks_of_any_size_make_the_same_file(tmp_path, monkeypatch):
    whole = cy.write(simulated(10.0), tmp_path / "whole.nc")
    for size in (1, 3 * 2 * 2 * 16 * 16 * 8):
        monkeypatch.setattr("cyclosis.dataset.contents.BLOCK_BYTES", size)
        path = tmp_path / f"{size}.nc"
        with cy.RunWriter(path) as writer:
            writer.finish(simulated(10.0, checkpoint=writer, checkpoint_seconds=0.0))
        assert differences(whole, path) == []
        assert np.array_equal(cy.load(path).frames[7], everything(whole)["P"][7])
        with cy.open_dataset(path) as data:
            assert data.sizes["time"] == 11


def test_a_run_whose_file_cannot_be_made_is_kept_to_its_end(finished, tmp_path, monkeypatch):
    target, write = tmp_path / "run.nc", writing.write_contents

    def full(contents, place, *others):
        if place == target:
            raise cy.InputError("out", str(place), "a file that can be written whole", "free some disk space")
        write(contents, place, *others)

    monkeypatch.setattr(writing, "write_contents", full)
    with cy.RunWriter(target) as writer, pytest.raises(cy.InputError, match="free some disk space"):
        writer.finish(simulated(checkpoint=writer))
    monkeypatch.undo()
    assert cy.load(target).t_final == 2.0
    assert cy.resume_file(target).t_final == 2.0
    assert differences(target, cy.write(finished, tmp_path / "whole.nc")) == []
