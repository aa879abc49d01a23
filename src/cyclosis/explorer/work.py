"""Threads that compute for all visitors: short steps of cells, and separately whatever takes seconds."""

from __future__ import annotations

import asyncio
import contextlib
import os
import sys
import threading
import time as clock
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from typing import Any

from ..config import Setup
from ..dynamics.protocol import Protocol
from ..model.errors import InputError
from .session import Kind, Session, kind_at
from .setup import SetUp, is_placed
from .surfaces import surface_of

MOST_KINDS = 12
"""Kinds of cell for which compiled programs are kept; each takes about 26 MB, and a closed one as four."""
FEW, FEW_PLACED = 100, 10
"""Most steps of a protocol for which adding one is quick, and if they change parameters in regions."""
_compiled: set[Kind] = set()
"""Kinds whose programs are compiled. JAX keeps these for the whole process."""
_locks: dict[frozenset[Kind], threading.Lock] = {}
"""Held while programs of those kinds are compiled, so that none is compiled twice."""

CLOSED = 4
"""The memory that programs of a closed cell take, over that of those of a cylinder."""
AHEAD = MOST_KINDS - CLOSED
"""How many kinds may be compiled in advance: a visitor's closed cell fits beside them."""


def taken(kinds: set[Kind]) -> int:
    """Return how many kinds of cylinder take as much memory as some kinds."""
    # A closed surface is known by more sizes than those of its grid: `Surface.program`.
    return sum(CLOSED if len(sizes) > 2 else 1 for sizes, *_ in kinds)


Prepare = Callable[[str, bool], contextlib.AbstractAsyncContextManager[None]]
"""Tells a visitor what is being prepared, in a sentence, and whether it is another cell, meanwhile."""


def _silently(what: str, another: bool) -> contextlib.AbstractAsyncContextManager[None]:
    return contextlib.nullcontext()


class Work:
    """Threads shared by all visitors: for short steps of cells, for long protocols, and for slow work.

    A program is compiled for every kind of cell, which takes seconds. That happens in the slow thread, so
    that other cells keep running, and no more programs are kept than there is memory for. Adding a step to a
    long protocol is slow too.
    """

    def __init__(self, threads: int) -> None:
        self.cells = ThreadPoolExecutor(threads, "cell")
        self.long = ThreadPoolExecutor(1, "long")
        self.slow = ThreadPoolExecutor(1, "slow")
        self.ahead = ThreadPoolExecutor(1, "ahead", _low_priority)
        self.inside = ThreadPoolExecutor(1, "inside", _low_priority, (5,))
        self.visits = 0
        self.took = 10.0

    def end(self) -> None:
        """Start no further work."""
        for threads in (self.cells, self.long, self.slow, self.ahead, self.inside):
            threads.shutdown(wait=False, cancel_futures=True)

    async def quickly(self, work: Callable[[], Any]) -> Any:
        """Do work that takes a moment."""
        return await _within(self.cells, work)

    async def slowly(self, work: Callable[[], Any]) -> Any:
        """Do work that may take seconds."""
        return await _within(self.slow, work)

    async def aside(self, work: Callable[[], Any]) -> Any:
        """Do work that only adds to pictures, in a thread of low priority."""
        return await _within(self.inside, work)

    async def forward(self, cell: Session, prepare: Prepare = _silently) -> bool:
        """Compute for a moment; return whether the next frame is reached."""
        needed = cell.kinds()
        done: bool
        if needed <= _compiled:
            done = await self.quickly(cell.forward)
        else:
            async with prepare(self._sentence("what the cell needs from now on"), False):
                done = await self.slowly(lambda: self._prepared(needed, lambda: cell).forward())
        return done

    async def opened(self, begun: SetUp, prepare: Prepare = _silently) -> Session:
        """Return the cell of a set-up."""
        ready = await self._ready(begun, prepare)
        needed = {kind_at(ready.schedule, ready.grid)}
        cell: Session
        if needed <= _compiled:
            cell = await _within(self._for(ready.protocol), lambda: Session(begun, ready))
        else:
            async with prepare(self._sentence(surface_of(ready.grid).words(ready.grid)), True):
                cell = await self.slowly(lambda: self._prepared(needed, lambda: Session(begun, ready)))
        return cell

    async def _ready(self, begun: SetUp, prepare: Prepare) -> Setup:
        """Return a set-up ready to run; the harmonics of a new surface take a while."""
        found: Setup
        if not await self.quickly(begun.is_dear):
            few = len(begun.steps) <= FEW_PLACED
            found = await _within(self.cells if few else self.long, begun.ready)
        else:
            words = surface_of(begun.grid).words(begun.grid)
            async with prepare(f"Preparing the surface of {words}.", True):
                found = await self.slowly(begun.ready)
        return found

    async def act(self, cell: Session, what: Callable[[], None], prepare: Prepare = _silently) -> None:
        """Act on a cell."""
        await _within(self._for(cell.live.protocol), what)
        if cell.kind not in _compiled:
            async with prepare(self._sentence("what this change needs"), False):
                await self.slowly(lambda: self._prepared(cell.kinds(), lambda: cell))

    async def prepared_ahead(self, begun: SetUp) -> None:
        """Compile what a set-up needs before anyone requests it, in a thread of low priority."""
        ready = await _within(self.ahead, begun.ready)
        needed = {kind_at(ready.schedule, ready.grid)}
        if not needed <= _compiled and taken(_compiled | needed) <= AHEAD:
            await _within(self.ahead, lambda: self._prepared(needed, lambda: Session(begun, ready)))

    def _sentence(self, what: str) -> str:
        return f"Preparing {what}. The first of its kind takes about {max(1, round(self.took))} s."

    def _for(self, protocol: Protocol) -> ThreadPoolExecutor:
        """Return the threads for work on a protocol."""
        return self.long if len(protocol) > (FEW_PLACED if is_placed(protocol) else FEW) else self.cells

    def _prepared(self, needed: set[Kind], make: Callable[[], Session]) -> Session:
        """Return a cell once everything that it needs now is compiled."""
        with _locks.setdefault(frozenset(needed), threading.Lock()):
            self._make_room(needed)
            began, cell = clock.perf_counter(), make()
            if cell.kind not in _compiled:
                cell.rehearse()
                _compiled.add(cell.kind)
                self.took = clock.perf_counter() - began
        return cell

    def _make_room(self, needed: set[Kind]) -> None:
        if taken(_compiled | needed) <= MOST_KINDS:
            return
        if self.visits > 1:
            rule = "one that the server has already computed while others are here"
            found = next(iter(needed - _compiled))[0]
            raise InputError("grid", found, rule, "try later, or choose another")
        import jax

        jax.clear_caches()  # type: ignore[no-untyped-call]
        _compiled.clear()
        _locks.clear()


def _low_priority(niceness: int = 10) -> None:
    """Give this thread a low priority, where threads have priorities."""
    if sys.platform == "linux":
        os.setpriority(os.PRIO_PROCESS, threading.get_native_id(), niceness)


async def _within(threads: ThreadPoolExecutor, work: Callable[[], Any]) -> Any:
    return await asyncio.get_running_loop().run_in_executor(threads, work)
