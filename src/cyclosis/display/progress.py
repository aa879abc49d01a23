"""Where the progress of a long call is shown: one line, updated in place, in a terminal or a notebook."""

from __future__ import annotations

import multiprocessing
import sys
import time
from collections.abc import Callable
from html import escape
from importlib import import_module
from typing import Any, Protocol

OFTEN, SELDOM = 0.2, 60.0
"""Seconds between two updates of the line, and between two lines where there is no terminal."""

_silent = False


def leave_to_the_command() -> None:
    """Show nothing by default from now on: a command of the command line has a display of its own."""
    global _silent
    _silent = True


class Surface(Protocol):
    """Where a line is shown."""

    every: float

    def show(self, share: float, words: str) -> None:
        """Show that a share is done."""

    def close(self) -> None:
        """Remove the line, if it can be removed."""


def surface(progress: bool | None) -> Callable[[], Surface] | None:
    """Return the kind of display for progress here, or None where nothing is shown."""
    if progress is False or (progress is None and _silent) or multiprocessing.parent_process() is not None:
        return None
    if in_notebook():
        return Notebook
    if sys.stderr is not None and sys.stderr.isatty():
        return Terminal
    return Lines if progress and sys.stderr is not None else None


def in_notebook() -> bool:
    """Return whether this is the kernel of a notebook, which shows HTML."""
    ipython = sys.modules.get("IPython")
    shell = None if ipython is None else ipython.get_ipython()
    return getattr(shell, "kernel", None) is not None


class Terminal:
    """A bar on the error stream of a terminal, which disappears at the end."""

    every = OFTEN

    def __init__(self) -> None:
        from rich.console import Console
        from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn, TimeRemainingColumn

        columns = (BarColumn(bar_width=24), TextColumn("{task.description}"), TimeElapsedColumn())
        left = (TextColumn("left"), TimeRemainingColumn(compact=True))
        how: Any = {"transient": True, "refresh_per_second": 2}  # each costs about a millisecond
        self.bar = Progress(*columns, *left, console=Console(stderr=True), **how)
        self.task = self.bar.add_task("", total=1.0)
        self.bar.start()

    def show(self, share: float, words: str) -> None:
        """Show that a share is done."""
        self.bar.update(self.task, completed=share, description=words)

    def close(self) -> None:
        """Remove the bar."""
        self.bar.stop()


class Notebook:
    """A bar below the cell of a notebook, which disappears at the end."""

    every = OFTEN

    def __init__(self) -> None:
        tools: Any = import_module("IPython.display")
        self.html = tools.HTML
        self.began = time.monotonic()
        self.handle = tools.display(tools.HTML(""), display_id=True)

    def show(self, share: float, words: str) -> None:
        """Show that a share is done."""
        spent = time.monotonic() - self.began
        left = f", {_clock(spent * (1 - share) / share)} left" if share > 0 else ""
        bar = f'<progress max="1" value="{share:.4f}" style="width:14em;vertical-align:middle"></progress>'
        self.handle.update(self.html(f"<div>{bar} {escape(words + left)}</div>"))

    def close(self) -> None:
        """Remove the bar."""
        self.handle.update(self.html(""))


class Lines:
    """A line a minute on an error stream that is no terminal."""

    every = SELDOM

    def show(self, share: float, words: str) -> None:
        """Print that a share is done."""
        print(f"{100 * share:.0f} %, {words}", file=sys.stderr, flush=True)

    def close(self) -> None:
        """Leave what was printed."""


def _clock(seconds: float) -> str:
    minutes, rest = divmod(round(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    return f"{hours}:{minutes:02d}:{rest:02d}" if hours else f"{minutes}:{rest:02d}"
