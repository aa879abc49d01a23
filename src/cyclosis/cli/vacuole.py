"""The command that draws the flow in the vacuole of a run, and writes it."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from ..model.errors import InputError
from . import targets
from .options import FILE, FORCE, OUTPUT

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from ..vacuole import UnsteadyFlow, VacuoleFlow

MOVIE_FRAMES = 97
"""Frames of the movie of dye."""


def _section(flow: VacuoleFlow, P: Any, z: float) -> Figure:
    from ..figures.vacuole_section import vacuole_section

    return vacuole_section(flow, z)


def _cutaway(flow: VacuoleFlow, P: Any, z: float) -> Figure:
    from ..figures.frames import facing_zone
    from ..figures.vacuole_cutaway import vacuole_cutaway

    return vacuole_cutaway(flow, P, facing_zone(P) + math.pi)


def _pitch(flow: VacuoleFlow, P: Any, z: float) -> Figure:
    from ..figures.vacuole_pitch import vacuole_pitch

    return vacuole_pitch()


FIGURES: dict[str, Callable[[VacuoleFlow, Any, float], Figure]] = {
    "section.png": _section,
    "cutaway.png": _cutaway,
    "circulation.png": _pitch,
}
"""The figures by the names of their files: functions of the flow, P, and the place of the section."""


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
    dye: Annotated[
        float | None,
        typer.Option(
            "--dye",
            metavar="PE",
            help="Write dye.mp4 as well: a drop of dye carried during the run at this Péclet number.",
        ),
    ] = None,
    force: FORCE = False,
) -> None:
    """Draw the flow inside the cell at one time: a section, the cell cut open, circulation by pitch."""
    from .. import dataset
    from ..figures import style
    from ..figures.frames import frame, grid_of, indices_at
    from ..vacuole import flow as flow_of
    from ..vacuole.sampled import peclet_number

    folder = out or file.with_name(f"{file.stem}-vacuole")
    names = [
        *FIGURES,
        *(("volume.nc", "volume.vts") if volume else ()),
        *(("dye.mp4",) if dye is not None else ()),
    ]
    with dataset.open_dataset(file) as data:
        grid = grid_of(data)
        index = -1 if time is None else indices_at(data, [time], "time")[0]
        place = 0.5 * grid.length if section is None else section
        if dye is not None:  # before anything is written
            peclet_number(dye)
            if data.sizes["time"] < 2:
                rule = "at least 2, to carry dye from one to the next"
                raise InputError("the number of saved frames", data.sizes["time"], rule, "save more often")
        _prepare(folder, names, force)
        shown, flow, P = float(data["time"][index]), flow_of(data.isel(time=index)), frame(data, index)[0]
        for name, figure in FIGURES.items():
            style.save(figure(flow, P, place), folder / name)
            print(f"saved {folder / name}")
        if volume:
            dataset.write_table(flow.to_dataset(), folder / "volume.nc")
            flow.to_vtk(folder / "volume.vts")
            print(f"saved {folder / 'volume.nc'}\nsaved {folder / 'volume.vts'}")
        if dye is not None:
            _dye(flow_of(data), dye, folder / "dye.mp4")
            print(f"saved {folder / 'dye.mp4'}")
    per_area = flow.dissipation / (2 * math.pi * grid.length)
    print(f"t = {shown:g}: the vacuole dissipates {per_area:.6g} ηU²/R per area of the wall")


def _dye(flow: UnsteadyFlow, peclet: float, path: Path) -> None:
    """Write the movie of a drop of dye that is released in the middle at the first frame of a run."""
    import numpy as np

    from ..figures.dye import dye
    from ..vacuole import transport

    length = flow.grid.length
    first, last = float(flow.times[0]), float(flow.times[-1])

    def drop(r: Any, theta: Any, z: Any) -> Any:
        apart = length / np.pi * np.sin(np.pi * (z / length - 0.5))
        return np.exp(-4 * (r**2 + apart**2)) + 0 * theta

    shown = np.linspace(first, last, MOVIE_FRAMES)
    dye(transport(flow, peclet, start=drop, t_end=last, times=shown, frames=shown, n_r=24), path)


def _prepare(folder: Path, names: list[str], force: bool) -> None:
    """Make the folder, and refuse it before any work is done if a file is in the way."""
    targets.check_folder(folder, "several files are written")
    try:
        folder.mkdir(exist_ok=True)
    except OSError as error:
        rule = "a folder that can be written to"
        raise InputError("out", str(folder), rule, f"choose another ({error.strerror or error})") from error
    for name in names:
        targets.check(folder / name, force, (".png", ".nc", ".vts", ".mp4"))
