"""Computing a sweep on a Dask cluster: every block is a task, and its result a file in the store.

The client keeps a limited number of blocks in progress, so that the scheduler never holds many, and workers
send back only counts. No other state is saved: a block is done if its file is in the store.
"""

from __future__ import annotations

import os
import random
import time
import warnings
from collections.abc import Callable, Iterator
from concurrent.futures import CancelledError
from contextlib import contextmanager
from typing import Any

from distributed import Client
from distributed.scheduler import KilledWorker

from ..dynamics.interrupts import Interrupts
from ..model.doors import door
from ..model.errors import InputError, whole
from ..model.reporting import Progress, counted, reported
from .cluster import running_cluster
from .cluster.local_cluster import local_client
from .cluster.progress import SweepProgress, SweepSummary, Tally
from .cluster.queue import BlockQueue, spread
from .cluster.task import BlockTask, Compute, Report, described
from .cluster.workers import BlockDone, News, NewWorkers, WorkerCount, Workers
from .plan.sweep import Sweep
from .store.store import Store

Watcher = Callable[[SweepProgress], None]

HOPELESS = 10
"""If this many blocks fail before any is computed, the cause is not in the blocks."""
AHEAD = 8
"""Blocks in progress beyond two per thread: enough for the shortest blocks."""
SHOW_SECONDS = 0.2
"""Shortest time between two calls of the watcher, and longest wait for news."""
LONELY_SECONDS = 60.0
"""How long a cluster started here may be without any worker."""
VISIBLE_SECONDS = 60.0
"""How long a block may take to appear after its worker has written it, on a network file system."""
MOST_WORKERS = 4096


@door
def run_sweep(
    sweep: Sweep,
    store: str | os.PathLike[str],
    client: Client | None = None,
    *,
    workers: int | None = None,
    progress: Progress = None,
    compute: Compute | None = None,
) -> SweepSummary:
    """Compute the blocks of a sweep that a store lacks, and return a summary.

    The store is a folder, which is created if it does not exist. `client` is a client of a running Dask
    cluster, whose workers need this package and the store's folder; without it `workers` processes are
    started here, by default one per core (a script must then call this under
    `if __name__ == "__main__":`). `progress` shows a bar in a terminal or a notebook unless it is
    False; a function is called with a `SweepProgress` a few times a second.
    `compute(sweep, index)` may replace that of `cyclosis.sweep.store.block`.

    A block that raises an exception is tried three times, and so is a block whose worker dies; then it is
    set aside in the store with the reason, until `repair` is called. Ctrl-C stops the workers and raises
    KeyboardInterrupt with the summary as its attribute `run`, of status "interrupted"; SIGTERM stops them and
    then has its usual effect. However a sweep was stopped, the same call continues it; several calls may
    work on one store at once. Raises `InputError` if the store holds another sweep or cannot be created.

    Example:
        >>> from dask.distributed import Client
        >>> import cyclosis as cy
        >>> tables = {"axes": {"alpha_p": {"values": [0.01, 0.02]}}, "ensemble": {"seeds": 2}}
        >>> sweep = cy.Sweep.from_tables(tables | {"grid": {"n_theta": 16, "n_z": 16}})
        >>> with Client(processes=False, threads_per_worker=1, dashboard_address=None) as client:
        ...     summary = cy.run_sweep(sweep, "weak", client)
        >>> summary.ok, summary.done, summary.regimes
        (True, 4, {'disordered': 4})
    """
    return _complete(Store.create(store, sweep), client, workers, progress, compute)


def repair(
    store: str | os.PathLike[str],
    client: Client | None = None,
    *,
    workers: int | None = None,
    progress: Progress = None,
    compute: Compute | None = None,
) -> SweepSummary:
    """Discard the damaged blocks of a store, and compute all blocks that it lacks.

    Blocks that were set aside are tried again. Arguments and result are those of `run_sweep`.

    Example:
        >>> import cyclosis as cy
        >>> from cyclosis.sweep.store.block import compute
        >>> from cyclosis.sweep.execute import repair
        >>> from cyclosis.sweep.store.store import Store
        >>> tables = {"axes": {"alpha_p": {"values": [0.01]}}, "ensemble": {"seeds": 2}}
        >>> sweep = cy.Sweep.from_tables(tables | {"grid": {"n_theta": 16, "n_z": 16}})
        >>> path = Store.create("whole", sweep).write(0, compute(sweep, 0))
        >>> repair("whole").status  # nothing to do, so that no worker starts
        'complete'
    """
    _check_arguments(workers, client)
    kept = Store(store)
    for index in {index for index, _ in kept.verify()} & kept.present() | kept.failed().keys():
        kept.discard(index)
    return _complete(kept, client, workers, progress, compute)


