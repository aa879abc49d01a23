"""Clusters that others have started: connecting to them, and checking their workers."""

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

from ...model.errors import InputError
from ...version import __version__
from ..store.store import Store, versions
from .dask_logging import quiet
from .environment import lacking

DECISIVE = ("jax", "jaxlib", "numpy", "scipy")
"""Packages whose version may change the last digits of results."""
CONNECT_SECONDS = 10.0
VISIBLE_SECONDS = 10.0
"""How long a file may take to appear on another machine of the same file system."""


@dataclass(frozen=True)
class WorkerReport:
    """What a worker reports about itself.

    Its versions of packages, the variables that its environment lacks, its number of threads, the name of a
    small file that it wrote into the store, and the reason why it cannot use the store, or "".
    """

    versions: dict[str, str]
    lacking: tuple[str, ...]
    threads: int
    token: str
    obstacle: str


@contextmanager
def guest_client(address: str | None = None, file: str | os.PathLike[str] | None = None) -> Iterator[Client]:
    """Provide a client of a running cluster, given the address of its scheduler or its scheduler file.

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
            warnings.simplefilter("ignore")  # versions are compared when workers report
            client = Client(place, timeout=CONNECT_SECONDS, set_as_default=False)
        with client:
            yield client


async def _reached(address: str | None) -> None:
    """Raise `OSError` or `ValueError` unless there is a server at an address."""
    comm = await connect(address, timeout=CONNECT_SECONDS, **Security().get_connection_args("client"))
    await comm.close()


def worker_report(folder: str, digest: str, dask_worker: Worker) -> WorkerReport:
    """Return the report of the worker that runs this."""
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
    return WorkerReport(versions(), lacking(os.environ), threads, token, obstacle)


async def confirmed(folder: Path, report: Any) -> Any:
    """Return a worker's report, with an obstacle if the file that it wrote does not appear here."""
    if not isinstance(report, WorkerReport) or report.obstacle:
        return report
    deadline = time.monotonic() + VISIBLE_SECONDS
    while time.monotonic() < deadline:
        try:
            (folder / report.token).unlink()
        except FileNotFoundError:
            await asyncio.sleep(0.1)
        else:
            return report
    return replace(report, obstacle="what it writes there does not arrive here")


def obstacle(reports: Mapping[str, Any]) -> str:
    """Return a sentence saying why a worker cannot be used, or ""."""
    for address, report in reports.items():
        found = _obstacle(report)
        if found:
            return f"the worker at {address} cannot be used: {found}."
    return ""


def remarks(reports: Mapping[str, Any]) -> str:
    """Return a sentence with advice about workers that can be used, or ""."""
    known = [report for report in reports.values() if isinstance(report, WorkerReport)]
    out = []
    missing = sorted({name for report in known for name in report.lacking})
    if missing:
        out.append("their environment lacks " + ", ".join(missing))
    threads = max((report.threads for report in known), default=1)
    if threads > 1:
        out.append(f"{threads} threads in one hinder each other, start it with --nthreads 1")
    here = versions()
    for name in DECISIVE:
        other = sorted({report.versions.get(name, "none") for report in known} - {here[name]})
        if other:
            out.append(f"{name} {', '.join(other)} instead of {here[name]} may change last digits")
    advice = "some workers of this cluster are not set up well: " + "; ".join(out)
    return f"{advice} (see docs/sweeps.md, On a cluster)." if out else ""


def _obstacle(report: Any) -> str:
    if isinstance(report, ImportError):
        return f"it lacks a package ({report}); install cyclosis where it runs"
    if not isinstance(report, WorkerReport):
        return " ".join(f"it does not answer ({type(report).__name__}: {report})".split())
    if report.versions["cyclosis"] != __version__:
        return f"it has cyclosis {report.versions['cyclosis']} and not {__version__}; install the same"
    return f"it does not reach the store ({report.obstacle.rstrip('.')})" if report.obstacle else ""
