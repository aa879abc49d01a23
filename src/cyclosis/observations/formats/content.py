"""What a file holds, before units and directions are settled: columns of numbers, and what the file says."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from ...model.errors import InputError

Array = npt.NDArray[np.float64]
Columns = dict[str, Array]
"""Columns of one length by name: x, y, u, v, good; or x, y, angle, good; or x, y, frame, track."""

VELOCITY, TRACKS, ANGLE, KYMOGRAPH, SLICE, SURFACE = (
    "velocity",
    "tracks",
    "angle",
    "kymograph",
    "slice",
    "surface",
)


@dataclass
class Content:
    """What a file holds.

    `frames` has the columns of every field in it. `length`, `speed` and `y` are the units and the direction
    of y that the file tells or its format fixes, None where somebody must say; `angle` is "degrees" or
    "radians". `origin_px` is the place of (0, 0) of the file in the image. `notes` are its conventions, as
    sentences to be shown.
    """

    format: str
    kind: str
    frames: list[Columns]
    length: str | None = None
    speed: str | None = None
    y: str | None = None
    pixel_um: float | None = None
    frame_s: float | None = None
    origin_px: tuple[float, float] | None = None
    complete: bool = False
    image: npt.NDArray[Any] | None = None
    notes: list[str] = field(default_factory=list)
    extra: dict[str, Any] = field(default_factory=dict)


@dataclass(frozen=True)
class Asked:
    """What the caller said of a file, for the formats that need it."""

    format: str | None = None
    columns: Mapping[str, Any] | None = None
    order: str | None = None
    step_px: float = 1.0


def unreadable(path: Path, rule: str, remedy: str) -> InputError:
    """Return the error for a file that cannot be used."""
    return InputError("file", str(path), rule, remedy)


def good_of(*columns: Array) -> npt.NDArray[np.bool_]:
    """Return where all columns are finite."""
    out = np.ones(columns[0].shape, dtype=bool)
    for column in columns:
        out &= np.isfinite(column)
    return out
