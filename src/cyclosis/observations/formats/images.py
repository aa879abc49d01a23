"""Arrays as images: optical flow and angles in .npy, and TIFF of angles, kymographs and cross-sections."""

from __future__ import annotations

import io
from pathlib import Path
from typing import Any

import numpy as np

from ...model.errors import InputError
from ..units import LENGTHS, is_length
from .content import ANGLE, KYMOGRAPH, SLICE, VELOCITY, Asked, Columns, Content, unreadable

ORDERS = ("row,col", "x,y")
"""The components of an optical flow: (down, right), as scikit-image has it, or (right, down), as OpenCV."""
PICTURES = ("angles", "kymograph", "slice")


def npy(path: Path, raw: bytes, asked: Asked) -> Content:
    """Return what an array of NumPy holds: an optical flow (2, rows, columns) or the like, or a picture."""
    try:
        stream = io.BytesIO(raw)
        array = np.load(stream, allow_pickle=False)
        if stream.read(1):
            raise ValueError("more bytes than the array has")
    except Exception as error:
        raise unreadable(
            path, "an array that is whole, without objects in it", "save it again with numpy.save"
        ) from error
    if array.dtype.kind not in "fiub" or not array.size:
        raise unreadable(path, "an array of numbers", "save it again as float")
    array = np.asarray(array, dtype=np.float64)
    if array.ndim == 2:
        return _picture(path, array, asked, {})
    parts = [axis for axis in (0, array.ndim - 1) if array.ndim == 3 and array.shape[axis] == 2]
    if len(parts) != 1:
        rule = (
            "an array (2, rows, columns) or (rows, columns, 2) of displacements, or (rows, columns) of angles"
        )
        raise unreadable(path, f"{rule}; its shape is {array.shape}", "save one frame to a file")
    if asked.order not in ORDERS:
        rule = (
            'given for an optical flow: "row,col" (scikit-image: down, right) or "x,y" (OpenCV: right, down)'
        )
        raise InputError("order", asked.order, rule, "say which", "give --order row,col or --order x,y")
    first, second = np.moveaxis(array, parts[0], 0)
    u, v = (second, first) if asked.order == ORDERS[0] else (first, second)
    good = np.isfinite(u) & np.isfinite(v) & ((u != 0) | (v != 0))
    columns = _sampled(u.shape, asked) | {"u": u.ravel(), "v": v.ravel(), "good": good.ravel().astype(float)}
    notes = [
        f"its components are {asked.order}; a pixel without texture reads 0 and is not taken as measured",
        "v is positive downwards, as rows are",
    ]
    return Content("flow", VELOCITY, [columns], "px", "px/frame", "down", complete=True, notes=notes)


def _sampled(shape: tuple[int, ...], asked: Asked) -> Columns:
    rows, columns = np.indices(shape)
    return {"x": columns.ravel() * asked.step_px, "y": rows.ravel() * asked.step_px}


def tiff(path: Path, raw: bytes, asked: Asked) -> Content:
    """Return what a TIFF file holds: a picture of the kind that `asked.format` names.

    Raises `InputError` if tifffile is not installed, and for damaged files and films.
    """
    array, about = image(path, raw)
    if array.ndim != 2:
        rule = f"one image (rows, columns); it has the shape {array.shape}"
        raise unreadable(path, rule, "save one image, or measure the film: cyclosis.observations.film(path)")
    return _picture(path, np.asarray(array, dtype=np.float64), asked, about)


def image(path: Path, raw: bytes) -> tuple[np.ndarray[Any, Any], dict[str, Any]]:
    """Return the array of a TIFF file, and what its tags say: `pixel_um` and `row_s`."""
    try:
        import tifffile
    except ImportError:
        rule = "read with tifffile, which is not installed"
        raise unreadable(path, rule, "install it: pip install 'cyclosis[data]'") from None
    about: dict[str, Any] = {}
    try:
        with tifffile.TiffFile(io.BytesIO(raw)) as file:
            array = np.squeeze(file.series[0].asarray())
            about = _tags(file)
    except Exception as error:
        reason = " ".join(f"{error}".split())[:80]
        raise unreadable(path, f"a TIFF file that is whole ({reason})", "save it again") from error
    if array.dtype.kind not in "fiub" or not array.size:
        raise unreadable(path, "an image of numbers", "save it again as 8, 16 or 32 bits per pixel")
    return array, about


def _tags(file: Any) -> dict[str, Any]:
    """Return the size of a pixel, in µm, and the seconds of a row, from ImageJ's tags."""
    tags, said = file.pages[0].tags, file.imagej_metadata or {}
    unit, out = str(said.get("unit", "")).replace("\\u00B5", "µ"), {}
    if "XResolution" in tags and is_length(unit):
        over, under = tags["XResolution"].value
        size = LENGTHS[unit]
        if over and under and size is not None and over != under:
            out["pixel_um"] = size * under / over
    step = said.get("finterval")
    if isinstance(step, int | float) and step > 0:
        out["row_s"] = float(step)
    return out


def _picture(path: Path, array: np.ndarray[Any, Any], asked: Asked, about: dict[str, Any]) -> Content:
    """Return an image as what it is said to be."""
    if asked.format not in PICTURES:
        rule = 'given for an image: "angles", "kymograph" (rows are times) or "slice" (a cross-section)'
        raise InputError("format", asked.format, rule, "say which", "give --format NAME")
    if min(array.shape) < 2:
        raise unreadable(path, "an image of at least 2 x 2 pixels", "check it")
    if asked.format == "angles":
        return _angles(path, array, asked)
    if asked.format == "kymograph":
        notes = ["rows are times, downwards; columns are places along the line"]
        return Content(
            "kymograph",
            KYMOGRAPH,
            [],
            "px",
            None,
            "down",
            about.get("pixel_um"),
            about.get("row_s"),
            image=array,
            notes=notes,
        )
    return section(array)


def section(array: np.ndarray[Any, Any]) -> Content:
    """Return a cross-section of the velocity along the cell."""
    notes = ["the velocity is that along the cell; what is not finite was not measured"]
    return Content("slice", SLICE, [], "px", None, "down", None, image=array, notes=notes)


def _angles(path: Path, array: np.ndarray[Any, Any], asked: Asked) -> Content:
    finite = np.abs(array[np.isfinite(array)])
    if finite.size == 0:
        raise unreadable(path, "an image with finite angles in it", "check it")
    largest = float(finite.max())
    if largest > 360.5:
        raise unreadable(path, f"an image of angles; {largest:g} occurs", "check its format")
    columns = _sampled(array.shape, asked) | {
        "angle": array.ravel(),
        "good": np.isfinite(array).ravel().astype(float),
    }
    notes = ["angles are counter-clockwise from the right as seen; they have no polarity"]
    unit = {"angle": "degrees"} if largest > 2 * np.pi + 0.01 else {}
    return Content("angles", ANGLE, [columns], "px", None, "down", complete=True, notes=notes, extra=unit)
