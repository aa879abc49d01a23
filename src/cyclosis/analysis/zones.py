"""Indifferent zones: where the axial polarity P_z changes sign, and the stripes between them."""

from __future__ import annotations

from dataclasses import dataclass

import contourpy
import numpy as np
import numpy.typing as npt
import scipy.optimize

from ..model.grid import Array, CylinderGrid

DISORDER = 0.05
"""Order <|P|²>^½ below which a state counts as disordered; 1000 filaments give noise of 0.032."""


def crossings(P: Array) -> npt.NDArray[np.int64]:
    """Return how often P_z of a state P (2, n_theta, n_z) changes sign around each circle z = const (n_z,).

    Example:
        >>> import cyclosis as cy
        >>> cy.zones.crossings(cy.initial.stripes(cy.CylinderGrid(16, 8), 4))
        array([4, 4, 4, 4, 4, 4, 4, 4])
    """
    up = P[1] > 0
    return np.sum(up != np.roll(up, 1, axis=0), axis=0)


@dataclass(frozen=True)
class Zone:
    """One closed or winding line P_z = 0 on the periodic surface; angles in radians, lengths in radii.

    `theta` and `z` are the unwrapped coordinates along it (they leave the fundamental domain where
    the line crosses its edge); `winding` counts its turns (around the axis, along the axis): (0, ±1)
    runs along the cell, (0, 0) is a closed loop.

    Example:
        >>> import numpy as np
        >>> import cyclosis as cy
        >>> grid = cy.CylinderGrid(16, 16, length=5.0)
        >>> state = cy.initial.stripes(grid)
        >>> state[1] = 0.9 * np.sin(grid.theta[:, None] + 2 * np.pi * grid.z / grid.length)  # a helix
        >>> zone = cy.zones.indifferent_zones(grid, state)[0]
        >>> tuple(map(abs, zone.winding)), round(zone.straightness, 3)
        ((1, 1), 1.0)
        >>> round(zone.arc_length, 2)  # (5² + (2π)²)^½
        8.03
    """

    theta: Array
    z: Array
    winding: tuple[int, int]

    @property
    def arc_length(self) -> float:
        """Length of the line on the cylinder of radius 1."""
        return float(np.sum(np.hypot(np.diff(self.theta), np.diff(self.z))))

    @property
    def straightness(self) -> float:
        """Distance between the two ends over arc length: 1 for a straight line or helix, 0 for a loop."""
        ends = np.hypot(self.theta[-1] - self.theta[0], self.z[-1] - self.z[0])
        return float(ends / self.arc_length) if self.arc_length > 0 else 0.0


def indifferent_zones(grid: CylinderGrid, state: npt.ArrayLike) -> list[Zone]:
    """Return the lines P_z = 0 of a state (2, n_theta, n_z), longest first.

    Contours are traced on the grid by linear interpolation and joined across the periodic edges.
    Coordinates are dimensionless (radians, radii). Raises `InputError` for a mismatched state.

    Example:
        >>> import cyclosis as cy
        >>> grid = cy.CylinderGrid(16, 16, length=5.0)
        >>> found = cy.zones.indifferent_zones(grid, cy.initial.stripes(grid))
        >>> [(abs(zone.winding[1]), round(zone.arc_length, 6)) for zone in found]
        [(1, 5.0), (1, 5.0)]
    """
    P_z = np.pad(grid.check_state(state)[1], ((0, 1), (0, 1)), mode="wrap")
    theta, z = np.append(grid.theta, 2 * np.pi), np.append(grid.z, grid.length)
    lines = contourpy.contour_generator(z, theta, P_z).lines(0.0)
    period = np.array([grid.length, 2 * np.pi])
    zones = [_zone(line, period) for line in _joined([np.asarray(line) for line in lines], period)]
    # Where a zero falls exactly on a corner of the grid, tracing leaves a piece of no length.
    zones = [zone for zone in zones if zone.arc_length > 1e-9]
    return sorted(zones, key=lambda zone: -zone.arc_length)


