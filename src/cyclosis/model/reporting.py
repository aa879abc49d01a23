"""The argument `progress` of every long call: a bar where somebody can see it, a function, or nothing.

None, the default, shows a line in a terminal or a notebook once the call has taken a second, and nothing
elsewhere. False shows nothing, True also prints a line a minute where there is no terminal. A function is
called instead.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

from ..display.progress import Surface, surface
from .errors import InputError

Progress = bool | Callable[..., None] | None
"""What a long call takes as `progress`."""
Told = Callable[..., tuple[float, str]]
"""Makes of the arguments of a callback the share that is done, 0 to 1, and what to say beside it."""

DELAY = 1.0
"""Seconds for which a call must have run before anything is shown."""


@contextmanager
def reported(progress: Progress, name: str, told: Told) -> Iterator[Callable[..., None] | None]:
    """Provide the callback of a call named `name`, or None where nothing is shown.

    Raises `InputError` if `progress` is neither a function nor true, false or None.
    """
    if progress is not None and not isinstance(progress, bool) and not callable(progress):
        rule = "True, False, None or a function"
        raise InputError("progress", progress, rule, "leave it out to see progress where that is possible")
    if callable(progress):
        yield progress
        return
    make = surface(progress)
    if make is None:
        yield None
        return
    line = _Line(make, name, told)
    try:
        yield line
    finally:
        line.close()


def counted(done: int, total: int) -> tuple[float, str]:
    """Return the share of things that are done, and their number."""
    return done / total if total else 1.0, f"{done} of {total}"


class _Line:
    """A callback that shows its arguments from time to time."""

    def __init__(self, make: Callable[[], Surface], name: str, told: Told) -> None:
        self.make, self.name, self.told = make, name, told
        self.surface: Surface | None = None
        self.due = time.monotonic() + DELAY

    def __call__(self, *now: Any) -> None:
        if time.monotonic() < self.due:
            return
        self.surface = self.surface or self.make()
        share, words = self.told(*now)
        self.surface.show(min(max(share, 0.0), 1.0), f"{self.name}: {words}" if self.name else words)
        self.due = time.monotonic() + self.surface.every

    def close(self) -> None:
        if self.surface is not None:
            self.surface.close()
