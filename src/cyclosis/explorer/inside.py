"""The flow inside the cell, for a visitor who asked for it: tracers, and the axial velocity on a section.

It is computed from the flow of the picture that was last sent, in a thread of its own, and touches neither
the cell nor its pictures. Tracers move at the pace of the page's specks, in the flow as it is at the moment,
so that their motion can be seen at every speed of the cell, and in a weak flow.
"""

from __future__ import annotations

import asyncio
import json
import struct
import time as clock
from collections.abc import Awaitable, Callable
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np

from ..model.grid import Array, CylinderGrid
from . import messages
from .work import Work

KIND = 1
"""The second number of a message, which is 0 in a picture."""
EVERY, SHARE = 0.12, 4.0
"""Least seconds between two messages, and at least so many times the processor's time that one took."""
LATEST = 0.5
"""Most seconds of motion in one message."""
SLOWS_BELOW = 0.15
"""Below this share of the largest flow so far, tracers slow down with it, as the page's specks do."""
RINGS, SECTORS = 12, 64
"""Points of the section: radii from the axis to the wall, and angles."""


@dataclass(frozen=True, eq=False)
class Seen:
    """What a picture showed: the flow `u` (2, n_theta, n_z) on a grid at time `t`, of the cell `begun`."""

    u: Array
    grid: CylinderGrid
    t: float
    begun: int
    playing: bool


class Tracers:
    """The tracers of one cell, `count` of them; `pace` is in radii per second at the peak of the flow."""

    def __init__(self, grid: CylinderGrid, count: int, pace: float) -> None:
        from ..vacuole.live import scattered

        self.grid = grid
        self.xyz = scattered(count, grid.length)
        self.pace = pace * (grid.length / 12 if grid.length > 12 else min(1.0, grid.length))
        self.largest = 0.0
        r, theta = np.linspace(0, 1, RINGS)[:, None], 2 * np.pi / SECTORS * np.arange(SECTORS)
        places = np.broadcast_arrays(r * np.cos(theta), r * np.sin(theta), 0.5 * grid.length)
        self.section = np.stack(places).reshape(3, -1)

    def message(self, seen: Seen, seconds: float) -> bytes:
        """Return the data of a message (see `web/src/protocol.ts`) after `seconds` of motion."""
        from ..vacuole import flow
        from ..vacuole.live import LONGEST, Interior

        interior = Interior(flow(self.grid, seen.u))
        peak = float(np.hypot(*seen.u).max())
        self.largest = max(self.largest, peak)
        reference = max(peak, SLOWS_BELOW * self.largest)
        if seconds > 0 and reference > 1e-12:
            distance = min(self.pace * seconds, 8 * LONGEST)
            self.xyz = interior.carried(self.xyz, distance / reference, reference)
        header = {
            "t": seen.t,
            "begun": seen.begun,
            "tracers": self.xyz.shape[1],
            "rings": RINGS,
            "sectors": SECTORS,
            "length": self.grid.length,
            "reference": reference,
        }
        text = json.dumps(header).encode()
        head = struct.pack("<II", len(text), KIND) + text.ljust(-(-len(text) // 8) * 8)
        axial = interior.at(np.concatenate([self.xyz, self.section], axis=1))[2]
        return head + np.concatenate([self.xyz.ravel(), axial]).astype("<f4").tobytes()


class Inside:
    """Sends messages after pictures as long as the visitor wants them. `show` sends one."""

    def __init__(self, work: Work, show: Callable[[bytes], Awaitable[None]]) -> None:
        self.work, self.show = work, show
        self.wanted: messages.Vacuole | None = None
        self.seen: Seen | None = None
        self.fresh = asyncio.Event()
        self.task: asyncio.Task[None] | None = None
        self.moved_at = self.due = 0.0

    @property
    def words(self) -> dict[str, Any]:
        """What the page is told of it with its cell: nothing unless it asked."""
        return {"vacuole": self.wanted.tracers} if self.wanted else {}

    def turn(self, ask: messages.Vacuole) -> None:
        """Begin, change or end; what is wanted already goes on."""
        if ask.on and self.wanted is not None and self.wanted.model_copy(update={"n": ask.n}) == ask:
            return
        self.end()
        self.wanted = ask if ask.on else None
        self.task = asyncio.create_task(self._watch(ask)) if ask.on else None

    def see(self, seen: Seen) -> None:
        """A picture was sent."""
        if self.wanted is not None:
            self.seen = seen
            self.fresh.set()

    def end(self) -> None:
        """Send nothing more."""
        self.seen = None
        self.fresh.clear()
        if self.task is not None:
            self.task.cancel()

    async def _watch(self, ask: messages.Vacuole) -> None:
        of, tracers = -1, None
        while True:
            await asyncio.sleep(max(0.0, self.due - clock.monotonic()))
            await self.fresh.wait()
            self.fresh.clear()
            if (seen := self.seen) is None:
                continue
            began = clock.monotonic()
            seconds = min(LATEST, began - self.moved_at) if seen.playing else 0.0
            self.moved_at, self.due = began, began + EVERY
            if tracers is None or of != seen.begun:
                of, tracers = seen.begun, Tracers(seen.grid, ask.tracers, ask.pace)
            data, spent = await self.work.aside(partial(_timed, tracers, seen, seconds))
            self.due = began + max(EVERY, SHARE * spent)
            await self.show(data)


def _timed(tracers: Tracers, seen: Seen, seconds: float) -> tuple[bytes, float]:
    """Return a message, and the processor's time that it took, in seconds."""
    began = clock.thread_time()
    return tracers.message(seen, seconds), clock.thread_time() - began
