"""Checks of a geometry that cost nothing: the rim, the axis, and the divergence of the flow."""

from __future__ import annotations

import warnings
from dataclasses import replace
from typing import Any

import numpy as np

from ..model.errors import InputError
from .observation import Array, Bools, Frame, Observation
from .view import View

MOST_OUTSIDE = 0.2
"""Share of good vectors outside the rim above which radius or centre are wrong."""
ALIKE = 0.5
"""A vector flows if it differs from its neighbours' median by less than this share of it."""
FLIPPED = 0.3
"""Correlation of the two parts of div u above which one component has the wrong sign."""
TILT_DEG = 1.0
"""Degrees between the mean direction of flow and the axis above which the axis may be wrong."""

FAR = 1 / 3
"""Share of a window's side that particles may move between two images."""


def too_far(obs: Observation) -> str | None:
    """Return a sentence if particles move by more than a third of a window between the images of a pair.

    So many of them leave their window meanwhile that the fast parts of the flow are lost. None if that is not
    so, or if the window or the time between the images is not known.
    """
    if obs.window_px is None or not any(frame.vx is not None and frame.good.any() for frame in obs.frames):
        return None
    interval = 1.0 if obs.time_unit == "frame" else obs.frame_s
    if interval is None:
        return None
    sizes = [np.hypot(f.vx, f.vy)[f.good] for f in obs.frames if f.vx is not None and f.vy is not None]
    peak = interval * float(np.quantile(np.concatenate(sizes), 0.99))
    if peak <= FAR * obs.window_px:
        return None
    return (
        f"particles move by up to {peak:.3g} pixels from image to image, more than a third of a window of "
        f"{obs.window_px:.3g}: fast flow is lost unless earlier passes had larger windows; "
        "take images closer in time"
    )


def inside(frame: Frame, view: View, outside: str, source: str) -> Frame:
    """Return a frame of which only the samples on the cell are good.

    Raises `InputError` if many outside move as a flow does. Still ones, and the noise that correlation
    gives in a background without texture, are left out and say nothing about the view.
    """
    there = np.isfinite(view.to_surface(frame.x, frame.y)[2])
    good = int(frame.good.sum())
    beyond = frame.good & ~there
    flowing = int((beyond & _flows(frame, there)).sum()) if beyond.any() else 0
    share = flowing / good if good else 0.0
    if share > MOST_OUTSIDE and outside == "refuse":
        rule = f"a view in which at most 20 % of the good vectors flow outside the cell; {share:.0%} do"
        remedy = "correct radius_px, axis_deg or centre_px, or give outside='drop' if that is not the cell"
        command = "correct the radius, --axis or --centre, or give --outside drop if that is not the cell"
        raise InputError("the view of " + source, view.to_dict(), rule, remedy, command)
    return replace(frame, good=frame.good & there)


def _flows(frame: Frame, there: Bools) -> Bools:
    """Return which samples move, and on a grid like those around them."""
    assert frame.vx is not None
    assert frame.vy is not None
    both = np.where(frame.good, np.stack([frame.vx, frame.vy]), np.nan)
    size = np.hypot(*both)
    within = size[there & frame.good]
    typical = float(np.median(within)) if within.size else 0.0
    moving: Bools = size > 0.1 * typical if typical > 0 else size > 0
    if frame.grid is None or min(frame.grid) < 3:
        return moving
    grid = np.pad(both.reshape(2, *frame.grid), ((0, 0), (1, 1), (1, 1)), constant_values=np.nan)
    rows, columns = frame.grid
    around = [grid[:, m : m + rows, n : n + columns] for m in range(3) for n in range(3) if (m, n) != (1, 1)]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)  # all neighbours may be bad
        middle = np.nanmedian(around, axis=0).reshape(2, -1)
    with np.errstate(invalid="ignore"):
        return moving & (np.hypot(*(both - middle)) < ALIKE * np.hypot(*middle))


def sanity(data: Any, view: View) -> list[str]:
    """Return sentences about what seems wrong with a measured flow on the surface."""
    u, theta, z, cos_phi = (data[n].values for n in ("u", "theta", "z", "cos_phi"))
    said = []
    found = divergence(u, theta, z, cos_phi)
    if found is not None and found > FLIPPED:
        said.append(
            "one component of the velocity seems to have the wrong sign: du_theta/dtheta and du_z/dz, which "
            f"cancel in a layer that is not compressed, correlate at {found:+.2f}; check y and the sign of v"
        )
    tilt = direction(u, cos_phi)
    if tilt is not None and abs(tilt) > TILT_DEG:
        turned = -tilt if not view.mirrored else tilt
        said.append(
            f"the mean line of the flow is {abs(tilt):.1f} degrees from the axis: the streams are helical, "
            f"or the axis is at {view.axis_deg + turned:.1f} degrees"
        )
    return said


def divergence(u: Array, theta: Array, z: Array, cos_phi: Array) -> float | None:
    """Return the correlation of du_θ/dθ and du_z/dz: -1 without divergence, 0 for noise, 1 if one is flipped.

    `u` is (time, 2, n_theta, n_z). None if too little is known, or if the correlation could be chance.
    """
    if theta.size < 4 or z.size < 4:
        return None
    inner = slice(1, -1)
    a = (u[:, 0, 2:, inner] - u[:, 0, :-2, inner]) / (theta[2:] - theta[:-2])[:, None]
    b = (u[:, 1, inner, 2:] - u[:, 1, inner, :-2]) / (z[2:] - z[:-2])
    used = np.isfinite(a) & np.isfinite(b) & (cos_phi[inner] > 0.5)[:, None]
    if used.sum() < 40:
        return None
    a, b = a[used], b[used]
    low, high = (np.quantile(np.abs(each), 0.99) for each in (a, b))
    a, b = np.clip(a, -low, low), np.clip(b, -high, high)
    size = float(np.sqrt((a**2).mean() * (b**2).mean()))
    if size == 0.0:
        return None
    found = float((a * b).mean()) / size
    return found if abs(found) > 4.0 / np.sqrt(a.size / 4.0) else None


def direction(u: Array, cos_phi: Array) -> float | None:
    """Return the angle of the mean line of the flow from +z towards +θ, in degrees: its first principal axis.

    None if the flow has no such line: if it is weak, or not mainly along one.
    """
    near = cos_phi > 0.7
    across, along = u[:, 0, near].ravel(), u[:, 1, near].ravel()
    used = np.isfinite(across) & np.isfinite(along)
    if used.sum() < 20:
        return None
    a, b = across[used], along[used]
    matrix = np.array([[a @ a, a @ b], [a @ b, b @ b]])
    values, vectors = np.linalg.eigh(matrix)
    if values[0] > 0.1 * values[1]:
        return None
    line = vectors[:, 1] * np.sign(vectors[1, 1] or 1.0)
    angle = float(np.degrees(np.arctan2(line[0], line[1])))
    error = np.degrees(np.sqrt(max(values[0], 0.0) / values[1]) / np.sqrt(used.sum() / 4.0))
    return angle if abs(angle) > 3.0 * error and abs(angle) < 20.0 else None
