"""A kymograph and a cross-section become velocities at places of the surface."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from ..model.errors import InputError
from .formats.content import VELOCITY
from .kymograph import line_speeds
from .observation import Array, Frame, Observation
from .view import View

ALONG_DEG = 3.0
"""A line counts as along or across the cell within this angle."""
WINDOW_PX = 64
"""Columns of a window of a kymograph, at least."""
HARMONICS = 8
"""Angular orders of the flow in a cross-section."""


def of_kymograph(obs: Observation, view: View) -> tuple[Observation, int]:
    """Return a kymograph as velocities along its line, and which component they are (0 θ, 1 z)."""
    frame, component = _line(obs, view)
    return replace(obs, kind=VELOCITY, frames=(frame,)), component


def _line(obs: Observation, view: View) -> tuple[Frame, int]:
    """Return the velocities along a line that runs along the cell or across it, and their component."""
    ends = obs.extra.get("line_px")
    if ends is None:
        rule = "given for a kymograph: the two ends of its line in the image, ((x, y), (x, y)), y down"
        raise InputError("line_px", None, rule, "give it when reading", "give --line X,Y,X,Y")
    image: Any = obs.image
    direction = (ends[1] - ends[0]) / np.hypot(*(ends[1] - ends[0]))
    cosine, sine = abs(float(direction @ view.e_z)), abs(float(direction @ view.e_across))
    if min(cosine, sine) > np.sin(np.radians(ALONG_DEG)):
        rule = f"along the cell or across it, within {ALONG_DEG:g} degrees"
        raise InputError("line_px", ends.tolist(), rule, "speeds along other lines are not one component")
    parts = max(1, image.shape[1] // WINDOW_PX)
    found = line_speeds(image, columns=parts)
    speed = found.speed[0] / (obs.frame_s or 1.0)
    share = found.places / (image.shape[1] - 1)
    places = ends[0] + share[:, None] * (ends[1] - ends[0])
    # Pixels of the kymograph are those of the image if the line was sampled once per pixel.
    scale = float(np.hypot(*(ends[1] - ends[0]))) / (image.shape[1] - 1)
    v = speed[:, None] * scale * direction
    along = cosine > sine
    if not along:
        cos_phi = view.to_surface(*places.T)[2]
        v = np.where((cos_phi > 0)[:, None], v, np.nan)
    good = np.isfinite(speed)
    grid = (1, parts) if along else (parts, 1)
    return Frame(places[:, 0], places[:, 1], good, v[:, 0], v[:, 1], grid=grid), int(along)


def at_rim(obs: Observation, view: View, theta: Array) -> tuple[Array, float]:
    """Return the velocity along the cell at its rim, from a cross-section, and its noise there.

    Both are in pixels per unit of time. The flow along the cell in the vacuole is harmonic, w = sum over m
    of r^|m| (a cos mφ + b sin mφ), so that all pixels inside tell its values at the rim. The centre of the
    view is that of the section. Its axis is the direction of θ = facing in the image, from which θ
    increases counter-clockwise, or clockwise if mirrored.
    """
    image: Any = obs.image
    rows, columns = np.indices(image.shape)
    right, down = columns - view.centre_px[0], rows - view.centre_px[1]
    r = np.hypot(right, down) / view.radius_px
    turn = np.arctan2(-down, right) - np.radians(view.axis_deg)
    phi = -turn if view.mirrored else turn
    used = np.isfinite(image) & (r < 1.0 - 0.5 / view.radius_px)
    if used.sum() < 4 * HARMONICS:
        rule = f"one with at least {4 * HARMONICS} measured pixels inside the circle of the view"
        raise InputError("observation", obs.source, rule, "check centre and radius")
    matrix = _harmonics(r[used], phi[used])
    found, *_ = np.linalg.lstsq(matrix, image[used], rcond=None)
    left = image[used] - matrix @ found
    rim = _harmonics(np.ones_like(theta), theta - view.facing)
    w: Array = rim @ found
    # What the scatter of the pixels leaves of uncertainty at the rim.
    spread = rim @ np.linalg.pinv(matrix.T @ matrix)
    return w, float(left.std() * np.sqrt((spread * rim).sum(axis=1).mean()))


def _harmonics(r: Array, phi: Array) -> Array:
    out = [np.ones_like(r)]
    for m in range(1, HARMONICS + 1):
        out += [r**m * np.cos(m * phi), r**m * np.sin(m * phi)]
    return np.stack(out, axis=1)
