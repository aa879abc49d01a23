"""The command for virtual experiments."""

from __future__ import annotations

import os
import sys
from pathlib import Path
from typing import Annotated, Any

import typer

from ..model.devices import VARIABLE, require_platforms
from ..model.errors import choice
from ..model.units import chosen_scales
from . import targets
from .looks import within_looks
from .options import FORCE, NO_PROGRESS, OUTPUT


@within_looks("colours", "font", "style")
def experiment(
    name: Annotated[
        str | None,
        typer.Argument(
            metavar="NAME", help="An experiment; list shows them; all runs all.", show_default=False
        ),
    ] = None,
    seeds: Annotated[
        int | None, typer.Option(metavar="WHOLE", help="Number of seeds; each has its own default.")
    ] = None,
    quick: Annotated[bool, typer.Option("--quick", help="Few seeds, and less of everything.")] = False,
    workers: Annotated[
        int | None, typer.Option(metavar="WHOLE", min=1, help="Processes; by default one per core.")
    ] = None,
    fresh: Annotated[
        bool, typer.Option("--fresh", help="Compute all members again, also those that are stored.")
    ] = False,
    out: Annotated[
        Path,
        typer.Option(
            "--out", metavar="FOLDER", help="Folder for datasets and figures.", rich_help_panel=OUTPUT
        ),
    ] = Path("experiments"),
    kind: Annotated[
        str,
        typer.Option(
            "--as", metavar="NAME", help="Format of figures: png, pdf, svg or eps.", rich_help_panel=OUTPUT
        ),
    ] = "png",
    force: FORCE = False,
    quiet: NO_PROGRESS = False,
) -> None:
    """Run a virtual experiment: a claim of the paper, a dataset, a figure, and a verdict."""
    from ..dynamics.interrupts import terminable
    from ..experiments import NAMES, perform
    from ..progress import ExperimentLines
    from ..report import experiments as report

    if name is None or name == "list":
        print(report.catalogue())
        if name is None:
            hint = "cyclosis: name one of these experiments, or all: `cyclosis experiment NAME`."
            print(hint, file=sys.stderr)
            raise typer.Exit(2)
        return
    choice("as", kind, tuple(suffix[1:] for suffix in targets.FIGURE))
    require_platforms(os.environ.get(VARIABLE, ""))
    choice("experiment", name, ("list", "all", *NAMES))
    progress = None if quiet else ExperimentLines()
    shown: dict[str, Any] = {"scales": chosen_scales(), "figure": kind}
    done = []
    for each in NAMES if name == "all" else (name,):
        try:
            with terminable():
                done.append(perform(each, out, seeds, quick, workers, force, progress, fresh, **shown))
        except KeyboardInterrupt as stopped:
            typer.echo(f"{each} was interrupted; the same command continues from there.", err=True)
            raise typer.Exit(130) from stopped
        print(report.outcome(done[-1]))
    if len(done) > 1:
        print(report.summary(done))
