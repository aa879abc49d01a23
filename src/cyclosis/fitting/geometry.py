"""What an error of the camera's geometry does to points and vectors on the surface.

With φ = θ - θ_facing, a point is seen at x = sin φ across the image and at z along it, in radii. If the axis
was off by an angle, the radius by a factor and the centre line by a distance, the same pixels lie elsewhere
on the surface, and vectors in the image are resolved differently there.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ..model.errors import InputError, closest, number
from ..model.grid import Array
from .film import Film

KINDS = {
    "axis_deg": ("standard deviation of the direction of the axis in degrees", 30.0),
    "radius": ("relative standard deviation of the radius", 0.5),
    "centre": ("standard deviation of the centre line across the axis, in radii", 0.5),
}
STEEPEST = 0.17
"""Least cos φ: points beyond are not moved closer to the rim."""


@dataclass(frozen=True)
class Tilt:
    """One geometry: the axis turned by `axis` radians, the radius times 1 + `radius`, a shift `centre`."""

    axis: float = 0.0
    radius: float = 0.0
    centre: float = 0.0

    def moved(self, theta: Array, z: Array, facing: float) -> tuple[Array, Array, Array]:
        """Return θ and z (n_theta, n_z) of the window's points, and the matrix (2, 2, ...) for vectors."""
        phi = theta[:, None] - facing
        middle = 0.5 * (z[0] + z[-1])
        x, y = np.broadcast_arrays(np.sin(phi), z[None, :] - middle)
        c, s, grown = np.cos(self.axis), np.sin(self.axis), 1 + self.radius
        across, along = (c * x + s * y) / grown + self.centre, (c * y - s * x) / grown
        bound = np.sqrt(1 - STEEPEST**2)
        across = np.clip(across, -bound, bound)
        angle = np.arcsin(across)
        before, after = np.cos(phi) + 0 * y, np.cos(angle)
        # On the image a vector is (cos φ v_θ, v_z); there it is turned and scaled, and then unprojected.
        frame = np.array([[c * before / after, s / after], [-s * before, c + 0 * y]]) / grown
        return facing + angle, middle + along, frame


def tilts(geometry: Mapping[str, Any] | None, draws: int, rng: np.random.Generator) -> list[Tilt]:
    """Return random geometries within their uncertainty, or none where it is not given."""
    scale = _deviations(geometry)
    return [Tilt(*(scale * rng.normal(size=3))) for _ in range(draws)] if scale.any() else []


def axes(geometry: Mapping[str, Any] | None) -> list[Tilt]:
    """Return the geometries that are off by one standard deviation in one thing each."""
    return [Tilt(*row) for row in np.diag(_deviations(geometry)) if row.any()]


def _deviations(geometry: Mapping[str, Any] | None) -> Array:
    """Return the standard deviations of a `Tilt`."""
    if geometry is None:
        return np.zeros(3)
    if not isinstance(geometry, Mapping):
        rule = "a table of axis_deg, radius and centre"
        raise InputError("geometry", geometry, rule, "write geometry={'axis_deg': 0.5}")
    size = dict.fromkeys(KINDS, 0.0)
    for name, value in geometry.items():
        if name not in KINDS:
            raise InputError("geometry", name, "one of " + ", ".join(KINDS), closest(name, KINDS))
        size[name] = number(
            f"{name} of the geometry", value, 0.0, KINDS[name][1], f"give the {KINDS[name][0]}"
        )
    return np.array([np.radians(size["axis_deg"]), size["radius"], size["centre"]])


def visible(film: Film) -> Film:
    """Return the part of a film that a camera can see: |φ| up to where cos φ is `STEEPEST`."""
    kept = np.cos(film.theta - film.facing) > STEEPEST
    kept &= np.abs(film.theta - film.facing) < 0.5 * np.pi
    if kept.all():
        return film
    if kept.sum() < 2:
        rule = "an angle that the data show"
        raise InputError("facing of the data", film.facing, rule, "set their attribute facing")
    P, u = (None if f is None else f[:, :, kept] for f in (film.P, film.u))
    angle = None if film.angle is None else film.angle[:, kept]
    seen, known = film.seen[kept], film.known[:, kept]
    return replace(film, theta=film.theta[kept], P=P, u=u, seen=seen, known=known, angle=angle)


def turned(P: Array, frame: Array) -> Array:
    """Return directions P (n, 2, ...) in another geometry: their angles change, and |P| does not."""
    new = carried(P, frame)
    before, after = np.sqrt((P**2).sum(axis=1)), np.sqrt((new**2).sum(axis=1))
    ratio: Array = before / np.where(after > 0, after, 1.0)
    return new * ratio[:, None]


def carried(v: Array, frame: Array) -> Array:
    """Return vectors (n, 2, ...) in another geometry."""
    return np.stack([frame[i, 0] * v[:, 0] + frame[i, 1] * v[:, 1] for i in range(2)], axis=1)
