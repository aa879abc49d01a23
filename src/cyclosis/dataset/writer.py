"""Streaming a run to its file, checkpoint by checkpoint, and continuing a run from its file."""

from __future__ import annotations

import contextlib
import glob
import os
import weakref
from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path
from types import TracebackType
from typing import Any

from ..contract.model import Model, TermLike
from ..display.shown import shown
from ..dynamics.interrupts import carried
from ..dynamics.simulate import CHECKPOINT_SECONDS, resume
from ..dynamics.trajectory import Status, Trajectory
from ..model.doors import door
from ..model.errors import InputError
from ..model.reporting import Progress
from ..model.scales import Scales
from ..model.units import table_of
from .contents import Contents, of_trajectory
from .convert import load
from .netcdf import damaged, joined, read_contents, write_contents
from .owner import claim
from .parts import MARKS, clear, digest_at, folder_of, is_superseded, marks_of, outcome_of, parts, stored
from .place import check_writable
from .whole import is_stale, sync_folder, unwritable


@shown
class RunWriter:
    """Streams a run to a file: the `checkpoint` of `simulate`, and `finish` at its end.

        with RunWriter("run.nc") as writer:
            writer.finish(simulate(..., checkpoint=writer))

    Only one writer at a time can write a run to a file: until `finish` or `close`, the end of the `with`, or
    the end of its process. In one thread, a new writer replaces an older one. With `continues` the run
    continues the one that is stored. With `force` it replaces a finished file when it ends, and an unfinished
    run when it begins. Raises `InputError` if a file or an unfinished run exists there (unless `force`), if
    another writer has the file, and if a part cannot be written; parts written before are kept.

    Example:
        >>> import cyclosis as cy
        >>> params, grid = cy.Parameters(), cy.CylinderGrid(16, 16)
        >>> with cy.RunWriter("streamed.nc") as writer:
        ...     run = cy.simulate(params, grid, cy.initial.stripes(grid), t_end=2.0, checkpoint=writer)
        ...     writer.finish(run).name
        'streamed.nc'
        >>> len(cy.load("streamed.nc").frames)
        3
    """

    def __init__(self, path: str | os.PathLike[str], force: bool = False, continues: bool = False) -> None:
        self.target, self.force = Path(path), force
        self.number, self.frames, self.records, self.interventions = 0, 0, 0, 0
        if not continues:
            check_writable(self.target, force)
        elif not parts(self.target)[0].is_file():
            raise damaged(self.target, FileNotFoundError())
        self.folder = folder_of(self.target)
        try:
            self._owner = claim(self.folder, self.target, "file" if continues else "out")
        except OSError as error:
            raise unwritable(self.folder, error) from error
        weakref.finalize(self, self._owner.release)
        try:
            self._begin(continues)
        except BaseException:
            self.close()
            raise

    def __repr__(self) -> str:
        return f"RunWriter({str(self.target)!r})"

    def _begin(self, continues: bool) -> None:
        for left in self.target.parent.glob(f".{glob.escape(self.target.name)}.*.new"):
            if is_stale(left):
                left.unlink(missing_ok=True)  # left by a killed process
        if not continues:
            check_writable(self.target, self.force)  # again, now that no other writer can change it
        self._found = _state(self.target)
        self.marks: dict[str, Any] = {"follows": digest_at(self.target), "continues": int(continues)}
        if not continues:
            return
        files = parts(self.target)
        if files != [self.target]:
            self.marks = marks_of(files[-1])
            self.number = int(files[-1].stem) + 1
        elif stored(self.target) and not is_superseded(self.target):
            rule = f"the one that the unfinished run in {self.folder} continues"
            remedy = "move one of the two elsewhere, then resume the other"
            raise InputError("file", str(self.target), rule, remedy)

    def __call__(self, run: Trajectory) -> None:
        """Write a part with everything since the last one, and release its frames."""
        self._owner.check(self.target)
        contents = self._new(run)
        contents.attributes |= self.marks
        try:
            if self.number == 0:
                clear(self.target)  # not before the run has begun, which bad input prevents
                sync_folder(self.folder.parent)
        except OSError as error:
            raise unwritable(self.folder, error) from error
        write_contents(contents, self.folder / f"{self.number:06d}.nc")
        self.number += 1
        self._note(run)
        run.frames.release()

    def _new(self, run: Trajectory) -> Contents:
        return of_trajectory(run, self.frames, self.records, self.interventions)

    def stands(self, run: Trajectory) -> None:
        """Record that all of a run is in the file. Raises `InputError` if the file holds another run by now.

        Example:
            >>> import cyclosis as cy
            >>> params, grid = cy.Parameters(), cy.CylinderGrid(16, 16)
            >>> path = cy.write(cy.simulate(params, grid, cy.initial.stripes(grid), t_end=1.0), "standing.nc")
            >>> run, writer = cy.load(path, fields=False), cy.RunWriter(path, continues=True)
            >>> writer.stands(run)
            >>> writer.finish(cy.resume(run, t_end=2.0, checkpoint=writer)).name
            'standing.nc'
        """
        found = outcome_of(parts(self.target)[-1])
        if (found["t_final"], found["evaluations"]) != (run.t_final, run.effort.evaluations):
            remedy = "load it again: it was continued in the meantime"
            raise InputError("t of the run", run.t_final, f"{found['t_final']:g}, as in the file", remedy)
        self._note(run)

    def _note(self, run: Trajectory) -> None:
        self.frames, self.records = len(run.frames), run.record_times.size
        self.interventions = len(run.interventions)

    def finish(self, run: Trajectory) -> Path:
        """Write the whole run to the file, and return its path.

        If that fails, everything since the last part is kept as a further part.
        """
        self._owner.check(self.target)
        nothing_yet = not (self.marks["continues"] or self.frames or self.records or self.interventions)
        try:
            earlier = [] if nothing_yet else self._earlier(run.model)
            self._put(joined([*earlier, self._new(run)]))
        except InputError:
            self(run)
            raise
        run.frames.release()
        return self.target

    def join(self, model: Model | None = None) -> Path:
        """Join the parts that are stored into the file, and return its path.

        `model` is needed only if it is not in `cyclosis.models`.

        Example:
            >>> import cyclosis as cy
            >>> params, grid = cy.Parameters(), cy.CylinderGrid(16, 16)
            >>> writer = cy.RunWriter("cut.nc")
            >>> run = cy.simulate(params, grid, cy.initial.stripes(grid), t_end=1.0, checkpoint=writer)
            >>> writer(run)
            >>> writer.join().name
            'cut.nc'
        """
        self._owner.check(self.target)
        earlier = self._earlier(model)
        if not earlier:
            raise damaged(self.target, FileNotFoundError())
        self._put(joined(earlier))
        return self.target

    def _earlier(self, model: Model | None) -> list[Contents]:
        """Return the contents of the files: the one that is continued, and the parts."""
        files = [self.target] * self.marks["continues"] + (stored(self.target) if self.number else [])
        return [read_contents(file, model=model) for file in files]

    def _put(self, contents: Contents) -> None:
        """Write the file with these contents, then remove the parts."""
        for mark in MARKS:
            contents.attributes.pop(mark, None)
        try:
            write_contents(contents, self.target, self.force or self._found != "", self._check_place)
        except FileExistsError as error:
            raise self._appeared() from error
        with contextlib.suppress(OSError):
            clear(self.target)
        self.close()
        sync_folder(self.target.parent)

    def _check_place(self) -> None:
        """Raise `InputError` if the file appeared or was changed during the run."""
        self._owner.check(self.target)
        if not self.force and _state(self.target) != self._found:
            raise self._appeared()

    def _appeared(self) -> InputError:
        rule = "a name at which no other file has appeared since the run began"
        remedy = f"the run is kept in {self.folder}: move that file elsewhere, then "
        python, command = f"cyclosis.resume_file({str(self.target)!r})", f"`cyclosis resume {self.target}`"
        return InputError("out", str(self.target), rule, remedy + python, remedy + command)

    def close(self) -> None:
        """Let others write the file; what was saved is kept and can be resumed.

        Example:
            >>> import cyclosis as cy
            >>> writer = cy.RunWriter("closed.nc")
            >>> writer.close()
        """
        self._owner.release()

    def __enter__(self) -> RunWriter:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()


