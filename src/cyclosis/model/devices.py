"""The devices that JAX computes on, and the error if it has none of those requested."""

from __future__ import annotations

import sys
from functools import cache
from importlib.metadata import entry_points
from pathlib import Path
from typing import Any

from .errors import InputError

VARIABLE = "JAX_PLATFORMS"
_GPU = ("cuda", "gpu")
_KNOWN = ("cpu", *_GPU, "rocm", "tpu")


def gpus() -> list[str]:
    """Return the numbers of the NVIDIA GPUs that this machine shows, without loading JAX."""
    return sorted(path.name.removeprefix("nvidia") for path in Path("/dev").glob("nvidia[0-9]*"))


def has_gpu_part() -> bool:
    """Return whether JAX was installed with its part for NVIDIA GPUs, without loading JAX."""
    return "cuda" in _plugins()


def _plugins() -> set[str]:
    """Return the names of the parts for accelerators that JAX was installed with; all for NVIDIA are cuda."""
    names = {item.name for item in entry_points(group="jax_plugins")}
    return {"cuda" if "cuda" in name else name for name in names}


def require_platforms(asked: str) -> None:
    """Raise `InputError` for platforms, as in JAX_PLATFORMS, that are certainly missing; JAX is not started.

    Example:
        >>> from cyclosis.model.devices import require_platforms
        >>> require_platforms("cpu")
        >>> require_platforms("")
    """
    for name in filter(None, (name.strip() for name in asked.split(","))):
        if (name in _GPU and _no_gpu()) or not (name in _KNOWN or _plugins() - {"cuda"}):
            raise _refused(asked, "")


@cache
def require_devices() -> None:
    """Start JAX's devices. Raises `InputError` if JAX has none of the platforms that it is set to use.

    Example:
        >>> from cyclosis.model.devices import require_devices
        >>> require_devices()
    """
    import jax

    config: Any = jax.config
    try:
        jax.devices()
    except (RuntimeError, AssertionError) as error:  # some releases of JAX assert that a GPU is there
        raise _refused(config.jax_platforms or "", _gist(error)) from error


def _no_gpu() -> str:
    """Return why there is certainly no NVIDIA GPU for JAX, or an empty text."""
    if not has_gpu_part():
        return "JAX is installed without its part for NVIDIA GPUs"
    return "this machine shows no NVIDIA GPU" if sys.platform == "linux" and not gpus() else ""


def _gist(error: Exception) -> str:
    """Return the reason that JAX gives, without its remedy."""
    text = " ".join(str(error).split()).partition(" (set JAX_PLATFORMS")[0]
    return text.partition("': ")[2] if text.startswith("Unable to initialize") else text


def _refused(asked: str, said: str) -> InputError:
    why = _no_gpu() if any(name in asked for name in _GPU) else ""
    why = why or (f"JAX says: {said[:160].rstrip('.')}" if said else "")
    remedy = f"unset it, or set it to cpu ({why})" if why else "unset it, or set it to cpu"
    return InputError(VARIABLE, asked, "a platform that JAX finds on this machine, such as cpu", remedy)
