"""Live progress on a terminal; nothing is shown where there is none."""

from __future__ import annotations

import sys
from types import TracebackType
from typing import Self

from rich.console import Console
from rich.progress import (
    BarColumn,
    MofNCompleteColumn,
    Progress,
    ProgressColumn,
    TextColumn,
    TimeRemainingColumn,
)

from .analysis.regimes import regime
from .dynamics.run import Snapshot
from .model.grid import CylinderGrid
from .model.parameters import Parameters


class _Shown:
    """A context around a bar of some columns, on the terminal's error stream."""

    def __init__(self, hidden: bool, *columns: ProgressColumn) -> None:
        self.shown = not hidden and sys.stderr.isatty()
        console = Console(stderr=True)
        self.bar = Progress(*columns, console=console, disable=not self.shown, transient=True)

    def __enter__(self) -> Self:
        self.bar.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.bar.stop()


class RunProgress(_Shown):
    """Gives `simulate` its progress callback: time reached, regime so far, time left."""

    def __init__(self, params: Parameters, grid: CylinderGrid, hidden: bool = False) -> None:
        time, name = TextColumn("t = {task.fields[t]}"), TextColumn("{task.fields[regime]}")
        super().__init__(
            hidden, time, BarColumn(), name, TextColumn("left"), TimeRemainingColumn(compact=True)
        )
        self.params, self.grid = params, grid
        self.task = self.bar.add_task("run", total=1.0, t="0", regime="compiling")

    def __call__(self, now: Snapshot) -> None:
        """Show where the run stands."""
        if self.shown:
            name = regime(self.params, self.grid, now.state).name
            self.bar.update(self.task, completed=now.t / now.t_end, t=f"{now.t:.1f}", regime=name)


class Bar(_Shown):
    """Shows how many of a number of things are done."""

    def __init__(self, name: str, hidden: bool = False) -> None:
        left = TimeRemainingColumn(compact=True)
        super().__init__(hidden, TextColumn(name), BarColumn(), MofNCompleteColumn(), left)
        self.task = self.bar.add_task(name, total=None)

    def __call__(self, done: int, total: int) -> None:
        """Show that `done` of `total` are done."""
        self.bar.update(self.task, completed=done, total=total)
