"""The command that draws the flow in the vacuole of a run, and writes it."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from ..model.errors import InputError, choice
from . import targets
from .looks import looking, width, with_looks
from .options import FILE, FORCE, OUTPUT

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from ..vacuole import UnsteadyFlow, VacuoleFlow

WATER_PA_S = 1e-3
"""Viscosity of water at 20 °C."""
MOVIE_FRAMES = 97
"""Frames of the movie of dye."""


def _section(flow: VacuoleFlow, P: Any, z: float, pitch: float | None, **how: Any) -> Figure:
    from ..figures.vacuole_section import vacuole_section

    return vacuole_section(flow, z, **how)


def _cutaway(flow: VacuoleFlow, P: Any, z: float, pitch: float | None, **how: Any) -> Figure:
    from ..figures.frames import facing_zone
    from ..figures.vacuole_cutaway import vacuole_cutaway

    return vacuole_cutaway(flow, P, facing_zone(P) + math.pi, **how)


def _circulation(flow: VacuoleFlow, P: Any, z: float, pitch: float | None, **how: Any) -> Figure:
    from ..figures.vacuole_pitch import vacuole_pitch

    return vacuole_pitch(**how)


def _uptake(flow: VacuoleFlow, P: Any, z: float, pitch: float | None, **how: Any) -> Figure:
    from ..figures.vacuole_uptake import vacuole_uptake

    return vacuole_uptake(flow, pitch, **how)


def _dispersion(flow: VacuoleFlow, P: Any, z: float, pitch: float | None, **how: Any) -> Figure:
    from ..figures.vacuole_dispersion import vacuole_dispersion

    return vacuole_dispersion(flow, pitch, **how)


def _poincare(flow: VacuoleFlow, P: Any, z: float, pitch: float | None, **how: Any) -> Figure:
    from ..figures.vacuole_poincare import vacuole_poincare

    return vacuole_poincare(flow, z, **how)


FIGURES: dict[str, Callable[..., Figure]] = {
    "section.png": _section,
    "cutaway.png": _cutaway,
    "circulation.png": _circulation,
    "uptake.png": _uptake,
    "dispersion.png": _dispersion,
    "poincare.png": _poincare,
}
"""The figures by the names of their files: functions of the flow, P, the section, a pitch, a width."""


@with_looks
def vacuole(
    file: FILE,
    out: Annotated[
        Path | None,
        typer.Option(
            "--out",
            metavar="DIR",
            help="Folder to write into; by default RUN-vacuole next to FILE.",
            rich_help_panel=OUTPUT,
        ),
    ] = None,
    time: Annotated[
        float | None,
        typer.Option(
            "--time", metavar="T", help="Time in the run: the nearest saved frame; default: the last."
        ),
    ] = None,
    section: Annotated[
        float | None,
        typer.Option(metavar="Z", help="Place of the cross-section, in radii; default: half of the length."),
    ] = None,
    volume: Annotated[
        bool, typer.Option("--volume", help="Write the volume as well, as volume.nc and volume.vts.")
    ] = False,
    uptake: Annotated[
        bool, typer.Option("--uptake", help="Draw how fast the wall takes up against Pe, as uptake.png.")
    ] = False,
    dispersion: Annotated[
        bool,
        typer.Option("--dispersion", help="Draw spreading along the cell against Pe, as dispersion.png."),
    ] = False,
    pitch: Annotated[
        float | None,
        typer.Option(
            metavar="R",
            help="Pitch of the twisted bands that these two compare with straight ones, in radii; by default "
            "that of the run, or one turn in its length.",
        ),
    ] = None,
    poincare: Annotated[
        bool, typer.Option("--poincare", help="Draw where tracers cross the section, as poincare.png.")
    ] = False,
    dye: Annotated[
        float | None,
        typer.Option(
            "--dye",
            metavar="PE",
            help="Write dye.mp4 as well: a drop of dye carried during the run at this Péclet number.",
        ),
    ] = None,
    gif: Annotated[bool, typer.Option("--gif", help="Write the movie of dye as dye.gif as well.")] = False,
    kind: Annotated[
        str,
        typer.Option(
            "--as",
            metavar="NAME",
            help="Format of the figures: png, pdf, svg or eps.",
            rich_help_panel=OUTPUT,
        ),
    ] = "png",
    force: FORCE = False,
    **looks: Any,
) -> None:
    """Draw the flow inside the cell at one time: a section, the cell cut open, circulation by pitch.

    Further figures compare the bands of the run, straight, with twisted ones, and show its paths and dye.
    """
    from .. import dataset
    from ..figures import style
    from ..figures.frames import frame, grid_of, indices_at
    from ..figures.vacuole_bands import compared
    from ..model.units import scales_in, shown_in, time_unit
    from ..vacuole import flow as flow_of
    from ..vacuole.sampled import peclet_number

    folder = out or file.with_name(f"{file.stem}-vacuole")
    wanted = {"uptake.png": uptake, "dispersion.png": dispersion, "poincare.png": poincare}
    choice("as", kind, tuple(suffix[1:] for suffix in targets.FIGURE))
    drawn = [name for name in FIGURES if wanted.get(name, True)]
    movies = [] if dye is None else ["dye.mp4", "dye.gif"][: 1 + gif]
    figures = [f"{Path(name).stem}.{kind}" for name in drawn]
    names = [*figures, *(("volume.nc", "volume.vts") if volume else ()), *movies]
    if pitch is not None and not (uptake or dispersion):
        raise InputError("pitch", pitch, "given with --uptake or --dispersion", "leave it out")
    if gif and dye is None:
        raise InputError("gif", gif, "given with --dye", "give the Péclet number of the dye")
    with dataset.open_dataset(file) as plain:
        data = dataset.with_scales(plain, None, looks["radius_um"], looks["speed_um_s"])
        scales = scales_in(data)
        grid = grid_of(data)
        index = -1 if time is None else indices_at(data, [time], "time")[0]
        place = 0.5 * grid.length if section is None else section
        if dye is not None:  # before anything is written
            peclet_number(dye)
            if data.sizes["time"] < 2:
                rule = "at least 2, to carry dye from one to the next"
                raise InputError("the number of saved frames", data.sizes["time"], rule, "save more often")
        shown, flow, P = float(data["time"][index]), flow_of(data.isel(time=index)), frame(data, index)[0]
        if uptake or dispersion:
            compared(flow, pitch)
        _prepare(folder, names, force)
        for name in drawn:
            target = (folder / name).with_suffix(f".{kind}")
            with shown_in(scales), looking(looks):
                figure = FIGURES[name](flow, P, place, pitch, **width(looks))
                style.save(style.signed(figure, data), target)
            print(f"saved {target}")
        if volume:
            dataset.write_table(flow.to_dataset(), folder / "volume.nc")
            flow.to_vtk(folder / "volume.vts")
            print(f"saved {folder / 'volume.nc'}\nsaved {folder / 'volume.vts'}")
        if dye is not None:
            with shown_in(scales):
                _dye(flow_of(data), dye, [folder / name for name in movies], style.marks(data))
    per_area = flow.dissipation / (2 * math.pi * grid.length)
    when, told = f"t = {shown:g}", f"{per_area:.6g} ηU²/R"
    if scales is not None:
        watts = per_area * WATER_PA_S * (1e-6 * scales.speed_um_per_s) ** 2 / (1e-6 * scales.radius_um)
        when += f" = {time_unit(scales, shown)(shown)}"
        told += f" = {watts:.4g} W/m² for the viscosity of water"
    print(f"{when}: the vacuole dissipates {told} per area of the wall")


def _dye(flow: UnsteadyFlow, peclet: float, paths: list[Path], about: str) -> None:
    """Write the movies of a drop of dye that is released in the middle at the first frame of a run."""
    import numpy as np

    from ..figures.dye import dye
    from ..vacuole import transport

    length = flow.grid.length
    first, last = float(flow.times[0]), float(flow.times[-1])

    def drop(r: Any, theta: Any, z: Any) -> Any:
        apart = length / np.pi * np.sin(np.pi * (z / length - 0.5))
        return np.exp(-4 * (r**2 + apart**2)) + 0 * theta

    shown = np.linspace(first, last, MOVIE_FRAMES)
    carried = transport(flow, peclet, start=drop, t_end=last, times=shown, frames=shown, n_r=24)
    for path in paths:
        dye(carried, path, about=about)
        print(f"saved {path}")


def _prepare(folder: Path, names: list[str], force: bool) -> None:
    """Make the folder, and refuse it before any work is done if a file is in the way."""
    targets.check_folder(folder, "several files are written")
    try:
        folder.mkdir(exist_ok=True)
    except OSError as error:
        rule = "a folder that can be written to"
        raise InputError("out", str(folder), rule, f"choose another ({error.strerror or error})") from error
    for name in names:
        targets.check(folder / name, force, (*targets.FIGURE, ".nc", ".vts", ".mp4", ".gif"))
