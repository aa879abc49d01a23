"""One connection of a visitor: messages go to the visit, and each side checks that the other is there.

A dead connection, as after a laptop has slept or a telephone has changed its network, looks open to both ends
for minutes. The server therefore sends a message every `BEAT` seconds, which the page answers; both take
longer silence as the end of the connection. The visit itself is kept for a while.
"""

from __future__ import annotations

import asyncio
import contextlib
import time as clock
from collections.abc import Coroutine
from typing import Any, Protocol

from ..model.errors import InputError
from . import messages

BEAT = 1.5
"""Seconds between two heartbeats of the server."""
QUIET = 2.5 * BEAT
"""Seconds without a message of the page after which its cell pauses."""
SILENCE = 10.0
"""Seconds without a message of the page after which the connection is given up."""
SOONEST = 0.2
"""Least seconds between two heartbeats of the server, however often a page requests one."""
SENDING = 30.0
"""Seconds within which a message must be sent."""


class Wire(Protocol):
    """The methods that a connection needs."""

    async def text(self) -> str:
        """Return the next message; raise once the visitor has left."""

    async def say(self, text: str) -> None:
        """Send text."""

    async def show(self, data: bytes) -> None:
        """Send a picture."""


class Host(Protocol):
    """The attributes that a line needs of its visit."""

    received: int
    asks: asyncio.Queue[messages.Ask | InputError | None]

    def leave(self) -> None:
        """End: the visitor will not come back."""

    def wake(self) -> None:
        """Check whether there is something to do."""


class Line:
    """A connection while it serves a visit."""

    def __init__(self, wire: Wire) -> None:
        self.wire, self.heard = wire, clock.monotonic()
        self.ended, self.closed, self.wanted = asyncio.Event(), asyncio.Event(), asyncio.Event()

    @property
    def quiet(self) -> bool:
        """Whether the page has been silent for longer than it should."""
        return clock.monotonic() - self.heard > QUIET

    async def hold(self, visit: Host, first: messages.Ask | InputError | None) -> None:
        """Serve until the connection is lost or `ended` is set."""
        work: tuple[Coroutine[Any, Any, Any], ...]
        work = self._read(visit, first), self._beat(visit), self.ended.wait()
        tasks = [asyncio.create_task(each) for each in work]
        try:
            await asyncio.wait(tasks, return_when=asyncio.FIRST_COMPLETED)
        finally:
            self.ended.set()
            for task in tasks:
                task.cancel()
            await asyncio.gather(*tasks, return_exceptions=True)
            self.closed.set()

    async def say(self, text: str) -> None:
        """Send text, or note that the connection is lost."""
        await self._sent(self.wire.say(text))

    async def show(self, data: bytes) -> None:
        """Send a picture, or note that the connection is lost."""
        await self._sent(self.wire.show(data))

    async def _sent(self, sending: Coroutine[Any, Any, None]) -> None:
        try:
            await asyncio.wait_for(sending, SENDING)
        except Exception:  # after any failure the connection is lost
            self.ended.set()

    async def _read(self, visit: Host, first: messages.Ask | InputError | None) -> None:
        ask = first
        while True:
            if isinstance(ask, messages.Sign):
                if ask.do == "ping":
                    self.wanted.set()
                elif ask.do == "leave":
                    visit.leave()
                    return
            elif ask is not None:
                await visit.asks.put(ask)
                self.heard = clock.monotonic()
                if not isinstance(ask, InputError) and ask.n is not None:
                    visit.received = ask.n
            text = await self.wire.text()
            if self.quiet:
                visit.wake()
            self.heard = clock.monotonic()
            ask = understood(text)

    async def _beat(self, visit: Host) -> None:
        # While requests wait to be answered, nothing more is read.
        while clock.monotonic() - self.heard < SILENCE or visit.asks.full():
            self.wanted.clear()
            await self.say('{"type": "alive"}')
            await asyncio.sleep(SOONEST)
            with contextlib.suppress(TimeoutError):
                await asyncio.wait_for(self.wanted.wait(), BEAT - SOONEST)


def understood(text: str) -> messages.Ask | InputError:
    """Return the request in a message, or the error if it is malformed."""
    try:
        return messages.understood(text)
    except InputError as error:
        return error
