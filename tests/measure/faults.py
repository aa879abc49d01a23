"""Sweeps that are killed at random moments: a worker, the client, or everything at once; then finished."""

from __future__ import annotations

import os
import random
import subprocess
import sys
import time
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

import psutil

from cyclosis.sweep.store.store import Store

from .files import COMMAND
from .sweeps import differences

KINDS = ("worker", "client", "everything")
ORPHAN_SECONDS = 10.0
"""How long a worker may outlive its client."""
FINISH_SECONDS = 600.0
"""How long a sweep may take to be finished."""
TESTS = Path(__file__).parents[1]
TINY = """
[parameters]
d_s = 0.1
[grid]
n_theta = 16
n_z = 16
[initial]
filaments_per_square = 50.0
[axes]
alpha_p = { start = 0.2, stop = 1.0, count = 6 }
alpha_u = { values = [0.1, 0.3, 0.5, 0.7, 0.9] }
[ensemble]
seeds = 16
block = 16
[run]
t_end = 500.0
"""


@dataclass(frozen=True)
class Blow:
    """What is killed, and when: so many seconds after the start, or as soon as so many blocks stand."""

    kind: str
    seconds: float = 0.0
    blocks: int = 0


@dataclass(frozen=True)
class Round:
    """A sweep that was disturbed and finished: how long workers outlived their client, and what was wrong.

    `standing` counts the blocks that stood at each blow; `wrong` is empty if nothing was.
    """

    standing: tuple[int, ...]
    outlived: float
    wrong: str


def environment(**changes: str) -> dict[str, str]:
    """Return an environment in which this folder's modules are found."""
    return os.environ | {"PYTHONPATH": str(TESTS)} | changes


def made_up_command(seconds: float) -> list[str]:
    """Return the command, less its store, of a sweep of made-up blocks that take some time."""
    return [sys.executable, "-m", "measure.sweeps", "--seconds", str(seconds)]


def real_command(folder: Path) -> list[str]:
    """Write a configuration of some real members into a folder; return the command, less its store."""
    (folder / "tiny.toml").write_text(TINY)
    return [*COMMAND, "sweep", "run", str(folder / "tiny.toml"), "--quiet", "--out"]


def start(command: Sequence[str], store: Path) -> subprocess.Popen[str]:
    """Start a command with a store at its end."""
    return subprocess.Popen(
        [*command, str(store)],
        env=environment(),
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        cwd=store.parent,
    )


def offspring(process: subprocess.Popen[str]) -> list[psutil.Process]:
    """Return the processes that a client has started: its workers."""
    with suppress(psutil.NoSuchProcess):
        return psutil.Process(process.pid).children(recursive=True)
    return []


def orphaned(workers: Sequence[psutil.Process]) -> float:
    """Return how long workers go on without their client, `ORPHAN_SECONDS` at most; then end them."""
    began = time.monotonic()
    _, alive = psutil.wait_procs(workers, timeout=ORPHAN_SECONDS)
    for process in alive:
        with suppress(psutil.NoSuchProcess):
            process.kill()
    return time.monotonic() - began


def disturbed(
    command: Sequence[str], straight: Path, store: Path, blows: Sequence[Blow], rng: random.Random
) -> Round:
    """Start a sweep, strike, start it again, strike ...; at last finish it and compare it with `straight`.

    After a worker was killed the same client is struck by the next blow, if it still runs.
    """
    standing, outlived = [], 0.0
    process: subprocess.Popen[str] | None = None
    for blow in blows:
        if process is None or process.poll() is not None:
            process = start(command, store)
        standing.append(_await(process, store, blow))
        workers = offspring(process)
        if blow.kind == "worker":
            _kill(rng.sample(workers, min(1, len(workers))))
            continue
        if blow.kind == "everything":
            _kill(workers)
        process.kill()
        process.communicate()
        outlived = max(outlived, orphaned(workers))
    if process is None or process.returncode is not None:
        process = start(command, store)
    try:
        _, said = process.communicate(timeout=FINISH_SECONDS)
    except subprocess.TimeoutExpired:
        _kill([*offspring(process), psutil.Process(process.pid)])
        return Round(tuple(standing), outlived, f"it still ran after {FINISH_SECONDS} s")
    wrong = f"exit {process.returncode}: {said}" if process.returncode != 0 else _amiss(straight, store)
    if not wrong and outlived >= ORPHAN_SECONDS:
        wrong = "workers outlived their client"
    return Round(tuple(standing), outlived, wrong)


def _await(process: subprocess.Popen[str], store: Path, blow: Blow) -> int:
    """Wait for the moment of a blow, and return how many blocks stand."""
    began, count = time.monotonic(), 0
    while process.poll() is None:
        count = len(Store(store).present()) if (store / "sweep.json").exists() else 0
        if time.monotonic() - began >= blow.seconds and count >= blow.blocks:
            break
        time.sleep(0.02)
    return count


def _kill(processes: Sequence[psutil.Process]) -> None:
    for process in processes:
        with suppress(psutil.NoSuchProcess):
            process.kill()


def _amiss(straight: Path, store: Path) -> str:
    found = Store(store)
    if found.verify():
        return f"bad blocks: {found.verify()}"
    if found.failed():
        return f"set aside: {found.failed()}"
    other = differences(straight, store)
    found.clean()
    left = [path.name for path in store.rglob("*.new")]
    return f"differs: {other[:5]}" if other else f"left over: {left}" if left else ""
