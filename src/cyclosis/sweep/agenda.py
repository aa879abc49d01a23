"""What is to be computed next, and which blocks are to blame when things go wrong."""

from __future__ import annotations

from array import array
from collections import Counter, deque
from collections.abc import Iterable

ATTEMPTS = 3
"""A block that fails as often, or whose worker dies as often, is given up."""


class Agenda:
    """The blocks that are still to do, in order, then those to be tried again, then the suspects.

    A worker that dies takes with it what it computes and what waits there for its turn, and nobody can tell
    which of them killed it. A block that has seen too many deaths is therefore a suspect: it is tried once
    more, alone, when all else is done, and to blame only if that kills its worker as well.
    """

    def __init__(self, blocks: Iterable[int]) -> None:
        self._blocks, self._at = array("q", blocks), 0
        self._again: deque[int] = deque()
        self._suspects: deque[int] = deque()
        self._failures: Counter[int] = Counter()
        self._deaths: Counter[int] = Counter()

    def __bool__(self) -> bool:
        return self._at < len(self._blocks) or bool(self._again) or bool(self._suspects)

    def next(self) -> int | None:
        """Return the next block that may be computed beside others, if there is one."""
        if self._at < len(self._blocks):
            self._at += 1
            return self._blocks[self._at - 1]
        return self._again.popleft() if self._again else None

    def next_suspect(self) -> int | None:
        """Return the next block that must be computed alone, if there is one."""
        return self._suspects.popleft() if self._suspects else None

    def unlucky(self, index: int) -> None:
        """Try a block again that is not to blame."""
        self._again.append(index)

    def failed(self, index: int) -> bool:
        """Note that a block has failed, and return whether it is to be given up."""
        self._failures[index] += 1
        if self._failures[index] < ATTEMPTS:
            self._again.append(index)
            return False
        return True

    def died(self, index: int, deaths: int, alone: bool) -> bool:
        """Note how often the worker of a block has died, and return whether the block is to be given up."""
        self._deaths[index] += deaths
        if self._deaths[index] < ATTEMPTS:
            self._again.append(index)
        elif not alone:
            self._suspects.append(index)
        else:
            return True
        return False

    def deaths(self, index: int) -> int:
        """Return how often the worker of a block has died."""
        return self._deaths[index]
