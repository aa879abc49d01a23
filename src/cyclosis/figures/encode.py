"""Pictures in a row -> a file: MP4 (H.264) or GIF. A file appears whole or not at all."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from fractions import Fraction
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
_COLOURS, _SAMPLES = 128, 12
"""Number of colours of a GIF, and of the frames from which they are chosen."""
_BT709 = 1
"""The number of the colour space of video in ITU-T H.273."""


class _Encoder(Protocol):
    def add(self, pixels: Pixels) -> None: ...
    def finish(self) -> None: ...


class Output:
    """A movie file in the making: a context that puts the file in its place at the end, or drops it.

    The kind follows from the suffix of `path`; `rate` is in frames per second. Frames go to a temporary
    file beside `path`. Raises `InputError` for other suffixes and places that cannot be written to.
    """

    def __init__(self, path: str | os.PathLike[str], rate: Fraction) -> None:
        self.path = Path(path)
        kind = self.path.suffix.lower()
        if kind not in SUFFIXES:
            rule = "a file name that ends in .mp4 or .gif"
            raise InputError("path", str(self.path), rule, "change its suffix")
        if self.path.is_dir():
            raise InputError("path", str(self.path), "a file name", "add a name to the folder")
        with self._writing():
            handle, name = tempfile.mkstemp(
                prefix=f".{self.path.name}.", suffix=".partial", dir=self.path.parent
            )
            os.close(handle)
            self.partial = Path(name)
        self.encoder: _Encoder = (_Mp4 if kind == ".mp4" else _Gif)(self.partial, rate)

    def add(self, pixels: Pixels) -> None:
        """Take the next frame (height, width, 3); both sizes even, the same for all frames."""
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
                    # Temporary files are private; a movie gets the rights that any new file gets.
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
    """H.264 as all players read it; its index comes first, so that it plays while it loads."""

    def __init__(self, path: Path, rate: Fraction) -> None:
        self.path, self.rate = path, rate
        self.container: Any = None

    def add(self, pixels: Pixels) -> None:
        if self.container is None:
            self._open(*pixels.shape[:2])
        frame = av.VideoFrame.from_ndarray(pixels, format="rgb24")
        self.container.mux(self.stream.encode(frame.reformat(format="yuv420p", dst_colorspace=_BT709)))

    def _open(self, height: int, width: int) -> None:
        self.container = av.open(str(self.path), "w", format="mp4", options={"movflags": "faststart"})
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

    def __init__(self, path: Path, rate: Fraction) -> None:
        self.path = path
        self.duration = max(20, 10 * round(100 / rate))  # GIFs count in hundredths of a second
        self.frames: list[Image.Image] = []

    def add(self, pixels: Pixels) -> None:
        image = Image.fromarray(pixels)
        factor = min(1.0, GIF_HEIGHT / image.height)
        size = (round(factor * image.width), round(factor * image.height))
        self.frames.append(image.resize(size, Image.Resampling.BILINEAR))

    def finish(self) -> None:
        chosen = np.linspace(0, len(self.frames) - 1, min(_SAMPLES, len(self.frames))).astype(int)
        sample = np.concatenate([np.asarray(self.frames[k]) for k in chosen])
        palette = Image.fromarray(sample).quantize(_COLOURS)
        # Paper stays white; the mean of nearly white colours would not be.
        colours = np.array(palette.getpalette()).reshape(-1, 3)
        colours[colours.sum(axis=1).argmax()] = 255
        palette.putpalette(colours.ravel().tolist())
        # Without dithering, whose noise would not compress.
        first, *others = (frame.quantize(palette=palette, dither=Image.Dither.NONE) for frame in self.frames)
        first.save(self.path, "gif", save_all=True, append_images=others, duration=self.duration, loop=0)
