"""Streaming a run to its file, checkpoint by checkpoint, and going on with one that stands there."""

from __future__ import annotations

import glob
import os
import shutil
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

from ..dynamics.run import Snapshot
from ..dynamics.simulate import CHECKPOINT_SECONDS, resume
from ..dynamics.trajectory import Status, Trajectory
from ..model.errors import InputError
from ..model.filaments import TermLike
from .contents import of_trajectory
from .convert import check_writable, load
from .netcdf import joined, sync_folder, unwritable, write_contents
from .parts import MARKS, digest_at, folder_of, is_unfinished, marks_of, parts


class RunWriter:
    """Streams a run to a file: the `checkpoint` of `simulate`, and `finish` at its end.

        writer = RunWriter("run.nc")
        writer.finish(simulate(..., checkpoint=writer))

    With `continues` the run goes on from what stands there. Raises `InputError` if a file or an
    unfinished run is in the way (unless `force`), and when a part cannot be written; parts written
    before are kept.

    Example:
        >>> import cyclosis as cy
        >>> params, grid = cy.Parameters(), cy.CylinderGrid(16, 16)
        >>> writer = cy.RunWriter("streamed.nc")
        >>> run = cy.simulate(params, grid, cy.initial.stripes(grid), t_end=2.0, checkpoint=writer)
        >>> writer.finish(run).name
        'streamed.nc'
        >>> len(cy.load("streamed.nc").frames)
        3
    """

    def __init__(self, path: str | os.PathLike[str], force: bool = False, continues: bool = False) -> None:
        self.target = Path(path)
        self.number, self.frames, self.records, self.interventions = 0, 0, 0, 0
        if not continues:
            check_writable(self.target, force)
        self.folder = folder_of(self.target)
        for killed in self.target.parent.glob(f".{glob.escape(self.target.name)}.*.new"):
            killed.unlink(missing_ok=True)  # what a killed process was writing
        if continues:
            self._continue(parts(self.target))
        elif not force and is_unfinished(self.target):
            remedy = f"go on with `cyclosis resume {self.target}`, or add --force (force=True)"
            raise InputError("out", str(self.target), "free of an unfinished run", remedy)
        else:
            shutil.rmtree(self.folder, ignore_errors=True)
            self.marks: dict[str, Any] = {"follows": digest_at(self.target), "continues": 0}

    def _continue(self, standing: list[Path]) -> None:
        if standing == [self.target]:
            shutil.rmtree(self.folder, ignore_errors=True)
            self.marks = {"follows": digest_at(self.target), "continues": 1}
        else:
            self.marks = marks_of(standing[-1])
            self.number = int(standing[-1].stem) + 1

    def __call__(self, run: Trajectory) -> None:
        """Write what is new since the last part, and release its frames."""
        contents = of_trajectory(run, self.frames, self.records, self.interventions)
        contents.attributes |= self.marks
        try:
            if not self.folder.is_dir():
                self.folder.mkdir(exist_ok=True)
                sync_folder(self.folder.parent)
        except OSError as error:
            raise unwritable(self.folder, error) from error
        write_contents(contents, self.folder / f"{self.number:06d}.nc")
        self.number += 1
        self.stands(run)
        run.frames.release()

    def stands(self, run: Trajectory) -> None:
        """Take note that all of a run is in the file.

        Example:
            >>> import cyclosis as cy
            >>> params, grid = cy.Parameters(), cy.CylinderGrid(16, 16)
            >>> path = cy.write(cy.simulate(params, grid, cy.initial.stripes(grid), t_end=1.0), "standing.nc")
            >>> run, writer = cy.load(path, fields=False), cy.RunWriter(path, continues=True)
            >>> writer.stands(run)
            >>> writer.finish(cy.resume(run, t_end=2.0, checkpoint=writer)).name
            'standing.nc'
        """
        self.frames, self.records = len(run.frames), run.record_times.size
        self.interventions = len(run.interventions)

    def finish(self, run: Trajectory) -> Path:
        """Write the last part, join all into the file, and return its path."""
        self(run)
        return self.join()

    def join(self) -> Path:
        """Join the parts that stand into the file, and return its path.

        Example:
            >>> import cyclosis as cy
            >>> params, grid = cy.Parameters(), cy.CylinderGrid(16, 16)
            >>> writer = cy.RunWriter("cut.nc")
            >>> run = cy.simulate(params, grid, cy.initial.stripes(grid), t_end=1.0, checkpoint=writer)
            >>> writer(run)
            >>> writer.join().name
            'cut.nc'
        """
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

    Example:
        >>> import cyclosis as cy
        >>> params, grid = cy.Parameters(), cy.CylinderGrid(16, 16)
        >>> path = cy.write(cy.simulate(params, grid, cy.initial.stripes(grid), t_end=1.0), "resumed.nc")
        >>> cy.resume_file(path, t_end=2.0).t_final, len(cy.load(path).frames)
        (2.0, 3)
    """
    run = load(path, terms, fields=False)
    writer = RunWriter(path, continues=True)
    writer.stands(run)
    if writer.number and run.status is not Status.INTERRUPTED and (t_end or 0.0) <= run.t_final:
        writer.join()  # the run had ended, and was cut off before its parts were joined
        return run
    onward = resume(
        run, t_end, terms=terms, progress=progress, checkpoint=writer, checkpoint_seconds=checkpoint_seconds
    )
    writer.finish(onward)
    return onward
