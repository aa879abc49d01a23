"""The kinds of cell among the presets, compiled before anyone needs them."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress

from ..model.errors import InputError
from .presets import PRESETS
from .session import Kind, kind_at
from .setup import SetUp, from_tables
from .visits import Visits


def cells() -> Iterator[SetUp]:
    """Yield one set-up of every kind that a preset begins with or reaches."""
    met: set[Kind] = set()
    for preset in PRESETS:
        ready = from_tables(preset.tables, preset.protocol).ready()
        for time in (0.0, *ready.schedule.times):
            # Later steps are applied at once, so that the cell is of the kind that it has at that time.
            steps = tuple(step | {"at": max(0.0, step["at"] - time)} for step in preset.protocol)
            begun = from_tables(preset.tables, steps)
            kind = kind_at(begun.ready().schedule, ready.grid)
            if kind not in met:
                met.add(kind)
                yield begun


async def prepare(visits: Visits) -> None:
    """Compile what the presets need, one kind after another, while nothing is computed for visitors."""
    for begun in list(cells()):
        await visits.at_rest()
        with suppress(InputError):
            await visits.work.prepared_ahead(begun)
