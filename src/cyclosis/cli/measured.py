"""Commands that read measurements of cells, and compare them with runs."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from ..model.errors import InputError, number
from . import targets
from .options import FORCE, OUTPUT, QUIET
from .sources import of_run

if TYPE_CHECKING:
    from ..observations import Observation

SUFFIXES = (".nc", ".png", ".pdf")
FILE, CELL, UNITS = "What the file holds", "Cell in the image", "Units"
"""Groups of options."""
OUT = Annotated[
    list[Path] | None,
    typer.Option(
        "--out",
        "-o",
        metavar="FILE",
        help="File to write: .nc for the numbers, .png or .pdf for a picture; may be repeated.",
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
            "--speed-um-per-s",
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
        float,
        typer.Option(
            "--step-px", metavar="PX", help="Pixels between samples of an array.", rich_help_panel=FILE
        ),
    ] = 1.0,
    window_px: Annotated[
        float | None,
        _option(
            "--window-px", metavar="PX", help="OpenPIV's search window, to correct its positions.", group=FILE
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
        str | None, _option("--line", metavar="X,Y,X,Y", help="Ends of the line of a kymograph.", group=FILE)
    ] = None,
    image: Annotated[
        Path | None,
        _option("--image", metavar="FILE", help="Image of the cell to draw the vectors on.", group=OUTPUT),
    ] = None,
    out: OUT = None,
    force: FORCE = False,
    quiet: QUIET = False,
) -> None:
    """Read a measurement, show what it holds, and put it on the unrolled surface of the cell."""
    from ..observations import read

    for target in out or []:
        targets.check(target, force, SUFFIXES)
    ends = _numbers("line", line, 4)
    seen = read(
        files,
        format,
        y=y,
        speed=speed,
        length=length,
        pixel_um=pixel_um,
        frame_s=frame_s,
        every_s=every_s,
        columns=None if columns is None else dict(map(_column, columns.split(","))),
        order=order,
        origin_px=_pair("origin", origin),
        step_px=step_px,
        focus_um=_numbers("focus_um", focus_um),
        noise_px=noise_px,
        angle=angle,
        line_px=None if ends is None else [ends[:2], ends[2:]],
        window_px=window_px,
    )
    given = (radius_um, radius_px, axis, centre, *(out or []))
    if all(value is None for value in given):
        print(seen)
        print("Give --radius-um or --radius-px, --axis and --centre to put it on the surface.")
        return
    if seen.camera is None:
        place: dict[str, Any] = {"radius_px": radius_px, "radius_um": radius_um, "axis_deg": axis}
        degrees = 180.0 if facing is None else number("facing", facing, -1e6, 1e6, "give degrees")
        seen = seen.view(
            **place, centre_px=_pair("centre", centre), facing=math.radians(degrees), mirrored=mirrored
        )
    data = _on_surface(seen, speed_um_per_s, max_angle, outside, depth_um)
    if not quiet:
        _say(seen, data)
    for target in out or []:
        _write(target, seen, data, image, depth_um)
        print(f"saved {target}")


def _on_surface(
    seen: Observation, speed: float | None, max_angle: float | None, outside: str, depth_um: float | None
) -> Any:
    """Return the measurement on the surface. Its warnings are printed, not raised."""
    import warnings

    from ..model.scales import Scales

    scales = None
    if speed is not None:
        if seen.pixel_um is None or seen.camera is None:
            rule = "given with the size of a pixel"
            raise InputError("speed_um_per_s", speed, rule, "give pixel_um", "give --pixel-um UM")
        scales = Scales(seen.camera.radius_px * seen.pixel_um, speed)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)
        return seen.on_surface(
            scales=scales,
            max_angle_deg=80.0 if max_angle is None else max_angle,
            outside=outside,
            depth_um=depth_um,
        )


def _say(seen: Observation, data: Any) -> None:
    import numpy as np

    print(seen)
    name = "u" if "u" in data else "angle"
    share = float(data["good"].mean())
    sizes = data.sizes
    low, high = (np.degrees(float(data["theta"][k])) for k in (0, -1))
    print(
        f"On the surface: {sizes['theta']} x {sizes['z']} points, θ from {low:.0f} to {high:.0f} degrees, "
        f"z from {float(data['z'][0]):.2f} to {float(data['z'][-1]):.2f} R, {share:.0%} of them with values."
    )
    if name == "u":
        largest = np.sqrt((data["u"].fillna(0.0) ** 2).sum("component")).max().item()
        unit = {"1": "U", "s-1": "R/s"}.get(data["u"].attrs["units"], "R/frame")
        print(f"Largest speed {largest:.4g} {unit}.")
    if data.attrs.get("warnings"):
        print(f"Warning: {data.attrs['warnings']}.")


def _write(target: Path, seen: Observation, data: Any, image: Path | None, depth_um: float | None) -> None:
    if target.suffix.lower() == ".nc":
        from ..dataset.tables import write_table

        write_table(data, target)
        return
    from ..figures import measured, style
    from ..observations.picture import picture

    style.save(measured.measurement(seen, data, None if image is None else picture(image), depth_um), target)


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
    out: OUT = None,
    force: FORCE = False,
    quiet: QUIET = False,
) -> None:
    """Find the shift, rotation, mirror image and time of a run that fit a measured flow best."""
    from ..observations import compare as comparison

    for target in out or []:
        targets.check(target, force, SUFFIXES)
    found = comparison(file, run, time=time, speed=speed, mirrored=mirrored)
    if not quiet:
        print(found)
    for target in out or []:
        if target.suffix.lower() == ".nc":
            from ..dataset.tables import write_table

            write_table(found.dataset, target)
        else:
            from ..figures import style

            style.save(found.figure(), target)
        print(f"saved {target}")


def _numbers(name: str, text: str | None, count: int | None = None) -> list[float] | None:
    if text is None:
        return None
    try:
        found = [float(part) for part in text.split(",")]
    except ValueError:
        found = []
    if not found or (count is not None and len(found) != count):
        rule = "numbers" if count is None else f"{count} numbers"
        raise InputError(name, text, f"{rule} with commas between them", "write them without spaces")
    return found


def _pair(name: str, text: str | None) -> tuple[float, float] | None:
    found = _numbers(name, text, 2)
    return None if found is None else (found[0], found[1])


def _column(text: str) -> tuple[str, Any]:
    name, _, at = text.partition("=")
    if not at:
        raise InputError("columns", text, "names with numbers", "write x=0,y=1,u=2,v=3")
    return name.strip(), int(at) if at.strip().isdigit() else at.strip()
