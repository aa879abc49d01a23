"""The light of a film: made even, its noise, and what stands still in it."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

Fields = npt.NDArray[np.float32]

SMOOTH = 10.0
"""Light that varies over more pixels than this is taken out: the outline of the cell, and the lamp."""
FINE = 1.0
"""Standard deviation in pixels by which frames are smoothed where noise is told from what moves."""


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


def smoothed(pictures: Fields) -> Fields:
    """Return frames with less noise, smoothed over a pixel."""
    from scipy.ndimage import gaussian_filter

    return np.asarray(gaussian_filter(pictures, (0.0, FINE, FINE)), dtype=np.float32)


def camera_noise(pictures: Fields) -> float:
    """Return the noise of prepared frames, smoothed: from the quietest windows of differences of two frames.

    There nothing moves.
    """
    from scipy.ndimage import uniform_filter

    found = []
    for k in np.unique(np.linspace(0, len(pictures) - 2, 5).astype(int)):
        change = smoothed(pictures[k + 1 : k + 2] - pictures[k : k + 1])[0]
        local = np.sqrt(np.maximum(uniform_filter(change**2, 15), 0.0))
        found.append(float(np.percentile(local, 5)) / np.sqrt(2))
    return max(float(np.median(found)), 1e-6)


def still(pictures: Fields) -> Fields:
    """Return what stands still in frames: their median over time, of at most 41 of them."""
    some = pictures[np.unique(np.linspace(0, len(pictures) - 1, 41).astype(int))]
    return np.asarray(np.median(some, axis=0), dtype=np.float32)


def _spread(values: Fields) -> float:
    low, high = np.percentile(values, (2, 98))
    return float(high - low)
