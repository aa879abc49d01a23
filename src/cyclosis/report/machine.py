"""What this installation computes with."""

from __future__ import annotations

import os
import platform
import shutil
from importlib.metadata import PackageNotFoundError, version

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
    import jax
    import jax.numpy as jnp

    from ..model.precision import double

    with double():
        exact = float(jnp.asarray(1.0) + 1e-15) != 1.0
    free = shutil.disk_usage(os.getcwd()).free / 2**30
    devices = ", ".join(f"{device.platform} ({device.device_kind})" for device in jax.devices())
    cpus = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count()
    lines = {
        "system": f"{platform.system()} {platform.machine()}, Python {platform.python_version()}",
        "packages": ", ".join(f"{name} {_version(name)}" for name in _PACKAGES),
        "devices": devices,
        "threads": f"{cpus} usable of {os.cpu_count()}",
        "XLA_FLAGS": os.environ.get("XLA_FLAGS") or "not set",
        "precision": "float64 works" if exact else "float64 DOES NOT WORK: reinstall jax",
        "disk": f"{free:.1f} GiB free in {os.getcwd()}",
    }
    return aligned(lines, 10)


def _version(name: str) -> str:
    try:
        return version(name)
    except PackageNotFoundError:
        return "missing"
