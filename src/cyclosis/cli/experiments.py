"""The command for virtual experiments."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from ..model.errors import choice
from .options import FORCE, QUIET

if TYPE_CHECKING:
    from ..sweep.tally import SweepProgress


def experiment(
    name: Annotated[
        str, typer.Argument(metavar="NAME", help="An experiment; list shows them; all does all.")
    ],
    seeds: Annotated[int | None, typer.Option(help="Number of seeds; each has its own default.")] = None,
    out: Annotated[
        Path, typer.Option("--out", metavar="DIR", help="Folder for datasets and figures.")
    ] = Path("experiments"),
    quick: Annotated[bool, typer.Option("--quick", help="Few seeds, and less of everything.")] = False,
    workers: Annotated[int | None, typer.Option(min=1, help="Processes; by default one a core.")] = None,
    force: FORCE = False,
    quiet: QUIET = False,
) -> None:
    """Do a virtual experiment: a claim of the paper, a dataset, a figure, and a verdict."""
    from ..experiments import NAMES, perform
    from ..report import experiments as report

    if name == "list":
        print(report.catalogue())
        return
    choice("experiment", name, ("list", "all", *NAMES))
    told = None if quiet else _told
    done = []
    for each in NAMES if name == "all" else (name,):
        done.append(perform(each, out, seeds, quick, workers, force, told))
        print(report.outcome(done[-1]))
    if len(done) > 1:
        print(report.summary(done))


def _told(label: str, now: SweepProgress) -> None:
    if now.done == now.total:
        typer.echo(f"  {label}: {now.total} runs in {now.seconds:.0f} s", err=True)
