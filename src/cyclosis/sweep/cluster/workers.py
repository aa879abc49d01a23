"""The workers of a cluster as the client uses them: it submits blocks and receives news.

Dask's own event loop waits for results and watches the workers. The caller receives everything as `News`
through one queue, so that it needs no lock and never waits longer than it wants to.
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

from . import running_cluster
from .pickling import shipped
from .task import BlockTask

WATCH_SECONDS = 0.5
"""Time between two checks of the workers."""


@dataclass(frozen=True)
class BlockDone:
    """The result of a block: a `Report`, or the exception that was raised instead."""

    index: int
    value: Any


@dataclass(frozen=True)
class WorkerCount:
    """The number of threads of every worker, by its address."""

    threads: Mapping[str, int]


@dataclass(frozen=True)
class NewWorkers:
    """The reports of workers that are new, or the exceptions that were raised instead, by their address."""

    reports: Mapping[str, Any]


News = BlockDone | WorkerCount | NewWorkers


class Workers:
    """The workers that a client reaches. New ones are asked for a report, unless this process started them.

    `own` says whether it did.
    """

    def __init__(self, client: Client, task: BlockTask, own: bool) -> None:
        self.client, self.task, self.own = client, task, own
        self._compute = shipped(task)
        self._pending: dict[int, Future[Any]] = {}
        self._news: SimpleQueue[News] = SimpleQueue()
        self._name, self._batches = f"block-{uuid.uuid4().hex[:12]}", 0
        self._over = False
        self._loop = cast("IOLoop", client.loop)
        self._loop.add_callback(self._watch)

    def __len__(self) -> int:
        """Return the number of blocks in progress."""
        return len(self._pending)

    @property
    def reachable(self) -> bool:
        """Whether there is a connection to the scheduler at this moment."""
        return bool(self.client.status == "running")

    @property
    def lost(self) -> bool:
        """Whether the connection to the scheduler is closed permanently."""
        return self.client.status in ("closing", "closed")

    def submit(self, batch: list[int]) -> None:
        """Submit some blocks to be computed."""
        self._batches += 1  # a block that is tried again needs a new key
        keys = [(self._name, index, self._batches) for index in batch]
        try:
            futures = self.client.map(self._compute, batch, key=keys, pure=False)
        except Exception as error:  # the connection has just been lost
            for index in batch:
                self._news.put(BlockDone(index, error))
            return
        for index, future in zip(batch, futures, strict=True):
            self._pending[index] = future
            self._loop.add_callback(self._await, index, future)

    def news(self, seconds: float) -> Iterator[News]:
        """Yield what has happened, waiting at most `seconds` for the first item."""
        with suppress(Empty):
            yield self._received(self._news.get(timeout=seconds))
            while True:
                yield self._received(self._news.get_nowait())

    def release(self) -> None:
        """Cancel pending blocks and stop watching the workers."""
        self._over = True
        with suppress(Exception):  # a scheduler that is gone computes nothing either
            self.client.cancel(list(self._pending.values()))
        self._pending.clear()

    def _received(self, news: News) -> News:
        if isinstance(news, BlockDone):
            self._pending.pop(news.index, None)
        return news

    async def _await(self, index: int, future: Future[Any]) -> None:
        value: Any
        try:
            value = await self.client.gather(future, asynchronous=True)
        except (Exception, asyncio.CancelledError) as error:
            value = error
        self._news.put(BlockDone(index, value))

    async def _watch(self) -> None:
        known: set[str] = set()
        while not self._over and not self.lost:
            with suppress(OSError):
                threads = await self.client.nthreads()
                new_workers = [] if self.own else sorted(threads.keys() - known)
                if new_workers:
                    self._news.put(NewWorkers(await self._reports(new_workers)))
                known = set(threads)
                self._news.put(WorkerCount(threads))
            await asyncio.sleep(WATCH_SECONDS)

    async def _reports(self, new_workers: list[str]) -> dict[str, Any]:
        folder, digest = Path(self.task.folder), self.task.digest
        reports: dict[str, Any] = await self.client.run(
            shipped(running_cluster.worker_report),
            str(folder),
            digest,
            workers=new_workers,
            on_error="return",
        )
        return {
            address: await running_cluster.confirmed(folder, report) for address, report in reports.items()
        }
