"""Live progress on a terminal; nothing is shown where there is none."""

from __future__ import annotations

import sys
from types import TracebackType

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

from .analysis.regimes import regime
from .dynamics.run import Snapshot
from .model.grid import CylinderGrid
from .model.parameters import Parameters


class RunProgress:
    """A context that gives `simulate` its progress callback; shows nothing where there is no terminal."""

    def __init__(self, params: Parameters, grid: CylinderGrid, hidden: bool = False) -> None:
        self.params, self.grid = params, grid
        self.shown = not hidden and sys.stderr.isatty()
        self.bar = Progress(
            TextColumn("t = {task.fields[t]}"),
            BarColumn(),
            TextColumn("{task.fields[regime]}"),
            TextColumn("left"),
            TimeRemainingColumn(compact=True),
            console=Console(stderr=True),
            disable=not self.shown,
            transient=True,
        )
        self.task = self.bar.add_task("run", total=1.0, t="0", regime="compiling")

    def __enter__(self) -> RunProgress:
        self.bar.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.bar.stop()

    def __call__(self, now: Snapshot) -> None:
        """Show where the run stands."""
        if self.shown:
            name = regime(self.params, self.grid, now.state).name
            self.bar.update(self.task, completed=now.t / now.t_end, t=f"{now.t:.1f}", regime=name)


class Bar:
    """A context that shows how many of a number of things are done."""

    def __init__(self, name: str, hidden: bool = False) -> None:
        shown = not hidden and sys.stderr.isatty()
        columns = (TextColumn(name), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn(compact=True))
        self.bar = Progress(*columns, console=Console(stderr=True), disable=not shown, transient=True)
        self.task = self.bar.add_task(name, total=None)

    def __enter__(self) -> Bar:
        self.bar.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.bar.stop()

    def __call__(self, done: int, total: int) -> None:
        """Show that `done` of `total` are done."""
        self.bar.update(self.task, completed=done, total=total)
