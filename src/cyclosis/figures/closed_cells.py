"""Closed cells of datasets: their grids, and fields and defects as drawings need them."""

from __future__ import annotations

import json
from functools import lru_cache

import numpy as np
import numpy.typing as npt
import xarray

from ..analysis.zones import DISORDER
from ..closed.defects import defects
from ..closed.grid import ClosedGrid
from ..closed.places import interpolation
from ..closed.shapes import Sphere
from ..model.errors import InputError
from ..model.grid import Array
from ..models.closed.shape_table import grid_of
from .frames import facing, frame
from .marks import Mark
from .portraits import Look
from .skin import Skin
from .subjects import Subject

AROUND = 192
"""Points around the chart on which fields are drawn."""
SPACING = 0.035
"""Distance between its points along a meridian, in radii."""

BODY = 0.5
"""Zones are looked for on circles of at least this radius."""


def closed_grid(dataset: xarray.Dataset) -> ClosedGrid:
    """Return the grid of the dataset of a closed run.

    Raises `InputError` for a dataset without a configuration, and for one that holds only a part of the cell,
    as a selection does.
    """
    table = json.loads(dataset.attrs.get("configuration", "{}")).get("grid")
    if not isinstance(table, dict):
        rule = "with its attribute `configuration`, which says what the surface is"
        raise InputError("the dataset's attributes", sorted(dataset.attrs), rule, "use the dataset of a run")
    grid = grid_of(**table)
    for name, points in (("theta", grid.theta), ("s", grid.s)):
        found = np.asarray(dataset[name].values) if name in dataset.coords else points
        if found.size != points.size or not np.allclose(found, points, rtol=0, atol=1e-6):
            shown, rule = f"{found.size} points", f"those of the whole cell, {points.size}"
            remedy = "keep the whole cell, not a part of it"
            raise InputError(f"{name} in the dataset", shown, rule, remedy)
    return grid


@lru_cache(maxsize=4)
def skin_of(grid: ClosedGrid) -> Skin:
    """Return the surface of a grid as drawings need it."""
    fine = grid.surface.meridian(np.linspace(0.0, np.pi, 4097))
    count = 2 * round(0.5 * grid.surface.meridian_length / SPACING) + 1
    s = np.linspace(0.0, float(fine.s[-1]), count)
    at = grid.surface.meridian(np.interp(s, fine.s, np.linspace(0.0, np.pi, 4097)))
    r = np.where((s == 0) | (s == s[-1]), 0.0, at.r)
    return Skin(AROUND, s, r, at.z, at.slope, at.rise, not isinstance(grid.surface, Sphere))


def on_chart(grid: ClosedGrid, field: npt.ArrayLike) -> Array:
    """Return a vector field (2, n_theta, n_s) on the chart (2, around, n) of `skin_of` its grid.

    Around the cell by its Fourier series, along it by the polynomial in cos τ, times sin τ for even modes.
    """
    given = np.asarray(field, dtype=np.float64)
    skin = skin_of(grid)
    spectrum = np.fft.fft(given[0] + 1j * given[1], axis=0, norm="forward")
    m = np.fft.fftfreq(grid.n_theta, 1 / grid.n_theta)
    onto, at_sin = _onto(grid)
    x = grid.points.x
    sin = np.sqrt((1 - x) * (1 + x))
    fine = np.zeros((skin.around, skin.s.size), complex)
    for wave, row in zip(m.astype(int).tolist(), spectrum, strict=True):
        if abs(wave) < min(grid.n_theta, skin.around) // 2:
            fine[wave] = onto @ row if wave % 2 else at_sin * (onto @ (row / sin))
    values = np.fft.ifft(fine, axis=0, norm="forward")
    return np.stack([values.real, values.imag])


@lru_cache(maxsize=4)
def _onto(grid: ClosedGrid) -> tuple[Array, Array]:
    """Return the matrix (n, n_s) that takes polynomials in cos τ to the chart, and sin τ there."""
    tau_fine = np.linspace(0.0, np.pi, 4097)
    tau = np.interp(skin_of(grid).s, grid.surface.meridian(tau_fine).s, tau_fine)
    return interpolation(grid.points, np.cos(tau)), np.sin(tau)


def marks_of(grid: ClosedGrid, P: Array) -> list[Mark]:
    """Return the defects of a state (2, n_theta, n_s): none in disorder, which is full of them."""
    if np.sqrt(grid.mean(np.sum(P**2, axis=0))) < DISORDER:
        return []
    return [(found.index, found.theta, found.s) for found in defects(grid, P)]


def turned(grid: ClosedGrid, field: Array, turn: Array) -> Array:
    """Return a vector field (2, n_theta, n_s) on a sphere, rotated with the sphere by a matrix (3, 3)."""
    before = np.tensordot(turn.T, grid.xyz, axes=1).reshape(3, -1).T
    vectors = (grid.cartesian(field, before) @ turn.T).T.reshape(3, *grid.shape)
    return np.stack([np.sum(vectors * grid.e_theta, axis=0), np.sum(vectors * grid.e_s, axis=0)])


def upright(grid: ClosedGrid, P: Array, u: Array) -> Array:
    """Return the rotation (3, 3) that turns the axis about which a flow on a sphere circulates to z.

    Without a flow it is the axis about which P circulates, and without either nothing is turned.
    """
    for field in (u, P):
        vectors = grid.e_theta * field[0] + grid.e_s * field[1]
        axis = np.asarray(grid.mean(np.cross(grid.xyz, vectors, axis=0)))
        size = float(np.hypot.reduce(axis))
        if size > 1e-6:
            break
    else:
        return np.eye(3)
    z = axis / size
    x = np.cross([0.0, 1.0, 0.0] if abs(z[1]) < 0.9 else [1.0, 0.0, 0.0], z)
    x /= np.hypot.reduce(x)
    return np.stack([x, np.cross(z, x), z])


def closed_subject(dataset: xarray.Dataset, upright_in: xarray.Dataset | None = None) -> Subject:
    """Return the cell of the dataset of a closed run.

    A sphere is shown with the axis about which its flow circulates in the last frame upright, or that of
    another run.
    """
    grid = closed_grid(dataset)
    other = dataset if upright_in is None else upright_in
    turn = None if skin_of(grid).axial else upright(closed_grid(other), *frame(other, -1))

    def look(P: Array, u: Array) -> Look:
        if turn is not None:
            P, u = turned(grid, P, turn), turned(grid, u, turn)
        return Look(on_chart(grid, P), on_chart(grid, u), marks_of(grid, P))

    def facing_of(P: Array) -> float:
        body = np.where(grid.r >= BODY, grid.weights[0], 0.0)
        return 0.0 if turn is not None else facing(P[1] @ body / body.sum())

    return Subject(skin_of(grid), look, facing_of, 1.0)
