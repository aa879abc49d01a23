"""The camera: pixels, frames and focus, and where it sees which point of a body."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...model.errors import InputError, number, whole
from ...model.scales import Scales
from ..view import View
from .body import Array, Body

LARGEST_PICTURE = 8192
MARGIN = 0.3
"""Room beside a cell in a picture, in radii."""


@dataclass(frozen=True)
class Camera:
    """What a microscope is set to. `size_px` is (width, height) of a picture.

    `pixel_um` is the size of a pixel, `frame_s` the time between two frames, `depth_um` the depth of field
    below the point that is nearest to the camera (None: everything is sharp), `noise_px` the standard
    deviation of one measured displacement or place, in pixels, and `speed_um_per_s` the U of the cell.
    """

    view: View
    size_px: tuple[int, int]
    pixel_um: float = 5.0
    frame_s: float = 0.3
    depth_um: float | None = None
    noise_px: float = 0.1
    speed_um_per_s: float = 100.0
    seed: int = 0

    def __post_init__(self) -> None:
        checks = {
            "pixel_um": (1e-6, 1e6, "give the size of a pixel in micrometres"),
            "frame_s": (1e-9, 1e9, "give the time between frames in seconds"),
            "noise_px": (0.0, 1e3, "give the noise in pixels, 0.1 for example"),
            "speed_um_per_s": (1e-9, 1e9, "give the unit of speed U in micrometres per second"),
        }
        for name, (low, high, remedy) in checks.items():
            object.__setattr__(self, name, number(name, getattr(self, name), low, high, remedy))
        if self.depth_um is not None:
            remedy = "give the depth of field in micrometres, or leave it out"
            object.__setattr__(self, "depth_um", number("depth_um", self.depth_um, 1e-6, 1e9, remedy))
        remedy = "give a whole number"
        object.__setattr__(self, "seed", whole("seed", self.seed, 0, 2**63 - 1, remedy))
        if not isinstance(self.size_px, list | tuple) or len(self.size_px) != 2:
            rule = "two whole numbers (width, height)"
            raise InputError("size_px", self.size_px, rule, "give the size of the picture in pixels")
        for each in self.size_px:
            whole("size_px", each, 16, LARGEST_PICTURE, "give the size of the picture in pixels")
        object.__setattr__(self, "size_px", (int(self.size_px[0]), int(self.size_px[1])))

    @property
    def radius_um(self) -> float:
        """The radius of the cell."""
        return self.view.radius_px * self.pixel_um

    @property
    def scales(self) -> Scales:
        """The physical units of the cell."""
        return Scales(self.radius_um, self.speed_um_per_s)

    @property
    def step(self) -> float:
        """The time between two frames, in R/U."""
        return self.frame_s / self.scales.time_s

    @property
    def px_per_frame(self) -> float:
        """The speed U in pixels per frame."""
        return self.view.radius_px * self.step

    @property
    def depth(self) -> float:
        """The depth of field in radii, infinite if everything is sharp."""
        return np.inf if self.depth_um is None else self.depth_um / self.radius_um

    @property
    def out(self) -> Array:
        """The direction (3,) to the camera."""
        facing = self.view.facing
        return np.array([np.cos(facing), np.sin(facing), 0.0])

    @property
    def across(self) -> Array:
        """The direction (3,) that `View.e_across` is in the image: of increasing θ where the camera looks."""
        facing = self.view.facing
        return np.array([-np.sin(facing), np.cos(facing), 0.0])

    def seen(self, body: Body, xyz: Array) -> tuple[Array, Array, Array, Array]:
        """Return x, y (pixels), cos φ and depth (radii) of positions (3, n) of a body.

        cos φ is the share of the surface's normal that points to the camera: negative on the far side. The
        depth is that below the point of a body of radius 1 that is nearest to the camera.
        """
        across, along = self.across @ xyz, xyz[2]
        a, e, R = self.view.e_across, self.view.e_z, self.view.radius_px
        x = self.view.centre_px[0] + R * (across * a[0] + along * e[0])
        y = self.view.centre_px[1] + R * (across * a[1] + along * e[1])
        return x, y, self.out @ body.normal(xyz), 1 - self.out @ xyz

    def near(self, body: Body, x: Array, y: Array) -> tuple[Array, Array]:
        """Return the positions (3, ...) of the near side at places of the picture, and cos φ; NaN outside."""
        right, down = np.broadcast_arrays(x - self.view.centre_px[0], y - self.view.centre_px[1])
        a, e, R = self.view.e_across, self.view.e_z, self.view.radius_px
        across, z = (right * a[0] + down * a[1]) / R, (right * e[0] + down * e[1]) / R
        with np.errstate(invalid="ignore"):
            ahead = np.sqrt(body.radius_at(z) ** 2 - across**2)
        out, side = self.out, self.across
        xyz = np.stack([ahead * out[k] + across * side[k] + z * (k == 2) + 0 * ahead for k in range(3)])
        flat = xyz.reshape(3, -1)
        good = ~np.isnan(flat[0])
        cos_phi = np.full(flat.shape[1], np.nan)
        cos_phi[good] = self.out @ body.normal(flat[:, good])
        return xyz, cos_phi.reshape(ahead.shape)

    def moved(self, vectors: Array) -> tuple[Array, Array]:
        """Return the image (right, down) of vectors (3, ...), in pixels per radius."""
        across = np.tensordot(self.across, vectors, 1)
        along = vectors[2]
        a, e, R = self.view.e_across, self.view.e_z, self.view.radius_px
        return R * (across * a[0] + along * e[0]), R * (across * a[1] + along * e[1])


def framing(
    body: Body, view: View, centre: tuple[float, float] | None, size: tuple[int, int] | None
) -> tuple[View, tuple[int, int]]:
    """Return a view and the size of a picture in which the whole of a body is seen.

    A given centre or size is kept.
    """
    low, high = body.ends
    R = view.radius_px
    corners = np.array([[a, z] for a in (-1.0, 1.0) for z in (low, high)])
    places = R * (corners[:, :1] * view.e_across + corners[:, 1:] * view.e_z)
    margin = MARGIN * R
    least, most = places.min(axis=0) - margin, places.max(axis=0) + margin
    if size is None:
        room = most - least if centre is None else np.asarray(centre) + most
        if np.any(room < 16):
            rule = "a place from which the cell is in the picture"
            raise InputError("centre_px", centre, rule, "leave it out, or give size_px")
        size = (2 * int(np.ceil(room[0] / 2)), 2 * int(np.ceil(room[1] / 2)))
    if centre is None:
        middle = 0.5 * (least + most)
        centre = tuple(np.round(0.5 * (np.array(size) - 1) - middle, 3).tolist())
    return View(R, view.axis_deg, centre, view.facing, view.mirrored), size
