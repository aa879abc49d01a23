"""Marks of defects: a plus or a minus in a small disc, by index."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from ..model.grid import Array
from .style import INK

Mark = tuple[int, float, float]
"""A defect of P: its index, theta in radians, and s in radii."""
SIZE = 5.0
"""Diameter of a mark in points."""


def draw_marks(ax: Any, places: Array, index: npt.ArrayLike, size: float = SIZE, clip: bool = False) -> None:
    """Mark defects of given indices (n,) at places (n, 2): +1 in a white disc, -1 in a dark one."""
    signs = np.asarray(index)
    for chosen, face, line, bars in (
        (signs > 0, "white", INK, ("_", "|")),
        (signs < 0, INK, "white", ("_",)),
    ):
        x, y = places[chosen].T
        if not x.size:
            continue
        ax.scatter(x, y, s=size**2, c=face, edgecolors=INK, linewidths=0.6, zorder=5, clip_on=clip)
        for bar in bars:
            ax.scatter(x, y, s=(0.55 * size) ** 2, c=line, marker=bar, linewidths=0.9, zorder=6, clip_on=clip)
