"""Compiled programs, kept on disk: the second process that needs one loads it instead of compiling it.

The folder is $CYCLOSIS_PROGRAMS, or else cyclosis/programs in $XDG_CACHE_HOME or ~/.cache; where that cannot
be written, a private folder among the temporary files. CYCLOSIS_PROGRAMS=off switches it off. A user's
settings of JAX's own cache are kept. Everything in the folder may be deleted at any time.
"""

from __future__ import annotations

import hashlib
import os
import platform
import shutil
import tempfile
import time
import zlib
from contextlib import suppress
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from threading import Lock
from typing import Any

VARIABLE = "CYCLOSIS_PROGRAMS"
OFF = "off"
MOST_BYTES = 512 * 2**20
"""Bytes of programs that are kept; the least recently used are deleted first."""
OUTDATED = 30 * 86_400.0
"""Seconds after which the programs of another version of JAX, or another processor, are deleted."""
CHECKED = ".checked"
"""The time of this file is that of the last check: programs written before it are complete."""
EVERYTHING = {
    "jax_persistent_cache_min_compile_time_secs": 0.0,
    "jax_persistent_cache_min_entry_size_bytes": 0,
}
"""Small programs are kept too: a run needs dozens, and each takes some hundredths of a second to compile."""

_FIRST = Lock()


def keep_programs() -> None:
    """Make JAX keep compiled programs, unless the user has decided otherwise; only the first call counts."""
    with _FIRST:
        _keep_programs()


@cache
def _keep_programs() -> None:
    import jax

    config: Any = jax.config
    if os.environ.get(VARIABLE, "").lower() == OFF or not config.jax_enable_compilation_cache:
        return
    if config.jax_compilation_cache_dir:
        return
    folder = programs_folder()
    check(folder)
    for name, value in EVERYTHING.items():
        if name.upper() not in os.environ:
            config.update(name, value)
    config.update("jax_compilation_cache_dir", str(folder))


def programs_folder() -> Path:
    """Return this user's folder for programs, one for each version of JAX and kind of processor."""
    name = f"{_version()}-{_processor()}"
    home = os.environ.get("XDG_CACHE_HOME") or os.path.expanduser("~/.cache")
    given = os.environ.get(VARIABLE)
    places = [Path(given)] if given else []
    for place in (*places, Path(home) / "cyclosis" / "programs", _private(Path(tempfile.gettempdir()))):
        folder = place / name
        with suppress(OSError):
            folder.mkdir(parents=True, exist_ok=True)
            if os.access(folder, os.W_OK | os.X_OK):
                return folder
    return Path(tempfile.mkdtemp(prefix="cyclosis-"))


def check(folder: Path, most: int = MOST_BYTES) -> None:
    """Delete programs that are broken, or beyond `most` bytes in all, and outdated folders beside this one.

    A process that was killed may have left a partly written program. One that is just being written may be
    deleted as well: it is compiled again when it is next needed. Errors are ignored, because other processes
    may do the same at the same time.
    """
    with suppress(OSError):
        began = time.time()
        stamp = folder / CHECKED
        last = stamp.stat().st_mtime if stamp.exists() else 0.0
        found = [(path, path.stat()) for path in folder.iterdir() if path != stamp]
        stamp.touch()
        os.utime(stamp, (began, began))
        by_use = sorted(found, key=lambda item: max(item[1].st_atime, item[1].st_mtime), reverse=True)
        total = 0
        for path, facts in by_use:
            total += facts.st_size
            if total > most or (facts.st_mtime >= last and not _whole(path)):
                path.unlink(missing_ok=True)
        for other in folder.parent.iterdir():
            stamp = other / CHECKED
            if other != folder and stamp.exists() and stamp.stat().st_mtime < began - OUTDATED:
                shutil.rmtree(other, ignore_errors=True)


def _whole(path: Path) -> bool:
    """Return whether a program can be unpacked; one in another format than zlib's is taken to be complete."""
    stored = path.read_bytes()
    if not stored.startswith(b"\x78"):
        return bool(stored)
    try:
        zlib.decompress(stored)
    except zlib.error:
        return False
    return True


def _private(temporary: Path) -> Path:
    """Return a folder in a temporary folder to which nobody else can write."""
    owner = os.getuid() if hasattr(os, "getuid") else 0
    folder = temporary / f"cyclosis-{owner}"
    try:
        folder.mkdir(mode=0o700, exist_ok=True)
        known = folder.stat()
    except OSError:
        return folder
    foreign = hasattr(os, "getuid") and (known.st_uid != owner or known.st_mode & 0o022)
    return Path(tempfile.mkdtemp(prefix="cyclosis-")) if foreign else folder


def _version() -> str:
    try:
        return f"jax-{version('jaxlib')}"
    except PackageNotFoundError:
        return "jax"


def _processor() -> str:
    """Return a short name of this kind of processor: programs compiled for one may crash another."""
    found = platform.machine()
    try:
        with open("/proc/cpuinfo") as file:
            found += next((line for line in file if line.startswith(("flags", "Features"))), "")
    except OSError:
        found += platform.processor()
    return hashlib.sha256(found.encode()).hexdigest()[:12]
