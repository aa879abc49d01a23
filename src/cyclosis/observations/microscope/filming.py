"""A film of bright particles, and what follows from it: kymographs and tracks."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from ...model.errors import InputError, choice, number, whole
from .body import Array, Body, within
from .camera import Camera
from .render import BRIGHT, chloroplasts, drawn, exposed, in_picture, shaded, spots
from .tracers import carried

PARTICLES_PER_PX = 0.012
"""Particles of a film per pixel of the surface: about twelve in a window of 32 x 32 pixels."""
FRAMES = {"film": 60, "kymograph": 160, "tracks": 40}
"""Frames if nothing is given."""
MOST_FRAMES = 20_000


def span(body: Body, camera: Camera, start: float | None, frames: int) -> Array:
    """Return the times (frames,) of a film in R/U: from `start` on, or the last of the run."""
    lasts = (frames - 1) * camera.step
    first = max(float(body.times[-1]) - lasts, float(body.times[0])) if start is None else start
    if len(body.times) > 1:
        within(body.times, first, "start")
        if first + lasts > body.times[-1] + 1e-9:
            rule = f"at most {int((body.times[-1] - first) / camera.step) + 1}, which end with the run"
            raise InputError("frames", frames, rule, "start earlier, or make frame_s shorter")
    return np.minimum(first + camera.step * np.arange(frames), max(float(body.times[-1]), first))


def moving(body: Body, camera: Camera, times: Array, particles: int, seed: int) -> Iterator[Array]:
    """Yield the positions (3, n) of particles at the times of the frames."""
    xyz = body.scattered(particles, np.random.default_rng([camera.seed, seed]))
    for k, t in enumerate(times):
        yield xyz
        if k + 1 < len(times):
            step = camera.step if len(body.times) == 1 else float(times[k + 1] - t)
            xyz = carried(body, xyz, float(t), step)


def pictures(body: Body, camera: Camera, times: Array, density: float, background: bool) -> Iterator[Any]:
    """Yield the frames (rows, columns) of a film, 8 bits."""
    rng = np.random.default_rng([camera.seed, 2])
    particles = max(1, round(density * body.area * camera.view.radius_px**2))
    brightness = BRIGHT * np.exp(0.3 * rng.normal(size=particles))
    still = shaded(camera, body)
    if background:
        still = still + chloroplasts(camera, body, rng)
    for xyz in moving(body, camera, times, particles, 1):
        yield exposed(still + drawn(camera.size_px, *spots(camera, body, xyz, brightness)[:4]), rng)


def film(
    body: Body,
    camera: Camera,
    start: float | None = None,
    frames: int | None = None,
    particles_per_px: float = PARTICLES_PER_PX,
    chloroplasts: bool = False,
) -> dict[str, Any]:
    """Return a film: `frames` (time, y, x) of 8 bits, and the times (time,) in R/U."""
    count = whole("frames", frames or FRAMES["film"], 2, MOST_FRAMES, "give a number of frames")
    remedy = "0.012 makes a dozen in a window of 32 pixels"
    density = number("particles_per_px", particles_per_px, 1e-6, 1.0, remedy)
    times = span(body, camera, start, count)
    return {"times": times, "frames": np.stack([*pictures(body, camera, times, density, chloroplasts)])}


def kymograph(
    body: Body,
    camera: Camera,
    start: float | None = None,
    frames: int | None = None,
    line: str = "along",
    at: float = 0.0,
    width_px: float = 5.0,
    particles_per_px: float = PARTICLES_PER_PX,
    chloroplasts: bool = False,
) -> dict[str, Any]:
    """Return the light along a line against time: `image` (time, place), places in px, times in R/U.

    The line lies along the cell at φ = `at` degrees, or across it at z = `at` radii.
    """
    from scipy.ndimage import map_coordinates

    choice("line", line, ("along", "across"))
    count = whole("frames", frames or FRAMES["kymograph"], 2, MOST_FRAMES, "give a number of frames")
    broad = number("width_px", width_px, 0.0, 100.0, "give the width of the line in pixels")
    x, y, places, phi, z = _line(body, camera, line, at)
    times = span(body, camera, start, count)
    normal = camera.view.e_across if line == "along" else camera.view.e_z
    offsets = np.linspace(-0.5, 0.5, max(1, round(broad))) * broad
    where = [
        np.stack([y + off * normal[1], x + off * normal[0]]) for off in (offsets if broad > 1 else [0.0])
    ]
    rows = []
    for picture in pictures(body, camera, times, particles_per_px, chloroplasts):
        light = [map_coordinates(picture.astype(float), each, order=1, mode="nearest") for each in where]
        rows.append(np.mean(light, axis=0))
    return {
        "times": times,
        "image": np.clip(np.rint(rows), 0, 255).astype(np.uint8),
        "place_px": places,
        "x": x,
        "y": y,
        "phi": phi,
        "z": z,
        "line": line,
    }


def _line(body: Body, camera: Camera, line: str, at: float) -> tuple[Array, Array, Array, Array, Array]:
    """Return x, y, place (pixels), φ and z along a line in the picture, one point a pixel."""
    width, height = camera.size_px
    view, low, high = camera.view, *body.ends
    R = view.radius_px
    if line == "along":
        degrees = number("at", at, -80.0, 80.0, "give the angle from the middle of the view in degrees")
        z = np.arange(low * R, high * R) / R
        across = np.full(z.size, np.sin(np.radians(degrees)))
    else:
        z0 = number("at", at, low, high, "give a height in radii")
        r = float(body.radius_at(np.array([z0]))[0])
        across = np.arange(-r * R + 1, r * R) / R
        z = np.full(across.size, z0)
    x = view.centre_px[0] + R * (across * view.e_across[0] + z * view.e_z[0])
    y = view.centre_px[1] + R * (across * view.e_across[1] + z * view.e_z[1])
    inside = (x >= 0) & (x <= width - 1) & (y >= 0) & (y <= height - 1)
    if inside.sum() < 16:
        raise InputError("at", at, "a line in the picture", "choose another, or a larger picture")
    x, y, across, z = x[inside], y[inside], across[inside], z[inside]
    places = (z if line == "along" else across) * R
    with np.errstate(invalid="ignore"):
        phi = np.arcsin(across / body.radius_at(z))
    return x, y, places, phi, z


PARTICLES_TRACKED = 0.0012
"""Tracked particles per pixel of the surface."""
GAP = 2
"""Frames that a track may miss."""
QUALITY = 25.0


def tracks(
    body: Body,
    camera: Camera,
    start: float | None = None,
    frames: int | None = None,
    particles_per_px: float = PARTICLES_TRACKED,
    missed: float = 0.05,
) -> dict[str, Any]:
    """Return the places of tracked particles: arrays (spots,) sorted by track and frame.

    A share `missed` of the spots is not found; a track goes on after at most two frames without its spot.
    """
    count = whole("frames", frames or FRAMES["tracks"], 2, MOST_FRAMES, "give a number of frames")
    share = number("missed", missed, 0.0, 0.9, "give the share of spots that is not found")
    remedy = "0.0012 makes tracks that hardly meet"
    density = number("particles_per_px", particles_per_px, 1e-6, 1.0, remedy)
    times = span(body, camera, start, count)
    particles = max(1, round(density * body.area * camera.view.radius_px**2))
    rng = np.random.default_rng([camera.seed, 3])
    found: list[Array] = []
    for k, xyz in enumerate(moving(body, camera, times, particles, 4)):
        all_, own = in_picture(camera, body, xyz)
        x, y, cos_phi, depth = camera.seen(body, all_)
        width, height = camera.size_px
        seen = (cos_phi > 0.05) & (depth <= camera.depth)
        seen &= (x >= 0) & (x <= width - 1) & (y >= 0) & (y <= height - 1)
        seen &= rng.random(x.size) >= share
        n = int(seen.sum())
        noise = camera.noise_px * rng.normal(size=(2, n))
        quality = QUALITY * np.exp(0.3 * rng.normal(size=n))
        at = np.stack([*own[:, seen], np.full(n, k), x[seen] + noise[0], y[seen] + noise[1], quality])
        found.append(at)
    table = np.concatenate(found, axis=1)
    table = table[:, np.lexsort((table[2], table[1], table[0]))]
    new = np.any(np.diff(table[:2], axis=1) != 0, axis=0) | (np.diff(table[2]) > GAP + 1)
    track = np.concatenate([[0], np.cumsum(new)])
    lengths = np.bincount(track)
    kept = lengths[track] >= 2
    _, track = np.unique(track[kept], return_inverse=True)
    _, _, frame, x, y, quality = table[:, kept]
    if track.size == 0:
        rule = "so many that at least one is seen in two frames"
        raise InputError("particles_per_px", particles_per_px, rule, "give more of them, or more frames")
    return {"times": times, "track": track, "frame": frame.astype(int), "x": x, "y": y, "quality": quality}
