"""The periodic cylinder in the explorer."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from ..analysis.regimes import regime
from ..analysis.zones import crossings
from ..contract.model import Array
from ..model.grid import CylinderGrid
from .surfaces import Judged, Surface


class OnCylinder(Surface):
    """Pictures hold the fields of the grid as they are."""

    traces = ("order", "mean_P_theta", "mean_P_z", "peak_speed", "power_input")
    straight = True

    def program(self, grid: CylinderGrid) -> tuple[Any, ...]:
        """Return the shape of a grid."""
        return grid.shape

    def known(self, grid: CylinderGrid) -> bool:
        """Nothing takes long."""
        return True

    def nearest(self, grid: CylinderGrid, z: float) -> float:
        """Return the height of the periodic cell that z means."""
        return round(z % grid.length, 3)

    def size(self, grid: CylinderGrid) -> tuple[int, int, float]:
        """Return the points and the length of a grid."""
        return grid.n_theta, grid.n_z, grid.length

    def drawn(self, grid: CylinderGrid, field: Array) -> Array:
        """Return a field as it is."""
        return field

    def outline(self, grid: CylinderGrid) -> None:
        """Return None: the page knows a cylinder."""

    def row(self, record: Mapping[str, Any]) -> list[float]:
        """Return the `traces` of a record."""
        mean = np.asarray(record["mean_P"])
        values = (record["order"], mean[0], mean[1], record["peak_speed"], record["power_input"])
        return [float(value) for value in values]

    def judged(self, params: Any, grid: CylinderGrid, P: Array) -> Judged:
        """Return the regime of a state P (2, n_theta, n_z)."""
        found, crossed = regime(params, grid, P), crossings(P)
        numbers = {
            "zones": found.zones.tolist(),
            "order": found.order,
            "around": float(np.mean(P[0] ** 2)) / max(found.order**2, 1e-300),
            "boundaries": [int(crossed.min()), int(crossed.max())],
            "drift": found.drift.tolist(),
            "mean": found.mean_P.tolist(),
        }
        return Judged(found.name, found.reason, found.widths, numbers)
