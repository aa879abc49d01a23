"""Reading files of measurements: units and directions are settled here, and nothing is guessed."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from ..model.arrays import numbers
from ..model.doors import door
from ..model.errors import InputError, choice, closest, number
from . import checks
from .formats import FORMATS, content_of
from .formats.content import ANGLE, KYMOGRAPH, SLICE, SURFACE, TRACKS, VELOCITY, Asked, Columns, Content
from .lattice import lattice
from .observation import Array, Frame, Observation
from .tracked import velocities
from .units import EXAMPLES, Calibration, is_length, length_unit, speed_unit

Paths = str | os.PathLike[str] | Sequence[str | os.PathLike[str]]
DIRECTIONS = ("down", "up")
_MIDDLE = (
    "y was reversed about the middle of the grid, as OpenPIV does; if the grid is not in the middle of the "
    "image, give origin_px, the place of (0, 0) of the file in the image"
)


@door
def read(
    path: Paths,
    format: str | None = None,
    *,
    y: str | None = None,
    speed: str | None = None,
    length: str | None = None,
    pixel_um: float | None = None,
    frame_s: float | None = None,
    every_s: float | None = None,
    columns: Mapping[str, Any] | None = None,
    order: str | None = None,
    origin_px: tuple[float, float] | None = None,
    step_px: float = 1.0,
    focus_um: Sequence[float] | None = None,
    noise_px: float | None = None,
    angle: str | None = None,
    line_px: Sequence[Sequence[float]] | None = None,
    max_gap: int = 3,
    window_px: float | None = None,
) -> Observation:
    r"""Return the measurement in one file, or in several of one kind, in pixels with y down.

    The format is recognised by what the file holds; `format`, one of `FORMATS`, insists on one. What the file
    does not say must be given: `y`, "down" or "up", the direction in which both its y and its v increase;
    `speed`, the unit of u and v ("px/frame", "px/s", "um/s", "mm/s", "m/s", ...); `pixel_um` if anything is
    in micrometres or the like; `frame_s`, the seconds between the two images of a pair. `length` is the unit
    of x and y, by default that of the speed. What is given here counts more than what a file says.

    Several files are successive times, `every_s` seconds apart, or with `focus_um`, the depths of their
    focus, one time in several planes. `columns` names the columns of any table by number or name, as {"x": 0,
    "y": 1, "u": 2, "v": 3}; also "bad" or "good", "frame", "track" and "angle". `order` tells what the parts
    of an optical flow are, "row,col" or "x,y". `origin_px` is the place in the image of (0, 0) of the file or
    of the first sample of an array, and `step_px` the pixels from one sample of an array to the next.
    `noise_px` is the noise of a component of a displacement. `window_px` is the side of the windows of which
    vectors are averages; a fit takes the average into account, and positions of OpenPIV, which its search
    windows shift, are put right. `angle` is the unit of angles, "degrees" or
    "radians". `line_px` has the two ends ((x, y), (x, y)) of the line of a kymograph. Links of tracks over
    more than `max_gap` frames are left out. Raises `InputError`, in one sentence, for what is missing and for
    files that cannot be used.

    Example: a table of four columns, in any order of rows.
        >>> from pathlib import Path
        >>> import cyclosis as cy
        >>> rows = ["0 0 1.5 0.0", "16 0 1.5 0.0", "0 16 2.5 0.0", "16 16 2.5 0.0"]
        >>> _ = Path("vectors.txt").write_text("\n".join(rows))
        >>> named = {"x": 0, "y": 1, "u": 2, "v": 3}
        >>> seen = cy.observations.read("vectors.txt", columns=named, y="down", speed="px/frame", frame_s=0.5)
        >>> seen.frames[0].vx, seen.time_unit
        (array([3., 3., 5., 5.]), 's')
        >>> cy.observations.read("vectors.txt", columns=named, speed="px/frame")
        Traceback (most recent call last):
            ...
        cyclosis.model.errors.InputError: y = None cannot be used: it must be ...
    """
    paths = _paths(path)
    if format is not None and format not in FORMATS:
        raise InputError("format", format, "one of " + ", ".join(FORMATS), closest(format, FORMATS))
    if y is not None:
        choice("y", y, DIRECTIONS)
    if speed is not None:
        speed_unit("speed", speed)
    if length is not None:
        length_unit("length", length)
    if noise_px is not None:
        noise_px = number("noise_px", noise_px, 1e-9, 1e9, "give the noise of a displacement in pixels")
    asked = Asked(format, columns, order, number("step_px", step_px, 1e-9, 1e9, "give it in pixels"))
    contents = [content_of(each, asked) for each in paths]
    _alike(paths, contents)
    first = contents[0]
    if first.kind == SURFACE:
        return _surface(paths, first)
    cal = Calibration(
        first.pixel_um if pixel_um is None else pixel_um, first.frame_s if frame_s is None else frame_s
    )
    settled = _Settled(first, y, speed, length, cal, _pair("origin_px", origin_px), angle, max_gap, window_px)
    if first.kind in (KYMOGRAPH, SLICE):
        return _pictured(paths, contents, settled, noise_px, line_px)
    frames = [frame for content in contents for frame in settled.frames(content)]
    frames = _timed(frames, contents, len(paths), every_s, focus_um, settled)
    if not any(frame.good.any() for frame in frames):
        rule = "one with at least one vector that is good; all are flagged, masked or not finite"
        raise InputError("file", str(paths[0]), rule, "check the mask and the validation")
    notes = tuple(dict.fromkeys([*first.notes, *settled.notes]))
    seen = Observation(
        tuple(frames),
        first.kind,
        settled.time_unit,
        cal.pixel_um,
        cal.frame_s,
        noise_px,
        first.format,
        ", ".join(each.name for each in paths),
        notes,
        window_px=None if window_px is None else float(window_px),
    )
    far = checks.too_far(seen)
    return seen if far is None else replace(seen, notes=(*notes, far))


class _Settled:
    """Units and directions of a file, with what was asked for and what the caller said."""

    def __init__(
        self,
        content: Content,
        y: str | None,
        speed: str | None,
        length: str | None,
        cal: Calibration,
        origin: tuple[float, float] | None,
        angle: str | None,
        max_gap: int,
        window_px: float | None = None,
    ) -> None:
        self.cal, self.notes, self.max_gap = cal, list[str](), max_gap
        self.window = None
        if window_px is not None:
            if content.kind != VELOCITY:
                rule = f"left out for the format {content.format}"
                raise InputError("window_px", window_px, rule, "it is for vectors of windows")
            number("window_px", window_px, 2.0, 1e5, "give the side of the windows in pixels")
            self.window = float(window_px) if content.format == "openpiv" else None
        self.origin = content.origin_px if origin is None else origin
        self.direction = y or content.y
        if content.y is not None and y is not None and y != content.y:
            self.notes.append(f"y={y!r} was given; the format itself has y {content.y}")
        if self.direction is None:
            rule = '"down" or "up": the direction in which y and v increase, which the file does not say'
            remedy = "say which; in an image as it is stored y increases downwards"
            also = " and --speed UNIT" if content.kind == VELOCITY and not (speed or content.speed) else ""
            raise InputError("y", None, rule, remedy, f"give --y down or --y up{also}")
        self.speed, self.length = self._units(content, speed, length)
        self.time_unit = "frame" if cal.frame_s is None else "s"
        self.position = cal.pixels("length", self.length)
        self.velocity = 1.0
        if content.kind == VELOCITY:
            over, time = speed_unit("speed", self.speed)
            factor, self.time_unit = cal.per_time(time)
            self.velocity = cal.pixels("speed", over) * factor
        self.angle = self._angle(content, angle)

    def _units(self, content: Content, speed: str | None, length: str | None) -> tuple[str | None, str]:
        said = speed or content.speed
        if content.kind == VELOCITY and said is None:
            rule = f"the unit of u and v, which the file does not say: {EXAMPLES}"
            raise InputError("speed", None, rule, "say which", "give --speed UNIT")
        if speed is not None and content.speed is not None and speed != content.speed:
            self.notes.append(f"speed={speed!r} was given; the file says {content.speed}")
        if length is None and content.length is None and said is not None:
            return said, speed_unit("speed", said)[0]
        unit = length or content.length
        if unit is None or not is_length(unit):
            rule = "the unit of x and y, which the file does not say: px, um, mm or m"
            raise InputError("length", None, rule, "say which", "give --length UNIT")
        return said, unit

    def _angle(self, content: Content, angle: str | None) -> float:
        if content.kind != ANGLE:
            return 1.0
        unit = angle or content.extra.get("angle")
        if unit is None:
            rule, remedy = (
                "the unit of the angles, degrees or radians, which the file does not say",
                "say which",
            )
            raise InputError("angle", None, rule, remedy, "give --angle degrees")
        return np.pi / 180 if choice("angle", unit, ("degrees", "radians")) == "degrees" else 1.0

    def frames(self, content: Content) -> list[Frame]:
        """Return the frames of a file in pixels, y down."""
        out = []
        for columns in content.frames:
            x, y = columns["x"] * self.position, columns["y"] * self.position
            x, y = self._placed(x, y, content)
            good = columns["good"] != 0 if "good" in columns else np.ones(x.shape, dtype=bool)
            if content.kind == TRACKS:
                spots = {"x": x, "y": y, "frame": columns["frame"], "track": columns["track"]}
                out += velocities(content, spots, good, self.cal.frame_s, self.max_gap)
                continue
            out.append(self._sampled(content, columns, x, y, good))
        return out

    def _sampled(self, content: Content, columns: Columns, x: Array, y: Array, good: Any) -> Frame:
        vx = vy = angle = None
        if content.kind == ANGLE:
            angle = columns["angle"] * self.angle  # counter-clockwise as seen, whatever y is
        else:
            sign = -1.0 if self.direction == "up" else 1.0
            vx, vy = columns["u"] * self.velocity, sign * columns["v"] * self.velocity
        return lattice(Frame(x, y, good, vx, vy, angle), content.complete, self.source(content))

    def source(self, content: Content) -> str:
        """Return the name of the file for a message."""
        return str(content.extra.get("path", content.format))

    def _placed(self, x: Array, y: Array, content: Content) -> tuple[Array, Array]:
        """Return positions in the image, y down."""
        if self.window is not None and x.size:
            x, y = self._uncentred(x), self._uncentred(y)
        right, down = self.origin or (0.0, 0.0)
        if self.direction == "down":
            return x + right, y + down
        if self.origin is not None:
            return x + right, down - y
        if content.kind == TRACKS:
            rule = "given, because y increases upwards: the place in the image of (0, 0) of the file"
            remedy = "give (0, height of the image) if y counts from its lower edge"
            raise InputError("origin_px", None, rule, remedy, "give --origin 0,HEIGHT")
        self.notes.append(_MIDDLE)
        finite = y[np.isfinite(y)]
        return x, (finite.min() + finite.max() - y if finite.size else y)

    def _uncentred(self, at: Array) -> Array:
        """Return positions of OpenPIV with the middle of the first window where its pixels are.

        `pyprocess.get_coordinates` moves positions by half of what the windows leave free of the image, and
        puts the middle of a window of n pixels at n/2; the windows themselves begin at the first pixel
        (OpenPIV 0.26.1). In a file with y upwards the smallest y belongs to the last row; that has moved as
        far.
        """
        assert self.window is not None
        return at - (np.nanmin(at) - 0.5 * (self.window - 1))


def _paths(path: Paths) -> list[Path]:
    given: list[Any] = [path] if isinstance(path, str | os.PathLike) else list(path)
    if not given or not all(isinstance(each, str | os.PathLike) for each in given):
        raise InputError("path", path, "a path or several", "give the files to read")
    return [Path(each) for each in given]


def _pair(name: str, value: Any) -> tuple[float, float] | None:
    if value is None:
        return None
    found = numbers(name, value, "two numbers (x, y)", "give pixels, y down")
    if found.shape != (2,) or not np.isfinite(found).all():
        raise InputError(name, value, "two finite numbers (x, y)", "give pixels, y down")
    return float(found[0]), float(found[1])


def _alike(paths: list[Path], contents: list[Content]) -> None:
    """Refuse files of different formats or units."""
    first = contents[0]
    for path, content in zip(paths, contents, strict=True):
        content.extra.setdefault("path", path)
        for name in ("format", "kind", "length", "speed", "y", "pixel_um", "frame_s"):
            found, expected = getattr(content, name), getattr(first, name)
            if found != expected:
                rule = f"like {paths[0].name}, whose {name} is {expected}; here it is {found}"
                raise InputError("file", str(path), rule, "read them apart")


def _timed(
    frames: list[Frame],
    contents: list[Content],
    files: int,
    every_s: float | None,
    focus_um: Sequence[float] | None,
    settled: _Settled,
) -> list[Frame]:
    """Return the frames with their times, or with their planes of focus."""
    if focus_um is not None:
        depths = numbers("focus_um", focus_um, "one number for every file", "give the depth of every focus")
        if depths.shape != (len(frames),):
            raise InputError("focus_um", focus_um, f"{len(frames)} numbers", "give one for every file")
        return [replace(f, time=0.0, focus_um=float(d)) for f, d in zip(frames, depths, strict=True)]
    if len(frames) == 1 or contents[0].kind == TRACKS:
        return frames
    if every_s is None:
        if settled.time_unit == "frame" and files == 1:
            return [replace(frame, time=float(k)) for k, frame in enumerate(frames)]
        rule = f"given, because there are {len(frames)} fields: the seconds from one to the next"
        remedy = "frame_s if every image is in two pairs, twice that if it is in one"
        raise InputError("every_s", None, rule, remedy, "give --every-s SECONDS")
    step = number("every_s", every_s, 1e-12, 1e12, "give the seconds from one field to the next")
    return [replace(frame, time=k * step) for k, frame in enumerate(frames)]


def _surface(paths: list[Path], content: Content) -> Observation:
    if len(paths) > 1:
        raise InputError("path", [p.name for p in paths], "one file of `cyclosis measure`", "read them apart")
    camera = content.extra.pop("view", None)
    return Observation(
        (),
        SURFACE,
        content.extra.get("time_unit", "s"),
        content.pixel_um,
        content.frame_s,
        None,
        content.format,
        paths[0].name,
        tuple(content.notes),
        camera,
        None,
        content.extra,
    )


def _pictured(
    paths: list[Path],
    contents: list[Content],
    settled: _Settled,
    noise_px: float | None,
    line_px: Sequence[Sequence[float]] | None,
) -> Observation:
    """Return a kymograph or a cross-section."""
    content = contents[0]
    if len(paths) > 1:
        raise InputError("path", [p.name for p in paths], f"one {content.kind}", "read them apart")
    image: npt.NDArray[Any] | None = content.image
    extra: dict[str, Any] = {}
    if content.kind == KYMOGRAPH:
        if settled.cal.frame_s is None:
            rule, remedy = "given: the seconds from one row to the next", "give frame_s"
            raise InputError("frame_s", None, rule, remedy, "give --frame-s SECONDS")
        if line_px is not None:
            ends = numbers("line_px", line_px, "two points ((x, y), (x, y))", "give pixels, y down")
            if ends.shape != (2, 2) or not np.isfinite(ends).all() or np.allclose(ends[0], ends[1]):
                raise InputError("line_px", line_px, "two different points ((x, y), (x, y))", "give pixels")
            extra["line_px"] = ends
    elif image is not None:
        if settled.speed is None:
            rule = f"the unit of the velocity, which the file does not say: {EXAMPLES}"
            raise InputError("speed", None, rule, "say which", "give --speed UNIT")
        over, time = speed_unit("speed", settled.speed)
        factor, settled.time_unit = settled.cal.per_time(time)
        image = image * (settled.cal.pixels("speed", over) * factor)
    return Observation(
        (),
        content.kind,
        settled.time_unit,
        settled.cal.pixel_um,
        settled.cal.frame_s,
        noise_px,
        content.format,
        paths[0].name,
        (*content.notes, *settled.notes),
        None,
        image,
        extra,
    )
