"""The workers of a cluster, as one that gives them blocks sees them: blocks go out, news come in.

Dask's own loop waits for answers and watches the workers; all that it learns comes to the caller as `News`
through one queue, so that the caller needs no lock and never waits longer than it wants to.
"""

from __future__ import annotations

import asyncio
import uuid
from collections.abc import Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from queue import Empty, SimpleQueue
from typing import Any, cast

from distributed import Client, Future
from tornado.ioloop import IOLoop

from . import guests
from .shipped import shipped
from .task import BlockTask

WATCH_SECONDS = 0.5
"""Time between two looks at the workers."""


@dataclass(frozen=True)
class Answer:
    """What came back of a block: a `Report`, or the exception that came instead."""

    index: int
    value: Any


@dataclass(frozen=True)
class Attendance:
    """The threads of every worker that is there, by its address."""

    threads: Mapping[str, int]


@dataclass(frozen=True)
class Acquaintance:
    """What workers that are new have to say of themselves, or the exceptions that came instead."""

    greetings: Mapping[str, Any]


News = Answer | Attendance | Acquaintance


class Crew:
    """The workers that a client reaches. They are greeted as they come, unless they are our `own`."""

    def __init__(self, client: Client, task: BlockTask, own: bool) -> None:
        self.client, self.task, self.own = client, task, own
        self._compute = shipped(task)
        self._flying: dict[int, Future[Any]] = {}
        self._news: SimpleQueue[News] = SimpleQueue()
        self._name, self._batches = f"block-{uuid.uuid4().hex[:12]}", 0
        self._over = False
        self._loop = cast("IOLoop", client.loop)
        self._loop.add_callback(self._watch)

    def __len__(self) -> int:
        """Return the number of blocks in work."""
        return len(self._flying)

    @property
    def reachable(self) -> bool:
        """Whether there is a connection to the scheduler at this moment."""
        return bool(self.client.status == "running")

    @property
    def lost(self) -> bool:
        """Whether the connection to the scheduler has been given up."""
        return self.client.status in ("closing", "closed")

    def submit(self, batch: list[int]) -> None:
        """Let some blocks be computed."""
        self._batches += 1  # a block that is tried again must not be taken for its former trial
        keys = [(self._name, index, self._batches) for index in batch]
        try:
            futures = self.client.map(self._compute, batch, key=keys, pure=False)
        except Exception as error:  # the connection was lost at this very moment
            for index in batch:
                self._news.put(Answer(index, error))
            return
        for index, future in zip(batch, futures, strict=True):
            self._flying[index] = future
            self._loop.add_callback(self._follow, index, future)

    def news(self, seconds: float) -> Iterator[News]:
        """Yield what has happened, waiting at most `seconds` for the first of it."""
        with suppress(Empty):
            yield self._received(self._news.get(timeout=seconds))
            while True:
                yield self._received(self._news.get_nowait())

    def dismiss(self) -> None:
        """Give up what is in work, and take no interest in the workers any more."""
        self._over = True
        with suppress(Exception):  # a scheduler that is gone has given up as well
            self.client.cancel(list(self._flying.values()))
        self._flying.clear()

    def _received(self, news: News) -> News:
        if isinstance(news, Answer):
            self._flying.pop(news.index, None)
        return news

    async def _follow(self, index: int, future: Future[Any]) -> None:
        value: Any
        try:
            value = await self.client.gather(future, asynchronous=True)
        except (Exception, asyncio.CancelledError) as error:
            value = error
        self._news.put(Answer(index, value))

    async def _watch(self) -> None:
        known: set[str] = set()
        while not self._over and not self.lost:
            with suppress(OSError):
                threads = await self.client.nthreads()
                strangers = [] if self.own else sorted(threads.keys() - known)
                if strangers:
                    self._news.put(Acquaintance(await self._greeted(strangers)))
                known = set(threads)
                self._news.put(Attendance(threads))
            await asyncio.sleep(WATCH_SECONDS)

    async def _greeted(self, strangers: list[str]) -> dict[str, Any]:
        folder, digest = Path(self.task.folder), self.task.digest
        greet = shipped(guests.greet)
        told: dict[str, Any] = await self.client.run(
            greet, str(folder), digest, workers=strangers, on_error="return"
        )
        return {address: await guests.confirmed(folder, greeting) for address, greeting in told.items()}
