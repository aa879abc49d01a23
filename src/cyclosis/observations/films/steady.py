"""The drift of the stage: how a film moves as a whole, told by what stands still in it."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import numpy.typing as npt

from .moving import Fields, registration

Array = npt.NDArray[np.float64]

BLOCKS = 8
"""Parts of a film whose medians are compared."""
LEAST_FRAMES = 10
"""Frames in a part: what moves vanishes in their median."""
GAIN = 0.02
"""By how much a shift must make two medians more alike, as a share of what they lack."""
TILES = 5
"""Parts of a picture, in each direction, that must agree on a drift."""
AGREE, MARGIN, MAJORITY = 0.75, 0.05, 0.6
"""A part agrees within so many pixels, or if no other shift makes it more alike by the second number.

The third is the share of the texture that must agree.
"""
LIKENESS = 0.3
"""Least correlation of two shifted medians."""
LARGEST = 0.2
"""Largest drift from part to part, as a share of the picture."""


def drift(pictures: Fields) -> Array:
    """Return the drift (n, 2) of frames (n, rows, columns), right and down in pixels, 0 for the first.

    The medians of parts of the film, in which what moves has vanished, are registered with each other. A
    shift is believed only if it makes them clearly more alike: in a film in which everything moves, or with
    nothing but straight walls, there is none to be found. Films of fewer than 20 frames have none.
    """
    count = len(pictures)
    parts = min(BLOCKS, count // LEAST_FRAMES)
    if parts < 2:
        return np.zeros((count, 2))
    spans = np.array_split(np.arange(count), parts)
    medians = [np.median(pictures[span], axis=0) for span in spans]
    middles = [float(span.mean()) for span in spans]
    found = [_shift(before, after) for before, after in pairwise(medians)]
    known = [each for each in found if each is not None]
    if 2 * len(known) < len(found):
        return np.zeros((count, 2))
    usual = np.mean(known, axis=0)  # for parts in which too little stands still
    steps = [usual if each is None else each for each in found]
    at = np.concatenate([np.zeros((1, 2)), np.cumsum(steps, axis=0)])
    frames = np.arange(count)
    if not at.any():
        return np.zeros((count, 2))
    if parts == 2:
        slope = (at[1] - at[0]) / (middles[1] - middles[0])
        where = slope * (frames[:, None] - middles[0])
    else:
        from scipy.interpolate import make_interp_spline

        where = make_interp_spline(middles, at, k=1)(frames)
    return np.asarray(where - where[0])


def _shift(before: Fields, after: Fields) -> Array | None:
    """Return how far the second picture lies from the first, right and down in pixels; None if unknown."""
    rows, columns = before.shape
    window = np.outer(np.hanning(rows), np.hanning(columns)).astype(np.float32)
    moved, _, _ = registration().phase_cross_correlation(
        before * window, after * window, upsample_factor=20, normalization=None
    )
    down, right = (-float(each) for each in moved)
    if max(abs(down) / rows, abs(right) / columns) > LARGEST:
        return None
    still = _alike(before, after, 0.0, 0.0)
    shifted = _alike(before, after, right, down)
    if shifted < LIKENESS or shifted - still < GAIN * (1 - still):
        return np.zeros(2)
    return np.array([right, down]) if _shared(before, after, right, down) else None


def _shared(before: Fields, after: Fields, right: float, down: float) -> bool:
    """Return whether parts of the picture, each by itself, have moved as the whole: streams have not."""
    from scipy.ndimage import shift

    back = shift(after, (-down, -right), order=1, mode="nearest")
    votes, power = [], []
    rows, columns = (np.array_split(np.arange(n), max(2, min(TILES, n // 40))) for n in before.shape)
    for row in rows:
        for column in columns:
            one, other = (part[np.ix_(row, column)] for part in (before, back))
            window = np.outer(np.hanning(row.size), np.hanning(column.size)).astype(np.float32)
            moved, _, _ = registration().phase_cross_correlation(
                one * window, other * window, upsample_factor=10, normalization=None
            )
            here = _alike(one, other, 0.0, 0.0)
            elsewhere = _alike(one, other, -float(moved[1]), -float(moved[0]))
            # What still moves in a median blurs the place of the best likeness, but gains little there.
            votes.append(np.hypot(*moved) < AGREE or here > max(elsewhere - MARGIN, LIKENESS))
            power.append(float(np.sqrt((one * one).mean() * (other * other).mean())))
    return float(np.average(votes, weights=np.array(power) + 1e-12)) >= MAJORITY


def _alike(one: Fields, other: Fields, right: float, down: float) -> float:
    from scipy.ndimage import shift

    edge = int(np.ceil(max(abs(right), abs(down)))) + 2
    back = shift(other, (-down, -right), order=1, mode="nearest")[edge:-edge, edge:-edge]
    ahead = one[edge:-edge, edge:-edge]
    if ahead.size < 100:
        return -1.0
    a, b = ahead - ahead.mean(), back - back.mean()
    return float((a * b).sum() / max(np.sqrt((a * a).sum() * (b * b).sum()), 1e-12))


def steadied(pictures: Fields, places: Array) -> Fields:
    """Return the frames moved back by their drift (n, 2)."""
    from scipy.ndimage import shift

    if not places.any():
        return pictures
    return np.stack(
        [
            shift(picture, (-down, -right), order=3, mode="nearest", prefilter=True)
            for picture, (right, down) in zip(pictures, places, strict=True)
        ]
    )
