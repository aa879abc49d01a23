"""What the files of a record do not say themselves: the arguments that read them, and the view in them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from ..view import View
from .mrv import EXTENT

if TYPE_CHECKING:
    from .observe import Recording

PIXELS = {"y": "down", "speed": "px/frame", "length": "px"}
VECTORS: dict[str, dict[str, Any]] = {
    "openpiv": PIXELS,
    "openpiv-um": {"y": "up", "speed": "um/s", "length": "um"},
    "pivlab": PIXELS,
    "pivlab-m": {"y": "down", "speed": "m/s", "length": "m"},
    "pivlab-mat": PIXELS,
    "npy": {"order": "row,col"},
}
"""Units and directions in the files of vectors."""


def in_the_files(recording: Recording) -> View:
    """Return where the cell lies in the files of a record; a cross-section is not seen by the camera."""
    view = recording.camera.view
    if recording.kind != "mrv":
        return view
    count = recording.data.sizes["column"]
    middle = 0.5 * (count - 1)
    return View(0.5 * count / EXTENT, 0.0, (middle, middle), view.facing, view.mirrored)


def reading(recording: Recording, format: str) -> dict[str, Any]:
    """Return the arguments of `cyclosis.observations.read`, or of `film`, for the files of a record."""
    camera, data = recording.camera, recording.data
    said: dict[str, Any] = {"pixel_um": camera.pixel_um, "frame_s": camera.frame_s}
    if recording.kind == "film":
        return said
    if recording.kind == "mrv":
        said = {"format": "slice", "speed": "mm/s", "pixel_um": 1000 * float(data.attrs["pixel_mm"])}
    elif recording.kind == "kymograph":
        x, y = data["x"].values, data["y"].values
        said |= {"format": "kymograph", "line_px": [[float(x[k]), float(y[k])] for k in (0, -1)]}
    elif recording.kind == "orientation":
        said |= {"angle": "degrees"} | ({} if format == "orientationj" else {"format": "angles"})
    elif recording.kind == "tracks":
        said |= {"noise_px": np.sqrt(2.0) * camera.noise_px}  # of a displacement: of two places
    else:
        said |= {**VECTORS[format], "noise_px": camera.noise_px}
        if format == "npy":
            at = float(data["x"][0]), float(data["y"][0])
            said |= {"origin_px": list(at), "step_px": float(data["x"][1] - data["x"][0])}
    steps = np.diff(data["seconds"].values)
    several = recording.kind in ("piv", "orientation") and steps.size > 0
    if several and np.ptp(steps) < 1e-6 * steps.mean():
        said["every_s"] = float(steps.mean())
    return {name: value for name, value in said.items() if name != "noise_px" or value > 0}
