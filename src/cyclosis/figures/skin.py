"""A closed surface of revolution as drawings need it: tables, fields on an even chart, and points in space.

Movies are drawn in processes that load only what draws: nothing here may load JAX, and so nothing of
`cyclosis.closed`.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import numpy.typing as npt
from scipy.ndimage import uniform_filter

from ..analysis.zones import GRAIN, REACH, weight
from ..model.grid import Array
from .ribbons import NEGLIGIBLE, ZONE_WIDTH, Ribbon, outline, runs, tapered
from .streamlines import Velocity, filled

PATCH = 0.1
"""Distance between the points at which streams beside a line P_s = 0 are looked for, in radii."""
THINNED = 4
"""Contrast is judged at every fourth point of a line."""
PIECE = 12
"""Points of a line that make one polygon."""
_MARGIN = 1.0


@dataclass(frozen=True, eq=False)
class Skin:
    """A closed surface of revolution, and a chart (theta, s) of `around` times n even points on it.

    Arrays (n,) at even arc lengths `s` from pole to pole, lengths in radii: the radius `r`, the height `z`,
    and the tangent (`slope`, `rise`) = (r', z') of the meridian. `axial` tells whether there is an axis by
    which polarity means anything: not on a sphere. Fields on the chart are (2, around, n), with theta_i =
    2π i / around. As a `Wall` its points are (x, y, z).
    """

    around: int
    s: Array
    r: Array
    z: Array
    slope: Array
    rise: Array
    axial: bool = True

    @property
    def length(self) -> float:
        """The length of a meridian, in radii."""
        return float(self.s[-1])

    @property
    def half_height(self) -> float:
        """The distance of a pole from the middle, in radii."""
        return float(self.z[-1])

    @property
    def widest(self) -> float:
        """The largest radius, which is 1 but for rounding."""
        return float(self.r.max())

    @cached_property
    def theta(self) -> Array:
        """Angles of the chart (around,), radians."""
        return 2 * np.pi * np.arange(self.around) / self.around

    @cached_property
    def _share(self) -> Array:
        """The share (n,) of the area south of each s."""
        rings = np.concatenate([[0.0], np.cumsum(0.5 * (self.r[1:] + self.r[:-1]) * np.diff(self.s))])
        return rings / rings[-1]

    @cached_property
    def area(self) -> float:
        """The area, in radii squared."""
        return float(2 * np.pi * np.sum(0.5 * (self.r[1:] + self.r[:-1]) * np.diff(self.s)))

    @property
    def period(self) -> Array:
        """The sides (3,) of a box that holds the surface, and a margin."""
        return np.array([2.0, 2.0, 2 * self.half_height]) + _MARGIN

    @cached_property
    def _latitude(self) -> Array:
        """atan2(r, -z/H) (n,): on convex surfaces it grows from pole to pole at a finite rate."""
        return np.arctan2(self.r, -self.z / self.half_height)

    def chart(self, points: npt.ArrayLike) -> tuple[Array, Array]:
        """Return theta, in (-π, π], and s of points (3, ...) on the surface, or a little off it."""
        x, y, z = np.asarray(points, dtype=np.float64)
        latitude = np.arctan2(np.hypot(x, y), -z / self.half_height)
        return np.arctan2(y, x), np.interp(latitude, self._latitude, self.s)

    def at(self, theta: npt.ArrayLike, s: npt.ArrayLike) -> Array:
        """Return the points (3, ...) at angles theta (...) and arc lengths s (...)."""
        r = np.interp(np.asarray(s, dtype=np.float64), self.s, self.r)
        return np.stack(
            np.broadcast_arrays(
                r * np.cos(theta),
                r * np.sin(theta),
                np.interp(np.asarray(s, dtype=np.float64), self.s, self.z),
            )
        )

    def frames(self, theta: Array, s: Array) -> tuple[Array, Array, Array]:
        """Return e_theta, e_s and the outward normal, (3, ...) each."""
        slope, rise = np.interp(s, self.s, self.slope), np.interp(s, self.s, self.rise)
        cos, sin = np.cos(theta), np.sin(theta)
        around = np.stack([-sin, cos, np.zeros_like(cos)])
        return (
            around,
            np.stack([slope * cos, slope * sin, rise]),
            np.stack([rise * cos, rise * sin, -slope]),
        )

    def onto(self, points: Array) -> Array:
        """Return the points of the surface next to points (3, ...) a little off it."""
        return self.at(*self.chart(points))

    def places(self, fractions: Array) -> Array:
        """Return the points (3, n) of fractions (2, n): of the angle, and of the area to the south."""
        return self.at(2 * np.pi * fractions[0], np.interp(fractions[1], self._share, self.s))

    def across(self, points: Array, along: Array) -> Array:
        """Return the unit vectors (3, n) to the left of tangents (3, n), seen from outside."""
        left = np.cross(self.frames(*self.chart(points))[2], along, axis=0)
        return left / np.maximum(np.hypot.reduce(left), 1e-300)

    def headings(self, paths: Array) -> Array:
        """Return the angle (steps, n) by which paths (3, steps + 1, n) have turned on the surface."""
        steps = np.diff(paths, axis=1)
        before, after = steps[:, :-1], steps[:, 1:]
        normal = self.frames(*self.chart(paths[:, 1:-1]))[2]
        sideways = np.sum(normal * np.cross(before, after, axis=0), axis=0)
        turned = np.cumsum(np.arctan2(sideways, np.sum(before * after, axis=0)), axis=0)
        return np.concatenate([np.zeros((1, *turned.shape[1:])), turned])

    def in_space(self, field: Array) -> Array:
        """Return a vector field (2, around, n) of the chart as vectors in space (3, around, n)."""
        around, along, _ = self.frames(*np.meshgrid(self.theta, self.s, indexing="ij"))
        return np.asarray(field[0] * around + field[1] * along)

    def sampled(self, values: Array, theta: Array, s: Array) -> Array:
        """Return fields (k, around, n) of the chart at angles and arc lengths (...): (k, ...), bilinear."""
        n, m = self.around, self.s.size
        x, y = theta * (n / (2 * np.pi)), s * ((m - 1) / self.length)
        i, j = np.floor(x).astype(np.int64), np.clip(np.floor(y).astype(np.int64), 0, m - 2)
        a, b = x - i, y - j
        row, after = np.mod(i, n) * m + j, np.mod(i + 1, n) * m + j
        flat = values.reshape(len(values), -1)
        low = flat[:, row] * (1 - b) + flat[:, row + 1] * b
        high = flat[:, after] * (1 - b) + flat[:, after + 1] * b
        return np.asarray(low * (1 - a) + high * a)

    def velocity(self, flow: Array) -> Velocity:
        """Return the function that interpolates a flow (2, around, n) at points (3, ...)."""
        # Vectors in space, because the directions of theta and s turn about a pole.
        vectors = self.in_space(flow)

        def velocity(points: Array) -> Array:
            theta, s = self.chart(points)
            found, normal = self.sampled(vectors, theta, s), self.frames(theta, s)[2]
            return np.asarray(found - normal * np.sum(normal * found, axis=0))

        return velocity

    def streams(self, flow: Array, peak_speed: float, scale: float = 1.0) -> list[Ribbon]:
        """Return streamlines of a flow (2, around, n) as polygons (n, 3) in space, and their strengths.

        They are those of `cyclosis.figures.ribbons.stream_ribbons`, on this surface.
        """
        if peak_speed <= 0:
            return []
        found = filled(self, flow, 0.095 * scale, 1.25 * scale, NEGLIGIBLE * peak_speed)
        ribbons = []
        for points, speed in found:
            width, strength = tapered(speed, peak_speed, scale)
            ribbons.append((self.ribbon(points, width), strength))
        return ribbons

    def ribbon(self, points: Array, width: Array) -> Array:
        """Return the outline (n, 3) of a line (3, m) of given widths (m,), with round ends."""
        return outline(points, width, lambda along: self.across(points, along))

    def zones(self, P: Array, scale: float = 1.0) -> list[Array]:
        """Return the indifferent zones P_s = 0 of a state (2, around, n) as polygons (n, 3) in space.

        As on the cylinder a line thins out and ends where filaments on its two sides do not point in opposite
        directions. So it does where those that cross it are more strongly ordered than those beside it: over
        the poles of a streaming cell, where P_s changes sign because the meridian does, not the stream.
        """
        if not self.axial:
            return []
        import contourpy

        P_s = np.concatenate([P[1], P[1, :1]])
        theta = np.append(self.theta, 2 * np.pi)
        vectors = self.in_space(P)
        polygons = []
        for line in contourpy.contour_generator(self.s, theta, P_s).lines(0.0):
            s, angle = np.asarray(line).T
            # Contrast varies over far more than the distance between points of a line.
            known = np.append(np.arange(0, s.size - 1, THINNED), s.size - 1)
            facing, crossing = self.beside(vectors, angle[known], s[known])
            open_to = np.clip(2 * (1 - crossing / np.maximum(facing, 1e-9)), 0.0, 1.0)
            plain = np.interp(np.arange(s.size), known, weight(facing) * open_to)
            for run in runs(plain > 0):
                points = self.at(angle[run], s[run])
                width = scale * ZONE_WIDTH * plain[run]
                # In short pieces, because a long line may pass behind the cell and come back.
                for first in range(0, width.size - 1, PIECE):
                    piece = slice(first, first + PIECE + 1)
                    polygons.append(self.ribbon(points[:, piece], width[piece]))
        return polygons

    def beside(self, vectors: Array, theta: Array, s: Array) -> tuple[Array, Array]:
        """Return how strongly filaments near points (n,) point in both directions of the meridian, and |P|.

        The first is `cyclosis.zones.contrast` of a state given as `vectors` (3, around, n) in space, in a
        patch of the plane that touches the surface at each point.
        """
        around, along, _ = self.frames(theta, s)
        reach, grain = round(REACH / PATCH), round(GRAIN / PATCH)
        steps = PATCH * np.arange(-reach - grain, reach + grain + 1)
        across, up = steps[:, None, None], steps[None, :, None]
        points = self.at(theta, s)[:, None, None] + around[:, None, None] * across + along[:, None, None] * up
        found = self.sampled(vectors, *self.chart(points))
        polarity = np.sum(found * along[:, None, None], axis=0)
        middle = reach + grain
        polarity = uniform_filter(polarity, (2 * grain + 1, 2 * grain + 1, 1))[grain:-grain, grain:-grain]
        facing = np.minimum(polarity.max((0, 1)), (-polarity).max((0, 1)))
        return facing, np.asarray(np.hypot.reduce(found[:, middle, middle]))
