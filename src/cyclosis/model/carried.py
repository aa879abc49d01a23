"""What a value carries besides its numbers: a trace of JAX, masked entries, a unit.

Ignoring any of them silently would give a wrong answer: a gradient of zero, a number that was marked as
missing, metres taken for radii.
"""

from __future__ import annotations

import sys
from collections.abc import Mapping
from typing import Any

DIMENSIONLESS = ("", "1", "-", "none", "dimensionless", "1 dimensionless", "1.0 dimensionless")
ANGULAR = ("rad", "radian", "radians")
PLAIN = (float, int, bool, str, type(None))
"""Types that carry nothing else."""
NOT_TRACED = (
    "a plain value, because JAX cannot trace through this function",
    "inside jax.grad, jax.vmap and jax.jit use cyclosis.traced, whose functions take parameters by name",
)
"""The rule and the remedy for a traced value."""


def objection(value: Any) -> tuple[str, str] | None:
    """Return the rule that a value breaks by what it carries, and the remedy; None if it breaks no rule."""
    if type(value) in PLAIN:
        return None
    if traced(value):
        return NOT_TRACED
    if masked(value):
        return "without masked entries", "fill them, or leave out what is missing"
    found = unit(value)
    if found is not None and found.strip().lower() not in DIMENSIONLESS + ANGULAR:
        return (
            f"dimensionless, not in {found}",
            "divide by the scale of the cell (see cyclosis.Scales) and give the plain numbers",
        )
    return None


def traced(value: Any) -> bool:
    """Return whether JAX traces a value, or one inside a list, tuple, table or array of objects."""
    core = getattr(sys.modules.get("jax"), "core", None)  # nothing is traced before JAX is loaded
    return core is not None and _holds(value, core.Tracer)


def _holds(value: Any, kind: type) -> bool:
    if type(value) in PLAIN:
        return False
    if isinstance(value, kind):
        return True
    if isinstance(value, Mapping):
        return any(_holds(item, kind) for item in value.values())
    if isinstance(value, list | tuple):
        return any(_holds(item, kind) for item in value)
    if getattr(getattr(value, "dtype", None), "kind", "") == "O" and hasattr(value, "flat"):
        return any(isinstance(item, kind) for item in value.flat)
    return False


def masked(value: Any) -> bool:
    """Return whether some entries of an array are masked."""
    if labelled(value) or framed(value):
        return False
    mask = getattr(value, "mask", None)
    if mask is None or callable(mask):
        return False
    import numpy as np

    return bool(np.any(mask))


def unit(value: Any) -> str | None:
    """Return the unit that a value carries, as it is written, or None if it carries no unit."""
    if labelled(value):
        written = value.attrs.get("units", value.attrs.get("unit"))
        return str(written) if written is not None else unit(value.data)
    if framed(value):
        return None
    for name in ("units", "unit"):
        written = getattr(value, name, None)
        if written is not None and not callable(written):
            return str(written)
    return None


def labelled(value: Any) -> bool:
    """Return whether a value is an array with named dimensions, as those of xarray."""
    return all(hasattr(value, name) for name in ("dims", "attrs", "sizes", "transpose", "data"))


def framed(value: Any) -> bool:
    """Return whether a value is a table or a column of pandas."""
    return type(value).__module__.partition(".")[0] == "pandas"


def bare(value: Any) -> Any:
    """Return a zero-dimensional number of any array type as a Python number, everything else unchanged."""
    value = getattr(value, "magnitude", value)
    if getattr(value, "shape", None) == () and hasattr(value, "item"):
        kind = getattr(getattr(value, "dtype", None), "kind", "")
        if kind and kind in "biuf":
            import numpy as np

            return np.asarray(value).item()  # that of some arrays is again an array
    return value
