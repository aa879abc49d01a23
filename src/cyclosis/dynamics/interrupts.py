"""Ctrl-C and termination: deferred until a run has reached a safe point and saved, then delivered."""

from __future__ import annotations

import signal
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType, TracebackType
from typing import Any

SIGNALS = (signal.SIGINT, signal.SIGTERM)
_ENDING = (signal.SIG_DFL, signal.default_int_handler)
"""What Python does by default: it ends the process, or raises KeyboardInterrupt."""


def carry(stop: KeyboardInterrupt, run: Any) -> None:
    """Attach to a KeyboardInterrupt what was done until then, as its attribute `run`.

    Its class stays KeyboardInterrupt: only for this class does Python report to the shell that Ctrl-C ended a
    script, so that a loop of the shell ends as well.
    """
    stop.run = run  # type: ignore[attr-defined]
    stop.add_note(f"{run.message} It is the attribute `run` of this exception.")


def carried(stop: KeyboardInterrupt) -> Any:
    """Return what a KeyboardInterrupt carries; raise it again if it carries nothing."""
    if not hasattr(stop, "run"):
        raise stop
    return stop.run


class Interrupts:
    """A context in which SIGINT and SIGTERM wait: they set `asked` until `deliver` lets them act.

    A second signal acts at once. Signals that the user ignores, or that Python does not handle, are left
    alone. With `handlers` the handlers that the user has installed wait as well; without, they are called at
    once. Outside the main thread signals cannot be deferred, and nothing changes.
    """

    def __init__(self, handlers: bool = True) -> None:
        self.asked = False
        self._handlers = handlers
        self._waiting: int | None = None
        self._stop: KeyboardInterrupt | None = None
        self._previous: dict[int, Any] = {}

    def __enter__(self) -> Interrupts:
        self._keep()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._restore()
        if self._waiting is not None:
            self._act()

    def wait(self, stop: KeyboardInterrupt) -> None:
        """Defer a KeyboardInterrupt that was raised, like a signal."""
        self.asked, self._stop = True, stop

    def deliver(self, run: Any) -> None:
        """Let the deferred signal act as it would have, and defer the next one if that returns.

        A KeyboardInterrupt that it raises carries `run`.
        """
        self._restore()
        try:
            if self._waiting is not None:
                self._act()
            if self._stop is not None:
                raise self._stop
        except KeyboardInterrupt as stop:
            carry(stop, run)
            raise
        self._keep()

    def _act(self) -> None:
        number, self._waiting, self.asked = self._waiting, None, False
        assert number is not None
        handler = signal.getsignal(number)
        if callable(handler):
            handler(number, sys._getframe())
        else:
            signal.raise_signal(number)

    def _keep(self) -> None:
        for number in SIGNALS:
            handler = signal.getsignal(number)
            if handler not in _ENDING and not (self._handlers and callable(handler)):
                continue
            try:
                self._previous[number] = signal.signal(number, self._ask)
            except ValueError:
                break

    def _ask(self, number: int, frame: FrameType | None) -> None:
        self.asked, self._waiting = True, number
        self._restore()

    def _restore(self) -> None:
        while self._previous:
            number, handler = self._previous.popitem()
            signal.signal(number, handler)


@contextmanager
def terminable() -> Iterator[None]:
    """Provide a context in which SIGTERM does what Ctrl-C does, unless the user has installed a handler."""
    try:
        decided = signal.getsignal(signal.SIGTERM) is not signal.SIG_DFL
        previous = None if decided else signal.signal(signal.SIGTERM, signal.default_int_handler)
    except ValueError:
        previous = None
    try:
        yield
    finally:
        if previous is not None:
            signal.signal(signal.SIGTERM, previous)
