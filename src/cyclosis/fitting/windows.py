"""What an interrogation window makes of a flow: its mean over a square of the image.

With φ = θ - θ_facing, a point of the surface is seen at x = sin φ across the image and z along it, in radii,
where the flow is (u_θ cos φ, u_z). Particles that are spread evenly over the surface have the density
1/cos φ in the image, and the vector of a window of side w is the mean of what they do,

    v̄ = ∫ v dx dz / cos φ  /  ∫ dx dz / cos φ  =  v + w²/24 [∂_x² v + ∂_z² v + 2 (tan φ/cos φ) ∂_x v] + O(w⁴).

The sides of the square are those of the image; it is turned against the cell by the direction of the axis.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ..model.errors import InputError, number
from ..model.grid import Array
from .film import Film

NODES = 24
"""Strips across a window in which its mean is taken."""
RIM, WIDEST = 0.98, 0.42
"""Largest sin φ of the far edge of a window, and its largest width on the surface in radians, whose mean can
be undone."""
LARGEST = 1.0
"""Largest side of a window, in radii."""
MEASURED = ("velocity",)
"""Measurements whose vectors are those of windows."""


@dataclass(frozen=True)
class Window:
    """A square of `side` radii, whose sides are at `angle` radians to the axis of the cell."""

    side: float
    angle: float = 0.0

    def strips(self) -> tuple[Array, Array, Array]:
        """Return the middles in x of strips across the square, and where they begin and end along z."""
        c, s, half = np.cos(self.angle), np.sin(self.angle), 0.5 * self.side
        reach = half * (abs(c) + abs(s))
        x = reach * ((np.arange(NODES) + 0.5) * 2 / NODES - 1)
        low, high = np.full(NODES, -np.inf), np.full(NODES, np.inf)
        for a, b in ((s, c), (-c, s)):  # |a x + b z| <= half
            if abs(b) > 1e-9:
                ends = np.sort([(-half - a * x) / b, (half - a * x) / b], axis=0)
                low, high = np.maximum(low, ends[0]), np.minimum(high, ends[1])
        return x, low, np.maximum(high, low)


def window_of(film: Film, side: float | None) -> Window | None:
    """Return the window of the vectors of a film, given or as the measurement knows it, or None."""
    known = film.attributes
    if side is None and "window_px" in known and "radius_px" in known:
        side = float(known["window_px"]) / float(known["radius_px"])
    if side is None:
        return None
    side = number("window", side, 0.0, LARGEST, "give the side of the windows in radii, 0 for point values")
    if side == 0.0:
        return None
    try:
        view: Mapping[str, Any] = json.loads(str(known.get("view", "{}")))
        angle = np.radians(float(view.get("axis_deg", 0.0))) * (-1.0 if view.get("mirrored") else 1.0)
    except (ValueError, TypeError, AttributeError) as error:
        raise InputError(
            "view of the data", known.get("view"), "what a measurement wrote", "leave it out"
        ) from error
    return Window(side, angle)


def unknown(film: Film) -> bool:
    """Return whether the vectors of a film are means over windows of an unknown size."""
    return film.attributes.get("measurement") in MEASURED and "window_px" not in film.attributes


def averaging(window: Window | None, theta: Array, facing: float, m: Array, q: Array) -> Array:
    """Return what takes waves exp(i m θ + i q z) to vectors at angles, (2, angles, m, q), at z = 0."""
    if window is None:
        plain = np.exp(1j * np.outer(theta, m))[:, :, None] * np.ones(q.size)
        return np.stack([plain, plain])
    x, low, high = window.strips()
    across = np.sin(theta - facing)[:, None] + x
    seen = (np.abs(across) < 1) & (high > low)
    phi = np.arcsin(np.where(seen, across, 0.0))
    weight = np.where(seen, (high - low) / np.cos(phi), 0.0)
    weight /= weight.sum(axis=1, keepdims=True)
    middle, half = 0.5 * (low + high), 0.5 * (high - low)
    along = np.exp(1j * np.outer(middle, q)) * np.sinc(np.outer(half, q) / np.pi)
    around = np.exp(1j * (facing + phi)[:, :, None] * m)
    leaning = np.cos(phi) / np.cos(theta - facing)[:, None]
    return np.stack(
        [np.einsum("ak,akm,kn->amn", w, around, along, optimize=True) for w in (weight * leaning, weight)]
    )


def sharpened(film: Film, window: Window) -> Film:
    """Return a film whose u is that at the points, to fourth order in the side of the windows.

    Points at the edge of what was seen have no second derivative and are dropped, and so are those where
    windows are too wide or reach over the rim.
    """
    assert film.u is not None
    c = np.cos(film.theta - film.facing)[:, None]
    s = np.sin(film.theta - film.facing)[:, None]
    first, second = _stencils(film.theta)
    _, along = _stencils(film.z)
    factor = window.side**2 / 24
    image = np.stack([film.u[:, 0] * c, film.u[:, 1]], axis=1)
    # ∂_x = ∂_θ/cos φ, so that ∂_x² = (∂_θ² + tan φ ∂_θ)/cos² φ.
    bend = (second @ image + 3 * (s / c) * (first @ image)) / c**2 + image @ along.T
    image = image - factor * bend
    u = np.stack([image[:, 0] / c, image[:, 1]], axis=1)
    reach = np.abs(np.sin(film.theta - film.facing)) + window.strips()[0].max()
    seen = film.seen & ((reach < RIM)[:, None] & (window.side < WIDEST * c))
    gone = np.pad(~film.seen, 1, constant_values=True)
    for shifted in (gone[:-2, 1:-1], gone[2:, 1:-1], gone[1:-1, :-2], gone[1:-1, 2:]):
        seen &= ~shifted
    return replace(film, u=np.where(seen, u, 0.0), seen=seen, known=film.known & seen).cropped()


def _stencils(points: Array) -> tuple[Array, Array]:
    """Return matrices of first and second derivatives: parabolas through three points, zero at the ends."""
    n = points.size
    first, second = np.zeros((n, n)), np.zeros((n, n))
    for k in range(1, n - 1):
        a, b = points[k] - points[k - 1], points[k + 1] - points[k]
        first[k, k - 1 : k + 2] = -b / (a * (a + b)), (b - a) / (a * b), a / (b * (a + b))
        second[k, k - 1 : k + 2] = 2 / (a * (a + b)), -2 / (a * b), 2 / (b * (a + b))
    return first, second
