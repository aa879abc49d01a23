"""Magnetic resonance velocimetry: the speed along the cell in a slice across it."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from ...model.errors import InputError, number, whole
from .body import Array, Body, chosen
from .camera import Camera

RADII = 65
EXTENT = 1.1
"""Half of the side of a slice, in radii."""
FINER = 4
"""Points across a pixel of a slice in which its velocity is averaged."""


def mrv(
    body: Body,
    camera: Camera,
    times: npt.ArrayLike | None = None,
    points: int = 64,
    slice_z: float | None = None,
    slice_um: float = 1000.0,
    venc_mm_per_s: float | None = None,
    noise_mm_per_s: float = 0.002,
) -> dict[str, Any]:
    """Return the velocity along the cell in a slice across it, `image` (time, points, points) in mm/s.

    The picture spans ±1.1 R; θ = facing is at its right and θ increases counter-clockwise as seen, with +z
    towards the viewer (mirrored: clockwise). A value is the mean over the slice, `slice_um` thick about
    `slice_z` radii, and over the pixel, in the vacuole and at its wall. Speeds beyond ± `venc_mm_per_s` wrap.
    Outside the cell there is no signal: the phase, and with it the velocity, is random.
    """
    from .cylinder import Cylinder

    if not isinstance(body, Cylinder):
        rule = "the periodic cylinder: the vacuole of a closed cell is not modelled"
        raise InputError("the surface of the run", "a closed cell", rule, "use a run on the cylinder")
    count = whole("points", points, 8, 1024, "give the number of pixels across the slice")
    length = body.grid.length
    middle = 0.5 * length if slice_z is None else slice_z
    middle = number("slice_z", middle, -1e9, 1e9, "give a position along the axis in radii")
    thick = number("slice_um", slice_um, 0.0, 1e9, "give the thickness of the slice in micrometres")
    noise = number("noise_mm_per_s", noise_mm_per_s, 0.0, 1e6, "give the noise in mm/s")
    unit = camera.speed_um_per_s / 1000
    venc = 2.0 * unit if venc_mm_per_s is None else venc_mm_per_s
    venc = number("venc_mm_per_s", venc, 1e-9, 1e9, "give the largest speed that does not wrap, in mm/s")
    when = chosen(body, times, all_=False)
    rng = np.random.default_rng([camera.seed, 7])
    side = EXTENT * (2 * (np.arange(count * FINER) + 0.5) / (count * FINER) - 1)
    right, up = np.meshgrid(side, side[::-1])
    sign = -1.0 if camera.view.mirrored else 1.0
    r, theta = np.hypot(right, up), camera.view.facing + sign * np.arctan2(up, right)
    inside = r <= 1.0
    share = _blocks(inside.astype(float))
    images = []
    for t in when:
        flow = body.flow.at_time(float(t)) if len(body.times) > 1 else body.flow.at_time(float(body.times[0]))
        along = _sliced(flow, middle, thick / camera.radius_um)
        fine = np.where(inside, _polar(along, r, theta), 0.0)
        with np.errstate(divide="ignore", invalid="ignore"):
            mean = unit * _blocks(fine) / share
        image = np.where(share > 0.5, mean + noise * rng.normal(size=mean.shape), 0.0)
        image = np.mod(image + venc, 2 * venc) - venc
        nothing = rng.uniform(-venc, venc, image.shape)
        images.append(np.where(share > 0.5, image, nothing))
    mm = 2 * EXTENT * camera.radius_um / 1000 / count
    return {
        "times": when,
        "image": np.stack(images).astype(np.float32),
        "inside": share > 0.5,
        "venc_mm_per_s": venc,
        "pixel_mm": mm,
        "slice_z": middle,
        "slice_um": thick,
    }


def _blocks(fine: Array) -> Array:
    n = fine.shape[0] // FINER
    return np.asarray(fine.reshape(n, FINER, n, FINER).mean(axis=(1, 3)))


def _sliced(flow: Any, middle: float, thickness: float) -> Array:
    """Return u_z (radius, θ) averaged over a slice: each wave along z by its own mean."""
    radii = np.linspace(0.0, 1.0, RADII)
    along = flow.volume(radii)[2]
    waves = np.fft.rfft(along, axis=-1, norm="forward")
    q = 2 * np.pi / flow.grid.length * np.arange(waves.shape[-1])
    factor = np.exp(1j * q * middle) * np.sinc(0.5 * q * thickness / np.pi)
    factor[1:] *= 2
    return np.asarray((waves * factor).real.sum(axis=-1))


def _polar(values: Array, r: Array, theta: Array) -> Array:
    """Return values (radius, θ) at places, by splines over the whole diameter."""
    from scipy.ndimage import map_coordinates

    n = values.shape[1]
    opposite = np.roll(values, n // 2, axis=1)[:0:-1]
    whole_ = np.concatenate([opposite, values])
    whole_ = np.concatenate([whole_[:, -6:], whole_, whole_[:, :6]], axis=1)
    places = [np.minimum(r, 1.0) * (RADII - 1) + RADII - 1, np.mod(theta, 2 * np.pi) / (2 * np.pi) * n + 6]
    return np.asarray(map_coordinates(whole_, places, order=3, mode="mirror"))