def _state(target: Path) -> str:
    """Return an identifier of a file's content, or "" if there is no file."""
    try:
        about = target.lstat()
    except FileNotFoundError:
        return ""
    return digest_at(target) or f"{about.st_ino} {about.st_size} {about.st_mtime_ns}"


@door
def resume_file(
    path: str | os.PathLike[str],
    t_end: float | None = None,
    *,
    terms: Iterable[TermLike] | None = None,
    model: Model | None = None,
    progress: Progress = None,
    checkpoint_seconds: float = CHECKPOINT_SECONDS,
    scales: Scales | None = None,
) -> Trajectory:
    """Continue the run in a file, finished or interrupted, to `t_end`; the file then holds the whole run.

    The result is bit for bit that of a run that never stopped, see `resume`. The trajectory's frames stay in
    the file. `scales` are stored with the run in the place of its own. Raises `InputError` if the file cannot
    be read or written, or if the run cannot be continued or is being written. After Ctrl-C it raises
    KeyboardInterrupt once the file holds everything done so far.

    Example:
        >>> import cyclosis as cy
        >>> params, grid = cy.Parameters(), cy.CylinderGrid(16, 16)
        >>> path = cy.write(cy.simulate(params, grid, cy.initial.stripes(grid), t_end=1.0), "resumed.nc")
        >>> cy.resume_file(path, t_end=2.0).t_final, len(cy.load(path).frames)
        (2.0, 3)
    """
    run = load(path, terms, fields=False, model=model)
    if scales is not None:
        run = replace(run, provenance={**run.provenance, "scales": table_of(scales)})
    with RunWriter(path, continues=True) as writer:
        writer.stands(run)
        if writer.number and run.status is not Status.INTERRUPTED and (t_end or 0.0) <= run.t_final:
            writer.join(model)  # the run had ended, but its parts had not been joined yet
            return run
        try:
            onward = resume(
                run,
                t_end,
                terms=terms,
                progress=progress,
                checkpoint=writer,
                checkpoint_seconds=checkpoint_seconds,
            )
        except KeyboardInterrupt as stopped:
            writer.finish(carried(stopped))
            raise
        writer.finish(onward)
        return onward
