"""One visit, from beginning to end: requests come in, the cell runs at its pace, pictures go out.

A visit outlives its connections: without one the cell pauses, and is kept for a while.
"""

from __future__ import annotations

import asyncio
import contextlib
import json
import time as clock
from collections import deque
from collections.abc import AsyncIterator, Callable
from typing import Any

from ..model.errors import InputError
from ..model.instants import instant
from ..model.parameters import Parameters
from . import messages, setup
from .about import curves, preset
from .inside import Inside, Seen
from .line import Line
from .session import Session, until
from .work import Work

WAITING = 64
"""Most requests that may wait; beyond, the connection is not read."""
UNSEEN = 2
"""Pictures that may be in transit before the page confirms one as drawn; one more after an action."""
PATIENCE = 5.0
"""Seconds for which a cell keeps running while the page draws nothing, as in a hidden tab."""
BEGINNING = 30.0
"""Seconds within which a visitor must begin a cell."""
MOST_PICTURES = 30.0
"""Most pictures sent per second."""
LEFT_ALONE = "This cell was idle for too long and has ended; its address still holds all of it."
REFUSALS = 20
"""Refused requests in a row after which the visit ends."""


class Visit:
    """A visitor's session and its pace. `go` returns when the visitor has left or has been idle too long."""

    def __init__(self, work: Work, token: str, idle_seconds: float, kept_seconds: float) -> None:
        self.work, self.token, self.idle_seconds, self.kept_seconds = work, token, idle_seconds, kept_seconds
        self.line: Line | None = None
        self.open = False
        self.asks: asyncio.Queue[messages.Ask | InputError | None] = asyncio.Queue(WAITING)
        self.received, self.done, self.busy, self.left = 0, 0, False, False
        self.session: Session | None = None
        self.preset: str | None = None
        self.begun, self.playing, self.speed = 0, False, 5.0
        self.catching_up: float | None = None
        self.goal: int | None = None
        """The frame to compute up to, as fast as possible."""
        self.unseen, self.seen_at, self.sent_at, self.due = 0, 0.0, 0.0, 0.0
        self.shown: deque[list[list[float]]] = deque(maxlen=UNSEEN + 1)
        self.heard = clock.monotonic()
        self.refusals, self.stale, self.acted, self.resumed = 0, False, False, False
        self.preparing: dict[str, Any] | None = None
        self.curves: asyncio.Task[None] | None = None
        self.inside = Inside(work, self._send)

    @property
    def at_work(self) -> bool:
        """Whether something is being computed for the visitor."""
        return self.busy or self._moving()

    def attach(self, line: Line) -> None:
        """Use a connection instead of the one before."""
        if self.line is not None:
            self.line.ended.set()
        self.line, self.open, self.heard = line, False, clock.monotonic()

    def resume(self) -> None:
        """Continue over the connection, once the first message has been sent."""
        self.open, self.resumed = True, self.session is not None or self.busy
        self.wake()

    def detach(self, line: Line) -> None:
        """Pause, if that was the connection."""
        if self.line is line:
            self.line, self.open, self.heard = None, False, clock.monotonic()
            self.wake()

    def leave(self) -> None:
        """End: the visitor will not come back."""
        self.left = True
        self.wake()

    async def go(self) -> None:
        """Serve the visitor."""
        try:
            while not self.left:
                ask = await self._next_ask()
                if self.resumed:
                    await self._resume()
                if self.line is None and self.session is None:
                    return  # the visitor is gone, and nothing has been computed yet
                if ask is not None:
                    self.heard = clock.monotonic()
                    await self._answer(ask)
                elif clock.monotonic() - self.heard > self._patience():
                    await self._say(type="ended", sentence=LEFT_ALONE)
                    return
                await self._onward()
                await asyncio.sleep(0)  # let other visits have their turn
        finally:
            self.inside.end()
            if self.curves is not None:
                self.curves.cancel()

    def wake(self) -> None:
        """Check whether there is something to do."""
        with contextlib.suppress(asyncio.QueueFull):  # then it is awake already
            self.asks.put_nowait(None)

    async def _resume(self) -> None:
        """Send the state of the cell over a new connection, with the records that did not arrive."""
        self.resumed = False
        cell = self.session
        if cell is None:
            return
        cell.fresh = [row for rows in self.shown for row in rows] + cell.fresh
        self.shown.clear()
        self.unseen, self.seen_at, self.stale = 0, clock.monotonic(), True
        self.due = clock.monotonic()
        await self._tell()

    async def _next_ask(self) -> messages.Ask | InputError | None:
        """Return the next request, or None when it is time to check whether there is something to do."""
        wait = self._patience() - (clock.monotonic() - self.heard) + 0.1
        if self._moving():
            wait = self.due - clock.monotonic()
        if self._to_show():
            wait = min(wait, self.sent_at + 1 / MOST_PICTURES - clock.monotonic())
        if wait <= 0:
            return None if self.asks.empty() else self.asks.get_nowait()
        try:
            return await asyncio.wait_for(self.asks.get(), wait)
        except TimeoutError:
            return None

    def _patience(self) -> float:
        """Seconds for which a visitor may be silent, or away."""
        if self.session is None:
            return min(BEGINNING, self.idle_seconds) if self.line is not None else 0.0
        return self.idle_seconds if self.line is not None else self.kept_seconds

    def _moving(self) -> bool:
        """Whether the cell runs: it has a time to reach, or it plays and is still watched."""
        if self.session is None or self.line is None or not self.open or self.line.quiet:
            return False
        if self.catching_up is not None or self.goal is not None:
            return True
        return self.playing and (self.unseen < UNSEEN or clock.monotonic() - self.seen_at < PATIENCE)

    def _to_show(self) -> bool:
        """Whether the page lacks the newest picture and is ready for it."""
        return self.stale and self.open and self.unseen < UNSEEN + self.acted

    async def _onward(self) -> None:
        """Compute for a moment if it is time, and send a picture if one is due."""
        cell = self.session
        if cell is None:
            return
        if self._moving() and clock.monotonic() >= self.due:
            try:
                arrived = await self.work.forward(cell, self._prepare)
            except InputError as error:
                self.playing, self.catching_up, self.goal = False, None, None
                await self._refuse(error)
                await self._tell()
                return
            if arrived:
                self.stale = True
                if self.catching_up is not None and cell.live.t >= instant(self.catching_up):
                    self.catching_up = None
                    await self._tell()
                hurried = self.catching_up is not None or self.goal is not None
                pause = 0.0 if hurried else cell.live.every / self.speed
                if self.goal is not None and cell.live.frame >= self.goal:
                    self.goal = None
                # Time that was lost is not made up for.
                self.due = max(self.due + pause, clock.monotonic() - pause)
        if self._to_show() and clock.monotonic() - self.sent_at >= 1 / MOST_PICTURES:
            await self._show()

    async def _answer(self, ask: messages.Ask | InputError) -> None:
        self.busy = True
        try:
            if isinstance(ask, InputError):
                raise ask
            if ask.n is not None:
                self.done = ask.n
            await self._do(ask)
            self.refusals = 0
        except InputError as error:
            self.refusals += 1
            await self._refuse(error)
            self.left = self.refusals >= REFUSALS
        finally:
            self.busy = False

    async def _do(self, ask: messages.Ask) -> None:
        if isinstance(ask, messages.Seen):
            self.unseen, self.seen_at = max(0, self.unseen - 1), clock.monotonic()
            if self.shown:
                self.shown.popleft()
            return
        if isinstance(ask, messages.Resume | messages.Sign):
            raise InputError("message", ask.do, "the first on a connection", "reload the page")
        if isinstance(ask, messages.Begin):
            await self._begin(ask)
            return
        cell = self.session
        if cell is None:
            raise InputError("cell", None, "begun", "begin one")
        if isinstance(ask, messages.Reach):
            self.playing, self.due = False, clock.monotonic()
            self.goal = ask.frame if ask.frame > cell.live.frame else None
            self.stale = self.stale or self.goal is None
            return
        if isinstance(ask, messages.Plain):
            await self._plain(ask.do, cell)
            return
        if isinstance(ask, messages.Speed):
            self.speed = ask.value
        elif isinstance(ask, messages.Units):
            cell.setup = cell.setup.scaled(ask.scales.model_dump() if ask.scales else None)
        elif isinstance(ask, messages.Vacuole):
            if ask.on and not cell.surface.straight:
                raise InputError("vacuole", "a closed cell", "that of the cylinder", "begin a cylinder")
            self.inside.turn(ask)
            self.stale = self.stale or ask.on
        elif isinstance(ask, messages.Set):
            await self._act(cell, lambda: cell.change(ask.values))
        elif isinstance(ask, messages.Drug):
            await self._act(cell, lambda: cell.drug(ask.name))
        else:
            await self._act(cell, lambda: cell.brush(ask))
        await self._tell()

    async def _plain(self, what: str, cell: Session) -> None:
        if what == "hash":
            await self._say(type="hash", t=cell.live.t, sha256=await self.work.quickly(cell.digest))
        elif what == "curves":
            if self.curves is None or self.curves.done():  # they take seconds, during which the cell runs
                self.curves = asyncio.create_task(self._curves(cell.live.params_now, cell.surface.straight))
        elif what == "new_seed":
            given = {name: dict(table) for name, table in cell.setup.tables.items()}
            given["initial"]["seed"] = given["initial"].get("seed", 0) + 1
            await self._open(setup.from_tables(given, cell.setup.steps), self.playing)
        elif what == "again":
            await self._open(cell.again(), self.playing, None if cell.own else self.preset)
        elif what == "undo":
            cell.undo()
            self.shown = deque((until(cell.live.t, rows) for rows in self.shown), self.shown.maxlen)
            self.stale, self.acted, self.sent_at, self.due = True, True, 0.0, clock.monotonic()
            await self._tell()
        elif what == "tell":
            await self._tell()
        elif what == "step":
            self.playing, self.goal = False, None
            await self._to_frame(cell, once=True)
            self.stale = True
            await self._tell()
        else:
            self.playing, self.goal = what == "play", None
            self.due = clock.monotonic()
            if not self.playing:
                await self._to_frame(cell)
                self.stale = True  # the picture is of the time that is told
            await self._tell()

    async def _curves(self, params: Parameters, straight: bool) -> None:
        await self._say(type="curves", **await self.work.slowly(lambda: curves(params, straight)))

    async def _begin(self, ask: messages.Begin) -> None:
        scales = ask.scales.model_dump() if ask.scales else None
        if ask.link is not None:
            begun = setup.from_link(ask.link)
            later = begun.until(ask.t) if ask.t is not None else begun
            await self._open(_shown(later, scales), bool(ask.playing))
        elif ask.preset is not None:
            chosen = preset(ask.preset)
            begun = setup.from_tables(chosen.tables, chosen.protocol)
            await self._open(_shown(begun, scales), self.playing, ask.preset)
        else:
            await self._open(_shown(setup.from_tables(ask.setup or {}), scales), self.playing)

    async def _open(self, begun: setup.SetUp, playing: bool, name: str | None = None) -> None:
        self.session = await self.work.opened(begun, self._prepare)
        self.preset, self.playing, self.due = name, playing, clock.monotonic()
        self.catching_up, self.goal = begun.t if begun.t > 0 else None, None
        # Pictures of the previous cell are still in transit; their records are no longer needed.
        self.shown = deque(([] for _ in self.shown), self.shown.maxlen)
        self.begun, self.stale = self.begun + 1, True
        await self._tell(fresh=True)

    async def _act(self, cell: Session, what: Callable[[], None]) -> None:
        await self._to_frame(cell)
        await self.work.act(cell, what, self._prepare)
        self.stale, self.acted, self.sent_at = True, True, 0.0

    async def _to_frame(self, cell: Session, once: bool = False) -> None:
        """Compute up to the next frame if the cell is between two, or with `once` in any case."""
        while once or not cell.live.at_frame:
            if await self.work.forward(cell, self._prepare):
                return

    async def _tell(self, fresh: bool = False) -> None:
        assert self.session is not None
        await self._say(
            type="cell",
            **self.session.words(self.catching_up or 0.0),
            playing=self.playing,
            speed=self.speed,
            catching_up=self.catching_up,
            preset=self.preset,
            begun=self.begun,
            done=self.done,
            fresh=fresh,
            **self.inside.words,
        )

    @contextlib.asynccontextmanager
    async def _prepare(self, what: str, another: bool) -> AsyncIterator[None]:
        """Report that something is being prepared, and when it is; `another` cell, or more of this one."""
        self.preparing = {"sentence": what, "another": another}
        await self._say(type="preparing", **self.preparing)
        try:
            yield
        finally:
            self.preparing = None
            await self._say(type="prepared")

    async def _show(self) -> None:
        cell = self.session
        assert cell is not None
        self.shown.append(cell.fresh)
        picture = await self.work.quickly(cell.picture)
        self.unseen, self.sent_at, self.stale = self.unseen + 1, clock.monotonic(), False
        self.acted = False
        await self._send(picture)
        if cell.shown is not None and cell.surface.straight:
            self.inside.see(Seen(cell.shown, cell.live.grid, cell.live.t, self.begun, self.playing))

    async def _send(self, data: bytes) -> None:
        if self.line is not None and self.open:
            await self.line.show(data)

    async def _refuse(self, error: InputError) -> None:
        await self._say(type="refused", sentence=str(error))

    async def _say(self, **words: Any) -> None:
        if self.line is not None and self.open:
            await self.line.say(json.dumps(words))


def _shown(begun: setup.SetUp, scales: dict[str, float] | None) -> setup.SetUp:
    """Return a set-up with the page's scales, unless it has its own."""
    return begun if scales is None or begun.tables["scales"] else begun.scaled(scales)
