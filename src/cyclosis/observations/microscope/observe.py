"""The synthetic microscope: from a run to what an instrument would have recorded."""

from __future__ import annotations

import inspect
import os
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ...display.shown import shown
from ...model.doors import door
from ...model.errors import InputError, choice, closest
from ...model.scales import Scales
from ...model.units import scales_in
from ..view import View
from .body import body_of
from .camera import Camera, framing
from .conventions import in_the_files
from .filming import film, kymograph, tracks
from .mrv import mrv
from .orientation import orientation
from .piv import piv

if TYPE_CHECKING:
    import xarray
    from matplotlib.figure import Figure

PIXEL_UM, SPEED_UM_PER_S = 5.0, 100.0
"""The size of a pixel and the speed U of a run without scales."""
INSTRUMENTS: dict[str, Callable[..., dict[str, Any]]] = {
    "piv": piv,
    "kymograph": kymograph,
    "tracks": tracks,
    "orientation": orientation,
    "mrv": mrv,
    "film": film,
}
"""The instruments by name: functions of a body, a camera and options."""
FORMATS: dict[str, tuple[str, ...]] = {
    "piv": ("openpiv", "openpiv-um", "pivlab", "pivlab-m", "pivlab-mat", "npy"),
    "kymograph": ("tiff", "npy"),
    "tracks": ("trackmate", "trackmate-xml", "trackpy"),
    "orientation": ("orientationj", "npy", "tiff"),
    "mrv": ("tiff", "mat", "npy"),
    "film": ("avi", "mp4", "tiff"),
}
"""The formats of the files of each instrument; the first is the usual one."""


@shown
@dataclass(frozen=True, eq=False, repr=False)
class Recording:
    """What an instrument recorded of a run, and how it looked at it.

    `kind` is one of `INSTRUMENTS`. `data` has the record, an `xarray.Dataset` whose variables name their
    units and whose coordinate `time` is that of the run, in R/U. `camera` has the `View` and the settings of
    the microscope; its `radius_um` and `px_per_frame` say how large and how fast the cell is in the picture.

    Example:
        >>> import cyclosis as cy
        >>> params, grid = cy.Parameters(), cy.CylinderGrid(16, 16)
        >>> run = cy.simulate(params, grid, cy.initial.stripes(grid), t_end=2.0)
        >>> view = cy.observations.View(radius_px=40.0, axis_deg=17.0)
        >>> seen = cy.observations.observe(run, view, as_="piv", pixel_um=12.5, frame_s=0.6)
        >>> seen.kind, dict(seen.data["vx"].sizes)["time"], seen.data["vx"].attrs["units"]
        ('piv', 3, 'px/frame')
        >>> [path.name for path in seen.write("measured", "openpiv")][:2]
        ['piv_0001.txt', 'piv_0002.txt']
        >>> seen.truth()["view"]["axis_deg"], seen.figure().axes[0].get_xlabel()
        (17.0, 'x (px)')
    """

    kind: str
    camera: Camera
    data: xarray.Dataset
    options: dict[str, Any] = field(default_factory=dict)

    def figure(self) -> Figure:
        """Return a picture of the record, as a person would see it in the program that made it."""
        from .pictures import picture

        return picture(self)

    def truth(self) -> dict[str, Any]:
        """Return the view, the settings and the times, as they are kept in view.json.

        `view` has the arguments of `Observation.view`: where the cell lies in the files. In a cross-section
        that is its circle. In view.json, `files` has the names of the files and `read` the arguments of
        `cyclosis.observations.read`, or of `film`, for them.
        """
        camera = self.camera
        return {
            "kind": self.kind,
            "view": in_the_files(self).to_dict(),
            "size_px": list(camera.size_px),
            "pixel_um": camera.pixel_um,
            "frame_s": camera.frame_s,
            "depth_um": camera.depth_um,
            "noise_px": camera.noise_px,
            "speed_um_per_s": camera.speed_um_per_s,
            "radius_um": camera.radius_um,
            "time_unit_s": camera.scales.time_s,
            "px_per_frame_at_unit_speed": camera.px_per_frame,
            "seed": camera.seed,
            "times": np.round(self.data["time"].values, 9).tolist(),
            **{name: value for name, value in self.data.attrs.items() if name != "title"},
        }

    def write(
        self, folder: str | os.PathLike[str], format: str | None = None, force: bool = False
    ) -> list[Path]:
        """Write the record in the files of a program, with a picture and view.json; return their paths.

        `format` is one of those of the kind, the first by default: openpiv (px/frame, y down), openpiv-um
        (µm/s, y up), pivlab, pivlab-m (m/s), pivlab-mat or npy for piv; tiff or npy for kymographs;
        trackmate, trackmate-xml or trackpy for tracks; orientationj, npy or tiff for orientation; tiff, mat
        or npy for mrv; avi, mp4 or tiff for a film. The folder is made. Raises `InputError` for other
        formats, for files that exist unless `force`, and for places that cannot be written to.
        """
        from .files import write

        chosen = FORMATS[self.kind][0] if format is None else choice("format", format, FORMATS[self.kind])
        return write(self, Path(folder), chosen, force)

    def __repr__(self) -> str:
        width, height = self.camera.size_px
        times = self.data["time"].values
        return f"Recording({self.kind}, {width} x {height} px, {len(times)} times from {times[0]:g})"


