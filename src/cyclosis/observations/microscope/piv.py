"""Image velocimetry: vectors of windows."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from ...model.errors import InputError, number, whole
from .body import Body, chosen
from .camera import Camera

SAMPLES = 8
"""Points across a window in which its vector is averaged."""
COVERED = 0.5
"""Share of a window that must see the cell, in focus, for a vector."""
DENSEST = 0.1
"""cos φ below which the density of particles in the picture, which goes as its inverse, grows no further."""


def piv(
    body: Body,
    camera: Camera,
    times: npt.ArrayLike | None = None,
    window_px: int = 32,
    step_px: int = 16,
    outliers: float = 0.0,
) -> dict[str, Any]:
    """Return vectors on a grid of windows: `vx`, `vy` (time, rows, columns), px a frame, y down.

    A vector is the mean over a square window of what the particles do that are in focus: their density in
    the picture goes as 1/cos φ. `mask` is where a window sees too little of the cell; there is no vector. A
    share of `outliers` is replaced by random vectors; `flag` tells which.
    """
    window = whole("window_px", window_px, 4, 512, "give the side of a window in pixels")
    step = whole("step_px", step_px, 1, 512, "give the distance of windows in pixels")
    wrong = number("outliers", outliers, 0.0, 0.9, "give the share of wrong vectors")
    when = chosen(body, times, all_=True)
    width, height = camera.size_px
    if min(width, height) < window:
        rule = f"at most {min(width, height)}, the size of the picture"
        raise InputError("window_px", window_px, rule, "give a smaller window")
    columns = np.arange((width - window) // step + 1) * step
    rows = np.arange((height - window) // step + 1) * step
    inner = (np.arange(SAMPLES) + 0.5) * window / SAMPLES - 0.5
    x = columns[None, :, None, None] + inner
    y = rows[:, None, None, None] + inner[:, None]
    xyz, cos_phi = camera.near(body, x, y)
    depth = 1 - np.tensordot(camera.out, xyz, 1)
    with np.errstate(invalid="ignore"):
        good = (cos_phi > 0) & (depth <= camera.depth)
    mask = good.mean(axis=(-2, -1)) < COVERED
    use = good & ~mask[..., None, None]
    weight = np.where(use, 1 / np.maximum(np.where(use, cos_phi, 1.0), DENSEST), 0.0)
    total = np.where(mask, 1.0, weight.sum(axis=(-2, -1)))
    rng = np.random.default_rng([camera.seed, 5])
    out = np.full((2, len(when), len(rows), len(columns)), np.nan)
    for k, t in enumerate(when):
        moved = np.zeros((2, *use.shape))
        for part, each in zip(moved, camera.moved(body.velocity(xyz[:, use], float(t))), strict=True):
            part[use] = each * camera.step
        out[:, k] = (weight * moved).sum(axis=(-2, -1)) / total
        out[:, k] += camera.noise_px * rng.normal(size=out.shape[2:])
    bad = (rng.random(out.shape[1:]) < wrong) & ~mask
    out[:, bad] = rng.uniform(-0.25, 0.25, (2, int(bad.sum()))) * window
    out[:, :, mask] = np.nan
    return {
        "times": when,
        "x": columns + 0.5 * (window - 1),
        "y": rows + 0.5 * (window - 1),
        "vx": out[0],
        "vy": out[1],
        "flag": bad,
        "mask": mask,
        "window_px": window,
    }
