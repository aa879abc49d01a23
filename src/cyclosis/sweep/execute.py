"""Computing a sweep on a Dask cluster: every block a task, its file in the store the answer.

The client keeps a window of blocks in work, so that the scheduler never holds many, and workers send
back counts alone. Nothing has to be saved: what is in the store is done, the rest is not.
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
from ..model.errors import InputError, whole
from . import guests
from .agenda import Agenda
from .crew import Acquaintance, Answer, Attendance, Crew, News
from .local import local_client
from .order import spread
from .plan import Sweep
from .store import Store
from .tally import SweepProgress, SweepSummary, Tally
from .task import BlockTask, Compute, Report, described

Watcher = Callable[[SweepProgress], None]

HOPELESS = 10
"""If so many blocks fail before any is computed, the fault is not theirs."""
AHEAD = 8
"""Blocks in work beyond two for every thread: enough for the shortest."""
SHOW_SECONDS = 0.2
"""Least time between two calls of the watcher, and the longest wait for news."""
LONELY_SECONDS = 60.0
"""How long a cluster of our own may be without any worker."""
VISIBLE_SECONDS = 60.0
"""How long a block may take to appear after its worker has written it, on a network's file system."""
MOST_WORKERS = 4096


def run_sweep(
    sweep: Sweep,
    store: str | os.PathLike[str],
    client: Client | None = None,
    *,
    workers: int | None = None,
    progress: Watcher | None = None,
    compute: Compute | None = None,
) -> SweepSummary:
    """Compute what a store lacks of a sweep, and return how that ended.

    The store is a folder, made if there is none. `client` is one of a running Dask cluster, whose workers
    need this package and the store's folder; without it `workers` processes are started here, by default
    one a core (a script must then do this under `if __name__ == "__main__":`). `progress` is called with a
    `SweepProgress` a few times a second. `compute(sweep, index)` may replace `cyclosis.sweep.block.compute`.

    A block that raises an exception is tried three times, and one whose worker dies as often; then it is
    set aside in the store with the reason, where it stays until `repair`. Ctrl-C and SIGTERM stop with status
    "interrupted". Whatever stops it, the same call goes on; several may work on one store at once. Raises
    `InputError` if the store holds another sweep or cannot be made.

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
    progress: Watcher | None = None,
    compute: Compute | None = None,
) -> SweepSummary:
    """Discard the blocks of a store that are not as they were written, and compute all that it lacks.

    Blocks that were set aside are tried again. Arguments and result are those of `run_sweep`.

    Example:
        >>> import cyclosis as cy
        >>> from cyclosis.sweep.block import compute
        >>> from cyclosis.sweep.execute import repair
        >>> from cyclosis.sweep.store import Store
        >>> tables = {"axes": {"alpha_p": {"values": [0.01]}}, "ensemble": {"seeds": 2}}
        >>> sweep = cy.Sweep.from_tables(tables | {"grid": {"n_theta": 16, "n_z": 16}})
        >>> path = Store.create("whole", sweep).write(0, compute(sweep, 0))
        >>> repair("whole").status  # nothing to do, so that no worker starts
        'complete'
    """
    _check(workers, client)
    kept = Store(store)
    for index in {index for index, _ in kept.verify()} & kept.present() | kept.failed().keys():
        kept.discard(index)
    return _complete(kept, client, workers, progress, compute)


def _check(workers: int | None, client: Client | None) -> None:
    if workers is not None:
        whole("workers", workers, 1, MOST_WORKERS, "leave it out for one a core")
        if client is not None:
            raise InputError("workers", workers, "left out beside a client", "start them on its cluster")


def _complete(
    store: Store,
    client: Client | None,
    workers: int | None,
    progress: Watcher | None,
    compute: Compute | None,
) -> SweepSummary:
    _check(workers, client)
    store.clean()
    execution = Execution(store, progress or (lambda now: None))
    if not execution.agenda:
        return execution.ended(False)
    task = BlockTask(str(store.path), store.digest, compute)
    with Interrupts() as interrupts, _client(client, workers) as (reached, own):
        return execution.run(Crew(reached, task, own), interrupts)


@contextmanager
def _client(client: Client | None, workers: int | None) -> Iterator[tuple[Client, bool]]:
    """Provide the client given, or that of a cluster of our own; and which of the two."""
    if client is None:
        with local_client(workers) as own:
            yield own, True
    elif client.asynchronous:
        raise InputError("client", client, "one that is not asynchronous", "make it with Client(address)")
    else:
        yield client, False


class Execution:
    """One call of `run_sweep`: it keeps the crew busy, and judges what comes back."""

    def __init__(self, store: Store, show: Watcher) -> None:
        self.store, self.sweep, self.show = store, store.sweep, show
        present, aside = store.present(), store.failed()
        self.tally = Tally(self.sweep.members, sum(map(self._members, present)), aside=aside)
        order = spread(self.sweep.blocks, random.randrange(self.sweep.blocks))
        self.agenda = Agenda(i for i in order if i not in present and i not in aside)
        self.obstacle = ""
        self._alone: int | None = None
        self._unseen: dict[int, tuple[float, Report]] = {}
        self._threads = self._given_up = 0
        self._remarks: set[str] = set()
        self._attended = self._shown = time.monotonic()

    def run(self, crew: Crew, interrupts: Interrupts) -> SweepSummary:
        """Compute until nothing is left, or something stands in the way."""
        try:
            while not (self.obstacle or interrupts.asked) and (self.agenda or crew or self._unseen):
                self._employ(crew)
                for news in crew.news(SHOW_SECONDS):
                    self._hear(crew, news)
                self._look(crew)
        finally:
            crew.dismiss()
        self.show(self.tally.progress())
        return self.ended(interrupts.asked)

    def ended(self, interrupted: bool) -> SweepSummary:
        """Return how it ended."""
        tally = self.tally
        stands = f"{tally.done} of {tally.total} runs are in {self.store.path}"
        if self.obstacle:
            return tally.summary("stopped", f"{self.obstacle.rstrip('.')}; {stands}.")
        if interrupted and tally.done < tally.total:
            return tally.summary("interrupted", f"interrupted; {stands}.")
        if tally.aside:
            index, reason = min(tally.aside.items())
            which = "1 block is" if len(tally.aside) == 1 else f"{len(tally.aside)} blocks are"
            why = f"block {index}: {reason.rstrip('.')}"
            return tally.summary("incomplete", f"{stands}; {which} set aside because of failures ({why}).")
        return tally.summary("complete", f"all {tally.total} runs are in {self.store.path}.")

    def _employ(self, crew: Crew) -> None:
        """Give out blocks until the window is full; suspects last, and alone."""
        if self._alone is not None or not self._threads or not crew.reachable:
            return
        batch: list[int] = []
        while len(crew) + len(batch) < 2 * self._threads + AHEAD:
            index = self.agenda.next()
            if index is None:
                break
            if self.store.has(index):  # another client has brought it
                self._count(Report(index))
            else:
                batch.append(index)
        if not batch and not crew:
            self._alone = self.agenda.next_suspect()
            batch = [] if self._alone is None else [self._alone]
        if batch:
            crew.submit(batch)

    def _hear(self, crew: Crew, news: News) -> None:
        if isinstance(news, Answer):
            alone, self._alone = self._alone is not None, None
            self._judge(crew, news.index, news.value, alone)
        elif isinstance(news, Attendance):
            self._threads = sum(news.threads.values())
            self.tally.see_workers(len(news.threads))
            if news.threads:
                self._attended = time.monotonic()
        else:
            self._meet(news)

    def _meet(self, news: Acquaintance) -> None:
        self.obstacle = self.obstacle or guests.obstacle(news.greetings)
        remarks = guests.remarks(news.greetings)
        if remarks and remarks not in self._remarks:
            self._remarks.add(remarks)
            warnings.warn(remarks, stacklevel=2)

    def _judge(self, crew: Crew, index: int, value: Any, alone: bool) -> None:
        """Take in what came back of a block."""
        if isinstance(value, Report):
            self._report(value)
        elif isinstance(value, KilledWorker):
            if self.agenda.died(index, value.allowed_failures + 1, alone):
                self._give_up(index, f"its worker died {self.agenda.deaths(index)} times")
        elif isinstance(value, CancelledError) or not crew.reachable:
            self.agenda.unlucky(index)
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

    def _look(self, crew: Crew) -> None:
        """Look for blocks that have not appeared yet and a crew that stays away; show how things stand."""
        now = time.monotonic()
        for index, (deadline, report) in list(self._unseen.items()):
            if self.store.has(index):
                self._count(report)
            elif now > deadline:
                self._fail(index, "its file does not appear in the store")
            else:
                continue
            del self._unseen[index]
        if crew.lost:
            self.obstacle = self.obstacle or "the scheduler cannot be reached any more"
        elif crew.own and now > self._attended + LONELY_SECONDS:
            self.obstacle = self.obstacle or "no worker can be started"
        if now > self._shown + SHOW_SECONDS:
            self._shown = now
            self.show(self.tally.progress())

    def _count(self, report: Report) -> None:
        self.tally.add(report, self._members(report.index))

    def _fail(self, index: int, reason: str) -> None:
        if self.agenda.failed(index):
            self._give_up(index, reason)

    def _give_up(self, index: int, reason: str) -> None:
        self.tally.aside[index] = reason
        try:
            self.store.set_aside(index, reason)
        except InputError as error:
            self.obstacle = self.obstacle or str(error)
        self._given_up += 1
        if not self.tally.computed and self._given_up >= HOPELESS:
            self.obstacle = self.obstacle or f"no block can be computed ({reason.rstrip('.')})"

    def _members(self, index: int) -> int:
        return len(self.sweep.block(index).members)
