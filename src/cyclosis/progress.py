"""Live progress: bars on a terminal, otherwise a line per minute, or JSON for other programs."""

from __future__ import annotations

import json
import sys
import time
from collections.abc import Callable
from dataclasses import asdict, replace
from threading import Event, Thread
from types import TracebackType
from typing import TYPE_CHECKING, Any, Self

from rich.console import Console
from rich.progress import (
    BarColumn,
    MofNCompleteColumn,
    Progress,
    ProgressColumn,
    TextColumn,
    TimeElapsedColumn,
    TimeRemainingColumn,
)

from .report.sweep import duration, told

if TYPE_CHECKING:
    from .contract.model import Problem
    from .dynamics.run import Snapshot
    from .sweep.cluster.progress import SweepProgress

LINE_SECONDS = 60.0
"""Time between two lines if there is no terminal."""
JSON_SECONDS = 1.0
"""Least time between two lines of JSON."""


def terminal() -> bool:
    """Return whether standard error is a terminal."""
    return sys.stderr is not None and sys.stderr.isatty()


class _Shown:
    """A context manager for a bar of some columns, on the terminal's error stream.

    If there is no terminal, a line with the `status` is printed once a minute instead.
    """

    def __init__(self, hidden: bool, *columns: ProgressColumn) -> None:
        self.shown = not hidden and terminal()
        self.lines = not hidden and not self.shown and sys.stderr is not None
        console = Console(stderr=True)
        self.bar = Progress(*columns, console=console, disable=not self.shown, transient=True)
        self._over = Event()
        self._printer = Thread(target=self._print, daemon=True)

    def status(self) -> str:
        """Return the progress in a few words, or "" for no line."""
        return ""

    def __enter__(self) -> Self:
        self.bar.start()
        if self.lines:
            self._printer.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._over.set()
        if self._printer.is_alive():
            self._printer.join()
        self.bar.stop()

    def _print(self) -> None:
        began = time.monotonic()
        while not self._over.wait(LINE_SECONDS):
            words = self.status()
            if words:
                after = duration(round(time.monotonic() - began))
                print(f"after {after}: {words}", file=sys.stderr, flush=True)


class RunProgress(_Shown):
    """Gives `simulate` its progress callback: time reached, regime so far, time left.

    A context manager for the whole of a command: until `follow` names the cell, it is being prepared; then
    its programs are compiled until the first step arrives.
    """

    def __init__(self, hidden: bool = False) -> None:
        columns = (TextColumn("t = {task.fields[t]}"), BarColumn(), TextColumn("{task.description}"))
        left = (TextColumn("{task.fields[left]}"), TimeRemainingColumn(compact=True))
        super().__init__(hidden, *columns, TimeElapsedColumn(), *left)
        self.doing = "preparing"
        self.task = self.bar.add_task(self.doing, total=None, t="0", left="")
        self._first: tuple[float, float] | None = None
        self._last: Snapshot | None = None

    def follow(self, problem: Problem, params_at: Callable[[float], Any]) -> None:
        """Set the cell that is computed next; `params_at` returns the active parameters at a time."""
        self.problem, self.params_at = problem, params_at
        self.label("compiling")

    def label(self, text: str) -> None:
        """Show what is being done."""
        self.doing = text
        self.bar.update(self.task, description=text)

    def __call__(self, now: Snapshot) -> None:
        """Show the progress of the run."""
        self.doing, self._last = "computing", now
        self._first = self._first or (now.t, time.monotonic())
        if self.shown:
            problem = replace(self.problem.at(self.params_at(now.t)), shape=now.state.shape)
            regime = problem.model.regime
            name = "" if regime is None else regime(problem, now.state).name
            done = now.t / now.t_end if now.t_end else 1.0
            self.bar.update(
                self.task, total=1.0, completed=done, description=name, t=f"{now.t:.1f}", left="left"
            )

    def status(self) -> str:
        """Return what is being done, or the progress of the run."""
        if self._first is None or self._last is None or self.doing != "computing":
            return self.doing
        (began, clock), now = self._first, self._last
        words = f"t = {now.t:.6g} of {now.t_end:g}"
        if now.t > began:
            rate = (now.t - began) / (time.monotonic() - clock)
            words += f", {duration(round((now.t_end - now.t) / rate))} left"
        return words


class Bar(_Shown):
    """Shows how many of a number of things are done."""

    def __init__(self, name: str, hidden: bool = False) -> None:
        left = TimeRemainingColumn(compact=True)
        super().__init__(hidden, TextColumn(name), BarColumn(), MofNCompleteColumn(), left)
        self.name, self.done, self.total = name, 0, 0
        self.task = self.bar.add_task(name, total=None)

    def __call__(self, done: int, total: int) -> None:
        """Show that `done` of `total` are done."""
        self.done, self.total = done, total
        self.bar.update(self.task, completed=done, total=total)

    def status(self) -> str:
        """Return how many are done."""
        return f"{self.done} of {self.total} {self.name}" if self.total else f"preparing {self.name}"


class SweepBar(_Shown):
    """Gives `run_sweep` its progress callback: a live line, or a line per minute if there is no terminal."""

    def __init__(self, hidden: bool = False) -> None:
        super().__init__(hidden, BarColumn(bar_width=20), TextColumn("{task.description}"))
        self.task = self.bar.add_task("starting", total=None)
        self.due = _Due(LINE_SECONDS)

    def __call__(self, now: SweepProgress) -> None:
        """Show the progress of the sweep."""
        if self.shown:
            self.bar.update(self.task, completed=now.done, total=now.total, description=told(now))
        elif self.lines and (now.workers or now.seconds > LINE_SECONDS) and self.due(now):
            print(told(now), file=sys.stderr, flush=True)


class SweepLines:
    """Gives `run_sweep` its progress callback: a JSON object per second, on standard output."""

    def __init__(self) -> None:
        self.due = _Due(JSON_SECONDS)

    def __call__(self, now: SweepProgress) -> None:
        """Print the progress of the sweep."""
        if self.due(now):
            print(json.dumps({"event": "progress", **asdict(now)}), flush=True)


class ExperimentLines:
    """Gives `perform` its progress callback: a line per minute, and one at the end of each sweep."""

    def __init__(self) -> None:
        self.next = time.monotonic() + LINE_SECONDS

    def __call__(self, label: str, now: SweepProgress) -> None:
        """Show the progress of one of the sweeps of an experiment."""
        if now.done == now.total:
            print(f"  {label}: {now.total} runs in {now.seconds:.0f} s", file=sys.stderr)
        elif time.monotonic() >= self.next:
            print(f"  {label}: {told(now)}", file=sys.stderr, flush=True)
        else:
            return
        self.next = time.monotonic() + LINE_SECONDS


class _Due:
    """Decides when to show progress: at an interval in seconds, and once when everything is done."""

    def __init__(self, seconds: float) -> None:
        self.seconds, self.next, self.over = seconds, 0.0, False

    def __call__(self, now: SweepProgress) -> bool:
        """Return whether it is time."""
        moment, over = time.monotonic(), now.done == now.total
        if moment < self.next and (self.over or not over):
            return False
        self.next, self.over = moment + self.seconds, over
        return True
