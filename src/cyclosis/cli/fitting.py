"""The command that fits the model to a measurement."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

from ..model.errors import InputError
from . import targets
from .options import FORCE, NO_PROGRESS, OUTPUT
from .sources import named


def fit(
    file: Annotated[
        Path,
        typer.Argument(
            metavar="FILE",
            help="NetCDF file with P and u, or u with or without angles, over time, component, theta and z.",
            show_default=False,
        ),
    ],
    parameters: Annotated[
        str | None,
        typer.Option(metavar="A,B,...", help="Parameters to report, by default all, as alpha_p,mu,U."),
    ] = None,
    fix: Annotated[
        list[str] | None,
        typer.Option(metavar="NAME=VALUE", help="A value known from elsewhere; may be repeated."),
    ] = None,
    method: Annotated[str, typer.Option(metavar="NAME", help="auto, equation, film or profile.")] = "auto",
    geometry: Annotated[
        list[str] | None,
        typer.Option(
            metavar="NAME=SD",
            help="Uncertainty of the camera's geometry: axis_deg, radius (relative) or centre (in radii); "
            "may be repeated.",
        ),
    ] = None,
    length: Annotated[
        float | None, typer.Option(metavar="NUMBER", help="Period of the cell along its axis, for a film.")
    ] = None,
    window: Annotated[
        float | None,
        typer.Option(
            metavar="NUMBER",
            help="Side of the windows of which vectors are averages, in radii; by default that of the file.",
        ),
    ] = None,
    radius_um: Annotated[
        float | None, typer.Option("--radius-um", metavar="NUMBER", help="Radius of the cell, in µm.")
    ] = None,
    speed_um_per_s: Annotated[
        float | None, typer.Option("--speed-um-s", metavar="NUMBER", help="Unit of speed U, in µm/s.")
    ] = None,
    seed: Annotated[int, typer.Option(metavar="WHOLE", help="Seed of the noise that is added again.")] = 0,
    out: Annotated[
        list[Path] | None,
        typer.Option(
            "--out",
            "-o",
            metavar="FILE",
            help="File to write: a figure (.png, .pdf, .svg, .eps) or numbers (.nc, .csv); may be repeated.",
            rich_help_panel=OUTPUT,
        ),
    ] = None,
    force: FORCE = False,
    quiet: NO_PROGRESS = False,
) -> None:
    """Fit the model to a measured cell: parameters with intervals, and what the film cannot tell."""
    from ..fitting import fit as fitted
    from ..model.scales import Scales
    from ..progress import Bar

    for target in out or []:
        targets.check(target, force, targets.THEORY)
    scales = None
    if (radius_um is None) != (speed_um_per_s is None):
        missing = "speed_um_per_s" if speed_um_per_s is None else "radius_um"
        raise InputError(missing, None, "given with the other scale", f"add --{missing.replace('_', '-')}")
    if radius_um is not None and speed_um_per_s is not None:
        scales = Scales(radius_um, speed_um_per_s)
    names = None if parameters is None else [name.strip() for name in parameters.split(",")]
    with Bar("steps of the fit", hidden=quiet) as bar:
        found = fitted(
            _opened(file),
            names,
            _pairs("fix", fix),
            method,
            scales,
            seed,
            geometry=_pairs("geometry", geometry) or None,
            length=length,
            window=window,
            progress=bar,
        )
    print(found)

    def draw() -> Any:
        from ..figures.fitted import fitted as figure

        return figure(found)

    targets.write(out, draw, found.to_dataset)


def _pairs(option: str, given: list[str] | None) -> dict[str, float]:
    out = {}
    for text in given or []:
        name, _, value = text.partition("=")
        try:
            out[name.strip()] = float(value)
        except ValueError as error:
            raise InputError(option, text, "NAME=VALUE", f"write --{option} mu=0.05, for example") from error
    return out


def _opened(file: Path) -> Any:
    import xarray

    place = named(file)
    try:
        with xarray.open_dataset(place, engine="h5netcdf", decode_times=False) as data:
            return data[[name for name in ("P", "u", "angle") if name in data]].load()
    except (OSError, ValueError, KeyError, RuntimeError) as error:
        reason = " ".join(str(error).split())[:100]
        rule = "a NetCDF file with P and u, or u alone"
        raise InputError("file", str(file), rule, f"check it ({reason})") from error
