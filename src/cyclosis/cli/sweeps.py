"""Commands for sweeps: plan, run, status, verify, repair, export."""

from __future__ import annotations

import json
import os
import shlex
import sys
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from ..model.devices import VARIABLE, require_platforms
from ..model.errors import InputError
from .options import FORCE, NO_PROGRESS, OUTPUT, QUIET, RADIUS, SPEED, command, commands
from .sources import of_store

if TYPE_CHECKING:
    from distributed import Client

    from ..sweep.cluster.progress import SweepSummary

sweeps = commands("Compute many cells over a grid of parameters.")

CONFIG = Annotated[Path, typer.Argument(metavar="CONFIG", help="Configuration file of a sweep.")]
STORE = Annotated[
    Path, typer.Argument(metavar="STORE", help="Folder of a sweep's results.", callback=of_store)
]
WORKERS = Annotated[
    int | None,
    typer.Option(
        metavar="WHOLE", min=1, help="Processes to start here; by default one per core, or one per GPU."
    ),
]
SCHEDULER = Annotated[
    str | None, typer.Option(metavar="ADDRESS", help="Dask scheduler of a running cluster to use instead.")
]
SCHEDULER_FILE = Annotated[
    Path | None, typer.Option(metavar="FILE", help="The same, given as the scheduler's file.")
]
JSON = Annotated[
    bool,
    typer.Option("--json", help="Print progress and outcome as lines of JSON.", rich_help_panel=OUTPUT),
]


def plan(config: CONFIG, workers: WORKERS = None) -> None:
    """Show what a sweep will compute, and estimate its cost from a few members computed now."""
    from ..sweep.cluster.environment import idlest_cores, processes, settle, wanted

    count = workers or processes(os.environ)
    os.environ.update(wanted(os.environ))  # the environment of a worker, set before JAX is loaded
    settle(idlest_cores()[0])

    from ..report import sweep as report
    from ..sweep.cluster.estimate import estimate
    from ..sweep.plan.sweep import Sweep

    chosen = Sweep.from_toml(config)
    print(report.plan(chosen, estimate(chosen, count)))


def run(
    config: CONFIG,
    out: Annotated[
        Path, typer.Option(metavar="STORE", help="Folder for the results.", rich_help_panel=OUTPUT)
    ],
    workers: WORKERS = None,
    scheduler: SCHEDULER = None,
    scheduler_file: SCHEDULER_FILE = None,
    json_lines: JSON = False,
    quiet: QUIET = False,
) -> None:
    """Compute a sweep into a store, or the part of it that is missing."""
    from ..sweep.execute import run_sweep
    from ..sweep.plan.sweep import Sweep

    chosen = Sweep.from_toml(config)
    with _client(scheduler, scheduler_file, workers) as client, _watching(json_lines, quiet) as progress:
        summary = _ended(lambda: run_sweep(chosen, out, client, workers=workers, progress=progress))
    place = _again(scheduler=scheduler, scheduler_file=scheduler_file, workers=workers)
    _end(summary, ["run", str(config), "--out", str(out)], place, out, json_lines, quiet)


def repair(
    store: STORE,
    workers: WORKERS = None,
    scheduler: SCHEDULER = None,
    scheduler_file: SCHEDULER_FILE = None,
    json_lines: JSON = False,
    quiet: QUIET = False,
) -> None:
    """Recompute the damaged blocks of a store, and compute those that are missing or were set aside."""
    from ..sweep.execute import repair as mend

    with _client(scheduler, scheduler_file, workers) as client, _watching(json_lines, quiet) as progress:
        summary = _ended(lambda: mend(store, client, workers=workers, progress=progress))
    place = _again(scheduler=scheduler, scheduler_file=scheduler_file, workers=workers)
    _end(summary, ["repair", str(store)], place, store, json_lines, quiet)


def status(store: STORE, quiet: NO_PROGRESS = False) -> None:
    """Show the progress of a sweep, and the outcomes of its members."""
    from ..progress import Bar
    from ..report import sweep as report
    from ..sweep.store.store import Store

    with Bar("blocks", hidden=quiet) as bar:
        text = report.status(Store(store), bar)
    print(text)


