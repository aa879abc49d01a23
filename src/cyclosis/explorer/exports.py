"""A cell as files: its configuration, its dataset, its movie, each made from the contents of its link.

Runs and movies are made in a separate process, which ends with its work or when nobody waits for it any
more, so that neither its memory nor its load affects visitors.
"""

from __future__ import annotations

import asyncio
import contextlib
import json
import sys
from collections.abc import AsyncIterator, Awaitable, Callable
from math import prod
from pathlib import Path
from typing import Any

from ..model.errors import InputError, choice
from ..model.instants import instant
from ..model.wording import beside
from . import setup
from .surfaces import surface_of

MOST = 4000
"""Most frames of a run that is exported as a file."""
MOST_VALUES = MOST * 64 * 64
"""Most grid points of all its frames together."""
FILES = {"cell.toml": "application/toml", "run.nc": "application/x-netcdf", "movie.mp4": "video/mp4"}
"""Files by name, with their types."""
OFTEN = 0.5
"""Seconds between two progress reports on a file, and between checks that the visitor still waits for it."""

Tell = Callable[[dict[str, Any]], Awaitable[None]]
"""Receives the progress of a file: the `share` that is done, or None, and what it is `doing`."""


class Refused(Exception):
    """A file cannot be made; the message says why in a sentence."""


async def nobody(_: dict[str, Any]) -> None:
    """Ignore the progress of a file."""


class Desk:
    """Makes files, one after another."""

    def __init__(self) -> None:
        self.turn = asyncio.Lock()

    async def make(
        self, name: str, link: str, folder: Path, left: Callable[[], Awaitable[bool]], tell: Tell = nobody
    ) -> Path:
        """Make a file in a folder and return its path; `tell` is called with its progress.

        Raises `InputError` or `Refused` for a cell of which it cannot be made, and `ConnectionAbortedError`
        once `left` says that the visitor has gone.
        """
        cell, target = checked(name, link), folder / name
        if name == "cell.toml":
            target.write_text(cell.toml(), encoding="utf-8")
            return target
        now: dict[str, Any] = {"share": None, "doing": "waiting for another file"}
        async with _task(self._made(target, link, now)) as making:
            while not (await asyncio.wait({making}, timeout=OFTEN))[0]:
                if await left():
                    raise ConnectionAbortedError("the visitor has left")
                await tell(now)
            making.result()
        return target

    async def _made(self, target: Path, link: str, now: dict[str, Any]) -> None:
        async with self.turn, _process(target, link) as maker:
            if sentence := await _heard(maker, now):
                raise Refused(sentence)


def checked(name: str, link: str) -> setup.SetUp:
    """Return the cell of a link. Raises `InputError` for one of which a file of that name cannot be made."""
    choice("file", name, tuple(FILES))
    cell = setup.from_link(link)
    if name != "cell.toml":
        _check(cell)
    return cell


@contextlib.asynccontextmanager
async def _task(work: Any) -> AsyncIterator[asyncio.Task[Any]]:
    """Do something concurrently, and cancel it on leaving."""
    task = asyncio.ensure_future(work)
    try:
        yield task
    finally:
        task.cancel()
        await asyncio.wait({task})


@contextlib.asynccontextmanager
async def _process(target: Path, link: str) -> AsyncIterator[asyncio.subprocess.Process]:
    """Start a process that makes a file, and end it on leaving."""
    pipe, nowhere = asyncio.subprocess.PIPE, asyncio.subprocess.DEVNULL
    command = sys.executable, "-m", f"{__package__}.maker", str(target)
    maker = await asyncio.create_subprocess_exec(*command, stdin=pipe, stdout=pipe, stderr=nowhere)
    try:
        assert maker.stdin is not None
        maker.stdin.write(link.encode())
        maker.stdin.close()
        yield maker
    finally:
        if maker.returncode is None:
            with contextlib.suppress(ProcessLookupError):
                maker.kill()
        await maker.wait()


async def _heard(maker: asyncio.subprocess.Process, now: dict[str, Any]) -> str:
    """Keep the messages of a maker in `now` until it ends; return why it failed, or ""."""
    assert maker.stdout is not None
    now["doing"], sentence = "starting", ""
    async for line in maker.stdout:
        with contextlib.suppress(ValueError):
            words = json.loads(line)
            sentence = words.pop("sentence", sentence)
            now.update(words)
    status = await maker.wait()
    if status < 0:
        why = "The server stopped making the file, most likely because memory ran out"
        return f"{why}: use the TOML with cyclosis run."
    return sentence or ("The file could not be made: try again." if status else "")


def _check(cell: setup.SetUp) -> None:
    frames = cell.t / cell.every
    if instant(cell.t) < instant(cell.every):
        rule = f"at least {beside(cell.every, cell.t)}, one frame"
        raise InputError("t", cell.t, rule, "let the cell run, then export it")
    surface, grid = surface_of(cell.grid), cell.grid
    surface.check(grid)
    most = min(MOST, MOST_VALUES // prod(grid.shape))
    if frames > most:
        rule = f"at most {most} in a file made here of {surface.points(grid)} points"
        raise InputError("frames", round(frames), rule, "use the TOML with cyclosis run")
