"""What moves in a film: displacements between two frames, where they can be trusted, what stands still."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from ...model.errors import InputError

Fields = npt.NDArray[np.float32]
Bools = npt.NDArray[np.bool_]

WINDOW = 10
"""Radius of the window of optical flow, in pixels."""
EVEN = (2 * WINDOW + 1) / 4 * 12**0.5
"""Side of a square with the second moments of that window, a Gaussian (2 WINDOW + 1)/4 pixels wide."""
SMOOTH = 10.0
"""Light that varies over more pixels than this is taken out: the outline of the cell, and the lamp."""
STILL_FRAMES = 16
"""Frames from which on what stands still can be told from what moves slowly."""
TEXTURE = 3.0
"""How much stronger than noise the texture must be where a displacement is trusted."""
ALIKE = 0.5
"""Least correlation of a frame with the next one, moved back."""
AGREE = 0.35
"""Largest difference of the displacements forward and backward, in pixels, beyond a tenth of them."""
EMPTY = 0.01
"""Share of a picture that must move for a film to be measured."""


@dataclass
class Flow:
    """Displacements from one frame to another, half way between them: `v` (2, rows, columns), right and down.

    `good` (rows, columns) is where they can be trusted.
    """

    v: Fields
    good: Bools


def registration() -> Any:
    """Return scikit-image's registration. Raises `InputError` if it is not installed."""
    try:
        from skimage import registration
    except ImportError:
        rule = "measured with scikit-image, which is not installed"
        raise InputError("film", "a film", rule, "install it: pip install 'cyclosis[film]'") from None
    return registration


def flattened(pictures: Fields) -> Fields:
    """Return frames (n, rows, columns) without slow variations of light, in units of their contrast.

    The square root makes the noise of photons even. Each frame gets the same contrast, whatever the lamp: its
    own darkest pixels are the zero of its light, so that a frame and the same one in less light become equal.
    """
    from scipy.ndimage import gaussian_filter

    out = np.empty_like(pictures)
    for k, picture in enumerate(pictures):
        dark = float(np.percentile(picture, 0.5))
        root = np.sqrt(np.maximum(picture - dark, 0.0))
        out[k] = root - gaussian_filter(root, SMOOTH)
    spread = np.array([_spread(each) for each in out])
    usual = float(np.median(spread))
    scale = np.where(spread > 0.1 * usual, spread, max(usual, 1e-12)).astype(np.float32)
    return np.asarray(out / scale[:, None, None], dtype=np.float32)


def without_still(pictures: Fields) -> tuple[Fields, Fields]:
    """Return frames without what stands still, and that, from at least `STILL_FRAMES` frames.

    Shorter films are returned as they are: what moves slowly would be lost.
    """
    if len(pictures) < STILL_FRAMES:
        return pictures, np.zeros_like(pictures[0])
    some = pictures[np.unique(np.linspace(0, len(pictures) - 1, 41).astype(int))]
    still = np.median(some, axis=0)
    return pictures - still, still


def between(first: Fields, second: Fields, noise: float) -> Flow:
    """Return the displacements from one prepared frame to another, by optical flow in both directions."""
    from scipy.ndimage import gaussian_filter, map_coordinates

    flow = registration().optical_flow_ilk
    ahead = flow(first, second, radius=WINDOW, gaussian=True)
    back = flow(second, first, radius=WINDOW, gaussian=True)
    v = 0.5 * (ahead - back)
    rows, columns = np.indices(first.shape, dtype=np.float32)
    half = [rows - 0.5 * v[0], columns - 0.5 * v[1]], [rows + 0.5 * v[0], columns + 0.5 * v[1]]
    one, other = (
        map_coordinates(picture, at, order=1, mode="nearest")
        for picture, at in zip((first, second), half, strict=True)
    )
    wide = 0.7 * WINDOW
    mean_one, mean_other = gaussian_filter(one, wide), gaussian_filter(other, wide)
    power = (
        gaussian_filter(one * one, wide) - mean_one**2,
        gaussian_filter(other * other, wide) - mean_other**2,
    )
    both = gaussian_filter(one * other, wide) - mean_one * mean_other
    alike = both / np.sqrt(np.maximum(power[0] * power[1], 1e-12))
    texture = np.sqrt(np.maximum(0.5 * (power[0] + power[1]), 0.0))
    apart = np.hypot(*(ahead + back)) * 0.5
    good = (alike > ALIKE) & (texture > TEXTURE * noise) & (apart < AGREE + 0.1 * np.hypot(*v))
    edge = WINDOW // 2
    good[:edge] = good[-edge:] = False
    good[:, :edge] = good[:, -edge:] = False
    return Flow(np.stack([v[1], v[0]]), good)


def camera_noise(pictures: Fields) -> float:
    """Return the noise of prepared frames: from the quietest tenth of the differences of two frames.

    There nothing moves; the median of the absolute differences of neighbouring pixels' means is a robust
    standard deviation.
    """
    from scipy.ndimage import uniform_filter

    found = []
    for k in np.unique(np.linspace(0, len(pictures) - 2, 5).astype(int)):
        change = pictures[k + 1] - pictures[k]
        local = np.sqrt(np.maximum(uniform_filter(change**2, 15), 0.0))
        found.append(float(np.percentile(local, 5)) / np.sqrt(2))
    return max(float(np.median(found)), 1e-6)


def moves(pictures: Fields, noise: float) -> Bools:
    """Return where the light changes more than noise explains, (rows, columns), over a window."""
    from scipy.ndimage import uniform_filter

    some = pictures[np.unique(np.linspace(0, len(pictures) - 1, 24).astype(int))]
    change = np.sqrt(uniform_filter(some.var(axis=0), 15))
    return np.asarray(change > 1.6 * noise)


def _spread(values: Fields) -> float:
    low, high = np.percentile(values, (2, 98))
    return float(high - low)
