"""Closed cells in the explorer: capsules, spheroids and spheres."""

from __future__ import annotations

import math
from collections.abc import Mapping
from functools import lru_cache
from typing import Any

import numpy as np

from ..closed.grid import ClosedGrid
from ..closed.places import interpolation
from ..closed.shapes import Sphere
from ..contract.model import Array
from ..model.grid import sign_changes
from ..models.closed.states import STRAIGHT
from ..models.fields import regime
from .surfaces import Judged, Surface

MERIDIAN = 97
"""Points of the meridian that the page gets: it draws the surface by them."""
MOST_KNOWN = 500
_known: set[ClosedGrid] = set()
"""Grids whose harmonics are computed: they are kept on disk, so that computing them again is quick."""


class OnClosed(Surface):
    """Pictures hold fields on an even chart: theta as on the grid, s in even steps from pole to pole."""

    traces = (
        "order",
        *("mean_vector_x", "mean_vector_y", "mean_vector_z"),
        *("circulation_x", "circulation_y", "circulation_z"),
        "peak_speed",
        "power_input",
    )
    unused = ("repulsion_angle", "zero_theta_flux")

    def words(self, grid: ClosedGrid) -> str:
        """Return the shape of a cell and its points in words."""
        return f"a {grid.surface.kind} of {self.points(grid)} points"

    def program(self, grid: ClosedGrid) -> tuple[Any, ...]:
        """Return the shapes of a grid's points and of its harmonics."""
        tables = grid.tables
        return (*grid.shape, *tables.vector.shape, tables.flow.shape[-1])

    def known(self, grid: ClosedGrid) -> bool:
        """Whether the harmonics of a grid are computed."""
        if grid in _known:
            return True
        if len(_known) >= MOST_KNOWN:
            _known.clear()
        _known.add(grid)
        return False

    def nearest(self, grid: ClosedGrid, z: float) -> float:
        """Return the arc length from the south pole that is nearest to z."""
        s = min(max(z, 0.0), float(grid.surface.meridian_length))
        return math.floor(1000 * s) / 1000

    def size(self, grid: ClosedGrid) -> tuple[int, int, float]:
        """Return the points of the chart and the length of the meridian."""
        return grid.n_theta, grid.n_s + 1, float(grid.surface.meridian_length)

    def drawn(self, grid: ClosedGrid, field: Array) -> Array:
        """Return a vector field (2, n_theta, n_s) on the chart.

        Along the meridian it is the polynomial in cos τ, times sin τ for even azimuthal modes.
        """
        onto, at_sin, sin, odd = _chart(grid)
        spectrum = np.fft.fft(field[0] + 1j * field[1], axis=0)
        smooth = np.where(odd, spectrum, spectrum / sin) @ onto.T
        chart = np.fft.ifft(np.where(odd, smooth, smooth * at_sin), axis=0)
        return np.stack([chart.real, chart.imag])

    def outline(self, grid: ClosedGrid) -> dict[str, Any]:
        """Return r, z and the outward normal at even steps of s; `axial` is False on a sphere."""
        found = _outline(grid.surface)
        return {name: [round(float(x), 5) for x in values] for name, values in found.items()} | {
            "axial": not isinstance(grid.surface, Sphere)
        }

    def row(self, record: Mapping[str, Any]) -> list[float]:
        """Return the `traces` of a record."""
        vectors = np.asarray(record["mean_vector"]), np.asarray(record["circulation"])
        values = (record["order"], *vectors[0], *vectors[1], record["peak_speed"], record["power_input"])
        return [float(value) for value in values]

    def judged(self, params: Any, grid: ClosedGrid, P: Array) -> Judged:
        """Return the regime of a state P (2, n_theta, n_s), with its defects."""
        of_any: Any = regime  # its types are those of the cylinder
        found = of_any(params, grid, P)
        crossed = sign_changes(P[1][:, grid.r >= STRAIGHT])
        numbers = {
            "zones": [],
            "order": found.order,
            "around": float(grid.mean(P[0] ** 2)) / max(found.order**2, 1e-300),
            "boundaries": [int(crossed.min()), int(crossed.max())],
            "drift": [found.drift, 0.0],
            "mean": [float(each) for each in grid.mean(P)],
            "defects": [[each.index, each.theta, each.s] for each in found.defects],
            "circulation": found.circulation.tolist(),
        }
        return Judged(found.name, found.reason, np.zeros(0), numbers)


def _latitudes(surface: Any, s: Array) -> Array:
    """Return τ (n,) at arc lengths s (n,), to the accuracy of a picture and beyond."""
    fine = np.linspace(0.0, np.pi, 4097)
    tau = np.interp(s, surface.meridian(fine).s, fine)
    for _ in range(2):  # Newton's method
        here = surface.meridian(tau)
        tau = np.clip(tau - (here.s - s) / here.speed, 0.0, np.pi)
    return np.asarray(tau)


@lru_cache(maxsize=8)
def _chart(grid: ClosedGrid) -> tuple[Array, Array, Array, Array]:
    """Return the matrix from the latitudes of a grid to the chart, sin τ on both, and which m are odd."""
    s = np.linspace(0.0, float(grid.surface.meridian_length), grid.n_s + 1)
    tau = _latitudes(grid.surface, s)
    x = grid.points.x
    m = np.abs(np.fft.fftfreq(grid.n_theta, 1 / grid.n_theta)).astype(int)
    return (
        interpolation(grid.points, np.cos(tau)),
        np.sin(tau),
        np.sqrt((1 - x) * (1 + x)),
        m[:, None] % 2 == 1,
    )


@lru_cache(maxsize=8)
def _outline(surface: Any) -> dict[str, Array]:
    s = np.linspace(0.0, float(surface.meridian_length), MERIDIAN)
    at = surface.meridian(_latitudes(surface, s))
    ends = (s == 0) | (s == s[-1])
    return {"r": np.where(ends, 0.0, at.r), "z": at.z, "out": np.where(ends, 0.0, at.rise), "up": -at.slope}
