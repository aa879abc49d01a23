"""The files of a record: those of a program, a picture, and the truth of the view."""

from __future__ import annotations

import json
import os
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

from ...dataset import check_writable
from ...dataset.whole import whole
from ...model.errors import InputError
from . import images, tables
from .conventions import reading

if TYPE_CHECKING:
    from .observe import Recording

Content = dict[str, Callable[[Path], None]]
"""Functions that write a file, by its name."""

WRITERS: dict[tuple[str, str], Callable[[Recording], Content]] = {
    ("piv", "openpiv"): tables.openpiv,
    ("piv", "openpiv-um"): tables.openpiv_um,
    ("piv", "pivlab"): tables.pivlab,
    ("piv", "pivlab-m"): tables.pivlab_m,
    ("piv", "pivlab-mat"): tables.pivlab_mat,
    ("piv", "npy"): tables.flow_npy,
    ("kymograph", "tiff"): images.kymograph_tiff,
    ("kymograph", "npy"): images.kymograph_npy,
    ("tracks", "trackmate"): tables.trackmate,
    ("tracks", "trackmate-xml"): tables.trackmate_xml,
    ("tracks", "trackpy"): tables.trackpy,
    ("orientation", "orientationj"): tables.orientationj,
    ("orientation", "npy"): images.angle_npy,
    ("orientation", "tiff"): images.angle_tiff,
    ("mrv", "tiff"): images.mrv_tiff,
    ("mrv", "mat"): images.mrv_mat,
    ("mrv", "npy"): images.mrv_npy,
    ("film", "avi"): images.film_avi,
    ("film", "mp4"): images.film_mp4,
    ("film", "tiff"): images.film_tiff,
}


def write(recording: Recording, folder: Path, format: str, force: bool) -> list[Path]:
    """Write the files of a record into a folder; see `Recording.write`."""
    from ...figures import style

    content = WRITERS[recording.kind, format](recording)
    names = list(content)
    files = [name for name in names if not name.startswith("filaments")]
    truth = recording.truth() | {"format": format, "files": files, "read": reading(recording, format)}
    picture = f"{recording.kind}.png"
    content |= {"view.json": lambda path: _text(path, json.dumps(truth, indent=1) + "\n")}
    prepare(folder, [*content, picture], force)
    paths = []
    for name, put in content.items():
        target = folder / name
        try:
            with whole(target) as new:
                put(new)
        except OSError as error:
            rule = "in a folder that can be written to"
            raise InputError(
                "out", str(target), rule, f"choose another ({error.strerror or error})"
            ) from error
        paths.append(target)
    return [*paths, style.save(style.signed(recording.figure(), truth), folder / picture)]


def prepare(folder: Path, names: list[str], force: bool) -> None:
    """Make a folder, and refuse it before any file is written if one of them is in the way."""
    try:
        folder.mkdir(exist_ok=True)
    except OSError as error:
        rule = "a folder that can be written to"
        raise InputError("out", str(folder), rule, f"choose another ({error.strerror or error})") from error
    for name in names:
        if force and os.path.isfile(folder / name):
            continue
        check_writable(folder / name, force)


def _text(path: Path, text: str) -> None:
    path.write_text(text, encoding="utf-8")
