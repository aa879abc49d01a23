"""Figures of a run in memory: what `run.plot` offers."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from matplotlib.figure import Figure

from ..display.shown import shown
from ..dynamics.trajectory import Trajectory
from .style import WIDTH, signed

__all__ = [
    "Plot",
]


def __dir__() -> list[str]:
    return sorted(__all__)


Paths = str | os.PathLike[str] | Sequence[str | os.PathLike[str]]
"""The name of one movie, or those of several."""


@shown
class Plot:
    """The figures of one run, each a matplotlib figure that a notebook shows; called, that of its course.

    Save them with `figure.savefig`, or with `cyclosis.figures.style.save`, which also writes the SHA-256 of
    the configuration into the file. Colours, fonts and style sheets are chosen by
    `with cyclosis.figures.looks.chosen(...)`. A run with scales is drawn in units.

    Example:
        >>> import cyclosis as cy
        >>> params, grid = cy.Parameters(), cy.CylinderGrid(16, 16)
        >>> run = cy.simulate(params, grid, cy.initial.stripes(grid, magnitude=0.5), t_end=5.0)
        >>> len(run.plot().axes), len(run.plot.snapshot(2.0, view="map", width=89.0).axes)
        (10, 2)
        >>> len(run.plot.history().axes)
        6
        >>> [path.name for path in run.plot.movie("cell.gif", frames=2, seconds=0.5, workers=1)]
        ['cell.gif']
    """

    def __init__(self, run: Trajectory) -> None:
        self._run = run

    def __call__(self, **how: Any) -> Figure:
        """Return the figure of the run over time, as `cyclosis.figures.emergence.emergence`."""
        from .emergence import emergence

        data = self._run.to_dataset()
        return signed(emergence(data, **how), data)

    def snapshot(self, time: float | None = None, view: str = "both", width: float = WIDTH) -> Figure:
        """Return the figure of one moment, by default the end: see `cyclosis.figures.snapshot.snapshot`."""
        from .snapshot import snapshot

        data = self._run.to_dataset()
        return signed(snapshot(data, time, view, width), data)

    def history(self, width: float = WIDTH) -> Figure:
        """Return the figure of order, speed and power over time: see `cyclosis.figures.history.history`."""
        from .history import history

        data = self._run.to_dataset()
        return signed(history(data, width), data)

    def movie(
        self, paths: str | os.PathLike[str] | Sequence[str | os.PathLike[str]], **how: Any
    ) -> list[Path]:
        """Write the movie of the run, and return the paths: see `cyclosis.figures.movie.movie`."""
        from .movie import movie

        return movie(self._run.to_dataset(), paths, **how)

    def __repr__(self) -> str:
        return "run.plot(), run.plot.snapshot(time), run.plot.history(), run.plot.movie(path)"
