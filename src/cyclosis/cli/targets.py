"""Output paths, checked before any work is done: the suffix names the format, and the place is writable."""

from __future__ import annotations

import hashlib
import json
import os
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

from ..model.errors import InputError
from ..model.units import chosen_scales, table_of
from . import usage

RUN = (".nc", ".nc4", ".h5")
FIGURE = (".png", ".pdf", ".svg", ".eps")
MOVIE = (".mp4", ".gif")
THEORY = (*FIGURE, ".nc", ".csv")
_NOT_DECISIVE = ("out", "force", "quiet", "json_lines", "width_mm", "colours", "font", "style")


def check(target: Path, force: bool, suffixes: tuple[str, ...]) -> None:
    """Refuse a file that could not be written, or whose suffix is that of another format."""
    from .. import dataset
    from ..dataset.place import is_stream

    if not target.name.lower().endswith(suffixes) and not is_stream(target) and not os.path.isdir(target):
        rule = f"a file name that ends in {_listed(suffixes)}, the format that is written"
        raise InputError("out", str(target), rule, f"write {target.stem}{suffixes[0]}, for example")
    dataset.check_writable(target, force)
    try:
        with tempfile.TemporaryFile(dir=target.parent):
            pass
    except OSError as error:
        rule = "in a folder that can be written to"
        raise InputError("out", str(target), rule, f"choose another ({error.strerror})") from error


_FRAMES = "every frame becomes a file (.vts), with one over all (.pvd)"


def check_folder(target: Path, reason: str = _FRAMES) -> None:
    """Refuse the name of a file for a new folder."""
    if target.suffix[1:2].isalpha() and not os.path.isdir(target):
        rule = f"the name of a folder, because {reason}"
        raise InputError("out", str(target), rule, f"leave out {target.suffix}")


def write(out: list[Path] | None, draw: Callable[[], Any], numbers: Callable[[], Any]) -> None:
    """Write results to files, as figures or numbers, depending on their suffixes."""
    from ..dataset.tables import SUFFIXES, write_table

    for target in out or []:
        if target.suffix.lower() in SUFFIXES:
            write_table(_with_units(numbers()), target)
        else:
            from ..figures import style

            style.save(style.signed(draw(), configuration()), target)
        print(f"saved {target}")


def _with_units(numbers: Any) -> Any:
    """Return a dataset with the scales that were chosen as an attribute. Its numbers stay as they are."""
    scales = chosen_scales()
    if scales is None:
        return numbers
    return numbers.assign_attrs(scales=json.dumps(table_of(scales), sort_keys=True))


def configuration() -> dict[str, Any]:
    """Return the command and what determines its results; files by the SHA-256 of their content."""
    asked = usage.asked()
    decisive = {n: value for n, value in asked.items() if value is not None and n not in _NOT_DECISIVE}
    return {name: _content(value) for name, value in decisive.items()}


def _content(value: Any) -> Any:
    if isinstance(value, Path) and value.is_file():
        with value.open("rb") as file:
            return hashlib.file_digest(file, "sha256").hexdigest()
    return value


def _listed(names: tuple[str, ...]) -> str:
    return names[0] if len(names) == 1 else ", ".join(names[:-1]) + f" or {names[-1]}"
