"""What a process that computes members should find in its environment, before JAX is loaded.

A worker is one process on one core: threads of its own would only compete with its neighbours. Compiled
programs are kept on disk, so that the second worker, and a worker that returns, need not compile again.
"""

from __future__ import annotations

import hashlib
import os
import platform
import tempfile
from collections.abc import Mapping
from importlib.metadata import entry_points
from pathlib import Path

import psutil

XLA_FLAG = "xla_cpu_multi_thread_eigen"
SINGLE = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")
CACHE = "JAX_COMPILATION_CACHE_DIR"


def wanted(found: Mapping[str, str]) -> dict[str, str]:
    """Return the variables to set in a worker's environment; what the user has set stays."""
    out = {name: "1" for name in SINGLE if name not in found}
    flags = found.get("XLA_FLAGS", "")
    if XLA_FLAG not in flags:
        out["XLA_FLAGS"] = f"{flags} --{XLA_FLAG}=false".strip()
    if CACHE not in found:
        out[CACHE] = str(cache_folder())
        out["JAX_PERSISTENT_CACHE_MIN_COMPILE_TIME_SECS"] = "0"
        out["JAX_PERSISTENT_CACHE_MIN_ENTRY_SIZE_BYTES"] = "0"
    return out


def lacking(found: Mapping[str, str]) -> tuple[str, ...]:
    """Return the variables that the environment of a worker started by others should have and has not."""
    if accelerators(found):
        return () if CACHE in found else (CACHE,)
    out = [name for name in SINGLE if found.get(name) != "1"]
    if XLA_FLAG not in found.get("XLA_FLAGS", ""):
        out.append("XLA_FLAGS")
    return tuple(out if CACHE in found else [*out, CACHE])


def cache_folder() -> Path:
    """Return this user's folder for compiled programs, one for every kind of processor.

    It lies in $XDG_CACHE_HOME or ~/.cache; where that cannot be written, in the folder for temporary files.
    """
    name = f"jax-{_processor()}"
    home = os.environ.get("XDG_CACHE_HOME") or os.path.expanduser("~/.cache")
    for folder in (Path(home) / "cyclosis" / name, _private(Path(tempfile.gettempdir())) / name):
        try:
            folder.mkdir(parents=True, exist_ok=True)
        except OSError:
            continue
        if os.access(folder, os.W_OK | os.X_OK):
            return folder
    return Path(tempfile.mkdtemp(prefix="cyclosis-"))


def accelerators(found: Mapping[str, str]) -> list[str]:
    """Return the names, for CUDA_VISIBLE_DEVICES, of the GPUs that JAX would use, without loading it."""
    platforms = found.get("JAX_PLATFORMS", "cuda").replace("gpu", "cuda").split(",")
    if "cuda" not in platforms or not any("cuda" in item.name for item in entry_points(group="jax_plugins")):
        return []
    present = sorted(path.name.removeprefix("nvidia") for path in Path("/dev").glob("nvidia[0-9]*"))
    visible = found.get("CUDA_VISIBLE_DEVICES")
    if visible is None or not present:
        return present
    return [name.strip() for name in visible.split(",") if name.strip() and name.strip() != "-1"]


def cores() -> list[int]:
    """Return the numbers of the cores that this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return sorted(os.sched_getaffinity(0))
    return list(range(os.cpu_count() or 1))


def processes(found: Mapping[str, str]) -> int:
    """Return how many workers suit this machine: one a GPU, or one a core."""
    return len(accelerators(found)) or len(cores())


def idlest_cores() -> list[int]:
    """Return those cores, the ones with the least to do first: others may compute here as well."""
    busy = psutil.cpu_percent(0.1, percpu=True)
    return sorted(cores(), key=lambda core: busy[core] if core < len(busy) else 0.0)


def settle(core: int) -> None:
    """Keep this process on one core. Libraries that are loaded after this start no more threads than that."""
    if hasattr(os, "sched_setaffinity"):
        os.sched_setaffinity(0, {core})


def _private(temporary: Path) -> Path:
    """Return a folder there that nobody else can put programs into."""
    owner = os.getuid() if hasattr(os, "getuid") else 0
    folder = temporary / f"cyclosis-{owner}"
    try:
        folder.mkdir(mode=0o700, exist_ok=True)
        known = folder.stat()
    except OSError:
        return folder
    foreign = hasattr(os, "getuid") and (known.st_uid != owner or known.st_mode & 0o022)
    return Path(tempfile.mkdtemp(prefix="cyclosis-")) if foreign else folder


def _processor() -> str:
    """Return a short name of this kind of processor: programs compiled for one may crash another."""
    found = platform.machine()
    try:
        with open("/proc/cpuinfo") as file:
            found += next((line for line in file if line.startswith(("flags", "Features"))), "")
    except OSError:
        found += platform.processor()
    return hashlib.sha256(found.encode()).hexdigest()[:12]
