"""One visitor, from connection to farewell: asks come in, the cell goes on at its pace, pictures go out."""

from __future__ import annotations

import asyncio
import json
import time as clock
from collections.abc import Callable
from dataclasses import replace
from typing import Any, Protocol

from ..model.errors import InputError
from ..model.parameters import Parameters
from . import messages, setup
from .about import curves, preset
from .session import Session
from .work import Work

WAITING = 64
"""Asks that may wait; beyond, the connection is read no further."""
UNSEEN = 2
"""Pictures that may be on their way before the page says that it has drawn one; one more after an action."""
PATIENCE = 5.0
"""Seconds for which a cell goes on while the page draws nothing, as one in a hidden tab."""
BEGINNING = 30.0
"""Seconds within which a visitor begins a cell."""
MOST_PICTURES = 30.0
"""Pictures sent in a second."""
REFUSALS = 20
"""Refused asks in a row after which the visit ends."""


class Wire(Protocol):
    """What a visit needs of a connection."""

    async def text(self) -> str:
        """Return the next message; raise once the visitor has left."""

    async def say(self, text: str) -> None:
        """Send text."""

    async def show(self, data: bytes) -> None:
        """Send a picture."""


class Visit:
    """A visitor's session and its pace. `go` returns when the visitor leaves or is idle too long."""

    def __init__(self, wire: Wire, work: Work, idle_seconds: float) -> None:
        self.wire, self.work, self.idle_seconds = wire, work, idle_seconds
        self.asks: asyncio.Queue[str] = asyncio.Queue(WAITING)
        self.session: Session | None = None
        self.preset: str | None = None
        self.playing, self.speed = False, 5.0
        self.catching_up: float | None = None
        self.unseen, self.seen_at, self.sent_at, self.due = 0, 0.0, 0.0, 0.0
        self.refusals, self.stale, self.acted = 0, False, False
        self.curves: asyncio.Task[None] | None = None

    async def go(self) -> None:
        """Serve the visitor."""
        reader = asyncio.create_task(self._read())
        try:
            heard = clock.monotonic()
            while True:
                ask = await self._next_ask(heard)
                if ask is not None:
                    heard = clock.monotonic()
                    if ask == "":
                        return
                    await self._answer(ask)
                elif clock.monotonic() - heard > self._patience():
                    words = "This cell was left alone for long and has ended: reload the page to go on."
                    await self._say(type="ended", sentence=words)
                    return
                await self._onward()
                await asyncio.sleep(0)  # asks that wait are not answered before those of others
        finally:
            reader.cancel()
            if self.curves is not None:
                self.curves.cancel()

    async def _read(self) -> None:
        try:
            while True:
                await self.asks.put(await self.wire.text())
        except Exception:
            await self.asks.put("")

    async def _next_ask(self, heard: float) -> str | None:
        """Return the next ask, or None when it is time to compute."""
        wait = self._patience() - (clock.monotonic() - heard) + 0.1
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
        """Seconds for which a visitor may say nothing."""
        return self.idle_seconds if self.session is not None else min(BEGINNING, self.idle_seconds)

    def _moving(self) -> bool:
        """Whether the cell goes on: someone waits for a time of it, or lets it play and still looks."""
        if self.session is None or self.catching_up is not None:
            return self.session is not None
        return self.playing and (self.unseen < UNSEEN or clock.monotonic() - self.seen_at < PATIENCE)

    def _to_show(self) -> bool:
        """Whether the page lacks the newest picture and can take it."""
        return self.stale and self.unseen < UNSEEN + self.acted

    async def _onward(self) -> None:
        """Compute a moment if it is time, and show what there is to show."""
        cell = self.session
        if cell is None:
            return
        if self._moving() and clock.monotonic() >= self.due:
            try:
                arrived = await self.work.forward(cell)
            except InputError as error:
                self.playing, self.catching_up = False, None
                await self._refuse(error)
                await self._tell()
                return
            if arrived:
                self.stale = True
                if self.catching_up is not None and cell.live.t >= self.catching_up - 1e-9:
                    self.catching_up = None
                    await self._tell()
                pause = 0.0 if self.catching_up is not None else cell.live.every / self.speed
                # What could not be kept up with is not made up for.
                self.due = max(self.due + pause, clock.monotonic() - pause)
        if self._to_show() and clock.monotonic() - self.sent_at >= 1 / MOST_PICTURES:
            await self._show()

    async def _answer(self, text: str) -> None:
        try:
            await self._done(messages.understood(text))
            self.refusals = 0
        except InputError as error:
            self.refusals += 1
            await self._refuse(error)
            if self.refusals >= REFUSALS:
                raise ConnectionError("too many refused asks") from error

    async def _done(self, ask: messages.Ask) -> None:
        if isinstance(ask, messages.Seen):
            self.unseen, self.seen_at = max(0, self.unseen - 1), clock.monotonic()
            return
        if isinstance(ask, messages.Begin):
            await self._begin(ask)
            return
        cell = self.session
        if cell is None:
            raise InputError("cell", None, "begun", "begin one")
        if isinstance(ask, messages.Plain):
            await self._plain(ask.do, cell)
            return
        if isinstance(ask, messages.Speed):
            self.speed = ask.value
        elif isinstance(ask, messages.Change):
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
            if self.curves is None or self.curves.done():  # they take seconds, in which the cell goes on
                self.curves = asyncio.create_task(self._curves(cell.live.params_now))
        elif what == "new_seed":
            given = {name: dict(table) for name, table in cell.setup.tables.items()}
            given["initial"]["seed"] = given["initial"].get("seed", 0) + 1
            await self._open(setup.from_tables(given, cell.setup.steps), self.playing)
        elif what == "tell":
            await self._tell()
        elif what == "step":
            self.playing = False
            await self._to_frame(cell, once=True)
            self.stale = True
            await self._tell()
        else:
            self.playing = what == "play"
            self.due = clock.monotonic()
            if not self.playing:
                await self._to_frame(cell)
            await self._tell()

    async def _curves(self, params: Parameters) -> None:
        await self._say(type="curves", **await self.work.slowly(lambda: curves(params)))

    async def _begin(self, ask: messages.Begin) -> None:
        if ask.link is not None:
            await self._open(setup.from_link(ask.link), False)
        elif ask.preset is not None:
            chosen = preset(ask.preset)
            await self._open(setup.from_tables(chosen.tables, chosen.protocol), self.playing, ask.preset)
        else:
            await self._open(setup.from_tables(ask.setup or {}), self.playing)

    async def _open(self, begun: setup.SetUp, playing: bool, name: str | None = None) -> None:
        self.session = await self.work.opened(begun)
        self.preset, self.playing, self.due = name, playing, clock.monotonic()
        self.catching_up = begun.t if begun.t > 0 else None
        self.stale = True
        await self._tell(fresh=True)

    async def _act(self, cell: Session, what: Callable[[], None]) -> None:
        await self._to_frame(cell)
        await self.work.act(cell, what)
        self.stale, self.acted, self.sent_at = True, True, 0.0

    async def _to_frame(self, cell: Session, once: bool = False) -> None:
        """Go on to the next frame, if the cell stands between two, or `once` in any case."""
        while once or not cell.live.at_frame:
            if await self.work.forward(cell):
                return

    async def _tell(self, fresh: bool = False) -> None:
        cell = self.session
        assert cell is not None
        live, told = cell.live, cell.told()
        if self.catching_up is not None:  # an address that is copied now keeps the time it asks for
            told = replace(told, t=max(told.t, self.catching_up))
        in_force = {
            name: value if not getattr(value, "ndim", 0) else float(value.mean())
            for name, value in live.params_now.items()
        }
        await self._say(
            type="cell",
            setup=cell.setup.filled(),
            parameters=in_force,
            special=cell.special(),
            protocol=[{"at": step.at, "text": str(step)} for step in live.protocol],
            link=told.link(),
            t=live.t,
            playing=self.playing,
            speed=self.speed,
            catching_up=self.catching_up,
            preset=self.preset,
            fresh=fresh,
        )

    async def _show(self) -> None:
        assert self.session is not None
        picture = await self.work.quickly(self.session.picture)
        self.unseen, self.sent_at, self.stale = self.unseen + 1, clock.monotonic(), False
        self.acted = False
        await self.wire.show(picture)

    async def _refuse(self, error: InputError) -> None:
        await self._say(type="refused", sentence=str(error))

    async def _say(self, **words: Any) -> None:
        await self.wire.say(json.dumps(words))
