"""Tables kept on disk under a name that says what they hold: a checksum of what they were computed for."""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Callable, Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any
from zipfile import BadZipFile

import numpy as np
import numpy.typing as npt

from ..model.programs import OFF, VARIABLE, programs_folder

FORMAT = 2
"""To be raised when the same key gives other tables."""
MOST_FILES = 32
"""Files that are kept; the least recently used are deleted first."""

Named = dict[str, npt.NDArray[Any]]


def kept(key: Mapping[str, Any], compute: Callable[[], Named]) -> Named:
    """Return arrays by name: those stored for this key, or else computed ones, which are then stored.

    The folder is a neighbour of that of compiled programs, and CYCLOSIS_PROGRAMS=off switches it off. A file
    that cannot be read or written is ignored.
    """
    if os.environ.get(VARIABLE, "").lower() == OFF:
        return compute()
    text = json.dumps({"format": FORMAT, **key}, sort_keys=True)
    folder = programs_folder().parent / "harmonics"
    path = folder / f"{hashlib.sha256(text.encode()).hexdigest()[:20]}.npz"
    with suppress(OSError, BadZipFile, ValueError, KeyError, EOFError), np.load(path) as stored:
        if str(stored["key"]) == text:
            found = {name: stored[name] for name in stored.files if name != "key"}
            os.utime(path)
            return found
    made = compute()
    with suppress(OSError):
        folder.mkdir(parents=True, exist_ok=True)
        unfinished = path.with_suffix(f".{os.getpid()}.npz")
        np.savez(unfinished, key=np.array(text), **made)  # type: ignore[arg-type]
        os.replace(unfinished, path)
        _prune(folder)
    return made


def _prune(folder: Path) -> None:
    files = sorted(folder.glob("*.npz"), key=lambda path: path.stat().st_mtime, reverse=True)
    for path in files[MOST_FILES:]:
        path.unlink(missing_ok=True)
