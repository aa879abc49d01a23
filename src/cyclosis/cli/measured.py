"""The command that reads measurements of cells, films among them."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Annotated, Any

import typer

from ..model.errors import number
from . import targets
from .measuring import column, drawn, numbers, on_surface, pair, reading, say
from .options import FORCE, OUTPUT, QUIET

SUFFIXES = (".nc", *targets.FIGURE)
FILE, CELL, UNITS, FILM = "What the file holds", "Cell in the image", "Units", "Film"
"""Groups of options."""
OUT = Annotated[
    list[Path] | None,
    typer.Option(
        "--out",
        "-o",
        metavar="FILE",
        help="File to write: .nc for numbers, .png, .pdf, .svg or .eps for a picture; may be repeated.",
        rich_help_panel=OUTPUT,
    ),
]


def _option(*names: str, metavar: str, help: str, group: str) -> Any:
    return typer.Option(*names, metavar=metavar, help=help, rich_help_panel=group, show_default=False)


def measure(
    files: Annotated[
        list[Path],
        typer.Argument(metavar="FILE", help="Files of one kind: successive times.", show_default=False),
    ],
    radius_um: Annotated[
        float | None,
        _option("--radius-um", metavar="R", help="Radius of the moving layer, micrometres.", group=CELL),
    ] = None,
    radius_px: Annotated[
        float | None, _option("--radius-px", metavar="R", help="The same in pixels.", group=CELL)
    ] = None,
    axis: Annotated[
        float | None,
        _option(
            "--axis",
            metavar="DEGREES",
            help="Direction of +z in the image, counter-clockwise from the right.",
            group=CELL,
        ),
    ] = None,
    centre: Annotated[
        str | None,
        _option(
            "--centre", metavar="X,Y", help="The point of the axis where z = 0, pixels, y down.", group=CELL
        ),
    ] = None,
    facing: Annotated[
        float | None,
        _option("--facing", metavar="DEGREES", help="θ that faces the camera; by default 180.", group=CELL),
    ] = None,
    mirrored: Annotated[
        bool | None,
        typer.Option(
            "--mirrored/--not-mirrored",
            help="Whether the image is mirrored, which decides the handedness of helices.",
            rich_help_panel=CELL,
            show_default=False,
        ),
    ] = None,
    max_angle: Annotated[
        float | None,
        _option(
            "--max-angle", metavar="DEGREES", help="Farthest from the facing line; by default 80.", group=CELL
        ),
    ] = None,
    outside: Annotated[
        str,
        typer.Option(
            "--outside",
            metavar="NAME",
            help="refuse or drop a flow of which more than a fifth lies outside the cell.",
            rich_help_panel=CELL,
        ),
    ] = "refuse",
    depth_um: Annotated[
        float | None,
        _option("--depth-um", metavar="D", help="Depth of field: only what is in focus counts.", group=CELL),
    ] = None,
    y: Annotated[
        str | None,
        _option("--y", metavar="NAME", help="Direction in which y and v increase: down or up.", group=UNITS),
    ] = None,
    speed: Annotated[
        str | None,
        _option("--speed", metavar="UNIT", help="Unit of u and v: px/frame, px/s, um/s, ...", group=UNITS),
    ] = None,
    length: Annotated[
        str | None,
        _option(
            "--length", metavar="UNIT", help="Unit of x and y; by default that of the speed.", group=UNITS
        ),
    ] = None,
    pixel_um: Annotated[
        float | None, _option("--pixel-um", metavar="UM", help="Size of a pixel, micrometres.", group=UNITS)
    ] = None,
    frame_s: Annotated[
        float | None,
        _option("--frame-s", metavar="SECONDS", help="Time between the two images of a pair.", group=UNITS),
    ] = None,
    every_s: Annotated[
        float | None,
        _option("--every-s", metavar="SECONDS", help="Time between successive fields.", group=UNITS),
    ] = None,
    noise_px: Annotated[
        float | None,
        _option(
            "--noise-px", metavar="PX", help="Noise of a displacement; by default estimated.", group=UNITS
        ),
    ] = None,
    speed_um_per_s: Annotated[
        float | None,
        _option(
            "--speed-um-s",
            metavar="U",
            help="The speed U: the numbers are then in R, U and R/U, as those of a run.",
            group=UNITS,
        ),
    ] = None,
    format: Annotated[
        str | None,
        _option("--format", metavar="NAME", help="Insist on a format, as openpiv or kymograph.", group=FILE),
    ] = None,
    columns: Annotated[
        str | None,
        _option("--columns", metavar="NAME=N,...", help="Columns from 0, as x=0,y=1,u=2,v=3.", group=FILE),
    ] = None,
    order: Annotated[
        str | None,
        _option("--order", metavar="NAME", help="Parts of an optical flow: row,col or x,y.", group=FILE),
    ] = None,
    origin: Annotated[
        str | None,
        _option(
            "--origin", metavar="X,Y", help="Place in the image of (0, 0) of the file, pixels.", group=FILE
        ),
    ] = None,
    step_px: Annotated[
        float | None,
        _option(
            "--step-px",
            metavar="PX",
            help="Pixels between samples: of an array, by default 1, or to take from a film, 8.",
            group=FILE,
        ),
    ] = None,
    window_px: Annotated[
        float | None,
        _option(
            "--window-px",
            metavar="PX",
            help="Side of the windows of which vectors are averages (corrects OpenPIV's positions too), "
            "or in a film of those to use.",
            group=FILE,
        ),
    ] = None,
    focus_um: Annotated[
        str | None,
        _option(
            "--focus-um",
            metavar="X,Y,...",
            help="Depths of focus: the files are one focal stack.",
            group=FILE,
        ),
    ] = None,
    angle: Annotated[
        str | None, _option("--angle", metavar="UNIT", help="Unit of angles: degrees or radians.", group=FILE)
    ] = None,
    line: Annotated[
        str | None,
        _option(
            "--line",
            metavar="X,Y,X,Y",
            help="Ends of the line of a kymograph, or of one to take from a film.",
            group=FILE,
        ),
    ] = None,
    frames: Annotated[
        str | None, _option("--frames", metavar="FIRST,LAST", help="Frames to use, from 0.", group=FILM)
    ] = None,
    every: Annotated[
        int | None, _option("--every", metavar="N", help="Use one frame in so many.", group=FILM)
    ] = None,
    pairs: Annotated[
        int | None,
        _option("--pairs", metavar="N", help="Pairs of frames to measure; by default 60.", group=FILM),
    ] = None,
    gap: Annotated[
        int | None,
        _option("--gap", metavar="N", help="Frames from the first of a pair to the second.", group=FILM),
    ] = None,
    average: Annotated[
        int | None, _option("--average", metavar="N", help="Pairs whose mean is a velocity.", group=FILM)
    ] = None,
    light: Annotated[
        str | None,
        _option("--light", metavar="NAME", help="Colour to use: luma, red, green or blue.", group=FILM),
    ] = None,
    keep_drift: Annotated[
        bool,
        typer.Option("--keep-drift", help="Leave the drift of the stage in.", rich_help_panel=FILM),
    ] = False,
    image: Annotated[
        Path | None,
        _option("--image", metavar="FILE", help="Image of the cell to draw the vectors on.", group=OUTPUT),
    ] = None,
    out: OUT = None,
    force: FORCE = False,
    quiet: QUIET = False,
) -> None:
    """Read a measurement, show what it holds, and put it on the unrolled surface of the cell."""
    for target in out or []:
        targets.check(target, force, SUFFIXES)
    ends = numbers("line", line, 4)
    line_px = None if ends is None else [ends[:2], ends[2:]]
    span = pair("frames", frames)
    said: dict[str, Any] = {
        "y": y,
        "speed": speed,
        "length": length,
        "every_s": every_s,
        "columns": None if columns is None else dict(map(column, columns.split(","))),
        "order": order,
        "origin_px": pair("origin", origin),
        "focus_um": numbers("focus_um", focus_um),
        "noise_px": noise_px,
        "angle": angle,
    }
    of_film: dict[str, Any] = {
        "frames": None if span is None else tuple(int(n) if n == int(n) else n for n in span),
        "every": every,
        "pairs": pairs,
        "gap": gap,
        "average": average,
        "light": light,
        "keep_drift": keep_drift or None,
    }
    both = {
        "pixel_um": pixel_um,
        "frame_s": frame_s,
        "line_px": line_px,
        "step_px": step_px,
        "window_px": window_px,
    }
    seen = reading(files, format, both, said, of_film, quiet)
    given = (radius_um, radius_px, axis, centre, *(out or []))
    if all(value is None for value in given):
        print(seen)
        print("Give --radius-um or --radius-px, --axis and --centre to put it on the surface.")
        return
    if seen.camera is None:
        place: dict[str, Any] = {"radius_px": radius_px, "radius_um": radius_um, "axis_deg": axis}
        degrees = 180.0 if facing is None else number("facing", facing, -1e6, 1e6, "give degrees")
        seen = seen.view(
            **place, centre_px=pair("centre", centre), facing=math.radians(degrees), mirrored=mirrored
        )
    data = on_surface(seen, speed_um_per_s, max_angle, outside, depth_um)
    if not quiet:
        say(seen, data)
    targets.write(out, lambda: drawn(seen, data, image, depth_um), lambda: data)
