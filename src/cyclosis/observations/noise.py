"""The noise of measured velocities, estimated from the measurement itself."""

from __future__ import annotations

import numpy as np

from .observation import Array, Frame, Observation

LEAST = 20
"""Fewer differences tell nothing."""


def estimated_noise(obs: Observation) -> float | None:
    """Return the noise of one component of a displacement in pixels, or None if nothing tells it.

    With at least four frames on one grid it comes from third differences in time. Otherwise it comes from
    third differences along the rows and columns of a grid: neighbours that share pixels make it too small,
    strong gradients too large. The median of their sizes is taken, so that outliers do not count.
    """
    frames = [frame for frame in obs.frames if frame.grid is not None and frame.vx is not None]
    if not frames or min(frames[0].grid or (0,)) < 2:
        return None
    same = all(f.grid == frames[0].grid and np.array_equal(f.x, frames[0].x) for f in frames)
    stack = np.stack([_components(frame) for frame in frames]) if same else _components(frames[0])[None]
    differences = (
        [np.diff(stack, 3, axis=0)]
        if same and len(frames) >= 4
        else [np.diff(stack, 3, axis=k) for k in (2, 3)]
    )
    sizes = np.concatenate([np.abs(each[np.isfinite(each)]) for each in differences])
    if sizes.size < LEAST:
        return None
    interval = 1.0 if obs.time_unit == "frame" or obs.frame_s is None else obs.frame_s
    return float(np.median(sizes) / 0.6745 / np.sqrt(20.0)) * interval


def _components(frame: Frame) -> Array:
    assert frame.grid is not None
    both = np.stack([frame.vx, frame.vy])  # type: ignore[list-item]
    return np.where(frame.good, both, np.nan).reshape(2, *frame.grid)