def _zone(line: Array, period: Array) -> Zone:
    turns = np.rint((line[-1] - line[0]) / period).astype(int)
    return Zone(line[:, 1], line[:, 0], (int(turns[1]), int(turns[0])))


def _joined(pieces: list[Array], period: Array) -> list[Array]:
    """Join open pieces whose ends are the same point of the torus."""

    def key(point: Array) -> tuple[int, int]:
        cell = np.rint(np.mod(point, period) / period * 1e9).astype(np.int64) % 1_000_000_000
        return int(cell[0]), int(cell[1])

    open_pieces = [piece for piece in pieces if not np.array_equal(piece[0], piece[-1])]
    done = [piece for piece in pieces if np.array_equal(piece[0], piece[-1])]
    starts: dict[tuple[int, int], list[int]] = {}
    for index, piece in enumerate(open_pieces):
        starts.setdefault(key(piece[0]), []).append(index)
    unused = set(range(len(open_pieces)))
    while unused:
        index = min(unused)
        unused.discard(index)
        line, first = open_pieces[index], key(open_pieces[index][0])
        while key(line[-1]) != first:
            following = next((i for i in starts.get(key(line[-1]), ()) if i in unused), None)
            if following is None:
                break
            unused.discard(following)
            piece = open_pieces[following]
            line = np.concatenate([line, piece[1:] + (line[-1] - piece[0])])
        done.append(line)
    return done


def zone_angles(profile: npt.ArrayLike) -> Array:
    """Return the angles in [0, 2π) at which a periodic profile over theta changes sign.

    The profile (n_theta,) is read as its trigonometric interpolant, so that the angles of a resolved
    profile are exact to rounding. Sorted; in radians. Empty where there is no change of sign.

    Example:
        >>> import numpy as np
        >>> import cyclosis as cy
        >>> theta = cy.CylinderGrid(16, 16).theta
        >>> cy.zones.zone_angles(np.cos(theta)).round(6)  # π/2 and 3π/2
        array([1.570796, 4.712389])
    """
    values = np.asarray(profile, dtype=np.float64)
    n = values.size
    spectrum = np.fft.rfft(values, norm="forward")
    if n % 2 == 0:
        spectrum[-1] = 0.0
    m = np.arange(spectrum.size)
    weight = np.where(m == 0, 1.0, 2.0)

    def value(angle: float) -> float:
        return float(np.sum(weight * (spectrum * np.exp(1j * m * angle)).real))

    fine = 4 * n
    step = 2 * np.pi / fine
    sampled = np.fft.irfft(spectrum, fine, norm="forward")
    positive = sampled > 0
    before = np.flatnonzero(positive != np.roll(positive, -1))
    angles = [_root(value, i * step, (i + 1) * step) for i in before]
    return np.sort(np.mod(np.array(angles, dtype=np.float64), 2 * np.pi))


def _root(value: object, low: float, high: float) -> float:
    a, b = value(low), value(high)  # type: ignore[operator]
    if a * b >= 0:  # one end is a root to rounding
        return low if abs(a) <= abs(b) else high
    return float(scipy.optimize.brentq(value, low, high, xtol=1e-14, rtol=1e-14))


def stripe_widths(angles: npt.ArrayLike) -> Array:
    """Return the widths of the stripes between sorted zone angles, as fractions of the circumference.

    Width i lies between angle i and the next one around; they sum to 1. Empty for no zones.

    Example:
        >>> import cyclosis as cy
        >>> cy.zones.stripe_widths([1.5707963, 3.1415927]).round(4)  # π/2 and π
        array([0.25, 0.75])
    """
    sorted_angles = np.asarray(angles, dtype=np.float64)
    if sorted_angles.size == 0:
        return np.empty(0)
    following = np.append(sorted_angles[1:], sorted_angles[0] + 2 * np.pi)
    return (following - sorted_angles) / (2 * np.pi)
