"""A measurement in the image, in pixels, with what is known of it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from ..display.notebook import text_tree
from ..display.shown import shown
from ..model.doors import door
from ..model.errors import InputError, flag, number
from .formats.content import ANGLE, KYMOGRAPH, SLICE, SURFACE, TRACKS, VELOCITY
from .view import View

if TYPE_CHECKING:
    import xarray

    from ..model.scales import Scales

Array = npt.NDArray[np.float64]
Bools = npt.NDArray[np.bool_]


@shown
@dataclass(frozen=True, eq=False)
class Frame:
    """What was measured at one time: samples at points of the image.

    `x` and `y` (n,) are in pixels, y down. `vx` and `vy` (n,) are in pixels per unit of time, vy positive
    downwards; `angle` (n,) is in radians counter-clockwise from the right, as seen. What was not measured is
    None. `good` (n,) tells which samples count. `grid` is (rows, columns) if the samples fill a grid row
    by row, with x and y increasing, and None if they are scattered. `focus_um` is the depth of the focus.

    Example:
        >>> import cyclosis as cy
        >>> frame = cy.observations.gridded([0, 16], [0, 16], [[1.0, 2.0], [3.0, 4.0]], [[0.0, 0.0]] * 2)
        >>> frame.grid, frame.x.tolist(), frame.vx.tolist(), frame.good.all().item()
        ((2, 2), [0.0, 16.0, 0.0, 16.0], [1.0, 2.0, 3.0, 4.0], True)
    """

    x: Array
    y: Array
    good: Bools
    vx: Array | None = None
    vy: Array | None = None
    angle: Array | None = None
    grid: tuple[int, int] | None = None
    time: float = 0.0
    focus_um: float | None = None


@door
def gridded(
    x: npt.ArrayLike,
    y: npt.ArrayLike,
    vx: npt.ArrayLike,
    vy: npt.ArrayLike,
    good: npt.ArrayLike | None = None,
    time: float = 0.0,
) -> Frame:
    """Return a frame of velocities on a grid of an image.

    `x` (columns,) and `y` (rows,) increase, in pixels, y down; `vx`, `vy` and `good` are (rows, columns), in
    pixels per unit of time, vy positive downwards; without `good` all finite vectors count. Raises
    `InputError` for shapes that do not match.

    Example:
        >>> import numpy as np
        >>> import cyclosis as cy
        >>> cy.observations.gridded(np.arange(3.0), np.arange(2.0), np.ones((2, 3)), np.zeros((2, 3))).grid
        (2, 3)
    """
    across, down, u, v = (np.asarray(each, dtype=np.float64) for each in (x, y, vx, vy))
    shape = (down.size, across.size)
    for name, axis in (("x", across), ("y", down)):
        if axis.ndim != 1 or not axis.size or not np.isfinite(axis).all() or (np.diff(axis) <= 0).any():
            raise InputError(name, axis, "increasing finite numbers (n,)", "sort the grid, with y down")
    ok = np.isfinite(u) & np.isfinite(v) if u.shape == v.shape else np.zeros(0, dtype=bool)
    if good is not None and ok.size:
        given = np.asarray(good, dtype=bool)
        ok = ok & given if given.shape == ok.shape else np.zeros(0, dtype=bool)
    if ok.shape != shape:
        rule = f"arrays of the shape (rows, columns) = {shape}"
        raise InputError("vx, vy and good", u, rule, "give them over y and x, in this order")
    xx, yy = np.meshgrid(across, down)
    return Frame(
        xx.ravel(), yy.ravel(), ok.ravel(), u.ravel(), v.ravel(), None, (down.size, across.size), time
    )


@shown
@dataclass(frozen=True, eq=False)
class Observation:
    """A measurement of a cell, in the image; with a `View` also on its surface.

    `kind` is "velocity", "tracks", "angle", "kymograph", "slice" or "surface". `frames` are the times, in
    `time_unit` ("s" or "frame"); velocities are in pixels per `time_unit`. `pixel_um` and `frame_s` are the
    size of a pixel and the time between the two images of a pair, or None. `noise_px` is the noise of one
    component of a displacement between two images, in pixels, or None, and `window_px` the side of the square
    over which every vector is an average. `format`, `source` and `notes` tell where it comes from and which
    conventions were applied.

    Example:
        >>> import cyclosis as cy
        >>> frame = cy.observations.gridded([0, 50], [0, 50], [[5.0, 5.0]] * 2, [[0.0, 0.0]] * 2)
        >>> seen = cy.observations.Observation((frame,)).view(100.0, 0.0, (0.0, 25.0))
        >>> print(seen.on_surface(n_theta=3, n_z=2)["u"].sel(component="z").values.round(3).squeeze())
        [[0.05 0.05]
         [0.05 0.05]
         [0.05 0.05]]
    """

    frames: tuple[Frame, ...]
    kind: str = VELOCITY
    time_unit: str = "s"
    pixel_um: float | None = None
    frame_s: float | None = None
    noise_px: float | None = None
    format: str = "arrays"
    source: str = ""
    notes: tuple[str, ...] = ()
    camera: View | None = None
    image: npt.NDArray[Any] | None = None
    extra: dict[str, Any] = field(default_factory=dict)
    window_px: float | None = None

    @property
    def times(self) -> Array:
        """The times of the frames (n,), in `time_unit`.

        Example:
            >>> import cyclosis as cy
            >>> frame = cy.observations.gridded([0, 1], [0, 1], [[1.0] * 2] * 2, [[0.0] * 2] * 2, time=3.0)
            >>> cy.observations.Observation((frame,)).times
            array([3.])
        """
        return np.array([frame.time for frame in self.frames])

    @door
    def view(
        self,
        radius_px: float | None = None,
        axis_deg: float | None = None,
        centre_px: tuple[float, float] | None = None,
        facing: float = np.pi,
        mirrored: bool | None = None,
        radius_um: float | None = None,
    ) -> Observation:
        """Return this measurement seen by a camera: where the cell lies in the image.

        The arguments are those of `View`. The radius may be given in micrometres if the size of a pixel is
        known. Nothing is guessed: radius, axis and centre must be given. `mirrored` is False if it is left
        out, which a note says. Raises `InputError` for what is missing or out of range.

        Example:
            >>> import cyclosis as cy
            >>> frame = cy.observations.gridded([0, 50], [0, 50], [[5.0, 5.0]] * 2, [[0.0, 0.0]] * 2)
            >>> cell = cy.observations.Observation((frame,), pixel_um=5.0)
            >>> cell.view(radius_um=500.0, axis_deg=0.0, centre_px=(0.0, 25.0)).camera.radius_px
            100.0
        """
        if radius_um is not None:
            if radius_px is not None or self.pixel_um is None:
                rule = "given with pixel_um, and without radius_px"
                raise InputError("radius_um", radius_um, rule, "give pixel_um, or radius_px alone")
            most = "give the radius in micrometres"
            radius_px = number("radius_um", radius_um, 1e-9, 1e12, most) / self.pixel_um
        missing = [
            option
            for option, value in (
                ("--radius-um or --radius-px", radius_px),
                ("--axis DEGREES", axis_deg),
                ("--centre X,Y", centre_px),
            )
            if value is None
        ]
        command = "give " + ", and ".join(missing)
        if radius_px is None:
            rule, remedy = (
                "given: vectors do not tell it",
                "measure it, or use cyclosis.observations.rim(image)",
            )
            raise InputError("radius_px", None, rule, remedy, command)
        if centre_px is None:
            rule, remedy = "given: a point (x, y) on the axis, in pixels, y down", "measure it in the image"
            raise InputError("centre_px", None, rule, remedy, command)
        if axis_deg is None:
            rule = "given: the direction of +z in the image, in degrees counter-clockwise from the right"
            raise InputError("axis_deg", None, rule, "measure it in the image", command)
        seen = flag("mirrored", mirrored) if mirrored is not None else False
        camera = View(radius_px, axis_deg, centre_px, facing, seen)
        said = "no mirror on the way was assumed (mirrored=False); it decides the handedness of helices"
        notes = self.notes if mirrored is not None or said in self.notes else (*self.notes, said)
        return replace(self, camera=camera, notes=notes)

    def on_surface(
        self,
        n_theta: int | None = None,
        n_z: int | None = None,
        *,
        theta: npt.ArrayLike | None = None,
        z: npt.ArrayLike | None = None,
        scales: Scales | None = None,
        max_angle_deg: float = 80.0,
        outside: str = "refuse",
        depth_um: float | None = None,
    ) -> xarray.Dataset:
        """Return the measurement on the surface of the cell, as a dataset like that of a run.

        See `cyclosis.observations.surface.on_surface`, whose arguments these are. Raises `InputError` as that
        does.

        Example:
            >>> import cyclosis as cy
            >>> frame = cy.observations.gridded([0, 50], [0, 50], [[5.0, 5.0]] * 2, [[0.0, 0.0]] * 2)
            >>> seen = cy.observations.Observation((frame,)).view(100.0, 0.0, (0.0, 25.0))
            >>> seen.on_surface(n_theta=4, n_z=3)["u"].dims
            ('time', 'component', 'theta', 'z')
        """
        from .surface import on_surface

        return on_surface(
            self,
            n_theta,
            n_z,
            theta=theta,
            z=z,
            scales=scales,
            max_angle_deg=max_angle_deg,
            outside=outside,
            depth_um=depth_um,
        )

    def __repr__(self) -> str:
        return text_tree(f"Observation of {self.kind}", self._rows())

    def _rows(self) -> list[tuple[str, str]]:
        """Return what is known of the measurement, as (name, text)."""
        rows = [("source", self.source or "-"), ("format", self.format)]
        count = sum(frame.good.size for frame in self.frames)
        if self.frames:
            good = sum(int(frame.good.sum()) for frame in self.frames)
            grid = self.frames[0].grid
            where = f" on {grid[1]} x {grid[0]}" if grid else ""
            rows.append(
                ("samples", f"{len(self.frames)} frame(s){where}, {good} of {count} samples are good")
            )
            rows.append(("units", f"pixels and {self.time_unit}, y down"))
        known = (
            ("pixel", self.pixel_um, "um"),
            ("frame", self.frame_s, "s"),
            ("noise", self.noise_px, "px"),
            ("window", self.window_px, "px"),
        )
        rows += [(name, f"{value:g} {unit}") for name, value, unit in known if value is not None]
        if self.camera is not None:
            c = self.camera
            mirror = ", mirrored" if c.mirrored else ""
            place = f"({c.centre_px[0]:g}, {c.centre_px[1]:g})"
            rows.append(("view", f"R {c.radius_px:g} px, axis {c.axis_deg:g} deg, centre {place} px{mirror}"))
        return rows + [("note", note) for note in self.notes]


def frames_of(obs: Observation, kinds: Sequence[str], what: str) -> tuple[Frame, ...]:
    """Return the frames of a measurement of one of some kinds. Raises `InputError` for others."""
    if obs.kind not in kinds:
        raise InputError("observation", obs.kind, f"one of {', '.join(kinds)}", f"{what} needs that")
    return obs.frames


__all__ = ["ANGLE", "KYMOGRAPH", "SLICE", "SURFACE", "TRACKS", "VELOCITY", "Frame", "Observation", "gridded"]