def _check_arguments(workers: int | None, client: Client | None) -> None:
    if workers is not None:
        whole("workers", workers, 1, MOST_WORKERS, "leave it out for one a core")
        if client is not None:
            raise InputError("workers", workers, "left out beside a client", "start them on its cluster")


def _complete(
    store: Store,
    client: Client | None,
    workers: int | None,
    progress: Progress,
    compute: Compute | None,
) -> SweepSummary:
    _check_arguments(workers, client)
    with reported(progress, "sweep", _told) as report:
        return _executed(store, client, workers, report or (lambda now: None), compute)


def _told(now: SweepProgress) -> tuple[float, str]:
    """Return the share of a sweep that is done, and in words what its members have become."""
    share, words = counted(now.done, now.total)
    regimes = ", ".join(f"{count} {name}" for name, count in now.regimes.items())
    return share, f"{words} runs" + (f" ({regimes})" if regimes else "")


def _executed(
    store: Store, client: Client | None, workers: int | None, show: Watcher, compute: Compute | None
) -> SweepSummary:
    store.clean()
    execution = Execution(store, show)
    if not execution.queue:
        return execution.ended(False)
    task = BlockTask(str(store.path), store.digest, compute)
    # A custom handler may return, and then the sweep continues: it need not wait.
    with Interrupts(handlers=False) as interrupts:
        with _client(client, workers) as (reached, own):
            summary = execution.run(Workers(reached, task, own), interrupts)
        store.clean()  # workers started here were killed, perhaps while one wrote a block
        interrupts.deliver(summary)
    return summary


@contextmanager
def _client(client: Client | None, workers: int | None) -> Iterator[tuple[Client, bool]]:
    """Provide the given client, or that of a new local cluster, and whether it is the latter."""
    if client is None:
        with local_client(workers) as own:
            yield own, True
    elif client.asynchronous:
        raise InputError("client", client, "one that is not asynchronous", "make it with Client(address)")
    else:
        yield client, False


