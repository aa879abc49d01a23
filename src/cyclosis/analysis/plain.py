"""Measured quantities as plain numbers."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..model.system import System


def plain(system: System, values: dict[str, Any]) -> dict[str, Any]:
    """Return measured quantities as floats and arrays, and the budget as a dictionary by term."""
    out: dict[str, Any] = {name: np.asarray(v) if np.ndim(v) else float(v) for name, v in values.items()}
    names = [term.name for term in system.terms]
    out["budget"] = dict(zip(names, map(float, out["budget"]), strict=True))
    return out
