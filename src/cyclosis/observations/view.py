"""Where a camera sees which point of the cell: the image and the surface, in both directions."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass, fields
from typing import Any

import numpy as np
import numpy.typing as npt

from ..display.shown import shown
from ..model.arrays import numbers
from ..model.doors import door
from ..model.errors import InputError, flag, number

Array = npt.NDArray[np.float64]
LARGEST = 1e9
"""The largest radius, centre and angle that are taken: beyond, differences of pixels drown in rounding."""


@shown
@dataclass(frozen=True)
class View:
    """A camera that looks at the side of a cylindrical cell.

        φ = θ - facing,   (x, y) = centre + R sin φ e_across + R z e_z,   e_across = ± e_z x e_out

    R is `radius_px`, the radius of the layer that moves, in pixels. Image coordinates are in pixels, x to the
    right and y DOWN, with the middle of the first pixel at (0, 0); velocities likewise, v positive downwards.
    `axis_deg` is the direction of +z in the image, counter-clockwise from the right, as seen. `centre_px` is
    the point (x, y) on the axis where z = 0. `facing` is the θ that faces the camera, radians. e_out points
    to the camera: with +z to the right, θ increases down the image; with +z up, to the right. A `mirrored`
    image (an odd number of mirrors on the way) has it the other way round. z is in radii, θ in radians in
    [0, 2π), speeds on the surface in radii per unit of time. Arrays broadcast. Raises `InputError` for
    values out of range.

    Example:
        >>> import numpy as np
        >>> import cyclosis as cy
        >>> view = cy.observations.View(radius_px=100.0, axis_deg=90.0, centre_px=(120.0, 500.0))
        >>> x, y, cos_phi = view.to_image(theta=np.pi + np.pi / 6, z=2.0)  # right of the axis, two radii up
        >>> round(float(x), 9), round(float(y), 9), round(float(cos_phi), 9)
        (170.0, 300.0, 0.866025404)
        >>> theta, z, cos_phi = view.to_surface(170.0, 300.0)
        >>> round(float(theta - np.pi), 9), round(float(z), 9)
        (0.523598776, 2.0)
        >>> view.to_surface(221.0, 300.0)[0].item()  # outside the rim
        nan
        >>> view.e_z.round(9) + 0.0, view.e_across.round(9) + 0.0  # up, and to the right
        (array([ 0., -1.]), array([1., 0.]))
        >>> view.phi(np.pi + 0.5).item()
        0.5
    """

    radius_px: float
    axis_deg: float = 0.0
    centre_px: tuple[float, float] = (0.0, 0.0)
    facing: float = math.pi
    mirrored: bool = False

    def __post_init__(self) -> None:
        give = "give it in pixels"
        set_ = object.__setattr__
        set_(self, "radius_px", number("radius_px", self.radius_px, 1e-3, LARGEST, give))
        degrees, radians = "give an angle in degrees", "give an angle in radians"
        set_(self, "axis_deg", number("axis_deg", self.axis_deg, -LARGEST, LARGEST, degrees))
        try:
            x, y = self.centre_px
        except (TypeError, ValueError):
            rule, remedy = "two numbers (x, y)", "give the place of z = 0 in pixels, y down"
            raise InputError("centre_px", self.centre_px, rule, remedy) from None
        centre = tuple(number("centre_px", each, -LARGEST, LARGEST, give) for each in (x, y))
        set_(self, "centre_px", centre)
        set_(self, "facing", number("facing", self.facing, -LARGEST, LARGEST, radians))
        set_(self, "mirrored", flag("mirrored", self.mirrored))

    @property
    def e_z(self) -> Array:
        """The direction (2,) of +z in the image, (x, y) with y down, a unit vector."""
        angle = math.radians(self.axis_deg)
        return np.array([math.cos(angle), -math.sin(angle)])

    @property
    def e_across(self) -> Array:
        """The direction (2,) of increasing θ in the image, (x, y) with y down, a unit vector."""
        angle = math.radians(self.axis_deg)
        sign = -1.0 if self.mirrored else 1.0
        return sign * np.array([math.sin(angle), math.cos(angle)])

    def phi(self, theta: npt.ArrayLike) -> Array:
        """Return the angle from the meridian that faces the camera, in radians from -π to π."""
        return np.asarray(_turned(_real("theta", theta) - self.facing))

    @door
    def to_surface(self, x: npt.ArrayLike, y: npt.ArrayLike) -> tuple[Array, Array, Array]:
        """Return θ, z and cos φ of points of the image: those on the side that faces the camera.

        x and y are in pixels, y down; θ is in radians, z in radii. All three are NaN outside the rim.
        """
        across, z = self._apart(_real("x", x) - self.centre_px[0], _real("y", y) - self.centre_px[1])
        inside = np.abs(across) <= 1.0
        across, z = np.where(inside, across, np.nan), np.where(inside, z, np.nan)
        theta = np.mod(self.facing + np.arcsin(across), 2 * np.pi)
        return theta, z, np.sqrt((1 - across) * (1 + across))

    @door
    def to_image(self, theta: npt.ArrayLike, z: npt.ArrayLike) -> tuple[Array, Array, Array]:
        """Return x, y (pixels, y down) and cos φ of points of the surface.

        cos φ is negative on the far side, which a camera does not see; x and y are given there too.
        """
        phi, along = np.broadcast_arrays(self.phi(theta), _real("z", z))
        x, y = self._together(np.sin(phi), along)
        return x + self.centre_px[0], y + self.centre_px[1], np.cos(phi)

    @door
    def velocity_to_surface(
        self, x: npt.ArrayLike, y: npt.ArrayLike, vx: npt.ArrayLike, vy: npt.ArrayLike
    ) -> tuple[Array, Array]:
        """Return u_θ and u_z, in radii per unit of time, of velocities vx, vy in pixels per unit of time.

        vy is positive downwards. u_θ = v_across / (R cos φ), so that its noise grows towards the rim; u_z =
        v_along / R. NaN outside the rim.

        Example:
            >>> import cyclosis as cy
            >>> view = cy.observations.View(radius_px=100.0)  # z to the right, θ down the image
            >>> u_theta, u_z = view.velocity_to_surface(0.0, 60.0, 10.0, 4.0)
            >>> round(float(u_theta), 12), round(float(u_z), 12)
            (0.05, 0.1)
        """
        cos_phi = self.to_surface(x, y)[2]
        across, along = self._apart(_real("vx", vx), _real("vy", vy))
        with np.errstate(divide="ignore", invalid="ignore"):
            return across / cos_phi, np.where(np.isnan(cos_phi), np.nan, along)

    @door
    def velocity_to_image(
        self, theta: npt.ArrayLike, z: npt.ArrayLike, u_theta: npt.ArrayLike, u_z: npt.ArrayLike
    ) -> tuple[Array, Array]:
        """Return vx, vy, in pixels per unit of time and vy positive downwards, of velocities on the surface.

        u_θ and u_z are in radii per unit of time.

        Example:
            >>> import numpy as np
            >>> import cyclosis as cy
            >>> view = cy.observations.View(radius_px=100.0, mirrored=True)
            >>> vx, vy = view.velocity_to_image(np.pi, 0.0, u_theta=0.1, u_z=0.2)
            >>> round(float(vx), 12), round(float(vy), 12)
            (20.0, -10.0)
        """
        cos_phi = self.to_image(theta, z)[2]
        across, along = np.broadcast_arrays(_real("u_theta", u_theta) * cos_phi, _real("u_z", u_z))
        return self._together(across, along)

    @door
    def jacobian(self, theta: npt.ArrayLike, z: npt.ArrayLike) -> Array:
        """Return ∂(x, y)/∂(θ, z), shape (2, 2, ...), in pixels per radian and per radius.

        Its determinant is ± R² cos φ: an area of the image is that of the surface times cos φ.

        Example:
            >>> import numpy as np
            >>> import cyclosis as cy
            >>> cy.observations.View(radius_px=100.0).jacobian(np.pi, 0.0).round(9) + 0.0
            array([[  0., 100.],
                   [100.,   0.]])
        """
        cos_phi = self.to_image(theta, z)[2]
        around = self._together(cos_phi, np.zeros_like(cos_phi))
        along = self._together(np.zeros_like(cos_phi), np.ones_like(cos_phi))
        return np.stack([np.stack(around), np.stack(along)], axis=1)

    @door
    def angle_to_surface(self, x: npt.ArrayLike, y: npt.ArrayLike, angle: npt.ArrayLike) -> Array:
        """Return the angle ψ from +z towards +θ of a line on the surface, radians in (-π/2, π/2].

        `angle` is that of the line in the image, in radians counter-clockwise from the right, as seen:
        tan ψ = tan ψ_image / cos φ. A line has no polarity: angles that differ by π are the same. NaN outside
        the rim.

        Example:
            >>> import numpy as np
            >>> import cyclosis as cy
            >>> view = cy.observations.View(radius_px=100.0)
            >>> float(np.degrees(view.angle_to_surface(0.0, 0.0, np.radians(30.0))).round(9))
            -30.0
        """
        cos_phi = self.to_surface(x, y)[2]
        line = _real("angle", angle)
        across, along = self._apart(np.cos(line), -np.sin(line))
        psi = np.arctan2(across, along * cos_phi)
        return np.asarray(_half(psi))

    @door
    def angle_to_image(self, theta: npt.ArrayLike, z: npt.ArrayLike, psi: npt.ArrayLike) -> Array:
        """Return the angle in the image, radians in (-π/2, π/2], of lines at ψ from +z towards +θ.

        It is counter-clockwise from the right, as seen.

        Example:
            >>> import numpy as np
            >>> import cyclosis as cy
            >>> view = cy.observations.View(radius_px=100.0, axis_deg=20.0)
            >>> float(np.degrees(view.angle_to_image(np.pi, 0.0, 0.0)).round(9))  # along the cell
            20.0
        """
        line = _real("psi", psi)
        vx, vy = self.velocity_to_image(theta, z, np.sin(line), np.cos(line))
        return np.asarray(_half(np.arctan2(-vy, vx)))

    @door
    def sharp(self, depth_px: float, focus_px: float = 0.0) -> tuple[float, float]:
        """Return the least and the largest |φ|, in radians, of the part of the surface that is sharp.

        `depth_px` is the depth of field D in pixels. Sharp is what lies between `focus_px` and `focus_px` + D
        below the point of the cell that is nearest to the camera. With the focus there, that is the cap
        |φ| < arccos(1 - D/R). A focal stack has a ring for every focus. NaN, NaN if nothing is sharp. Raises
        `InputError` for a depth that is not positive.

        Example:
            >>> import numpy as np
            >>> import cyclosis as cy
            >>> view = cy.observations.View(radius_px=500.0)
            >>> [round(float(np.degrees(each))) for each in view.sharp(60.0)]
            [0, 28]
        """
        depth = number("depth_px", depth_px, 1e-9, LARGEST, "give the depth of field in pixels")
        focus = number("focus_px", focus_px, -LARGEST, LARGEST, "give the depth of the focus in pixels")
        top, bottom = focus / self.radius_px, (focus + depth) / self.radius_px
        if top >= 1.0 or bottom <= 0.0:
            return math.nan, math.nan
        return math.acos(1 - max(top, 0.0)), math.acos(1 - min(bottom, 1.0))

    def to_dict(self) -> dict[str, Any]:
        """Return the settings as plain numbers, for a file.

        Example:
            >>> import cyclosis as cy
            >>> view = cy.observations.View(radius_px=100.0, mirrored=True)
            >>> view.to_dict()["radius_px"], cy.observations.View.from_dict(view.to_dict()) == view
            (100.0, True)
        """
        return asdict(self) | {"centre_px": list(self.centre_px)}

    @classmethod
    def from_dict(cls, settings: Mapping[str, Any]) -> View:
        """Return the view with the settings that `to_dict` gives; other names are left alone.

        Raises `InputError` if there is no radius, and for values that cannot be used.

        Example:
            >>> import cyclosis as cy
            >>> seen = cy.observations.View(radius_px=100.0, axis_deg=17.0)
            >>> cy.observations.View.from_dict(seen.to_dict()) == seen
            True
        """
        known = {item.name for item in fields(cls)}
        found = {name: value for name, value in settings.items() if name in known}
        if "radius_px" not in found:
            rule = "settings with at least radius_px"
            raise InputError("view", sorted(settings), rule, "give the radius of the cell in pixels")
        return cls(**found)

    def _apart(self, right: Array, down: Array) -> tuple[Array, Array]:
        """Return the parts across and along the axis of vectors of the image, in radii."""
        across = right * self.e_across[0] + down * self.e_across[1]
        along = right * self.e_z[0] + down * self.e_z[1]
        return across / self.radius_px, along / self.radius_px

    def _together(self, across: Array, along: Array) -> tuple[Array, Array]:
        """Return vectors of the image, in pixels, from their parts across and along, in radii."""
        a, e = self.e_across, self.e_z
        right, down = across * a[0] + along * e[0], across * a[1] + along * e[1]
        return self.radius_px * right, self.radius_px * down


def _real(name: str, value: npt.ArrayLike) -> Array:
    return numbers(name, value, "one number or an array of numbers", "give plain numbers")


def _turned(angle: Array) -> Any:
    """Return angles between -π and π."""
    return np.mod(angle + np.pi, 2 * np.pi) - np.pi


def _half(angle: Array) -> Any:
    """Return directions of lines, which have no polarity, in (-π/2, π/2]."""
    return np.pi / 2 - np.mod(np.pi / 2 - angle, np.pi)
