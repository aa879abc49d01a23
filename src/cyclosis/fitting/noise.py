"""The noise of a film, from the film itself: its size, what neighbours share of it, and more like it.

A smooth signal leaves little in high differences in time, at any spacing of the frames, and noise that is
independent from frame to frame all of itself.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from ..model.grid import Array

ORDERS = (3, 4, 5)
"""Orders of the time differences from which noise is estimated; the one with least signal is taken."""
SHARED = 0.1
"""Least correlation with a neighbour that counts; the sum ends at the first lag below it."""
FARTHEST = 12
"""Most grid steps over which noise can be shared."""
PAIRS = 200
"""Fewest products of neighbours from which a correlation is taken."""


def differences(times: Array, order: int) -> Array:
    """Return the matrix (n - order, n) of differences in time that leave white noise its variance.

    Each row takes order + 1 successive frames, gives 0 for polynomials of lower degree, and its squares sum
    to 1. At even spacing these are the binomial coefficients.
    """
    out = np.zeros((times.size - order, times.size))
    for k in range(len(out)):
        at = times[k : k + order + 1]
        apart = at[:, None] - at[None, :]
        np.fill_diagonal(apart, 1.0)
        row = 1.0 / np.prod(apart / np.ptp(at), axis=1)
        out[k, k : k + order + 1] = row / np.linalg.norm(row)
    return out


def left(field: Array, times: Array, known: npt.NDArray[np.bool_]) -> Array | None:
    """Return what the differences with the least signal leave of a field (n, ...), NaN where one is unknown.

    `known` (n, n_theta, n_z) says which values were measured. None if there are too few frames.
    """
    best, least = None, np.inf
    for order in ORDERS:
        if field.shape[0] <= order + 1:
            break
        matrix = differences(times, order)
        whole = np.tensordot((matrix != 0).astype(np.float64), ~known, 1) == 0
        found = np.where(
            _over(whole, field), np.tensordot(matrix, np.where(_over(known, field), field, 0.0), 1), np.nan
        )
        size = float(np.nanmean(found**2)) if np.isfinite(found).any() else np.inf
        if size < least:
            best, least = found, size
    return best


def _over(mask: Any, field: Array) -> Any:
    """Return a mask (n, n_theta, n_z) in the shape of a field, which may have components."""
    return mask if field.ndim == 3 else mask[:, None]


def noise_of(field: Array, times: Array, known: npt.NDArray[np.bool_]) -> Array:
    """Return the variance of the noise of a field (n, ..., n_theta, n_z), without its first axis.

    It is averaged along z, because what is seen obliquely is noisier, and 0 where nothing was seen.
    """
    return variance(left(field, times, known), field)


def variance(found: Array | None, field: Array) -> Array:
    """Return the variance of the noise of a field, given what `left` has found of it."""
    return np.zeros(field.shape[1:]) if found is None else size(found)


def size(found: Array) -> Array:
    """Return the mean square of noise (n, ..., n_theta, n_z) in each row along z, without its first axis."""
    good = np.isfinite(found)
    count = good.sum(axis=(0, -1))
    rows = np.where(good, found**2, 0.0).sum(axis=(0, -1)) / np.maximum(count, 1)
    every = float(np.where(good, found**2, 0.0).sum() / max(good.sum(), 1))
    rows = np.where(count > 0, rows, every)
    return np.repeat(rows[..., None], found.shape[-1], axis=-1)


def shared(found: Array | None) -> float:
    """Return how many vectors share noise (n, ..., n_theta, n_z): the sum of correlations with neighbours.

    Overlapping windows and interpolation make neighbours alike, so that n of them tell as much as n divided
    by this about anything that is wider. It is 1 for independent noise.
    """
    if found is None or not np.isfinite(found).any():
        return 1.0
    scale = np.sqrt(size(found))
    flat = (found / np.where(scale > 0, scale, 1.0)).reshape(-1, *found.shape[-2:])
    return float(np.prod([_along(flat, axis) for axis in (1, 2)]))


def _along(flat: Array, axis: int) -> float:
    """Return the sum of the correlations along one axis."""
    total, whole = 1.0, float(np.nanmean(flat**2))
    for lag in range(1, min(FARTHEST, flat.shape[axis] - 1) + 1):
        ahead = np.take(flat, range(lag, flat.shape[axis]), axis)
        behind = np.take(flat, range(flat.shape[axis] - lag), axis)
        products = ahead * behind
        if np.isfinite(products).sum() < PAIRS or not whole > 0:
            break
        found = float(np.nanmean(products)) / whole
        if found < SHARED:
            break
        total += 2 * found
    return total


def surrogate(field: Array, times: Array, power: Array, rng: np.random.Generator) -> Array:
    """Return noise of a variance like that of a field, with the same pattern in space and none in time.

    Its frames are those of the third difference in random order and with random signs, so that vectors that
    share pixels stay correlated.
    """
    pool = np.tensordot(differences(times, 3), field, 1)
    drawn = pool[rng.integers(0, pool.shape[0], field.shape[0])]
    drawn = drawn * rng.choice([-1.0, 1.0], (field.shape[0], *[1] * (field.ndim - 1)))
    scale = np.sqrt(np.mean(pool**2, axis=(0, -1), keepdims=True))
    spread = np.sqrt(power.mean(axis=-1, keepdims=True))[None]
    return drawn * np.where(scale > 0, spread / np.where(scale > 0, scale, 1.0), 0.0)
