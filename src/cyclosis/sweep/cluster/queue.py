"""The order in which blocks are computed, and which block is to blame when a worker dies."""

from __future__ import annotations

import math
from array import array
from collections import Counter, deque
from collections.abc import Iterable, Iterator

GOLDEN = (math.sqrt(5.0) - 1.0) / 2.0


def spread(count: int, start: int = 0) -> Iterator[int]:
    """Yield 0 ... count - 1, each once, so that those yielded so far always cover the range evenly.

    The k-th is start + k s modulo count, where the stride s, close to the golden section of count, has no
    common divisor with it. The blocks computed first are then a representative sample: the remaining time can
    be estimated from them, and no run of costly neighbours is left for the end. Two clients with different
    starts rarely compute the same block at the same time.
    """
    stride = _stride(count)
    for k in range(count):
        yield (start + k * stride) % count


def _stride(count: int) -> int:
    near = max(1, round(count * GOLDEN))
    return next(
        s for d in range(count + 1) for s in (near + d, near - d) if s > 0 and math.gcd(s, count) == 1
    )


ATTEMPTS = 3
"""A block that has failed, or whose worker has died, this many times is given up."""


class BlockQueue:
    """The blocks still to be computed, in order, then those to be tried again, then the suspects.

    When a worker dies, the block that it was computing is lost, and so are those that were waiting there: it
    is unknown which of them killed it. A block whose workers died too often is therefore a suspect: it is
    tried once more, alone, after all other blocks, and it is to blame only if its worker dies again.
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

    def retry(self, index: int) -> None:
        """Try a block again that is not to blame for its failure."""
        self._again.append(index)

    def failed(self, index: int) -> bool:
        """Record that a block has failed, and return whether it is given up."""
        self._failures[index] += 1
        if self._failures[index] < ATTEMPTS:
            self._again.append(index)
            return False
        return True

    def died(self, index: int, deaths: int, alone: bool) -> bool:
        """Record that workers of a block have died `deaths` times, and return whether it is given up."""
        self._deaths[index] += deaths
        if self._deaths[index] < ATTEMPTS:
            self._again.append(index)
        elif not alone:
            self._suspects.append(index)
        else:
            return True
        return False

    def deaths(self, index: int) -> int:
        """Return how many times a worker of a block has died."""
        return self._deaths[index]
