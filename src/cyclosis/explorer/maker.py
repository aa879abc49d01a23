"""One file of a cell, made in a separate process, which prints its progress, or why it failed."""

from __future__ import annotations

import json
import os
import sys
import time as clock
from pathlib import Path
from typing import Any

from ..model.errors import InputError
from . import setup

MOVIE_FRAMES = 144
OFTEN = 0.2
"""Least seconds between two progress reports."""
COMPUTING = {"run.nc": 0.9, "movie.mp4": 0.4}
"""Share of the work on a file that computing the run takes."""


class Words:
    """The messages of the process, one JSON object per line."""

    def __init__(self) -> None:
        self.last = 0.0

    def far(self, share: float, doing: str, now: bool = False) -> None:
        """Report the share of the work that is done, 0 to 1, and what is being done; not too often."""
        if now or clock.monotonic() - self.last >= OFTEN:
            self.last = clock.monotonic()
            print(json.dumps({"share": round(share, 4), "doing": doing}), flush=True)

    def failed(self, sentence: str) -> None:
        """Report why there will be no file."""
        print(json.dumps({"sentence": sentence}), flush=True)


def make(target: Path, link: str, words: Words) -> None:
    """Make a file. Raises `InputError` for a cell of which it cannot be made."""
    cell, computing = setup.from_link(link), COMPUTING[target.name]
    words.far(0.0, "preparing the computation", now=True)
    run = _run(cell, computing, words)
    if run.t_final < cell.t:
        found = f"{run.status.value} at t = {run.t_final:g}"
        raise InputError("this cell", found, "one that the grid resolves", "use more grid points")
    if target.name == "run.nc":
        from .. import dataset

        words.far(computing, "writing the data", now=True)
        dataset.write(run, target)
    else:
        from ..figures.movie import movie

        words.far(computing, "preparing the pictures", now=True)

        def drawn(done: int, total: int) -> None:
            share = computing + (1.0 - computing) * done / total
            words.far(share, f"drawing picture {done} of {total}")

        movie(run.to_dataset(), target, frames=MOVIE_FRAMES, workers=1, progress=drawn)


def _run(cell: setup.SetUp, computing: float, words: Words) -> Any:
    from ..dynamics.simulate import simulate

    ready = cell.ready()
    return simulate(
        ready.params,
        ready.grid,
        ready.state,
        cell.t,
        cell.every,
        model=ready.model,
        protocol=ready.protocol,
        provenance={"initial": ready.initial},
        progress=lambda now: words.far(
            computing * now.t / now.t_end, f"computing, t = {now.t:.1f} of {now.t_end:.1f}"
        ),
    )


def reason(error: Exception) -> str:
    """Return a sentence that says why a file could not be made."""
    if isinstance(error, InputError):
        return str(error)
    if isinstance(error, MemoryError):
        return "The server does not have enough memory for this file: use the TOML with cyclosis run."
    if isinstance(error, OSError) and error.strerror:
        return f"The server could not write the file ({error.strerror}): try again later."
    what = " ".join(f"{type(error).__name__}: {error}".split())[:200]
    return f"The file could not be made because of an error in the program ({what}): please report it."


def main(target: Path, link: str) -> int:
    """Make one file; return the exit status."""
    words = Words()
    try:
        make(target, link, words)
    except Exception as error:
        words.failed(reason(error))
        return 1
    return 0


if __name__ == "__main__":
    if hasattr(os, "nice"):
        os.nice(10)
    sys.exit(main(Path(sys.argv[1]), sys.stdin.read()))
