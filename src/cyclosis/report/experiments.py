"""Virtual experiments in a few lines of text."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence
from typing import TYPE_CHECKING

from ..model.units import scales_in, scales_text

if TYPE_CHECKING:
    from ..experiments import Performance

WIDTH = 100


def catalogue() -> str:
    """Return every experiment with the claim that it tests."""
    from ..experiments import NAMES, experiment

    longest = max(map(len, NAMES))
    rows = []
    for name in NAMES:
        claim = textwrap.wrap(experiment(name).claim, WIDTH - longest - 2)
        rows.append(f"{name:<{longest}}  {claim[0]}")
        rows += [" " * (longest + 2) + line for line in claim[1:]]
    return "\n".join(rows)


def outcome(done: Performance) -> str:
    """Return what an experiment found."""
    lines = [
        f"{done.experiment.name}: {done.verdict.outcome.upper()}",
        *_paragraph("claim", done.experiment.claim),
        *_paragraph("measured", done.verdict.measured),
        *_units(done),
        f"{'saved':>10}  {done.file}, {done.figure}",
    ]
    return "\n".join(lines)


def _units(done: Performance) -> list[str]:
    """Return the scales of the cell that was chosen, in words."""
    scales = scales_in(done.dataset)
    return [] if scales is None else _paragraph("units", scales_text(scales))


def summary(done: Sequence[Performance]) -> str:
    """Return the verdicts of many experiments, one a line."""
    longest = max(len(each.experiment.name) for each in done)
    return "\n".join(f"{each.experiment.name:<{longest}}  {each.verdict.outcome}" for each in done)


def _paragraph(name: str, text: str) -> list[str]:
    lines = textwrap.wrap(text, WIDTH - 12)
    return [f"{name if k == 0 else '':>10}  {line}" for k, line in enumerate(lines)]
