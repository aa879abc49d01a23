"""Live progress: bars on a terminal, a line a minute where there is none, or JSON for other programs."""

from __future__ import annotations

import json
import sys
import time
from collections.abc import Callable
from dataclasses import asdict
from types import TracebackType
from typing import TYPE_CHECKING, Self

from rich.console import Console
from rich.progress import (
    BarColumn,
    MofNCompleteColumn,
    Progress,
    ProgressColumn,
    TextColumn,
    TimeRemainingColumn,
)

from .report.sweep import told

if TYPE_CHECKING:
    from .dynamics.run import Snapshot
    from .model.grid import CylinderGrid
    from .model.parameters import Parameters
    from .sweep.tally import SweepProgress

LINE_SECONDS = 60.0
"""Time between two lines where there is no terminal."""
JSON_SECONDS = 1.0
"""Least time between two lines of JSON."""


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
    """Gives `simulate` its progress callback: time reached, regime so far, time left.

    `params_at` returns the parameters in force at a time.
    """

    def __init__(
        self, params_at: Callable[[float], Parameters], grid: CylinderGrid, hidden: bool = False
    ) -> None:
        time, name = TextColumn("t = {task.fields[t]}"), TextColumn("{task.fields[regime]}")
        super().__init__(
            hidden, time, BarColumn(), name, TextColumn("left"), TimeRemainingColumn(compact=True)
        )
        self.params_at, self.grid = params_at, grid
        self.task = self.bar.add_task("run", total=1.0, t="0", regime="compiling")

    def __call__(self, now: Snapshot) -> None:
        """Show where the run stands."""
        if self.shown:
            from .analysis.regimes import regime

            name = regime(self.params_at(now.t), self.grid, now.state).name
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


class SweepBar(_Shown):
    """Gives `run_sweep` its progress callback: a live line, or a line a minute where there is no terminal."""

    def __init__(self, hidden: bool = False) -> None:
        super().__init__(hidden, BarColumn(bar_width=20), TextColumn("{task.description}"))
        self.task = self.bar.add_task("starting", total=None)
        self.lines = not hidden and not self.shown
        self.due = _Due(LINE_SECONDS)

    def __call__(self, now: SweepProgress) -> None:
        """Show where the sweep stands."""
        if self.shown:
            self.bar.update(self.task, completed=now.done, total=now.total, description=told(now))
        elif self.lines and (now.workers or now.seconds > LINE_SECONDS) and self.due(now):
            print(told(now), file=sys.stderr, flush=True)


class SweepLines:
    """Gives `run_sweep` its progress callback: an object of JSON a second, on standard output."""

    def __init__(self) -> None:
        self.due = _Due(JSON_SECONDS)

    def __call__(self, now: SweepProgress) -> None:
        """Print where the sweep stands."""
        if self.due(now):
            print(json.dumps({"event": "progress", **asdict(now)}), flush=True)


class _Due:
    """Tells when something is to be shown: every so many seconds, and once when all is done."""

    def __init__(self, seconds: float) -> None:
        self.seconds, self.next, self.over = seconds, 0.0, False

    def __call__(self, now: SweepProgress) -> bool:
        """Return whether it is time."""
        moment, over = time.monotonic(), now.done == now.total
        if moment < self.next and (self.over or not over):
            return False
        self.next, self.over = moment + self.seconds, over
        return True
