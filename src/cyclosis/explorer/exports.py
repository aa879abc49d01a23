"""A cell as files: its configuration, its dataset, its movie, each made anew from what its link holds.

Runs and movies are made by a process of their own, which ends with its work or when nobody waits for it any
more: neither its memory nor its load is the visitors'.
"""

from __future__ import annotations

import asyncio
import json
import os
import sys
from collections.abc import Awaitable, Callable
from pathlib import Path
from typing import Any

from ..model.errors import InputError
from . import setup

MOST = 4000
"""Frames of a run that is exported as a file."""
MOST_VALUES = MOST * 64 * 64
"""Grid points of all its frames together."""
MOVIE_FRAMES = 144
FILES = {"cell.toml": "application/toml", "run.nc": "application/x-netcdf", "movie.mp4": "video/mp4"}
"""Files by name, with their types."""


class Refused(Exception):
    """A file that cannot be made; the message says why in a sentence."""


async def make(name: str, link: str, folder: Path, left: Callable[[], Awaitable[bool]]) -> Path:
    """Make a file in a folder and return its path.

    Raises `InputError` or `Refused` for a cell of which it cannot be made, and `ConnectionAbortedError` once
    `left` says that nobody waits.
    """
    cell, target = setup.from_link(link), folder / name
    if name == "cell.toml":
        target.write_text(cell.toml(), encoding="utf-8")
        return target
    _check(cell)
    pipe, nowhere = asyncio.subprocess.PIPE, asyncio.subprocess.DEVNULL
    command = sys.executable, "-m", __name__, str(target)
    maker = await asyncio.create_subprocess_exec(*command, stdin=pipe, stdout=pipe, stderr=nowhere)
    said = asyncio.create_task(maker.communicate(link.encode()))
    try:
        while not (await asyncio.wait({said}, timeout=0.5))[0]:
            if await left():
                raise ConnectionAbortedError("the visitor has left")
    finally:
        if maker.returncode is None:
            maker.kill()
        words, _ = await said
    if maker.returncode:
        raise Refused(json.loads(words) if words else "The file could not be made: try again.")
    return target


def _check(cell: setup.SetUp) -> None:
    frames = cell.t / cell.every
    if frames < 1:
        rule = f"at least {cell.every:g}, one frame"
        raise InputError("t", cell.t, rule, "let the cell go on, then export it")
    points = [cell.filled()["grid"][key] for key in ("n_theta", "n_z")]
    most = min(MOST, MOST_VALUES // (points[0] * points[1]))
    if frames > most:
        rule = f"at most {most} in a file made here of {points[0]} x {points[1]} points"
        raise InputError("frames", round(frames), rule, "use the TOML with cyclosis run")


def _run(cell: setup.SetUp) -> Any:
    from ..dynamics.simulate import simulate

    ready = cell.ready()
    return simulate(
        ready.params,
        ready.grid,
        ready.state,
        cell.t,
        cell.every,
        protocol=ready.protocol,
        provenance={"initial": ready.initial},
    )


def _main(target: Path, link: str) -> None:
    """Make one file."""
    try:
        run = _run(setup.from_link(link))
        if target.name == "run.nc":
            from .. import dataset

            dataset.write(run, target)
        else:
            from ..figures.movie import movie

            movie(run.to_dataset(), target, frames=MOVIE_FRAMES, workers=1)
    except InputError as error:
        print(json.dumps(str(error)))
        sys.exit(1)


if __name__ == "__main__":
    if hasattr(os, "nice"):
        os.nice(10)
    _main(Path(sys.argv[1]), sys.stdin.read())
