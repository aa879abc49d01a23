"""Where a sweep stands while it is computed, and how it ended: plain values for whoever watches."""

from __future__ import annotations

import time
from collections import Counter, deque
from collections.abc import Mapping
from dataclasses import dataclass, field

from .task import Report

LATELY = 256
"""Answers from which the rate is told."""


@dataclass(frozen=True)
class SweepProgress:
    """Where a sweep stands. Members are counted, except where blocks are named; times are in seconds.

    `done` of `total` members are in the store, `computed` of them came in this call: `regimes` and
    `statuses` count those by name. `rate` is members per second lately, `left` the time that the rest would
    take at that rate (None as long as there is no telling), `workers` how many are there, `aside` how many
    blocks are set aside because they failed.
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


@dataclass(frozen=True)
class SweepSummary:
    """How a call of `run_sweep` or `repair` ended.

    `status` is "complete" (the store holds every member), "incomplete" (all but the blocks in `aside`, by
    their number with the reason), "stopped" (something stood in the way) or "interrupted"; `message` is the
    same as a sentence. `done` of `total` members are in the store, `computed` of them came in this call:
    `core_seconds` is what their blocks took in all, `seconds` the time on the clock. What is in the store is
    never lost: the same call again goes on from there.
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
    """Counts what is done of `total` members, of which `done` were there before."""

    total: int
    done: int
    computed: int = 0
    regimes: Counter[str] = field(default_factory=Counter)
    statuses: Counter[str] = field(default_factory=Counter)
    core_seconds: float = 0.0
    workers: int = 0
    most_workers: int = 0
    aside: dict[int, str] = field(default_factory=dict)
    began: float = field(default_factory=time.monotonic)
    _recent: deque[tuple[float, int]] = field(default_factory=lambda: deque(maxlen=LATELY))

    def see_workers(self, count: int) -> None:
        """Note how many workers there are."""
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
        """Return where things stand now."""
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
            aside=len(self.aside),
        )

    def summary(self, status: str, message: str) -> SweepSummary:
        """Return how it ended."""
        return SweepSummary(
            status=status,
            message=message,
            done=self.done,
            total=self.total,
            computed=self.computed,
            regimes=dict(self.regimes.most_common()),
            statuses=dict(self.statuses.most_common()),
            aside=dict(self.aside),
            seconds=time.monotonic() - self.began,
            core_seconds=self.core_seconds,
            workers=self.most_workers,
        )
