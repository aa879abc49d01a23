"""All visits of a server: admitting new ones, resuming those whose connection was lost, and ending others.

A visit whose connection is lost is kept for a while, paused, under a token that only its page knows. It still
counts as a session, but is dropped for a new visitor when all sessions are taken.
"""

from __future__ import annotations

import asyncio
import json
import secrets

from ..model.errors import InputError
from . import messages
from .line import Line, Wire, understood
from .visit import Visit
from .work import Work

FIRST = 10.0
"""Seconds within which a connection must send its first request."""
OVER, LATER = 1000, 1013
"""Codes with which a connection is closed: its visit is over, or the visitor should try again later."""
REST = 3.0
"""Seconds without any computation before something is prepared ahead."""


class Visits:
    """The visits of a server, at most `most`, by token."""

    def __init__(self, work: Work, most: int, idle_seconds: float, kept_seconds: float) -> None:
        self.work, self.most, self.idle_seconds, self.kept_seconds = work, most, idle_seconds, kept_seconds
        self.all: dict[str, Visit] = {}
        self.tasks: dict[str, asyncio.Task[None]] = {}

    async def serve(self, wire: Wire) -> int:
        """Serve a connection until it ends, and return the code to close it with.

        Raises the error of a connection that fails before it belongs to a visit.
        """
        first: messages.Ask | InputError | None = understood(await asyncio.wait_for(wire.text(), FIRST))
        visit, known = None, isinstance(first, messages.Resume)
        if isinstance(first, messages.Resume):
            visit, first = self.all.get(first.token), None
            if visit is None or visit.left:  # one that was left may still be busy with its last request
                visit, known = None, False
                await wire.say(json.dumps({"type": "forgotten"}))
                first = understood(await asyncio.wait_for(wire.text(), FIRST))
        visit = visit or self._admitted()
        if visit is None:
            words = f"This server has {self.most} sessions and all are taken: try again later."
            await wire.say(json.dumps({"type": "ended", "sentence": words}))
            return LATER
        line, before = Line(wire), visit.line
        visit.attach(line)  # before anything is awaited, so that its session is taken
        self._count()
        try:
            if before is not None:
                await before.closed.wait()  # requests that it still passes on count as received
            said = {"type": "resumed" if known else "welcome", "token": visit.token}
            await line.say(json.dumps(said | {"received": visit.received, "preparing": visit.preparing}))
            visit.resume()
            await line.hold(visit, first)
        finally:
            visit.detach(line)
            self._count()
        return OVER

    async def at_rest(self) -> None:
        """Return once nothing has been computed for a while."""
        while True:
            for _ in range(10):
                await asyncio.sleep(REST / 10)
                if any(visit.at_work for visit in self.all.values()):
                    break
            else:
                return

    def end(self) -> None:
        """End all visits."""
        for task in self.tasks.values():
            task.cancel()

    def _admitted(self) -> Visit | None:
        """Return a new visit, or None if all sessions are taken."""
        if len(self.all) >= self.most:
            # Drop the one that is away the longest, but none that still computes, to keep the work bounded.
            away = [visit for visit in self.all.values() if visit.line is None and not visit.busy]
            if not away:
                return None
            self._forget(min(away, key=lambda visit: visit.heard))
        visit = Visit(self.work, secrets.token_urlsafe(32), self.idle_seconds, self.kept_seconds)
        self.all[visit.token] = visit
        self.tasks[visit.token] = asyncio.create_task(self._gone(visit))
        return visit

    async def _gone(self, visit: Visit) -> None:
        try:
            await visit.go()
        finally:
            self._forget(visit)

    def _forget(self, visit: Visit) -> None:
        task = self.tasks.pop(visit.token, None)
        self.all.pop(visit.token, None)
        if visit.line is not None:
            visit.line.ended.set()
        if task is not None and task is not asyncio.current_task():
            task.cancel()

    def _count(self) -> None:
        self.work.visits = sum(visit.line is not None for visit in self.all.values())