@door
def observe(
    source: Any,
    view: View,
    as_: str = "piv",
    *,
    pixel_um: float | None = None,
    frame_s: float = 0.3,
    depth_um: float | None = None,
    noise_px: float = 0.1,
    speed_um_per_s: float | None = None,
    size_px: tuple[int, int] | None = None,
    centred: bool = True,
    seed: int = 0,
    **options: Any,
) -> Recording:
    """Return what an instrument would have recorded of a run, a `Recording`.

    `source` is a run on the cylinder or in a closed cell (`Trajectory`), or its dataset. A cell on the
    cylinder is a piece of a long one: it goes on, periodically, beyond the picture. `as_` is the instrument:

    * piv: vectors of windows, at `times` (all frames); `window_px` 32, `step_px` 16, `outliers` 0
    * film: bright particles; from `start` for `frames` (60); `particles_per_px`, `chloroplasts` (standing)
    * kymograph: such a film along a `line` "along" the cell `at` φ degrees, or "across" it `at` z radii
    * tracks: places of single particles, with gaps; `particles_per_px`, `missed` (0.05)
    * orientation: filaments drawn along P and the angle of their texture, at `times` (the last)
    * mrv: the speed along the cell in a slice; `points` 64, `slice_z`, `slice_um`, `venc_mm_per_s`,
      `noise_mm_per_s`; on the cylinder only

    Times are in R/U. `pixel_um` and `frame_s` set pixels and frames: R is `view.radius_px` pixels, and the
    speed U is `speed_um_per_s`. The defaults of both sizes are those of a run with scales, else 5 µm and
    100 µm/s. Only what lies within `depth_um` below the nearest point is in focus (None: all of the near
    side). `noise_px` is the standard deviation of every measured displacement or place. With `centred` the
    centre of the view is chosen so that the whole cell is in the picture. Raises `InputError` for values out
    of range, for times outside the run, and for options of other instruments.

    Example:
        >>> import cyclosis as cy
        >>> params, grid = cy.Parameters(), cy.CylinderGrid(16, 16)
        >>> run = cy.simulate(params, grid, cy.initial.stripes(grid), t_end=2.0)
        >>> view = cy.observations.View(radius_px=30.0)
        >>> cy.observations.observe(run, view, "film", pixel_um=16.0, frames=4)
        Recording(film, 168 x 78 px, 4 times from 1.8125)
        >>> cy.observations.observe(run, view, "mrv", points=16).data["speed"].attrs["units"]
        'mm/s'
    """
    choice("as_", as_, tuple(INSTRUMENTS))
    if not isinstance(view, View):
        raise InputError("view", view, "a cyclosis.observations.View", "give View(radius_px=100.0)")
    instrument = INSTRUMENTS[as_]
    known = list(inspect.signature(instrument).parameters)[2:]
    for name, value in options.items():
        if name not in known:
            rule = f"an option of {as_}: {', '.join(known)}"
            raise InputError(name, value, rule, closest(name, known))
    body = body_of(source)
    framed, size = framing(body, view, None if centred else view.centre_px, size_px)
    pixel, speed = _scaled(source, view, pixel_um, speed_um_per_s)
    camera = Camera(framed, size, pixel, frame_s, depth_um, noise_px, speed, seed)
    found = instrument(body, camera, **options)
    from .contents import dataset

    return Recording(as_, camera, dataset(as_, camera, body.ends, found), dict(options))


def _scaled(
    source: Any, view: View, pixel_um: float | None, speed_um_per_s: float | None
) -> tuple[float, float]:
    """Return the size of a pixel and the speed U: those given, those of the run, or usual ones."""
    held = getattr(source, "scales", None)
    known = held if isinstance(held, Scales) else scales_in(source) if hasattr(source, "attrs") else None
    pixel = PIXEL_UM if known is None else known.radius_um / view.radius_px
    speed = SPEED_UM_PER_S if known is None else known.speed_um_per_s
    return (
        pixel if pixel_um is None else pixel_um,
        speed if speed_um_per_s is None else speed_um_per_s,
    )
