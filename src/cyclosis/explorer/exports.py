"""A cell as files: its configuration, its dataset, its movie, each made anew from what its link holds."""

from __future__ import annotations

import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

from ..model.errors import InputError
from .setup import SetUp

MOST = 4000
"""Frames of a run that is exported as a file."""
MOVIE_FRAMES = 144


def toml(cell: SetUp, alive: Callable[[], bool]) -> bytes:
    """Return the configuration that `cyclosis run` takes."""
    return cell.toml().encode()


def netcdf(cell: SetUp, alive: Callable[[], bool]) -> bytes:
    """Return the run's NetCDF file, computed by `simulate`."""
    from .. import dataset

    with tempfile.TemporaryDirectory(prefix="cyclosis-") as folder:
        return dataset.write(_run(cell, alive), Path(folder) / "run.nc").read_bytes()


def movie(cell: SetUp, alive: Callable[[], bool]) -> bytes:
    """Return the run's movie as MP4."""
    from ..figures.movie import movie as drawn

    def watch(done: int, total: int) -> None:
        _go_on(alive)

    run = _run(cell, alive)
    with tempfile.TemporaryDirectory(prefix="cyclosis-") as folder:
        target = Path(folder) / "movie.mp4"
        drawn(run.to_dataset(), target, frames=MOVIE_FRAMES, progress=watch, workers=1)
        return target.read_bytes()


FILES: dict[str, tuple[str, Callable[[SetUp, Callable[[], bool]], bytes]]] = {
    "cell.toml": ("application/toml", toml),
    "run.nc": ("application/x-netcdf", netcdf),
    "movie.mp4": ("video/mp4", movie),
}
"""Files by name: their type and how they are made."""


def _run(cell: SetUp, alive: Callable[[], bool]) -> Any:
    from ..dynamics.simulate import simulate

    frames = cell.t / cell.every
    if not 1 <= frames <= MOST:
        raise InputError(
            "frames", round(frames), f"from 1 to {MOST} in a file made here", "use the TOML with cyclosis run"
        )
    ready = cell.ready()
    return simulate(
        ready.params,
        ready.grid,
        ready.state,
        cell.t,
        cell.every,
        protocol=ready.protocol,
        progress=lambda now: _go_on(alive),
        provenance={"initial": ready.initial},
    )


def _go_on(alive: Callable[[], bool]) -> None:
    if not alive():
        raise ConnectionAbortedError("the visitor has left")
