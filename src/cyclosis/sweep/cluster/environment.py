"""The environment of a process that computes members, to be set before JAX is loaded.

A worker is one process on one core: further threads would only compete with the other workers.
"""

from __future__ import annotations

import os
from collections.abc import Mapping

import psutil

from ...model.devices import gpus, has_gpu_part

XLA_FLAG = "xla_cpu_multi_thread_eigen"
SINGLE = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")


def wanted(found: Mapping[str, str]) -> dict[str, str]:
    """Return the variables to set in a worker's environment; what the user has set is kept."""
    out = {name: "1" for name in SINGLE if name not in found}
    flags = found.get("XLA_FLAGS", "")
    if XLA_FLAG not in flags:
        out["XLA_FLAGS"] = f"{flags} --{XLA_FLAG}=false".strip()
    return out


def lacking(found: Mapping[str, str]) -> tuple[str, ...]:
    """Return the variables that are missing in the environment of a worker started by others."""
    if accelerators(found):
        return ()
    out = [name for name in SINGLE if found.get(name) != "1"]
    if XLA_FLAG not in found.get("XLA_FLAGS", ""):
        out.append("XLA_FLAGS")
    return tuple(out)


def accelerators(found: Mapping[str, str]) -> list[str]:
    """Return the names, for CUDA_VISIBLE_DEVICES, of the GPUs that JAX would use, without loading it."""
    platforms = found.get("JAX_PLATFORMS", "cuda").replace("gpu", "cuda").split(",")
    if "cuda" not in platforms or not has_gpu_part():
        return []
    present = gpus()
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
    """Return how many workers suit this machine: one per GPU, or one per core."""
    return len(accelerators(found)) or len(cores())


def idlest_cores() -> list[int]:
    """Return those cores, the least busy first: other programs may run here as well."""
    busy = psutil.cpu_percent(0.1, percpu=True)
    return sorted(cores(), key=lambda core: busy[core] if core < len(busy) else 0.0)


def settle(core: int) -> None:
    """Pin this process to one core. Libraries that are loaded later then start only one thread."""
    if hasattr(os, "sched_setaffinity"):
        os.sched_setaffinity(0, {core})
