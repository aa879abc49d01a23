"""What a visitor did last can be undone: the cell is kept as it was before each intervention."""

from __future__ import annotations

import time as clock
from collections import deque
from typing import Any, NamedTuple

from ..dynamics.live import Live
from ..model.errors import InputError

MOST = 20
"""Interventions that can be undone; each keeps a state, 1 MB or less."""
TOGETHER = 1.0
"""Seconds within which pieces of one gesture, as of a slider that is moved, count as one intervention."""


class Before(NamedTuple):
    """A cell before an intervention, and the parameters that the visitor had changed by then."""

    live: Live
    own: dict[str, Any]


class Undo:
    """The cell before each of the last interventions."""

    def __init__(self) -> None:
        self._kept: deque[Before] = deque(maxlen=MOST)
        self._gesture: tuple[Any, ...] = ()
        self._at = 0.0

    def __len__(self) -> int:
        return len(self._kept)

    def keep(self, before: Before, gesture: tuple[Any, ...]) -> None:
        """Keep a cell, unless the intervention continues the same gesture."""
        now = clock.monotonic()
        if not self._kept or gesture != self._gesture or now - self._at > TOGETHER:
            self._kept.append(before)
        self._gesture, self._at = gesture, now

    def back(self) -> Before:
        """Return the cell before the last intervention. Raises `InputError` if there is none."""
        if not self._kept:
            raise InputError("undo", "nothing", "asked for after an intervention", "change something first")
        self._gesture = ()
        return self._kept.pop()
