"""The command that shows a run as an instrument would have recorded it."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Annotated, Any

import typer

from ..model.definitions import Definition
from ..model.errors import InputError, choice, number
from .options import FILE, FORCE, OUTPUT

_TIMES = Definition("times", "t", "times", None, "numbers", 0.0, 1e9)
_PAIR = Definition("pair", "-", "two numbers", None, "numbers", -1e9, 1e9)
CAMERA, RECORD = "Microscope", "Record"


def _set(metavar: str, help: str, panel: str = CAMERA, name: str | None = None) -> Any:
    """Return an option with a value."""
    names = () if name is None else (name,)
    return typer.Option(*names, metavar=metavar, help=help, rich_help_panel=panel)


def observe(
    file: FILE,
    as_: Annotated[
        str,
        _set(
            "NAME",
            "Instrument: piv, kymograph, tracks, orientation, mrv or film. Several may be joined with +.",
            RECORD,
            "--as",
        ),
    ] = "piv",
    format: Annotated[
        str | None,
        _set(
            "NAME",
            "Files: openpiv, openpiv-um, pivlab, pivlab-m, pivlab-mat or npy (piv); tiff or npy "
            "(kymograph); trackmate, trackmate-xml or trackpy (tracks); orientationj, npy or tiff "
            "(orientation); tiff, mat or npy (mrv); avi, mp4 or tiff (film).",
            RECORD,
        ),
    ] = None,
    radius_px: Annotated[float, _set("R", "Radius of the moving layer, in pixels.")] = 100.0,
    axis: Annotated[
        float, _set("DEGREES", "Direction of +z in the picture, counter-clockwise from the right.")
    ] = 0.0,
    facing: Annotated[float, _set("DEGREES", "The angle theta that faces the camera.")] = 180.0,
    mirrored: Annotated[
        bool, typer.Option("--mirrored", help="The picture is mirrored.", rich_help_panel=CAMERA)
    ] = False,
    centre: Annotated[
        str | None,
        _set("X,Y", "Place of z = 0 on the axis, in pixels, y down; by default the cell is in the middle."),
    ] = None,
    size: Annotated[
        str | None, _set("W,H", "Size of the picture in pixels; by default the cell is in it.")
    ] = None,
    pixel_um: Annotated[
        float | None,
        _set("UM", "Size of a pixel, in micrometres; by default the radius of FILE over --radius-px, or 5."),
    ] = None,
    frame_s: Annotated[float, _set("S", "Time between two frames, in seconds.")] = 0.3,
    depth_um: Annotated[
        float | None,
        _set("UM", "Depth of field, in micrometres; by default the whole near side is in focus."),
    ] = None,
    noise_px: Annotated[
        float, _set("PX", "Standard deviation of a measured displacement or place, in pixels.")
    ] = 0.1,
    radius_um: Annotated[
        float | None,
        _set("UM", "Radius of the cell, in micrometres, instead of --pixel-um."),
    ] = None,
    speed_um_per_s: Annotated[
        float | None,
        typer.Option(
            "--speed-um-s",
            metavar="UM",
            help="The unit of speed U, in micrometres per second; by default that in FILE, or 100.",
            rich_help_panel=CAMERA,
        ),
    ] = None,
    seed: Annotated[int, _set("N", "Seed of particles and noise.")] = 0,
    times: Annotated[
        str | None,
        _set(
            "T,T,...", "Times in the run (piv, orientation, mrv); default: all frames, or the last.", RECORD
        ),
    ] = None,
    start: Annotated[
        float | None, _set("T", "Time of the first frame (film, kymograph, tracks).", RECORD)
    ] = None,
    frames: Annotated[int | None, _set("N", "Number of frames (film, kymograph, tracks).", RECORD)] = None,
    window_px: Annotated[int | None, _set("PX", "Side of a window (piv); default 32.", RECORD)] = None,
    step_px: Annotated[
        int | None, _set("PX", "Distance of vectors (piv, 16) or of angles (orientation, 12).", RECORD)
    ] = None,
    outliers: Annotated[float | None, _set("X", "Share of wrong vectors (piv).", RECORD)] = None,
    missed: Annotated[
        float | None, _set("X", "Share of spots that are not found (tracks); default 0.05.", RECORD)
    ] = None,
    chloroplasts: Annotated[
        bool,
        typer.Option("--chloroplasts", help="Draw chloroplasts, which stand still.", rich_help_panel=RECORD),
    ] = False,
    line: Annotated[
        str | None, _set("NAME", "Line of a kymograph: along or across the cell.", RECORD)
    ] = None,
    at: Annotated[
        float | None,
        _set("X", "Where it lies: degrees from the middle of the view (along), or z (across).", RECORD),
    ] = None,
    slice_z: Annotated[float | None, _set("Z", "Place of the slice (mrv), in radii.", RECORD)] = None,
    slice_um: Annotated[float | None, _set("UM", "Thickness of the slice (mrv).", RECORD)] = None,
    points: Annotated[int | None, _set("N", "Pixels across the slice (mrv); default 64.", RECORD)] = None,
    venc: Annotated[
        float | None, _set("MM", "Speed in mm/s at which the phase wraps (mrv); default 2 U.", RECORD)
    ] = None,
    noise_mm_per_s: Annotated[float | None, _set("MM", "Noise of the slice (mrv).", RECORD)] = None,
    out: Annotated[
        Path | None,
        typer.Option(
            "--out",
            "-o",
            metavar="DIR",
            help="Folder to write into; by default RUN-observed next to FILE.",
            rich_help_panel=OUTPUT,
        ),
    ] = None,
    force: FORCE = False,
) -> None:
    """Show a run as an instrument would have recorded it, in the files of common programs.

    With the files come a picture and view.json, which has the view, the settings and the times.
    """
    from .. import dataset
    from ..observations import View
    from ..observations import observe as observed
    from ..observations.microscope.observe import FORMATS, INSTRUMENTS
    from . import targets

    if radius_um is not None:
        if pixel_um is not None:
            raise InputError("radius_um", radius_um, "left out with --pixel-um", "give one of the two")
        pixel_um = number("radius_um", radius_um, 1e-3, 1e6, "give micrometres") / radius_px
    kinds = as_.split("+")
    for kind in kinds:
        choice("as", kind, tuple(INSTRUMENTS))
    if format is not None:
        if len(kinds) > 1:
            raise InputError("format", format, "given with one instrument", "write them one by one")
        choice("format", format, FORMATS[kinds[0]])
    folder = out or file.with_name(f"{file.stem}-observed")
    targets.check_folder(folder, "several files are written")
    given = {
        "times": None if times is None else _TIMES.parse(times),
        "venc_mm_per_s": venc,
        "chloroplasts": chloroplasts or None,
        **{"start": start, "frames": frames, "window_px": window_px, "step_px": step_px},
        **{"outliers": outliers, "missed": missed, "line": line, "at": at, "slice_z": slice_z},
        **{"slice_um": slice_um, "points": points, "noise_mm_per_s": noise_mm_per_s},
    }
    chosen = {name: value for name, value in given.items() if value is not None}
    place = (0.0, 0.0) if centre is None else _pair("centre", centre)
    view = View(radius_px, axis, place, math.radians(facing), mirrored)
    width, height = (None, None) if size is None else map(round, _pair("size", size))
    with dataset.open_dataset(file) as data:
        for kind in kinds:
            recording = observed(
                data,
                view,
                kind,
                pixel_um=pixel_um,
                frame_s=frame_s,
                depth_um=depth_um,
                noise_px=noise_px,
                speed_um_per_s=speed_um_per_s,
                size_px=None if width is None or height is None else (width, height),
                centred=centre is None,
                seed=seed,
                **chosen,
            )
            into = folder if len(kinds) == 1 else folder / kind
            if len(kinds) > 1:
                folder.mkdir(exist_ok=True)
            for path in recording.write(into, format, force):
                print(f"saved {path}")


def _pair(name: str, text: str) -> tuple[float, float]:
    found = _PAIR.parse(text)
    if len(found) != 2:
        raise InputError(name, text, "two numbers", "write them as 300,200")
    return float(found[0]), float(found[1])
