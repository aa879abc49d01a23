"""Threads that compute for all visitors: moments of cells, and beside them what takes seconds."""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from typing import Any

from ..dynamics.protocol import Protocol
from ..model.errors import InputError
from .session import Kind, Session, kinds
from .setup import SetUp, is_placed

MOST_KINDS = 40
"""Kinds of cell for which compiled programs are kept; each takes about 20 MB."""
FEW, FEW_PLACED = 100, 10
"""Steps of a protocol to which one more is added in a moment, and if they change parameters in regions."""
_known: set[Kind] = set()
"""Kinds whose programs are compiled. JAX keeps these for the whole process."""


class Work:
    """What visitors share: threads for moments of cells, one for long protocols, one for what takes seconds.

    A program is compiled for every kind of cell, in seconds. That happens in the slow thread, so that cells
    under way go on, and no more programs are kept than there is memory for. To do one thing more to a cell
    to which much was done takes longer than a moment.
    """

    def __init__(self, threads: int) -> None:
        self.cells = ThreadPoolExecutor(threads, "cell")
        self.long = ThreadPoolExecutor(1, "long")
        self.slow = ThreadPoolExecutor(1, "slow")
        self.visits = 0

    def end(self) -> None:
        """Begin nothing more."""
        for threads in (self.cells, self.long, self.slow):
            threads.shutdown(wait=False, cancel_futures=True)

    async def quickly(self, work: Callable[[], Any]) -> Any:
        """Do what takes a moment."""
        return await _within(self.cells, work)

    async def slowly(self, work: Callable[[], Any]) -> Any:
        """Do what may take seconds."""
        return await _within(self.slow, work)

    async def forward(self, cell: Session) -> bool:
        """Compute on for a moment; return whether the next frame is reached."""
        needed = cell.kinds()
        done: bool
        if needed <= _known:
            done = await self.quickly(cell.forward)
        else:
            done = await self.slowly(lambda: self._prepared(needed, lambda: cell).forward())
        return done

    async def opened(self, begun: SetUp) -> Session:
        """Return the cell of a set-up."""
        ready = await _within(self.long if len(begun.steps) > FEW_PLACED else self.cells, begun.ready)
        needed = kinds(ready.schedule, ready.grid)
        threads = self._for(ready.protocol) if needed <= _known else self.slow
        cell: Session = await _within(threads, lambda: self._prepared(needed, lambda: Session(begun, ready)))
        return cell

    async def act(self, cell: Session, what: Callable[[], None]) -> None:
        """Do something to a cell."""
        await _within(self._for(cell.live.protocol), what)
        if cell.kind not in _known:
            await self.slowly(lambda: self._prepared(cell.kinds(), lambda: cell))

    def _for(self, protocol: Protocol) -> ThreadPoolExecutor:
        """Return the threads for what becomes of a protocol."""
        return self.long if len(protocol) > (FEW_PLACED if is_placed(protocol) else FEW) else self.cells

    def _prepared(self, needed: set[Kind], make: Callable[[], Session]) -> Session:
        """Return a cell once what it needs now is compiled."""
        self._make_room(needed)
        cell = make()
        if cell.kind not in _known:
            cell.rehearse()
            _known.add(cell.kind)
        return cell

    def _make_room(self, needed: set[Kind]) -> None:
        if len(_known | needed) <= MOST_KINDS:
            return
        if self.visits > 1:
            rule = "one that the server has already computed while others are here"
            raise InputError("grid", next(iter(needed - _known))[0], rule, "try later, or choose another")
        import jax

        jax.clear_caches()  # type: ignore[no-untyped-call]
        _known.clear()


async def _within(threads: ThreadPoolExecutor, work: Callable[[], Any]) -> Any:
    return await asyncio.get_running_loop().run_in_executor(threads, work)
