"""Runs that are still going, or were cut off: parts in a folder, joined into one file at the end.

While a run goes towards `run.nc`, its checkpoints stand in `run.nc.unfinished/` as numbered NetCDF
files, each with the frames since the one before and the stepper's state, each written whole or not at
all. A checkpoint therefore costs the same however long the run already is, and whatever kills the
process, the parts that stand can be opened and resumed. At the end the parts are joined into `run.nc` and
the folder goes. When a finished file is resumed it stays as the first part until the join replaces it.
"""

from __future__ import annotations

import glob
import os
import shutil
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

import h5py

from ..dynamics.run import Snapshot
from ..dynamics.simulate import CHECKPOINT_SECONDS, resume
from ..dynamics.trajectory import Status, Trajectory
from ..model.errors import InputError
from ..model.filaments import TermLike
from .contents import of_trajectory
from .netcdf import DAMAGED, attributes_of, damaged, joined, sync_folder, unwritable, write_contents

MARKS = ("follows", "continues")
"""Attributes of a part: the digest of the file at its run's place when the run began, and whether the run
continues that file."""


def folder_of(target: Path) -> Path:
    """Return the folder of the parts of an unfinished run."""
    return target.with_name(target.name + ".unfinished")


def parts(target: Path) -> list[Path]:
    """Return the files that make up a run: the one at its place, or what an unfinished run has left."""
    stored = sorted(folder_of(target).glob("[0-9]*.nc"))
    if not stored:
        return [target]
    marks = _marks(stored[-1])
    if marks["follows"] != _digest(target):
        return [target]  # the run has been joined since: the folder was only not yet removed
    return [target, *stored] if marks["continues"] else stored


def is_unfinished(target: Path) -> bool:
    """Return whether parts of an unfinished run stand beside `target`."""
    return parts(target) != [target]


class RunWriter:
    """Streams a run to a file: the `checkpoint` of `simulate`, and `finish` at its end.

        writer = RunWriter("run.nc")
        writer.finish(simulate(..., checkpoint=writer))

    With `continues` the run goes on from what stands there. Raises `InputError` if a file or an
    unfinished run is in the way (unless `force`), and when a part cannot be written; parts written
    before are kept.
    """

    def __init__(self, path: str | os.PathLike[str], force: bool = False, continues: bool = False) -> None:
        self.target, self.folder = Path(path), folder_of(Path(path))
        self.number, self.frames, self.records = 0, 0, 0
        standing = parts(self.target)
        for killed in self.target.parent.glob(f".{glob.escape(self.target.name)}.*.new"):
            killed.unlink(missing_ok=True)  # what a killed process was writing
        if continues:
            self._continue(standing)
        elif standing != [self.target] and not force:
            remedy = f"go on with `cyclosis resume {self.target}`, or add --force (force=True)"
            raise InputError("out", str(self.target), "free of an unfinished run", remedy)
        else:
            shutil.rmtree(self.folder, ignore_errors=True)
            self.marks: dict[str, Any] = {"follows": _digest(self.target), "continues": 0}

    def _continue(self, standing: list[Path]) -> None:
        if standing == [self.target]:
            shutil.rmtree(self.folder, ignore_errors=True)
            self.marks = {"follows": _digest(self.target), "continues": 1}
        else:
            self.marks = _marks(standing[-1])
            self.number = int(standing[-1].stem) + 1

    def __call__(self, run: Trajectory) -> None:
        """Write what is new since the last part, and release its frames."""
        contents = of_trajectory(run, self.frames, self.records)
        contents.attributes |= self.marks
        try:
            self.folder.mkdir(exist_ok=True)
        except OSError as error:
            raise unwritable(self.folder, error) from error
        write_contents(contents, self.folder / f"{self.number:06d}.nc")
        self.number += 1
        self.frames, self.records = len(run.frames), run.record_times.size
        run.frames.release()

    def finish(self, run: Trajectory) -> Path:
        """Write the last part, join all into the file, and return its path."""
        self(run)
        return self.join()

    def join(self) -> Path:
        """Join the parts that stand into the file, and return its path."""
        whole = joined(parts(self.target))
        for mark in MARKS:
            whole.attributes.pop(mark, None)
        write_contents(whole, self.target)
        shutil.rmtree(self.folder, ignore_errors=True)
        sync_folder(self.target.parent)
        return self.target


def resume_file(
    path: str | os.PathLike[str],
    t_end: float | None = None,
    *,
    terms: Iterable[TermLike] | None = None,
    progress: Callable[[Snapshot], None] | None = None,
    checkpoint_seconds: float = CHECKPOINT_SECONDS,
) -> Trajectory:
    """Continue the run in a file, finished or cut off, to `t_end`; the file then holds the whole run.

    Bitwise as if it had never stopped, see `resume`. The trajectory's frames stay in the file. Raises
    `InputError` for files that cannot be read, runs that cannot go on, and failures to write.
    """
    from .convert import load

    run = load(path, terms, fields=False)
    writer = RunWriter(path, continues=True)
    writer.frames, writer.records = len(run.frames), run.record_times.size
    if writer.number and run.status is not Status.INTERRUPTED and (t_end or 0.0) <= run.t_final:
        writer.join()  # the run had ended, and was cut off before its parts were joined
        return run
    onward = resume(
        run, t_end, terms=terms, progress=progress, checkpoint=writer, checkpoint_seconds=checkpoint_seconds
    )
    writer.finish(onward)
    return onward


def _digest(path: Path) -> str:
    """Return the digest that a file states of itself, or nothing where there is no such file."""
    try:
        with h5py.File(path, "r") as file:
            return str(file.attrs["digest"])
    except DAMAGED:
        return ""


def _marks(path: Path) -> dict[str, Any]:
    try:
        with h5py.File(path, "r") as file:
            found = attributes_of(file)
            return {mark: found[mark] for mark in MARKS}
    except DAMAGED as error:
        raise damaged(path, error) from error
