"""Pictures: bright spots, lines, chloroplasts, and the noise of a camera."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from .body import Array, Body
from .camera import Camera
from .tracers import repeated

SPOT_PX = 1.2
"""Standard deviation of a sharp spot in the picture, in pixels."""
BLUR = 2.0
"""How fast spots widen below the depth of field: at twice the depth they are this many times as wide."""
WIDEST = 3.0
"""Spots wider than this many sharp ones are lost in the background."""
BACKGROUND, BRIGHT = 18.0, 170.0
"""Grey levels of the background and of the middle of a sharp spot of usual brightness, of 255."""
CHLOROPLAST = 40.0
"""Grey levels of each of the three spots that make a chloroplast."""
GAIN = 0.35
"""Grey levels per square root of a grey level of photon noise; together with `READ` the noise of a camera."""
READ = 1.5


def spots(
    camera: Camera, body: Body, xyz: Array, brightness: Array
) -> tuple[Array, Array, Array, Array, npt.NDArray[np.int64]]:
    """Return x, y, width (pixels), height (grey levels) and number of the spots of particles in a picture.

    Only those on the near side are seen. Below the depth of field they are wide and faint, then lost.
    """
    all_, own = in_picture(camera, body, xyz)
    x, y, cos_phi, depth = camera.seen(body, all_)
    out_of_focus = np.maximum(depth / camera.depth - 1, 0.0) if np.isfinite(camera.depth) else 0 * depth
    wide = np.sqrt(1 + (BLUR * out_of_focus) ** 2)
    width, height = camera.size_px
    margin = 4 * SPOT_PX
    seen = (cos_phi > 0) & (wide < WIDEST)
    seen &= (x > -margin) & (x < width + margin) & (y > -margin) & (y < height + margin)
    return x[seen], y[seen], SPOT_PX * wide[seen], brightness[own[0, seen]] / wide[seen] ** 2, own[0, seen]


def in_picture(camera: Camera, body: Body, xyz: Array) -> tuple[Array, npt.NDArray[np.int64]]:
    """Return positions with their copies along a periodic cell, as far as the picture goes."""
    width, height = camera.size_px
    corners = np.array([[0.0, 0.0], [width, 0.0], [0.0, height], [width, height]])
    along = (corners - camera.view.centre_px) @ camera.view.e_z / camera.view.radius_px
    return repeated(body, xyz, along.min() - 0.2, along.max() + 0.2)


def drawn(size: tuple[int, int], x: Array, y: Array, width: Array, height: Array) -> Array:
    """Return a picture (rows, columns) of Gaussian spots, averaged over each pixel."""
    from scipy.special import erf

    columns, rows = size
    if x.size == 0:
        return np.zeros((rows, columns))
    reach = int(np.ceil(3.5 * width.max() + 1))
    offsets = np.arange(-reach, reach + 1)
    parts, places = [], []
    for at, most in ((x, columns), (y, rows)):
        pixel = np.rint(at).astype(np.int64)[:, None] + offsets
        scale = np.sqrt(2) * width[:, None]
        share = 0.5 * (erf((pixel + 0.5 - at[:, None]) / scale) - erf((pixel - 0.5 - at[:, None]) / scale))
        inside = (pixel >= 0) & (pixel < most)
        parts.append(share * inside)
        places.append(np.clip(pixel, 0, most - 1))
    total = height * 2 * np.pi * width**2
    values = total[:, None, None] * parts[1][:, :, None] * parts[0][:, None, :]
    index = places[1][:, :, None] * columns + places[0][:, None, :]
    picture = np.bincount(index.ravel(), weights=values.ravel(), minlength=rows * columns)
    return np.asarray(picture, dtype=np.float64).reshape(rows, columns)


def exposed(picture: Array, rng: np.random.Generator) -> npt.NDArray[np.uint8]:
    """Return what an 8-bit camera records of a picture in grey levels."""
    light = BACKGROUND + picture
    noisy = light + rng.normal(size=light.shape) * np.sqrt(READ**2 + GAIN**2 * light)
    return np.clip(np.rint(noisy), 0, 255).astype(np.uint8)


def shaded(camera: Camera, body: Body) -> Array:
    """Return the faint glow of the cell itself (rows, columns), which shows its outline."""
    width, height = camera.size_px
    x, y = np.meshgrid(np.arange(width, dtype=np.float64), np.arange(height, dtype=np.float64))
    cos_phi = camera.near(body, x, y)[1]
    rim = np.where(np.isnan(cos_phi), 1.0, cos_phi)
    return np.where(np.isnan(cos_phi), 0.0, 9.0 + 16.0 * np.exp(-((rim / 0.25) ** 2)))


def chloroplasts(camera: Camera, body: Body, rng: np.random.Generator) -> Array:
    """Return a picture of chloroplasts, which stand still: files of oval bodies along the cell."""
    gap_around, gap_along = 0.16, 0.22
    low, high = body.ends
    picture = np.zeros(camera.size_px[::-1])
    for file in range(round(2 * np.pi / gap_around)):
        z = np.arange(low + gap_along * rng.random(), high, gap_along)
        z = z + 0.15 * gap_along * rng.normal(size=z.size)
        theta = file * gap_around + 0.02 * rng.normal(size=z.size)
        r = body.radius_at(z)
        good = ~np.isnan(r)
        xyz = np.stack([r * np.cos(theta), r * np.sin(theta), z])[:, good]
        # A row of overlapping spots along the axis makes an oval.
        for shift in (-0.05, 0.0, 0.05):
            part = xyz + np.array([[0.0], [0.0], [shift]])
            found = spots(camera, body, part, np.full(part.shape[1], CHLOROPLAST))
            wide = np.full(found[0].shape, 0.035 * camera.view.radius_px)
            picture += drawn(camera.size_px, found[0], found[1], wide, found[3])
    return picture


def lines(camera: Camera, body: Body, xyz: Array, direction: Array, length: float, points: int) -> Array:
    """Return a picture of short straight filaments, each a row of spots along its direction (3, n)."""
    picture = np.zeros(camera.size_px[::-1])
    for share in np.linspace(-0.5, 0.5, points):
        part = body.held(xyz + share * length * direction)
        x, y, width, height, _ = spots(camera, body, part, np.ones(part.shape[1]))
        picture += drawn(camera.size_px, x, y, width, height)
    return picture
