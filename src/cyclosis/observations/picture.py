"""An image of a cell from a file, for drawing on."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from ..model.errors import InputError
from .formats.images import image as tiff_image


def picture(path: Path) -> npt.NDArray[Any]:
    """Return an image in grey (rows, columns), or several frames of it, from TIFF, PNG, JPEG, BMP or .npy.

    Raises `InputError` for what cannot be read.
    """
    try:
        raw = path.read_bytes()
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or error
        raise InputError(
            "image", str(path), "a file that can be read", f"check the path ({reason})"
        ) from error
    if raw[:4] in (b"II*\0", b"MM\0*", b"II+\0", b"MM\0+"):
        array = tiff_image(path, raw)[0]
    else:
        array = _other(path, raw)
    if array.ndim not in (2, 3) or min(array.shape[-2:]) < 2:
        raise InputError("image", str(path), "an image (rows, columns)", "save one image")
    return np.nan_to_num(np.asarray(array, dtype=np.float64))


def _other(path: Path, raw: bytes) -> npt.NDArray[Any]:
    import io

    from PIL import Image

    try:
        if raw.startswith(b"\x93NUMPY"):
            return np.asarray(np.load(io.BytesIO(raw), allow_pickle=False), dtype=np.float64)
        with Image.open(io.BytesIO(raw)) as opened:
            return np.asarray(opened.convert("F"))
    except Exception as error:
        remedy = "save it as PNG or TIFF"
        raise InputError(
            "image", str(path), "a TIFF, PNG, JPEG or BMP image that is whole", remedy
        ) from error
