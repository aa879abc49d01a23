"""The order in which the blocks of a sweep are computed."""

from __future__ import annotations

import math
from collections.abc import Iterator

GOLDEN = (math.sqrt(5.0) - 1.0) / 2.0


def spread(count: int, start: int = 0) -> Iterator[int]:
    """Yield 0 ... count - 1, each once, so that at every moment those yielded cover the range evenly.

    The k-th is start + k s modulo count, where the stride s, next to the golden section of count, has no
    divisor in common with it. What was computed first is then a fair sample of the whole: the time left can
    be told from it, and no row of costly neighbours is left for the end. Two clients with different starts
    are far apart for most of their way.
    """
    stride = _stride(count)
    for k in range(count):
        yield (start + k * stride) % count


def _stride(count: int) -> int:
    near = max(1, round(count * GOLDEN))
    return next(
        s for d in range(count + 1) for s in (near + d, near - d) if s > 0 and math.gcd(s, count) == 1
    )
