"""The progress of a sweep while it is computed, and a summary at its end, as plain values."""

from __future__ import annotations

import time
from collections import Counter, deque
from collections.abc import Mapping
from dataclasses import dataclass, field

from ...display.shown import shown
from .task import Report

LATELY = 256
"""Number of latest blocks from which the rate is computed."""


@shown
@dataclass(frozen=True)
class SweepProgress:
    """The progress of a sweep. Numbers count members unless they are of blocks; times are in seconds.

    `done` of `total` members are in the store, `computed` of them were added by this call: `regimes` and
    `statuses` count those by name. `rate` is the recent number of members per second, `left` the time that
    the rest will take at that rate (None while it is unknown), `workers` the number of workers, `aside` the
    number of blocks that are set aside because they failed.
    """

    done: int
    total: int
    computed: int
    regimes: Mapping[str, int]
    statuses: Mapping[str, int]
    seconds: float
    rate: float
    left: float | None
    workers: int
    aside: int


def counted(done: int, total: int, seconds: float) -> SweepProgress:
    """Return the progress of members that are only counted, `done` of `total` in `seconds`."""
    rate = done / seconds if seconds > 0 else 0.0
    left = (total - done) / rate if rate > 0 else None
    return SweepProgress(done, total, done, {}, {}, seconds, rate, left, 0, 0)


@shown
@dataclass(frozen=True)
class SweepSummary:
    """The summary of a call of `run_sweep` or `repair`.

    `status` is "complete" (the store holds every member), "incomplete" (it holds all but the blocks in
    `aside`, which maps their numbers to reasons), "stopped" (an obstacle ended the call) or "interrupted";
    `message` says the same in a sentence. `done` of `total` members are in the store, `computed` of them were
    added by this call: `core_seconds` is the total time of their blocks, `seconds` the wall time. Nothing
    that is in the store is lost: the same call continues from there.
    """

    status: str
    message: str
    done: int
    total: int
    computed: int
    regimes: Mapping[str, int]
    statuses: Mapping[str, int]
    aside: Mapping[int, str]
    seconds: float
    core_seconds: float
    workers: int

    @property
    def ok(self) -> bool:
        """Whether the store holds every member."""
        return self.status == "complete"


@dataclass
class Tally:
    """Counts how many of `total` members are done; it begins with those that are `done` already."""

    total: int
    done: int
    computed: int = 0
    regimes: Counter[str] = field(default_factory=Counter)
    statuses: Counter[str] = field(default_factory=Counter)
    core_seconds: float = 0.0
    workers: int = 0
    most_workers: int = 0
    set_aside: dict[int, str] = field(default_factory=dict)
    began: float = field(default_factory=time.monotonic)
    _recent: deque[tuple[float, int]] = field(default_factory=lambda: deque(maxlen=LATELY))

    def see_workers(self, count: int) -> None:
        """Record how many workers there are."""
        if count and not self._recent:
            self._recent.append((time.monotonic(), 0))
        self.workers, self.most_workers = count, max(count, self.most_workers)

    def add(self, report: Report, members: int) -> None:
        """Count the members of a block that is in the store."""
        self.done += members
        if report.regimes:
            self.computed += members
            self.regimes.update(report.regimes)
            self.statuses.update(report.statuses)
            self.core_seconds += report.seconds
            self._recent.append((time.monotonic(), self.computed))

    def progress(self) -> SweepProgress:
        """Return the progress at this moment."""
        now = time.monotonic()
        since, before = self._recent[0] if self._recent else (now, self.computed)
        rate = (self.computed - before) / (now - since) if now > since else 0.0
        return SweepProgress(
            done=self.done,
            total=self.total,
            computed=self.computed,
            regimes=dict(self.regimes.most_common()),
            statuses=dict(self.statuses.most_common()),
            seconds=now - self.began,
            rate=rate,
            left=(self.total - self.done) / rate if rate > 0 else None,
            workers=self.workers,
            aside=len(self.set_aside),
        )

    def summary(self, status: str, message: str) -> SweepSummary:
        """Return a summary with this status and message."""
        return SweepSummary(
            status=status,
            message=message,
            done=self.done,
            total=self.total,
            computed=self.computed,
            regimes=dict(self.regimes.most_common()),
            statuses=dict(self.statuses.most_common()),
            aside=dict(self.set_aside),
            seconds=time.monotonic() - self.began,
            core_seconds=self.core_seconds,
            workers=self.most_workers,
        )
