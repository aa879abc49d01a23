"""What this installation computes with."""

from __future__ import annotations

import os
import platform
import shutil
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

from ..model.errors import InputError
from .lines import aligned

_PACKAGES = (
    "cyclosis",
    "jax",
    "jaxlib",
    "numpy",
    "scipy",
    "xarray",
    "h5netcdf",
    "h5py",
    "matplotlib",
    "contourpy",
    "distributed",
    "zarr",
)


def machine() -> str:
    """Return what this installation computes with: versions, devices, threads, precision, disk."""
    devices, precision = _computing()
    cpus = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count()
    lines = {
        "system": f"{platform.system()} {platform.machine()}, Python {platform.python_version()}",
        "packages": ", ".join(f"{name} {_version(name)}" for name in _PACKAGES),
        "devices": devices,
        "threads": f"{cpus} usable of {os.cpu_count()}",
        "programs": _programs(),
        "XLA_FLAGS": os.environ.get("XLA_FLAGS") or "not set",
        "precision": precision,
        "disk": _disk(),
    }
    return aligned(lines, 10)


def _programs() -> str:
    """Return where compiled programs are kept, and their size; call after something was computed."""
    import jax

    config: Any = jax.config
    place = config.jax_compilation_cache_dir
    if not place or not config.jax_enable_compilation_cache:
        return "not kept: every process compiles"
    sizes = [path.stat().st_size for path in Path(place).glob("*") if path.is_file()]
    return f"{sum(sizes) / 2**20:.0f} MiB of compiled ones kept in {place}"


def _computing() -> tuple[str, str]:
    """Return the devices, and whether double precision works on them."""
    import jax
    import jax.numpy as jnp

    from ..model.precision import double

    try:
        with double():
            exact = float(jnp.asarray(1.0) + 1e-15) != 1.0
    except InputError as error:
        return f"NONE for {error.field} = {error.value}", "not tried"
    devices = ", ".join(f"{device.platform} ({device.device_kind})" for device in jax.devices())
    return devices, "float64 works" if exact else "float64 DOES NOT WORK: reinstall jax"


def _disk() -> str:
    try:
        folder = os.getcwd()
        return f"{shutil.disk_usage(folder).free / 2**30:.1f} GiB free in {folder}"
    except OSError as error:
        return f"unknown: the current folder cannot be read ({error.strerror})"


def _version(name: str) -> str:
    try:
        return version(name)
    except PackageNotFoundError:
        return "missing"
