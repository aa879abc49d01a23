"""Clusters that others have started: reaching them, and whether their workers are fit for a sweep."""

from __future__ import annotations

import asyncio
import json
import os
import time
import uuid
import warnings
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from distributed import Client, Security, Worker
from distributed.comm.core import connect

from ..model.errors import InputError
from ..version import __version__
from .environment import lacking
from .quiet import quiet
from .store import Store, versions

DECISIVE = ("jax", "jaxlib", "numpy", "scipy")
"""Packages of which another version may change the last digits of results."""
CONNECT_SECONDS = 10.0
VISIBLE_SECONDS = 10.0
"""How long a file may take to appear on another machine of the same file system."""


@dataclass(frozen=True)
class Greeting:
    """What a worker says of itself.

    Its versions of packages, the variables that its environment lacks, its threads, a small file that it
    wrote into the store, and what stands in its way there (empty: nothing).
    """

    versions: dict[str, str]
    lacking: tuple[str, ...]
    threads: int
    token: str
    obstacle: str


@contextmanager
def guest_client(address: str | None = None, file: str | os.PathLike[str] | None = None) -> Iterator[Client]:
    """Provide a client of a running cluster, given the scheduler's address or its scheduler file.

    Raises `InputError` if it cannot be reached.
    """
    with quiet():
        try:
            place = address if file is None else str(json.loads(Path(file).read_text())["address"])
            asyncio.run(_reached(place))
        except (OSError, ValueError, KeyError, TypeError, ImportError) as error:
            field, value = ("scheduler", address) if file is None else ("scheduler_file", str(file))
            reason = " ".join(str(error).split())[:120] or type(error).__name__
            rule = "that of a Dask scheduler that can be reached from here"
            raise InputError(field, value, rule, f"check that it runs ({reason})") from error
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # versions are looked at when workers are greeted
            client = Client(place, timeout=CONNECT_SECONDS, set_as_default=False)
        with client:
            yield client


async def _reached(address: str | None) -> None:
    """Raise `OSError` or `ValueError` unless something answers at an address."""
    comm = await connect(address, timeout=CONNECT_SECONDS, **Security().get_connection_args("client"))
    await comm.close()


def greet(folder: str, digest: str, dask_worker: Worker) -> Greeting:
    """Return what the worker that runs this says of itself."""
    token, obstacle = "", ""
    try:
        if Store(folder).digest != digest:
            obstacle = "it finds another sweep there"
        else:
            token = f".greeting-{uuid.uuid4().hex}.new"
            (Path(folder) / token).write_text(dask_worker.address)
    except (InputError, OSError) as error:
        obstacle = str(error)
    threads = dask_worker.state.nthreads
    return Greeting(versions(), lacking(os.environ), threads, token, obstacle)


async def confirmed(folder: Path, told: Any) -> Any:
    """Return what a worker said, with an obstacle if what it wrote into the store does not arrive here."""
    if not isinstance(told, Greeting) or told.obstacle:
        return told
    deadline = time.monotonic() + VISIBLE_SECONDS
    while time.monotonic() < deadline:
        try:
            (folder / told.token).unlink()
        except FileNotFoundError:
            await asyncio.sleep(0.1)
        else:
            return told
    return replace(told, obstacle="what it writes there does not arrive here")


def obstacle(greetings: Mapping[str, Any]) -> str:
    """Return in a sentence why some of the workers cannot be used, or nothing."""
    for address, told in greetings.items():
        found = _obstacle(told)
        if found:
            return f"the worker at {address} cannot be used: {found}."
    return ""


def remarks(greetings: Mapping[str, Any]) -> str:
    """Return in a sentence what would be better about workers that can be used, or nothing."""
    known = [greeting for greeting in greetings.values() if isinstance(greeting, Greeting)]
    out = []
    missing = sorted({name for greeting in known for name in greeting.lacking})
    if missing:
        out.append("their environment lacks " + ", ".join(missing))
    threads = max((greeting.threads for greeting in known), default=1)
    if threads > 1:
        out.append(f"{threads} threads in one hinder each other, start it with --nthreads 1")
    here = versions()
    for name in DECISIVE:
        other = sorted({greeting.versions.get(name, "none") for greeting in known} - {here[name]})
        if other:
            out.append(f"{name} {', '.join(other)} instead of {here[name]} may change last digits")
    told = "some workers of this cluster could do better: " + "; ".join(out)
    return f"{told} (see docs/sweeps.md, On a cluster)." if out else ""


def _obstacle(told: Any) -> str:
    if isinstance(told, ImportError):
        return f"it lacks a package ({told}); install cyclosis where it runs"
    if not isinstance(told, Greeting):
        return " ".join(f"it does not answer ({type(told).__name__}: {told})".split())
    if told.versions["cyclosis"] != __version__:
        return f"it has cyclosis {told.versions['cyclosis']} and not {__version__}; install the same"
    return f"it does not reach the store ({told.obstacle.rstrip('.')})" if told.obstacle else ""
