"""Pictures of filaments, and the angle of their texture."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from ...model.errors import number, whole
from .body import Array, Body, chosen
from .camera import Camera
from .render import exposed, lines, shaded

FILAMENTS_PER_PX = 0.006
FILAMENT = 0.22
"""Length of a drawn filament, in radii."""
POINTS = 14
"""Spots in a row that make a filament."""
BRIGHTEST = 99.0
"""Percentile of the light of a picture that the exposure is set by."""
TENSOR_PX = 6.0
"""Standard deviation of the Gaussian window of the structure tensor, in pixels."""
TABLE_PX = 12


def orientation(
    body: Body,
    camera: Camera,
    times: npt.ArrayLike | None = None,
    filaments_per_px: float = FILAMENTS_PER_PX,
    step_px: int = TABLE_PX,
) -> dict[str, Any]:
    """Return pictures of filaments and the angle of their texture, (time, rows, columns).

    Filaments lie along random directions whose mean is P. `angle` is the direction of the texture in degrees
    (-90, 90], counter-clockwise from the right as seen; `coherency` says from 0 to 1 how parallel it is, and
    `energy` how much texture there is, as OrientationJ does.
    """
    remedy = "0.006 makes a dense texture"
    density = number("filaments_per_px", filaments_per_px, 1e-6, 1.0, remedy)
    step = whole("step_px", step_px, 1, 512, "give the distance of points in a table, in pixels")
    when = chosen(body, times, all_=False)
    rng = np.random.default_rng([camera.seed, 6])
    count = max(1, round(density * body.area * camera.view.radius_px**2))
    glow = shaded(camera, body)
    found: dict[str, list[Any]] = {name: [] for name in ("image", "angle", "coherency", "energy")}
    for t in when:
        xyz = body.scattered(count, rng)
        direction = _directions(body, xyz, float(t), rng)
        picture = lines(camera, body, xyz, direction, FILAMENT, POINTS)
        usual = max(float(np.percentile(picture, BRIGHTEST)), 1e-12)
        image = exposed(glow + 200.0 / usual * picture, rng)
        angle, coherency, energy = structure(image.astype(float))
        for name, value in zip(found, (image, angle, coherency, energy), strict=True):
            found[name].append(value)
    return {"times": when, **{name: np.stack(each) for name, each in found.items()}, "step_px": step}


def _directions(body: Body, xyz: Array, t: float, rng: np.random.Generator) -> Array:
    """Return unit vectors (3, n) along the surface whose mean is P: von Mises about its direction."""
    from scipy.special import i0e, i1e

    P = body.filaments(xyz, t)
    size = np.clip(np.linalg.norm(P, axis=0), 1e-9, 0.995)
    table = np.concatenate([[0.0], np.geomspace(1e-3, 200.0, 400)])
    sharpness = np.interp(size, i1e(table) / i0e(table), table)
    along = P / np.maximum(np.linalg.norm(P, axis=0), 1e-12)
    beside = np.cross(body.normal(xyz), along, axis=0)
    angle = rng.vonmises(0.0, sharpness)
    return np.cos(angle) * along + np.sin(angle) * beside


def structure(image: Array, window_px: float = TENSOR_PX) -> tuple[Array, Array, Array]:
    """Return angle (degrees), coherency and energy of the texture of a picture, from its structure tensor.

        angle = ½ atan2(2 J_xy, J_yy - J_xx),   coherency = ((J_yy - J_xx)² + 4 J_xy²)^½ / (J_xx + J_yy)

    in image coordinates, y down; the angle is counter-clockwise from the right as seen, along the texture.
    """
    from scipy.ndimage import gaussian_filter

    gx = gaussian_filter(image, 1.0, order=(0, 1))
    gy = gaussian_filter(image, 1.0, order=(1, 0))
    xx, yy, xy = (gaussian_filter(part, window_px) for part in (gx * gx, gy * gy, gx * gy))
    angle = np.degrees(0.5 * np.arctan2(2 * xy, yy - xx))
    energy = xx + yy
    strength = np.hypot(yy - xx, 2 * xy)
    coherency = strength / np.maximum(energy, 1e-12)
    return np.where(angle <= -90.0, angle + 180.0, angle), coherency, energy / max(energy.max(), 1e-12)
