"""Reading films: videos of any kind that FFmpeg opens, and stacks of TIFF pictures."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from ...model.errors import InputError, choice

Array = npt.NDArray[np.float64]
Pictures = npt.NDArray[np.float32]

TIFF = (".tif", ".tiff", ".btf", ".tf8")
STARTS = ((0, b"RIFF"), (4, b"ftyp"), (0, b"\x1a\x45\xdf\xa3"), (0, b"GIF8"), (0, b"\0\0\x01\xba"))
"""Where the first bytes of usual videos are, and what they are: AVI, MP4 and MOV, Matroska, GIF, MPEG."""
VIDEOS = (".avi", ".mp4", ".m4v", ".mov", ".mkv", ".webm", ".gif", ".mpg", ".mpeg", ".wmv")
LIGHTS = ("luma", "red", "green", "blue")
MOST_BYTES = 3 * 2**30
"""Memory that the pictures of a film may take."""
LEAST_SIDE = 48
"""Least side of a picture in pixels."""
LARGEST = 1_000_000
"""Pixels of a picture above which neighbouring ones are averaged."""
LUMA = np.array([0.299, 0.587, 0.114])
STEADY = 0.02
"""Relative differences of the times between frames below which they count as equal."""


def is_video(raw: bytes) -> bool:
    """Return whether the first bytes of a file are those of a video."""
    return any(raw[at : at + len(start)] == start for at, start in STARTS)


def is_film(path: Path) -> bool:
    """Return whether a file is a video or a TIFF stack: by what is in it, or by its name if it is damaged."""
    try:
        with open(path, "rb") as file:
            start = file.read(16)
    except (OSError, ValueError):
        return False
    if start[:4] in (b"II*\0", b"MM\0*", b"II+\0", b"MM\0+"):
        return _several(path)
    return is_video(start) or path.suffix.lower() in VIDEOS


def _several(path: Path) -> bool:
    """Return whether a TIFF file has more than one picture; not if that cannot be told."""
    try:
        import tifffile

        with tifffile.TiffFile(path) as file:
            page, series = file.pages[0], file.series[0]
            return bool(np.prod(series.shape) > np.prod(page.shape))
    except Exception:  # the reader of pictures says what is wrong
        return False


@dataclass
class Film:
    """The frames of a film: `pictures` (n, rows, columns), and their `times` (n,), in seconds.

    `times` is None if the file does not tell them. `pixel_um` is the size of a pixel, None if it is not told.
    `binned` pixels of the file, in each direction, make one here.
    """

    pictures: Pictures
    times: Array | None
    pixel_um: float | None
    binned: int
    notes: list[str]


def read(path: Path, span: tuple[int, int | None], every: int, light: str) -> Film:
    """Return frames of a film: those from span[0] to span[1], one in `every`.

    Raises `InputError` for files that cannot be read, and for films without two frames there.
    """
    choice("light", light, LIGHTS)
    if not path.is_file():
        remedy = "check the path" if not path.exists() else "give one film, or a stack of pictures"
        raise InputError("file", str(path), "a film: a video, or a TIFF stack", remedy)
    film = (_stack if path.suffix.lower() in TIFF else _video)(path, span, every, light)
    count, height, width = film.pictures.shape
    if count < 2:
        rule = "a film of at least two frames"
        raise InputError("file", str(path), rule, f"choose other frames: {count} was found in this span")
    if min(height, width) * film.binned < LEAST_SIDE:
        rule = f"a film of at least {LEAST_SIDE} pixels in each direction, not {width} x {height}"
        raise InputError("file", str(path), rule, "record a larger part of the cell")
    return film


class _Kept:
    """Frames that are kept: in single precision, with neighbouring pixels averaged in large pictures."""

    def __init__(self, path: Path) -> None:
        self.path, self.pictures, self.binned, self.bytes = path, [], 1, 0  # type: ignore[var-annotated]

    def add(self, picture: npt.NDArray[Any]) -> None:
        if not self.pictures:
            while picture.size / self.binned**2 > LARGEST:
                self.binned += 1
        b = self.binned
        if b > 1:
            rows, columns = (n // b * b for n in picture.shape)
            cut = picture[:rows, :columns].astype(np.float32)
            picture = cut.reshape(rows // b, b, columns // b, b).mean(axis=(1, 3))
        small = picture.astype(np.float32)
        if self.pictures and small.shape != self.pictures[0].shape:
            rule = "a film whose frames all have the same size"
            raise InputError("file", str(self.path), rule, "cut it where the size changes")
        self.bytes += small.nbytes
        if self.bytes > MOST_BYTES:
            rule = f"less than {MOST_BYTES / 2**30:.0f} GB of pictures; these are more than that"
            remedy = "give frames=(first, last) or every=2"
            raise InputError("file", str(self.path), rule, remedy, "give --frames or --every")
        self.pictures.append(small)

    def film(self, times: Array | None, pixel_um: float | None, notes: list[str]) -> Film:
        if self.binned > 1:
            notes = [*notes, f"{self.binned} x {self.binned} pixels were averaged, because the film is large"]
        pictures = np.stack(self.pictures) if self.pictures else np.zeros((0, 0, 0), np.float32)
        return Film(pictures, times, pixel_um, self.binned, notes)


def _video(path: Path, span: tuple[int, int | None], every: int, light: str) -> Film:
    import av

    kept, times, notes = _Kept(path), [], []
    try:
        with av.open(str(path)) as container:
            if not container.streams.video:
                rule = "a film: there are no pictures in it"
                raise InputError("file", str(path), rule, "choose another file")
            stream = container.streams.video[0]
            stream.thread_type = "AUTO"
            rate = stream.average_rate
            last = span[1]
            try:
                for index, frame in enumerate(container.decode(stream)):
                    if last is not None and index >= last:
                        break
                    if index < span[0] or (index - span[0]) % every:
                        continue
                    kept.add(_grey(frame, light))
                    time = frame.time
                    times.append(float(time) if time is not None else index / float(rate or 1))
            except av.error.FFmpegError as error:
                if not kept.pictures:
                    raise
                notes.append(
                    f"the film ends early: it is damaged after {len(kept.pictures)} frames ({error})"
                )
    except (av.error.FFmpegError, OSError, ValueError) as error:
        if isinstance(error, InputError):
            raise
        rule = "a film that can be read: a video, or a TIFF stack"
        reason = getattr(error, "strerror", None) or type(error).__name__
        remedy = f"convert it with FFmpeg or ImageJ ({reason})"
        raise InputError("file", str(path), rule, remedy) from error
    when = np.array(times)
    if when.size > 1 and np.any(np.diff(when) <= 0):
        notes.append("times in the file do not increase; the mean rate was taken")
        when = np.arange(when.size, dtype=np.float64) * every / float(rate or 1)
    return kept.film(when, None, notes)


def _grey(frame: Any, light: str) -> npt.NDArray[Any]:
    if light != "luma":
        return np.asarray(frame.to_ndarray(format="rgb24")[..., LIGHTS.index(light) - 1])
    if frame.format.name in ("gray16le", "gray16be", "gray12le", "gray10le"):
        return np.asarray(frame.to_ndarray(format="gray16le"))
    return np.asarray(frame.to_ndarray(format="gray"))


def _stack(path: Path, span: tuple[int, int | None], every: int, light: str) -> Film:
    try:
        import tifffile
    except ImportError:
        rule = "a video, or a TIFF stack, which is read with tifffile; that is not installed"
        raise InputError("file", str(path), rule, "install it: pip install 'cyclosis[data]'") from None
    kept, notes = _Kept(path), []
    try:
        with tifffile.TiffFile(path) as file:
            series = file.series[0]
            shape, axes = series.shape, series.axes
            about = file.imagej_metadata or {}
            tags: Any = getattr(file.pages[0], "tags", {})
            resolution = tags["XResolution"].value if "XResolution" in tags else None
            turn, planes, colours = _order(path, shape, axes)
            count = int(np.prod([shape[k] for k in turn]) if turn else 1)
            if planes > 1:
                notes.append(f"the first of {planes} planes or channels of every frame was used")
            chosen = range(count)[span[0] : span[1] : every]
            frames = _pages(series, shape, axes, turn, colours)
            for index in chosen:
                kept.add(_lit(frames(index), light, colours))
    except InputError:
        raise
    except Exception as error:  # tifffile raises many kinds for damaged files
        rule = "a stack of TIFF pictures that is whole"
        raise InputError("file", str(path), rule, f"save it again ({type(error).__name__})") from error
    interval = about.get("finterval")
    times: Array | None = None
    if isinstance(interval, int | float) and interval > 0:
        times = float(interval) * every * np.arange(len(kept.pictures), dtype=np.float64)
    return kept.film(times, _pixel(about, resolution), notes)


def _order(path: Path, shape: tuple[int, ...], axes: str) -> tuple[list[int], int, bool]:
    """Return the axis of time, how many planes and channels each frame has, and whether it has colours."""
    colours = axes.endswith("S") and shape[-1] in (3, 4)
    letters = axes[:-1] if colours else axes
    if not letters.endswith("YX"):
        rule = f"a stack of pictures; its axes are {axes}"
        raise InputError("file", str(path), rule, "save it as a stack over time in ImageJ")
    longer = [k for k in range(len(letters) - 2) if shape[k] > 1]
    named = [k for k in longer if letters[k] == "T"]
    turn = named or longer[-1:]
    if not named and len(longer) > 1:
        turn = [max(longer, key=lambda k: shape[k])]
    planes = int(np.prod([shape[k] for k in longer if k not in turn])) if longer else 1
    return turn, planes, colours


def _pages(
    series: Any, shape: tuple[int, ...], axes: str, turn: list[int], colours: bool
) -> Callable[[int], npt.NDArray[Any]]:
    """Return the function that gives one frame, reading page by page where every page is a frame."""
    inner = 3 if colours else 2
    outer = shape[: len(shape) - inner]
    if len(series.pages) == int(np.prod(outer)) and len(series.pages) > 1:

        def page(index: int) -> npt.NDArray[Any]:
            place = [0] * len(outer)
            for axis in turn:
                place[axis] = index
            number = int(np.ravel_multi_index(place, outer)) if outer else 0
            return np.asarray(series.pages[number].asarray())

        return page
    whole = series.asarray()

    def part(index: int) -> npt.NDArray[Any]:
        place: list[Any] = [0] * len(outer)
        for axis in turn:
            place[axis] = index
        return np.asarray(whole[tuple(place)])

    return part


def _lit(picture: npt.NDArray[Any], light: str, colours: bool) -> npt.NDArray[Any]:
    if not colours:
        return picture
    return picture[..., :3] @ LUMA if light == "luma" else picture[..., LIGHTS.index(light) - 1]


def _pixel(about: dict[str, Any], resolution: Any) -> float | None:
    """Return the size of a pixel in micrometres, if the description and the tags tell it."""
    sizes = {"um": 1.0, "micron": 1.0, "microns": 1.0, "µm": 1.0, "\\u00b5m": 1.0, "mm": 1e3, "nm": 1e-3}
    factor = sizes.get(str(about.get("unit", "")))
    if factor is None or not resolution or not resolution[0]:
        return None
    return factor * resolution[1] / resolution[0]
