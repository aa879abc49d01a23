"""Threads that compute for all visitors: moments of cells, and beside them what takes seconds."""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from typing import Any

from ..model.errors import InputError
from .session import Kind, Session, kinds
from .setup import SetUp

MOST_KINDS = 40
"""Kinds of cell for which compiled programs are kept; each takes about 20 MB."""
_known: set[Kind] = set()
"""Kinds whose programs are compiled. JAX keeps these for the whole process."""


class Work:
    """What visitors share: threads for moments of cells, and one for all that takes seconds.

    A program is compiled for every kind of cell, in seconds. That happens in the slow thread, so that cells
    under way go on, and no more programs are kept than there is memory for.
    """

    def __init__(self, threads: int) -> None:
        self.cells = ThreadPoolExecutor(threads, "cell")
        self.slow = ThreadPoolExecutor(1, "slow")
        self.visits = 0

    def end(self) -> None:
        """Begin nothing more."""
        for threads in (self.cells, self.slow):
            threads.shutdown(wait=False, cancel_futures=True)

    async def quickly(self, work: Callable[[], Any]) -> Any:
        """Do what takes a moment."""
        return await asyncio.get_running_loop().run_in_executor(self.cells, work)

    async def slowly(self, work: Callable[[], Any]) -> Any:
        """Do what may take seconds."""
        return await asyncio.get_running_loop().run_in_executor(self.slow, work)

    async def of_kinds(self, needed: set[Kind], work: Callable[[], Any]) -> Any:
        """Do what takes a moment for cells of known kinds, and else may take seconds."""
        if needed <= _known:
            return await self.quickly(work)
        return await self.slowly(lambda: self._new(needed, work))

    async def known(self, cell: Session) -> None:
        """Wait until what a cell needs now is compiled."""
        if cell.kind not in _known:
            await self.of_kinds(cell.kinds(), lambda: self.prepared(cell))

    async def forward(self, cell: Session) -> bool:
        """Compute on for a moment; return whether the next frame is reached."""
        done: bool = await self.of_kinds(cell.kinds(), lambda: self.prepared(cell).forward())
        return done

    async def opened(self, begun: SetUp) -> Session:
        """Return the cell of a set-up."""
        ready = await self.quickly(begun.ready)
        needed = kinds(ready.schedule, ready.grid)
        cell: Session = await self.of_kinds(needed, lambda: self.prepared(Session(begun, ready)))
        return cell

    def prepared(self, cell: Session) -> Session:
        """Return a cell once what it needs now is compiled."""
        if cell.kind not in _known:
            cell.rehearse()
            _known.add(cell.kind)
        return cell

    def _new(self, needed: set[Kind], work: Callable[[], Any]) -> Any:
        if len(_known | needed) > MOST_KINDS:
            if self.visits > 1:
                rule = "one that the server has already computed while others are here"
                raise InputError("grid", next(iter(needed - _known))[0], rule, "choose 64 x 64, or try later")
            import jax

            jax.clear_caches()  # type: ignore[no-untyped-call]
            _known.clear()
        return work()
