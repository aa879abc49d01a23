"""The command that compares a measured cell with a run."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

from . import targets
from .measured import OUT, SUFFIXES
from .options import FORCE, QUIET, UNITS
from .sources import of_run


def compare(
    file: Annotated[
        Path, typer.Argument(metavar="CELL", help="File of `cyclosis measure`, .nc.", show_default=False)
    ],
    run: Annotated[
        Path, typer.Argument(metavar="RUN", help="NetCDF file of a run.", show_default=False, callback=of_run)
    ],
    time: Annotated[
        float | None,
        typer.Option(
            "--time", metavar="T", help="Time of the run, R/U; by default all saved ones are tried."
        ),
    ] = None,
    speed: Annotated[
        float | None,
        typer.Option("--speed", metavar="U", help="U in the unit of the measured speeds; by default fitted."),
    ] = None,
    mirrored: Annotated[
        bool | None,
        typer.Option(
            "--mirrored/--not-mirrored",
            help="Take one of the mirror images; by default both.",
            show_default=False,
        ),
    ] = None,
    radius_um: Annotated[
        float | None,
        typer.Option(
            "--radius-um",
            metavar="NUMBER",
            help="Radius of the cell in micrometres, if CELL does not know it.",
            rich_help_panel=UNITS,
        ),
    ] = None,
    speed_um_s: Annotated[
        float | None,
        typer.Option(
            "--speed-um-s",
            metavar="NUMBER",
            help="U in micrometres per second, instead of --speed.",
            rich_help_panel=UNITS,
        ),
    ] = None,
    out: OUT = None,
    force: FORCE = False,
    quiet: QUIET = False,
) -> None:
    """Find the shift, rotation, mirror image and time of a run that fit a measured flow best."""
    from ..observations import compare as comparison

    for target in out or []:
        targets.check(target, force, SUFFIXES)
    units: dict[str, Any] = {"radius_um": radius_um, "speed_um_s": speed_um_s}
    found = comparison(file, run, time=time, speed=speed, mirrored=mirrored, **units)
    if not quiet:
        print(found)
    targets.write(out, found.figure, lambda: found.dataset)
