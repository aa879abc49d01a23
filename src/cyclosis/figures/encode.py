"""Encode a sequence of pictures to a file, MP4 (H.264) or GIF, which appears complete or not at all."""

from __future__ import annotations

import math
import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from fractions import Fraction
from itertools import pairwise
from pathlib import Path
from types import TracebackType
from typing import Any, Protocol

import av
import numpy as np
from PIL import Image

from ..model.errors import InputError
from .scene import Pixels

SUFFIXES = (".mp4", ".gif")
GIF_HEIGHT = 324
"""GIFs are at most this many pixels high, because they compress badly."""
SHORTEST_DELAY = 2
"""Least time that a picture of a GIF is shown, in hundredths of a second: browsers slow down faster ones."""
LONGEST_DELAY = 655.35
"""Longest time that it is shown, in seconds: the format has 16 bits for it."""
_COLOURS, _SAMPLES = 128, 12
"""Number of colours of a GIF, and of frames from which they are chosen."""
_BT709 = 1
"""The number of the colour space of video in ITU-T H.273."""


class _Encoder(Protocol):
    def add(self, pixels: Pixels) -> None: ...
    def finish(self) -> None: ...


class Output:
    """A movie file being written: a context manager that moves the file to its path at the end, or drops it.

    The kind follows from the suffix of `path`. `frames` pictures last `seconds` in total: in an MP4 equally
    long, with the total right to a millisecond, in a GIF in whole hundredths of a second that add up. Frames
    go to a temporary file next to `path`, and `about` to its comment. Raises `InputError` for other suffixes,
    for a GIF whose frames would be shown too long, and for places that cannot be written to.
    """

    def __init__(self, path: str | os.PathLike[str], frames: int, seconds: float, about: str = "") -> None:
        self.path = Path(path)
        kind = self.path.suffix.lower()
        if kind not in SUFFIXES:
            rule = "a file name that ends in .mp4 or .gif"
            raise InputError("path", str(self.path), rule, "change its suffix")
        if self.path.is_dir():
            raise InputError("path", str(self.path), "a file name", "add a name to the folder")
        if kind == ".gif" and seconds > LONGEST_DELAY * frames:
            rule = f"at least {math.ceil(seconds / LONGEST_DELAY)} for a GIF of {seconds:g} seconds"
            raise InputError("frames", frames, rule, "give more frames, or write an MP4")
        with self._writing():
            handle, name = tempfile.mkstemp(
                prefix=f".{self.path.name}.", suffix=".partial", dir=self.path.parent
            )
            os.close(handle)
            self.partial = Path(name)
        self.encoder: _Encoder = (_Mp4 if kind == ".mp4" else _Gif)(self.partial, frames, seconds, about)

    def add(self, pixels: Pixels) -> None:
        """Add the next frame (height, width, 3); both sizes even, the same for all frames."""
        with self._writing():
            self.encoder.add(pixels)

    def __enter__(self) -> Output:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        try:
            with self._writing():
                if error is None:
                    self.encoder.finish()
                    # Temporary files are private; a movie gets the permissions of any new file.
                    mask = os.umask(0)
                    os.umask(mask)
                    self.partial.chmod(0o666 & ~mask)
                    os.replace(self.partial, self.path)
        finally:
            self.partial.unlink(missing_ok=True)

    @contextmanager
    def _writing(self) -> Iterator[None]:
        try:
            yield
        except OSError as error:
            rule = "a place that can be written to"
            remedy = f"free space or choose another ({error.strerror})"
            raise InputError("path", str(self.path), rule, remedy) from error


class _Mp4:
    """H.264 that all players read; its index comes first, so that it plays while it loads."""

    def __init__(self, path: Path, frames: int, seconds: float, about: str = "") -> None:
        self.path, self.about = path, about
        self.rate = frames / Fraction(round(1000 * seconds), 1000)
        self.container: Any = None

    def add(self, pixels: Pixels) -> None:
        if self.container is None:
            self._open(*pixels.shape[:2])
        frame = av.VideoFrame.from_ndarray(pixels, format="rgb24")
        self.container.mux(self.stream.encode(frame.reformat(format="yuv420p", dst_colorspace=_BT709)))

    def _open(self, height: int, width: int) -> None:
        self.container = av.open(str(self.path), "w", format="mp4", options={"movflags": "faststart"})
        self.container.metadata["comment"] = self.about
        options = {"crf": "18", "preset": "veryfast"}
        self.stream: Any = self.container.add_stream("libx264", rate=self.rate, options=options)
        self.stream.height, self.stream.width, self.stream.pix_fmt = height, width, "yuv420p"
        context = self.stream.codec_context
        context.colorspace = context.color_primaries = context.color_trc = _BT709

    def finish(self) -> None:
        self.container.mux(self.stream.encode())
        self.container.close()


class _Gif:
    """An endless loop, with one palette chosen from frames throughout the movie."""

    def __init__(self, path: Path, frames: int, seconds: float, about: str = "") -> None:
        self.path, self.about = path, about
        self.delays = delays(frames, seconds)
        self.frames: list[Image.Image] = []
        shown = len(self.delays)
        self.chosen = {round(k * (frames - 1) / max(shown - 1, 1)) for k in range(shown)}
        self.seen = 0

    def add(self, pixels: Pixels) -> None:
        self.seen += 1
        if self.seen - 1 not in self.chosen:
            return
        image = Image.fromarray(pixels)
        factor = min(1.0, GIF_HEIGHT / image.height)
        size = (round(factor * image.width), round(factor * image.height))
        self.frames.append(image.resize(size, Image.Resampling.BILINEAR))

    def finish(self) -> None:
        chosen = np.linspace(0, len(self.frames) - 1, min(_SAMPLES, len(self.frames))).astype(int)
        sample = np.concatenate([np.asarray(self.frames[k]) for k in chosen])
        palette = Image.fromarray(sample).quantize(_COLOURS)
        # The background stays white; the mean of nearly white colours would not.
        colours = np.array(palette.getpalette()).reshape(-1, 3)
        colours[colours.sum(axis=1).argmax()] = 255
        palette.putpalette(colours.ravel().tolist())
        # Without dithering, whose noise would not compress.
        first, *others = (frame.quantize(palette=palette, dither=Image.Dither.NONE) for frame in self.frames)
        lasting = [10 * delay for delay in self.delays]  # Pillow counts in milliseconds
        how = {"duration": lasting, "loop": 0, "comment": self.about}
        first.save(self.path, "gif", save_all=True, append_images=others, **how)


def delays(frames: int, seconds: float) -> list[int]:
    """Return how many hundredths of a second each picture of a GIF is shown, `seconds` in total.

    Where there would be less than `SHORTEST_DELAY` for each of `frames` pictures, there are fewer pictures.
    """
    whole = round(100 * seconds)
    shown = min(frames, whole // SHORTEST_DELAY)
    ends = [k * whole // shown for k in range(shown + 1)]
    return [end - start for start, end in pairwise(ends)]
