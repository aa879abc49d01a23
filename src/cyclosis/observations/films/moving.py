"""What moves in a film: displacements between two frames, their errors, and where they can be trusted."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from ...model.errors import InputError
from .light import smoothed

Fields = npt.NDArray[np.float32]
Bools = npt.NDArray[np.bool_]

RADIUS = 10
"""Radius of the window of optical flow, in pixels, unless a larger one is needed."""
WARPS = 4
"""Iterations at each scale. With 10, the default, nine tenths of good samples change by less than 0.01 px."""
ALIKE = 0.5
"""Least correlation of a frame with the next one, moved back."""
ALIKE_WIDTH = 7.0
"""Standard deviation in pixels of the window in which they are compared."""
AGREE = 0.35
"""Largest difference of the displacements forward and backward, in pixels, beyond a tenth of them."""
GRAIN = 1.5
"""Standard deviation in pixels within which errors of neighbouring pixels go together."""


@dataclass
class Flow:
    """Displacements from one frame to another, half way between them: `v` (2, rows, columns), right and down.

    `consistent` (rows, columns) is where the displacements forward and backward agree and the moved frame
    resembles the other one. `error` (rows, columns) is the standard error of one component, in pixels.
    """

    v: Fields
    consistent: Bools
    error: Fields


def registration() -> Any:
    """Return scikit-image's registration. Raises `InputError` if it is not installed."""
    try:
        from skimage import registration
    except ImportError:
        rule = "measured with scikit-image, which is not installed"
        raise InputError("film", "a film", rule, "install it: pip install 'cyclosis[film]'") from None
    return registration


def between(first: Fields, second: Fields, radius: int = RADIUS) -> Flow:
    """Return the displacements from one prepared frame to another, by optical flow in both directions."""
    flow = registration().optical_flow_ilk
    ahead = flow(first, second, radius=radius, num_warp=WARPS, gaussian=True)
    back = flow(second, first, radius=radius, num_warp=WARPS, gaussian=True)
    v = 0.5 * (ahead - back)
    one, other = _halfway(first, second, v)
    apart = np.hypot(*(ahead + back)) * 0.5
    agrees = apart < AGREE + 0.1 * np.hypot(*v)
    consistent = (_likeness(one, other) > ALIKE) & agrees
    edge = radius // 2
    consistent[:edge] = consistent[-edge:] = False
    consistent[:, :edge] = consistent[:, -edge:] = False
    return Flow(np.stack([v[1], v[0]]), consistent, standard_error(one, other, width_of(radius)))


def width_of(radius: int) -> float:
    """Return the standard deviation in pixels of the Gaussian window that scikit-image gives this radius."""
    return (2 * radius + 1) / 4


def even_side(radius: int) -> float:
    """Return the side in pixels of a square with the second moments of that window.

    Each displacement is the mean of those in the window, by its weights and the gradients of the light: the
    iteration uses the displacement of every pixel at its own place.
    """
    return width_of(radius) * 12**0.5


def standard_error(one: Fields, other: Fields, width: float) -> Fields:
    """Return the standard error of one component of a displacement (rows, columns), in pixels.

    `one` and `other` are the frames, both moved to the middle. Lucas and Kanade's displacement solves
    <g g'> v = <g d>, with g the gradient of the light, d its difference, and < > the mean over a window. So
    its covariance is <g g'>^-1 cov(<g d>) <g g'>^-1. The scatter of g d over the window gives cov(<g d>); g d
    is averaged over `GRAIN` pixels first, so that neighbours that go together are not counted as many.
    """
    from scipy.ndimage import gaussian_filter

    def mean(values: Fields) -> npt.NDArray[np.float64]:
        return np.asarray(gaussian_filter(values, width, mode="mirror"), dtype=np.float64)

    down, right = np.gradient(0.5 * (one + other))
    difference = one - other
    a, b = (gaussian_filter(g * difference, GRAIN, mode="mirror") for g in (down, right))
    # Independent averages in the window, less those that the displacement itself has used up.
    share = GRAIN**2 / width**2
    factor = share / (1 - share)
    yy, xx, xy = mean(down * down), mean(right * right), mean(down * right)
    aa, bb, ab = (factor * mean(each) for each in (a * a, b * b, a * b))
    # The trace of G^-1 C G^-1 = G^-2 C for symmetric 2 x 2 matrices; G^-1 = [[xx, -xy], [-xy, yy]] / det.
    det = np.maximum(yy * xx - xy * xy, 1e-12)
    squares = (xx * xx + xy * xy) * aa + (yy * yy + xy * xy) * bb - 2 * xy * (xx + yy) * ab
    return np.asarray(np.sqrt(np.maximum(0.5 * squares, 0.0)) / det, dtype=np.float32)


def moves(pictures: Fields, noise: float) -> Bools:
    """Return where the light changes more than noise explains, (rows, columns), over a window."""
    from scipy.ndimage import uniform_filter

    some = smoothed(pictures[np.unique(np.linspace(0, len(pictures) - 1, 24).astype(int))])
    change = np.sqrt(uniform_filter(some.var(axis=0, ddof=1), 15))
    return np.asarray(change > 1.6 * noise)


def _halfway(first: Fields, second: Fields, v: Fields) -> tuple[Fields, Fields]:
    """Return two frames, each moved half of the displacement `v` (2, rows, columns), down and right."""
    from scipy.ndimage import map_coordinates

    rows, columns = np.indices(first.shape, dtype=np.float32)
    one = map_coordinates(first, (rows - 0.5 * v[0], columns - 0.5 * v[1]), order=1, mode="nearest")
    other = map_coordinates(second, (rows + 0.5 * v[0], columns + 0.5 * v[1]), order=1, mode="nearest")
    return one, other


def _likeness(one: Fields, other: Fields) -> Fields:
    """Return the correlation of two frames (rows, columns), over a window."""
    from scipy.ndimage import gaussian_filter

    def mean(values: Fields) -> Fields:
        return np.asarray(gaussian_filter(values, ALIKE_WIDTH), dtype=np.float32)

    a, b = mean(one), mean(other)
    both, powers = mean(one * other) - a * b, (mean(one * one) - a * a) * (mean(other * other) - b * b)
    return np.asarray(both / np.sqrt(np.maximum(powers, 1e-24)), dtype=np.float32)