def verify(store: STORE, quiet: NO_PROGRESS = False) -> None:
    """Check every byte of a store, and name the blocks that are missing or damaged."""
    from ..progress import Bar
    from ..report import sweep as report
    from ..sweep.store.store import Store

    found = Store(store)
    with Bar("blocks", hidden=quiet) as bar:
        bad = found.verify(lambda done: bar(done, found.sweep.blocks))
    print(report.verified(found, bad))
    raise typer.Exit(1 if bad else 0)


def export(
    store: STORE,
    out: Annotated[
        Path,
        typer.Option(
            metavar="FILE", help="What to write: .zarr, .nc, .csv or .csv.gz.", rich_help_panel=OUTPUT
        ),
    ],
    radius_um: RADIUS = None,
    speed_um_s: SPEED = None,
    force: FORCE = False,
) -> None:
    """Write the results in a store to one file for other programs."""
    from ..model.units import of_table
    from ..sweep.export import export as write
    from ..sweep.store.store import Store

    given = {"radius_um": radius_um, "speed_um_s": speed_um_s}
    known = Store(store).sweep.tables.get("scales", {})
    scales = of_table(known | {name: value for name, value in given.items() if value is not None})
    print(f"saved {write(store, out, force=force, scales=scales)}")


@contextmanager
def _client(address: str | None, file: Path | None, workers: int | None) -> Iterator[Client | None]:
    """Provide a client of the cluster that was named, if one was."""
    if address is None and file is None:
        require_platforms(os.environ.get(VARIABLE, ""))  # before workers set all blocks aside
        yield None
        return
    if address is not None and file is not None:
        raise InputError("scheduler_file", str(file), "left out if scheduler is given", "give one of the two")
    if workers is not None:
        raise InputError("workers", workers, "left out if a scheduler is given", "start them on its cluster")
    from ..sweep.cluster.running_cluster import guest_client

    with guest_client(address, file) as client:
        yield client


@contextmanager
def _watching(json_lines: bool, quiet: bool) -> Iterator[Any]:
    """Provide the display of progress; each warning becomes a sentence."""
    from ..progress import SweepBar, SweepLines

    with warnings.catch_warnings():
        warnings.showwarning = lambda message, *_, **__: print(f"cyclosis: {message}", file=sys.stderr)
        if json_lines:
            yield SweepLines()
        else:
            with SweepBar(hidden=quiet) as bar:
                yield bar


def _ended(work: Callable[[], SweepSummary]) -> SweepSummary:
    """Return how a sweep ended, even if Ctrl-C or SIGTERM ended it."""
    from ..dynamics.interrupts import carried, terminable

    try:
        with terminable():
            return work()
    except KeyboardInterrupt as stopped:
        summary: SweepSummary = carried(stopped)
        return summary


def _again(**given: object) -> list[str]:
    """Return the options that were given, as on the command line."""
    options = {f"--{name.replace('_', '-')}": value for name, value in given.items() if value is not None}
    return [word for name, value in options.items() for word in (name, str(value))]


def _end(
    summary: SweepSummary, again: list[str], place: list[str], store: Path, json_lines: bool, quiet: bool
) -> None:
    from dataclasses import asdict

    from ..report import sweep as report
    from ..report.lines import aligned

    if json_lines:
        print(json.dumps({"event": "end", **asdict(summary)}))
    elif not (quiet and summary.ok):
        print(report.ended(summary))
        if summary.status == "incomplete":
            repair = shlex.join(["cyclosis", "sweep", "repair", str(store), *place])
            print(aligned({"to try again": repair}))
        elif not summary.ok:
            print(aligned({"to continue": shlex.join(["cyclosis", "sweep", *again, *place])}))
    raise typer.Exit({"complete": 0, "interrupted": 130}.get(summary.status, 1))


command(sweeps, "sweep plan sweep.toml")(plan)
command(sweeps, "sweep run sweep.toml --out store", "sweep run sweep.toml --out store --workers 4 --json")(
    run
)
command(sweeps, "sweep status store")(status)
command(sweeps, "sweep verify store")(verify)
command(sweeps, "sweep repair store")(repair)
command(sweeps, "sweep export store --out store.nc")(export)
