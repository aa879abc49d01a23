"""Records as pictures and films: TIFF with ImageJ's description, NumPy arrays, MATLAB files, AVI and MP4."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from .tables import save_npy

if TYPE_CHECKING:
    from .observe import Recording

Content = dict[str, Callable[[Path], None]]
_DESCRIPTION, _X, _Y, _UNIT = 270, 282, 283, 296
"""Tags of TIFF."""


def tiff(pictures: Any, per_x: float, unit: str, path: Path, *, per_y: float = 0.0, **about: Any) -> None:
    """Write pictures (n, rows, columns) as a TIFF that ImageJ opens as a stack, with pixels per unit."""
    from PIL import Image
    from PIL.TiffImagePlugin import IFDRational, ImageFileDirectory_v2

    pages = [Image.fromarray(np.ascontiguousarray(page)) for page in pictures]
    lines = ["ImageJ=1.54f", f"images={len(pages)}", f"slices={len(pages)}", f"unit={unit}"]
    lines += [f"{name}={value}" for name, value in about.items()]
    tags = ImageFileDirectory_v2()
    tags[_DESCRIPTION] = "\n".join(lines) + "\n"
    for tag, per in ((_X, per_x), (_Y, per_y or per_x)):
        tags[tag] = IFDRational(*Fraction(per).limit_denominator(10**6).as_integer_ratio())
    tags[_UNIT] = 1
    with open(path, "w+b") as file:  # Pillow reads what it has written
        pages[0].save(file, "TIFF", save_all=True, append_images=pages[1:], tiffinfo=tags)


def kymograph_tiff(recording: Recording) -> Content:
    """A picture whose rows are times, with micrometres across and seconds down."""
    camera, image = recording.camera, recording.data["image"].values
    per_s = 1 / camera.frame_s
    return {
        "kymograph.tif": partial(
            tiff, image[None], 1 / camera.pixel_um, "um", per_y=per_s, yunit="sec", finterval=camera.frame_s
        )
    }


def kymograph_npy(recording: Recording) -> Content:
    """The array (time, place)."""
    return {"kymograph.npy": partial(save_npy, recording.data["image"].values)}


def textures(recording: Recording) -> Content:
    """The pictures of the filaments."""
    images, per = recording.data["image"].values, 1 / recording.camera.pixel_um
    return {
        f"filaments_{k + 1:04d}.tif": partial(tiff, image[None], per, "um") for k, image in enumerate(images)
    }


def angle_npy(recording: Recording) -> Content:
    """Maps of angles in degrees, as OrientationPy's theta."""
    angles = recording.data["angle"].values
    files: Content = {f"angle_{k + 1:04d}.npy": partial(save_npy, each) for k, each in enumerate(angles)}
    return files | textures(recording)


def angle_tiff(recording: Recording) -> Content:
    """Maps of angles in degrees as 32-bit pictures, as OrientationJ's."""
    angles, per = recording.data["angle"].values.astype(np.float32), 1 / recording.camera.pixel_um
    files: Content = {
        f"angle_{k + 1:04d}.tif": partial(tiff, each[None], per, "um") for k, each in enumerate(angles)
    }
    return files | textures(recording)


def mrv_tiff(recording: Recording) -> Content:
    """Slices in mm/s as 32-bit pictures."""
    data = recording.data
    per = 1 / float(data.attrs["pixel_mm"])
    return {
        f"mrv_{k + 1:04d}.tif": partial(tiff, each[None], per, "mm")
        for k, each in enumerate(data["speed"].values)
    }


def mrv_mat(recording: Recording) -> Content:
    """Slices as a MATLAB file: `velocity` (rows, columns, times) in mm/s, `pixel_mm` and `venc`."""
    data = recording.data
    content = {
        "velocity": np.moveaxis(data["speed"].values, 0, -1).astype(float),
        "pixel_mm": float(data.attrs["pixel_mm"]),
        "venc": float(data.attrs["venc_mm_per_s"]),
    }

    def put(path: Path) -> None:
        from scipy.io import savemat

        with open(path, "wb") as file:
            savemat(file, content)

    return {"mrv.mat": put}


def mrv_npy(recording: Recording) -> Content:
    """Slices in mm/s as arrays."""
    values = recording.data["speed"].values
    return {f"mrv_{k + 1:04d}.npy": partial(save_npy, each) for k, each in enumerate(values)}


def film_avi(recording: Recording) -> Content:
    """Motion JPEG, which ImageJ opens."""
    return {"film.avi": partial(_video, recording, "avi", "mjpeg", "yuvj420p", {})}


def film_mp4(recording: Recording) -> Content:
    """H.264, as phones and screen recorders write it."""
    return {"film.mp4": partial(_video, recording, "mp4", "libx264", "yuv420p", {"crf": "14"})}


def film_tiff(recording: Recording) -> Content:
    """A stack of 8-bit pictures."""
    camera = recording.camera
    frames = recording.data["frames"].values
    return {"film.tif": partial(tiff, frames, 1 / camera.pixel_um, "um", finterval=camera.frame_s)}


def _video(
    recording: Recording, format: str, codec: str, pixels: str, options: dict[str, str], path: Path
) -> None:
    import av

    rate = Fraction(1 / recording.camera.frame_s).limit_denominator(1000) or Fraction(1, 1000)
    with av.open(str(path), "w", format=format) as container:
        stream: Any = container.add_stream(codec, rate=rate, options=options)
        stream.width, stream.height = recording.camera.size_px
        stream.pix_fmt = pixels
        if codec == "mjpeg":
            stream.codec_context.qmin, stream.codec_context.qmax = 2, 2
        for picture in recording.data["frames"].values:
            frame = av.VideoFrame.from_ndarray(picture, format="gray")
            container.mux(stream.encode(frame.reformat(format=pixels)))
        container.mux(stream.encode())