class Execution:
    """One call of `run_sweep`: submits blocks to the workers and handles their results."""

    def __init__(self, store: Store, show: Watcher) -> None:
        self.store, self.sweep, self.show = store, store.sweep, show
        present, set_aside = store.present(), store.failed()
        self.tally = Tally(self.sweep.members, sum(map(self._members, present)), set_aside=set_aside)
        order = spread(self.sweep.blocks, random.randrange(self.sweep.blocks))
        self.queue = BlockQueue(i for i in order if i not in present and i not in set_aside)
        self.obstacle = ""
        self._alone: int | None = None
        self._unseen: dict[int, tuple[float, Report]] = {}
        self._threads = self._given_up = 0
        self._remarks: set[str] = set()
        self._last_worker = self._shown = time.monotonic()

    def run(self, workers: Workers, interrupts: Interrupts) -> SweepSummary:
        """Compute until nothing is left, or an obstacle prevents it."""
        try:
            while not (self.obstacle or interrupts.asked) and (self.queue or workers or self._unseen):
                self._submit(workers)
                for news in workers.news(SHOW_SECONDS):
                    self._handle(workers, news)
                self._check(workers)
        finally:
            workers.release()
        self.show(self.tally.progress())
        return self.ended(interrupts.asked)

    def ended(self, interrupted: bool) -> SweepSummary:
        """Return a summary of the call."""
        tally = self.tally
        stored = f"{tally.done} of {tally.total} runs are in {self.store.path}"
        if self.obstacle:
            return tally.summary("stopped", f"{self.obstacle.rstrip('.')}; {stored}.")
        if interrupted and tally.done < tally.total:
            return tally.summary("interrupted", f"interrupted; {stored}.")
        if tally.set_aside:
            index, reason = min(tally.set_aside.items())
            which = "1 block is" if len(tally.set_aside) == 1 else f"{len(tally.set_aside)} blocks are"
            why = f"block {index}: {reason.rstrip('.')}"
            return tally.summary("incomplete", f"{stored}; {which} set aside because of failures ({why}).")
        return tally.summary("complete", f"all {tally.total} runs are in {self.store.path}.")

    def _submit(self, workers: Workers) -> None:
        """Submit blocks until enough are in progress; suspects last, and alone."""
        if self._alone is not None or not self._threads or not workers.reachable:
            return
        batch: list[int] = []
        while len(workers) + len(batch) < 2 * self._threads + AHEAD:
            index = self.queue.next()
            if index is None:
                break
            if self.store.has(index):  # another client has had it computed
                self._count(Report(index))
            else:
                batch.append(index)
        if not batch and not workers:
            self._alone = self.queue.next_suspect()
            batch = [] if self._alone is None else [self._alone]
        if batch:
            workers.submit(batch)

    def _handle(self, workers: Workers, news: News) -> None:
        if isinstance(news, BlockDone):
            alone, self._alone = self._alone is not None, None
            self._handle_block(workers, news.index, news.value, alone)
        elif isinstance(news, WorkerCount):
            self._threads = sum(news.threads.values())
            self.tally.see_workers(len(news.threads))
            if news.threads:
                self._last_worker = time.monotonic()
        else:
            self._handle_new(news)

    def _handle_new(self, news: NewWorkers) -> None:
        self.obstacle = self.obstacle or running_cluster.obstacle(news.reports)
        remarks = running_cluster.remarks(news.reports)
        if remarks and remarks not in self._remarks:
            self._remarks.add(remarks)
            warnings.warn(remarks, stacklevel=2)

    def _handle_block(self, workers: Workers, index: int, value: Any, alone: bool) -> None:
        """Handle the result of a block: a report or an exception."""
        if isinstance(value, Report):
            self._report(value)
        elif isinstance(value, KilledWorker):
            if self.queue.died(index, value.allowed_failures + 1, alone):
                self._give_up(index, f"its worker died {self.queue.deaths(index)} times")
        elif isinstance(value, CancelledError) or not workers.reachable:
            self.queue.retry(index)
        else:
            self._fail(index, described(value))

    def _report(self, report: Report) -> None:
        if report.obstacle:
            self.obstacle = self.obstacle or report.obstacle
        elif report.failure:
            self._fail(report.index, report.failure)
        elif self.store.has(report.index):
            self._count(report)
        else:
            self._unseen[report.index] = (time.monotonic() + VISIBLE_SECONDS, report)

    def _check(self, workers: Workers) -> None:
        """Check for blocks that have not appeared yet and for missing workers; show the progress."""
        now = time.monotonic()
        for index, (deadline, report) in list(self._unseen.items()):
            if self.store.has(index):
                self._count(report)
            elif now > deadline:
                self._fail(index, "its file does not appear in the store")
            else:
                continue
            del self._unseen[index]
        if workers.lost:
            self.obstacle = self.obstacle or "the scheduler cannot be reached any more"
        elif workers.own and now > self._last_worker + LONELY_SECONDS:
            self.obstacle = self.obstacle or "no worker can be started"
        if now > self._shown + SHOW_SECONDS:
            self._shown = now
            self.show(self.tally.progress())

    def _count(self, report: Report) -> None:
        self.tally.add(report, self._members(report.index))

    def _fail(self, index: int, reason: str) -> None:
        if self.queue.failed(index):
            self._give_up(index, reason)

    def _give_up(self, index: int, reason: str) -> None:
        self.tally.set_aside[index] = reason
        try:
            self.store.set_aside(index, reason)
        except InputError as error:
            self.obstacle = self.obstacle or str(error)
        self._given_up += 1
        if not self.tally.computed and self._given_up >= HOPELESS:
            self.obstacle = self.obstacle or f"no block can be computed ({reason.rstrip('.')})"

    def _members(self, index: int) -> int:
        return len(self.sweep.block(index).members)
