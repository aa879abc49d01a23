"""Indifferent zones: where the axial polarity P_z changes sign, and the stripes between them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from ..display.shown import shown
from ..model.arrays import STATE_DIMS, numbers, series
from ..model.doors import door
from ..model.errors import InputError
from ..model.grid import Array, CylinderGrid, resolved, sign_changes

__all__ = [
    "DISORDER",
    "DOMINANT",
    "GRAIN",
    "REACH",
    "Zone",
    "contrast",
    "crossings",
    "indifferent_zones",
    "stripe_widths",
    "weight",
    "zone_angles",
    "zones_of",
]


def __dir__() -> list[str]:
    return sorted(__all__)


DISORDER = 0.05
"""Order <|P|²>^½ below which a state counts as disordered; 1000 filaments give noise of 0.032."""
DOMINANT = 0.8
"""Share of <|P|²> in P_theta that makes a state circumferential; half of it must be in P_z for stripes."""
REACH = 0.5
"""Streams on the two sides of a line P_z = 0 are searched for within this distance, in radii."""
GRAIN = 0.2
"""Before that P_z is averaged over this distance to each side, in radii, since noise is not a stream."""
FAINT, PLAIN = DISORDER, 0.15
"""Contrast up to which a line P_z = 0 is not drawn, and from which on it is drawn in full."""


@door
def crossings(P: npt.ArrayLike) -> npt.NDArray[np.int64]:
    """Return how often P_z of a state P (2, n_theta, n_z) changes sign around each circle z = const (n_z,).

    Here and below the state is taken without its Nyquist modes, as in the right-hand side. Raises
    `InputError` for an array that is not a state.

    Example:
        >>> import cyclosis as cy
        >>> cy.zones.crossings(cy.initial.stripes(cy.CylinderGrid(16, 8), 4))
        array([4, 4, 4, 4, 4, 4, 4, 4])
    """
    return sign_changes(resolved(_state(P)[1]))


def _state(P: npt.ArrayLike) -> Array:
    rule = "an array of real numbers of shape (2, n_theta, n_z)"
    found = numbers("P", P, rule, "give one state", STATE_DIMS)
    if found.ndim != 3 or found.shape[0] != 2 or not found.size:
        raise InputError("P", found, rule, "give one state")
    return found


@door
def zones_of(P: Array) -> Array:
    """Return the angles at which the axial mean of P_z of a state (2, n_theta, n_z) changes sign, in radians.

    Sorted, in [0, 2π). Empty for a state that has no stripes: disordered, with `DOMINANT` of <|P|²> in
    P_theta, or with P_z of one sign everywhere. Raises `InputError` for an array that is not a state.

    Example:
        >>> import cyclosis as cy
        >>> grid = cy.CylinderGrid(16, 16)
        >>> cy.zones.zones_of(cy.initial.stripes(grid)).round(6)
        array([0.      , 3.141593])
        >>> cy.zones.zones_of(cy.initial.circumferential(grid)).size
        0
    """
    state = resolved(_state(P))
    around, along = np.mean(state**2, axis=(1, 2)).tolist()
    up = state[1] > 0
    striped = np.sqrt(around + along) >= DISORDER and around < DOMINANT * (around + along)
    if not striped or up.all() or not up.any():
        return np.empty(0)
    return zone_angles(state[1].mean(axis=1))


@shown
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


@door
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
    import contourpy  # slow to load, and a run needs only angles of zones

    P_z = np.pad(resolved(grid.check_state(state)[1]), ((0, 1), (0, 1)), mode="wrap")
    theta, z = np.append(grid.theta, 2 * np.pi), np.append(grid.z, grid.length)
    lines = contourpy.contour_generator(z, theta, P_z).lines(0.0)
    period = np.array([grid.length, 2 * np.pi])
    zones = [_zone(line, period) for line in _joined([np.asarray(line) for line in lines], period)]
    # If a zero is exactly on a corner of the grid, tracing leaves a piece of no length.
    zones = [zone for zone in zones if zone.arc_length > 1e-9]
    return sorted(zones, key=lambda zone: -zone.arc_length)


@door
def contrast(grid: CylinderGrid, state: npt.ArrayLike) -> Array:
    """Return how strongly filaments near each point of a state (2, n_theta, n_z) point in both directions.

    c = min(max p, max(-p)) over the patch within `REACH` of the point in theta and in z, where p is P_z
    averaged over all points within `GRAIN`: (n_theta, n_z), dimensionless, at most 1 and negative within a
    stream. Near a line between streams of P_z = ±p it is p; in disorder it is small, although P_z changes
    sign everywhere. So a line P_z = 0 is judged by the points around it and not by |P| on it, which vanishes
    between steady straight streams. Raises `InputError` for a mismatched state.

    Example:
        >>> import cyclosis as cy
        >>> grid = cy.CylinderGrid(64, 16)
        >>> stripes = cy.zones.contrast(grid, cy.initial.stripes(grid))
        >>> disorder = cy.zones.contrast(grid, cy.initial.disordered(grid))
        >>> round(float(stripes[0, 0]), 2), bool(disorder.max() < cy.zones.FAINT)
        (0.42, True)
    """
    up = resolved(grid.check_state(state))[1]
    from scipy.ndimage import maximum_filter1d, uniform_filter1d  # a run does not need them

    spacings = (2 * np.pi / grid.n_theta, grid.length / grid.n_z)
    for axis, spacing in enumerate(spacings):
        points = _points_within(GRAIN, spacing, up.shape[axis])
        up = uniform_filter1d(up, points, axis, mode="wrap")
    down = -up
    for axis, spacing in enumerate(spacings):
        points = _points_within(REACH, spacing, up.shape[axis])
        up, down = (maximum_filter1d(side, points, axis, mode="wrap") for side in (up, down))
    return np.minimum(up, down)


def _points_within(reach: float, spacing: float, count: int) -> int:
    """Return how many of `count` periodic points lie within `reach` of one of them: at least 3, and odd."""
    each_way = max(1, int(reach / spacing + 0.5))
    return 2 * min(each_way, (count - 1) // 2) + 1


@door
def weight(contrast: npt.ArrayLike) -> Array:
    """Return the opacity with which a line P_z = 0 of a contrast (...) is drawn: 0 to 1, dimensionless.

    0 up to a contrast of `FAINT`, 1 from `PLAIN` on, and linear between. Raises `InputError` for anything
    that is not an array of numbers.

    Example:
        >>> import cyclosis as cy
        >>> cy.zones.weight([0.02, 0.1, 0.9]).round(3)
        array([0. , 0.5, 1. ])
    """
    given = numbers("contrast", contrast, "numbers from 0 to 1", "take them from `contrast`")
    return np.clip((given - FAINT) / (PLAIN - FAINT), 0.0, 1.0)


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


@door
def zone_angles(profile: npt.ArrayLike) -> Array:
    """Return the angles in [0, 2π) at which a periodic profile over theta changes sign.

    The profile (n_theta,) is interpolated trigonometrically, so that the angles of a resolved
    profile are exact to rounding. Sorted; in radians. Empty where there is no change of sign. Raises
    `InputError` for an array that is not a profile.

    Example:
        >>> import numpy as np
        >>> import cyclosis as cy
        >>> theta = cy.CylinderGrid(16, 16).theta
        >>> cy.zones.zone_angles(np.cos(theta)).round(6)  # π/2 and 3π/2
        array([1.570796, 4.712389])
    """
    rule = "an array of real numbers of shape (n_theta,)"
    values = numbers("profile", profile, rule, "give P_z around the cell", ("theta",))
    if values.ndim != 1 or not values.size:
        raise InputError("profile", values, rule, "give P_z around the cell")
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


def _root(value: Callable[[float], float], low: float, high: float) -> float:
    a, b = value(low), value(high)
    if a * b >= 0:  # one end is a root to rounding
        return low if abs(a) <= abs(b) else high
    import scipy.optimize  # slow to load, and needed only if there are zones

    return float(scipy.optimize.brentq(value, low, high, xtol=1e-14, rtol=1e-14))


@door
def stripe_widths(angles: npt.ArrayLike) -> Array:
    """Return the widths of the stripes between sorted zone angles, as fractions of the circumference.

    Width i is that between angle i and the next one; they sum to 1. Empty for no zones. Raises
    `InputError` for anything that is not a list of angles.

    Example:
        >>> import cyclosis as cy
        >>> cy.zones.stripe_widths([1.5707963, 3.1415927]).round(4)  # π/2 and π
        array([0.25, 0.75])
    """
    sorted_angles = series("angles", angles, "give the angles of the zones")
    if sorted_angles.size == 0:
        return np.empty(0)
    following = np.append(sorted_angles[1:], sorted_angles[0] + 2 * np.pi)
    return (following - sorted_angles) / (2 * np.pi)
