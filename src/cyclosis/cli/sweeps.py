"""Commands for sweeps: plan, run, status, verify, repair, export."""

from __future__ import annotations

import json
import os
import shlex
import sys
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from ..model.errors import InputError
from .options import FORCE, QUIET, commands

if TYPE_CHECKING:
    from distributed import Client

    from ..sweep.tally import SweepSummary

sweeps = commands("Compute many cells over a grid of parameters.")

CONFIG = Annotated[Path, typer.Argument(metavar="CONFIG", help="Configuration file of a sweep.")]
STORE = Annotated[Path, typer.Argument(metavar="STORE", help="Folder of a sweep's results.")]
WORKERS = Annotated[
    int | None, typer.Option(min=1, help="Processes to start here; by default one a core, or one a GPU.")
]
SCHEDULER = Annotated[
    str | None, typer.Option(metavar="ADDRESS", help="Dask scheduler of a running cluster to use instead.")
]
SCHEDULER_FILE = Annotated[
    Path | None, typer.Option(metavar="FILE", help="The same, given by the scheduler's file.")
]
JSON = Annotated[bool, typer.Option("--json", help="Print progress and outcome as JSON, a line each.")]


@sweeps.command()
def plan(config: CONFIG, workers: WORKERS = None) -> None:
    """Show what a sweep will compute, and estimate its cost from a few members computed now."""
    from ..sweep.environment import idlest_cores, processes, settle, wanted

    count = workers or processes(os.environ)
    os.environ.update(wanted(os.environ))  # as a worker would have it, before JAX is loaded
    settle(idlest_cores()[0])

    from ..report import sweep as report
    from ..sweep.estimate import estimate
    from ..sweep.plan import Sweep

    chosen = Sweep.from_toml(config)
    print(report.plan(chosen, estimate(chosen, count)))


@sweeps.command()
def run(
    config: CONFIG,
    out: Annotated[Path, typer.Option(metavar="STORE", help="Folder for the results.")],
    workers: WORKERS = None,
    scheduler: SCHEDULER = None,
    scheduler_file: SCHEDULER_FILE = None,
    json_lines: JSON = False,
    quiet: QUIET = False,
) -> None:
    """Compute a sweep into a store; or what the store lacks of it."""
    from ..sweep.execute import run_sweep
    from ..sweep.plan import Sweep

    chosen = Sweep.from_toml(config)
    with _client(scheduler, scheduler_file, workers) as client, _watching(json_lines, quiet) as progress:
        summary = run_sweep(chosen, out, client, workers=workers, progress=progress)
    place = _again(scheduler=scheduler, scheduler_file=scheduler_file, workers=workers)
    _end(summary, ["run", str(config), "--out", str(out)], place, out, json_lines)


@sweeps.command()
def repair(
    store: STORE,
    workers: WORKERS = None,
    scheduler: SCHEDULER = None,
    scheduler_file: SCHEDULER_FILE = None,
    json_lines: JSON = False,
    quiet: QUIET = False,
) -> None:
    """Compute again what is damaged in a store, and what is missing or was set aside."""
    from ..sweep.execute import repair as mend

    with _client(scheduler, scheduler_file, workers) as client, _watching(json_lines, quiet) as progress:
        summary = mend(store, client, workers=workers, progress=progress)
    place = _again(scheduler=scheduler, scheduler_file=scheduler_file, workers=workers)
    _end(summary, ["repair", str(store)], place, store, json_lines)


@sweeps.command()
def status(store: STORE, quiet: QUIET = False) -> None:
    """Show how far a sweep is, and what its members have become."""
    from ..progress import Bar
    from ..report import sweep as report
    from ..sweep.store import Store

    with Bar("blocks", hidden=quiet) as bar:
        text = report.status(Store(store), bar)
    print(text)


@sweeps.command()
def verify(store: STORE, quiet: QUIET = False) -> None:
    """Check every byte of a store, and name the blocks that are missing or damaged."""
    from ..progress import Bar
    from ..report import sweep as report
    from ..sweep.store import Store

    found = Store(store)
    with Bar("blocks", hidden=quiet) as bar:
        bad = found.verify(lambda done: bar(done, found.sweep.blocks))
    print(report.verified(found, bad))
    raise typer.Exit(1 if bad else 0)


@sweeps.command()
def export(
    store: STORE,
    out: Annotated[Path, typer.Option(help="What to write: .zarr, .nc, .csv or .csv.gz.")],
    force: FORCE = False,
) -> None:
    """Write the results in a store to one file for other programs."""
    from ..sweep.export import export as write

    print(f"saved {write(store, out, force=force)}")


@contextmanager
def _client(address: str | None, file: Path | None, workers: int | None) -> Iterator[Client | None]:
    """Provide a client of the cluster that was named, if one was."""
    if address is None and file is None:
        yield None
        return
    if address is not None and file is not None:
        raise InputError("scheduler_file", str(file), "left out beside scheduler", "give one of the two")
    if workers is not None:
        raise InputError("workers", workers, "left out beside a scheduler", "start them on its cluster")
    from ..sweep.guests import guest_client

    with guest_client(address, file) as client:
        yield client


@contextmanager
def _watching(json_lines: bool, quiet: bool) -> Iterator[Any]:
    """Provide what shows progress; warnings become a sentence each."""
    from ..progress import SweepBar, SweepLines

    with warnings.catch_warnings():
        warnings.showwarning = lambda message, *_, **__: print(f"cyclosis: {message}", file=sys.stderr)
        if json_lines:
            yield SweepLines()
        else:
            with SweepBar(hidden=quiet) as bar:
                yield bar


def _again(**given: object) -> list[str]:
    """Return those options that were given, as they were."""
    options = {f"--{name.replace('_', '-')}": value for name, value in given.items() if value is not None}
    return [word for name, value in options.items() for word in (name, str(value))]


def _end(summary: SweepSummary, again: list[str], place: list[str], store: Path, json_lines: bool) -> None:
    from dataclasses import asdict

    from ..report import sweep as report
    from ..report.lines import aligned

    if json_lines:
        print(json.dumps({"event": "end", **asdict(summary)}))
    else:
        print(report.ended(summary))
        if summary.status == "incomplete":
            repair = shlex.join(["cyclosis", "sweep", "repair", str(store), *place])
            print(aligned({"to try again": repair}))
        elif not summary.ok:
            print(aligned({"to go on": shlex.join(["cyclosis", "sweep", *again, *place])}))
    raise typer.Exit({"complete": 0, "interrupted": 130}.get(summary.status, 1))
