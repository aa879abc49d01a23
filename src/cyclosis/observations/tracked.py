"""Tracks of spots become velocities between frames, each in the middle of its link."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..model.errors import InputError
from .formats.content import Array, Content
from .observation import Frame


def velocities(
    content: Content, spots: dict[str, Array], good: Any, frame_s: float | None, max_gap: int
) -> list[Frame]:
    """Return one frame of scattered velocities for every interval between two frames of the film.

    `spots` has x, y (pixels, y down), frame and track, in any order; a NaN track is no track. A link over a
    gap of n frames gives the mean velocity over it, at its middle, and belongs to the interval that holds
    that. Links over more than `max_gap` frames are left out. Raises `InputError` if a spot occurs twice, if
    frames are not whole numbers, and if nothing was tracked.
    """
    source = str(content.extra.get("path", content.format))
    used = np.isfinite(spots["track"]) & np.isfinite(spots["x"]) & np.isfinite(spots["y"]) & good
    frame, track = spots["frame"][used], spots["track"][used]
    if not np.isfinite(frame).all() or (frame != np.round(frame)).any():
        raise InputError("file", source, "one whose frames are whole numbers", "give the column of frames")
    order = np.lexsort((frame, track))
    x, y, frame, track = spots["x"][used][order], spots["y"][used][order], frame[order], track[order]
    gap = np.diff(frame)
    linked = np.diff(track) == 0
    if (linked & (gap == 0)).any():
        rule = "one with at most one spot of a track in a frame"
        raise InputError("file", source, rule, "remove the repeated spots, or split the tracks that branch")
    linked &= gap <= max_gap
    if not linked.any():
        rule = "one with tracks over at least two frames"
        raise InputError("file", source, rule, "link the spots first, or raise max_gap")
    seconds = 1.0 if frame_s is None else frame_s
    k = np.flatnonzero(linked)
    over = gap[k] * seconds
    vx, vy = (x[k + 1] - x[k]) / over, (y[k + 1] - y[k]) / over
    middle_x, middle_y = 0.5 * (x[k] + x[k + 1]), 0.5 * (y[k] + y[k + 1])
    interval = np.floor(0.5 * (frame[k] + frame[k + 1]))
    by_time = np.argsort(interval, kind="stable")
    first, starts = np.unique(interval[by_time], return_index=True)
    out = []
    for number, part in zip(first, np.split(by_time, starts[1:]), strict=True):
        ok = np.isfinite(vx[part]) & np.isfinite(vy[part])
        time = (float(number) + 0.5) * seconds
        out.append(Frame(middle_x[part], middle_y[part], ok, vx[part], vy[part], time=time))
    return out
