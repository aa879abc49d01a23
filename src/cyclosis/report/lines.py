"""Named lines of text, one under the other."""

from __future__ import annotations

from collections.abc import Mapping


def aligned(lines: Mapping[str, str], width: int = 18) -> str:
    """Return a line for each name, the names flush right in a column of `width`, or wider if they need it."""
    width = max([width, *map(len, lines)])
    return "\n".join(f"{name:>{width}}  {text}" for name, text in lines.items())
