"""The frames of a movie: the cell next to the unwrapped map, the clock, and the order so far.

Frames are drawn in worker processes, which import only this module: nothing here may load JAX.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt
from matplotlib.backends.backend_agg import FigureCanvasAgg

from ..model.grid import Array, CylinderGrid
from ..model.scales import Scales
from ..model.units import time_unit
from . import looks
from .clock import time_axis, time_text
from .edges import name_axes
from .marks import Mark
from .portraits import Look, portrait
from .ribbons import Ribbon
from .skin import Skin
from .style import INK, QUIET, TYPE, blank, place, scale_bar

Pixels = npt.NDArray[np.uint8]

# Places in millimetres; a frame is 160 x 90.
_WIDTH, _HEIGHT = 160.0, 90.0
_FLOOR, _CEILING, _SIDE, _APART, _KEY, _KEY_ROOM = 22.5, 8.5, 11.0, 10.0, 3.0, 13.0
_TRACE = (16.0, 7.5, 128.0, 8.0)
# Hinting distorts letters as small as these.
_TYPE = TYPE | {
    "font.size": 9.0,
    "axes.labelsize": 9.0,
    "xtick.labelsize": 8.0,
    "ytick.labelsize": 8.0,
    "text.hinting": "none",
}


@dataclass(frozen=True, eq=False)
class Shot:
    """The contents of one frame, dimensionless.

    The state `P` and flow `u` (2, n_theta, n_z), streamlines as ribbons, the angle (radians) that faces
    the viewer, the time, the order then, and the defects to mark.
    """

    P: Array
    u: Array
    ribbons: Sequence[Ribbon]
    view_angle: float
    time: float
    order: float
    marks: Sequence[Mark] = ()


@dataclass(frozen=True, eq=False)
class Scene:
    """What all frames have in common: the surface, order (n,) over times (n,), the height in pixels.

    With `scales` they are in units; `colours` are one of `cyclosis.figures.looks.COLOURS`.
    """

    grid: CylinderGrid | Skin
    times: Array
    order: Array
    height: int
    scales: Scales | None = None
    colours: str | None = None


class SceneLayout:
    """A scene prepared for drawing: the fixed parts are drawn once, and each frame adds the rest."""

    def __init__(self, scene: Scene) -> None:
        self.scene, self.portrait = scene, portrait(scene.grid)
        with looks.chosen(self.scene.colours), looks.setting(_TYPE):
            self.figure = blank(_WIDTH, _HEIGHT)
            # A little more than requested, because matplotlib rounds sizes down.
            self.figure.set_dpi((scene.height + 1e-3) / self.figure.get_size_inches()[1])
            canvas: Any = FigureCanvasAgg(self.figure)
            self._cell()
            self._trace()
            canvas.draw()
            self.canvas, self.still = canvas, canvas.copy_from_bbox(self.figure.bbox)

    def drawn(self, shot: Shot) -> Pixels:
        """Return the picture (height, width, 3) of one frame, top row first."""
        self._set(shot)
        self.canvas.restore_region(self.still)
        with looks.chosen(self.scene.colours), looks.setting(_TYPE):
            for ax in (self.solid, self.flat):
                for artist in sorted(_contents(ax), key=lambda part: part.get_zorder()):
                    ax.draw_artist(artist)
            for artist in [*self.flat.spines.values(), self.past, self.now, self.clock, self.reading]:
                self.figure.draw_artist(artist)
        return np.array(np.asarray(self.canvas.buffer_rgba())[..., :3])

    def _set(self, shot: Shot) -> None:
        """Replace the parts that change from frame to frame."""
        times, order = self.scene.times, self.scene.order
        look = Look(shot.P, shot.u, shot.marks)
        for artist in [*_contents(self.solid), *_contents(self.flat)]:
            artist.remove()
        self.portrait.solid(
            self.solid, look, view_angle=shot.view_angle, ribbons=shot.ribbons, pixels=self.pixels
        )
        self.portrait.flat(self.flat, look, ribbons=shot.ribbons, scale=1.0)
        past = times < shot.time
        self.past.set_data(np.append(times[past], shot.time), np.append(order[past], shot.order))
        self.now.set_data([shot.time], [shot.order])
        self.clock.set_text(time_text(self.scene.scales, shot.time, ".1f", self.scene.times[-1]))
        self.reading.set_text(f"order {shot.order:.2f}")

    def _cell(self) -> None:
        """Place cell, map, the readings above them, and the key, on one scale."""
        cell, type_size = self.portrait, 11.0
        left, right, bottom, top = cell.extent(cell.tilt)
        box = cell.map_extent()
        across, up, around, along = right - left, top - bottom, box[1] - box[0], box[3] - box[2]
        room, breadth = _HEIGHT - _FLOOR - _CEILING, _WIDTH - 2 * _SIDE - _APART - _KEY_ROOM
        scale = min(room / max(up, along), breadth / (across + around))
        self.pixels = max(8, round(scale * across * self.scene.height / _HEIGHT))
        start = 0.5 * (_WIDTH - scale * (across + around) - _APART - _KEY_ROOM)
        floor = _FLOOR + 0.5 * (room - scale * up)
        above = (_FLOOR + 0.5 * room + 0.5 * scale * max(up, along) + 2.0) / _HEIGHT
        self.solid = place(self.figure, start, floor, scale * across, scale * up)
        self.solid.set_axis_off()
        self.solid.set(xlim=(left, right), ylim=(bottom, top))
        scale_bar(self.solid, self.scene.scales, (left, right, bottom, top))
        self.clock = self.figure.text(start / _WIDTH, above, "", fontsize=type_size, animated=True)
        start, floor = start + scale * across + _APART, floor + 0.5 * scale * (up - along)
        self.flat = place(self.figure, start, floor, scale * around, scale * along)
        self.flat.set(xlim=box[:2], ylim=box[2:])
        cell.edges(self.flat, self.scene.scales)
        name_axes(self.flat, cell.across, cell.along, pad=-7.0)
        self.reading = self.figure.text(start / _WIDTH, above, "", fontsize=type_size, animated=True)
        start += scale * around + _KEY_ROOM - 8.0
        cell.key(place(self.figure, start, floor, _KEY, scale * along))

    def _trace(self) -> None:
        """Draw the order of the whole run in grey; its past is drawn over it in ink."""
        times, order = self.scene.times, self.scene.order
        ax = place(self.figure, *_TRACE)
        ax.plot(times, order, color=QUIET, linewidth=0.8)
        (self.past,) = ax.plot([], [], color=INK, linewidth=1.4, animated=True)
        (self.now,) = ax.plot([], [], "o", color=INK, markersize=4.0, clip_on=False, animated=True)
        ax.set_ylim(0, 1)
        time_axis(ax, float(times[0]), float(times[-1]), self.scene.scales)
        ax.set_yticks([0, 1])
        ax.set_ylabel("order", labelpad=2.0)
        unit = time_unit(self.scene.scales, float(times[-1]))
        ax.set_xlabel(f"$t$ {unit.name}".strip(), labelpad=-6.0, x=1.035)
        ax.text(1, 1.2, "square-root scale", fontsize=6.5, color=INK, ha="right", transform=ax.transAxes)
        ax.spines[["top", "right"]].set_visible(False)


def _contents(ax: Any) -> list[Any]:
    return [*ax.images, *ax.collections, *ax.patches]


_stage: SceneLayout | None = None


def open_stage(scene: Scene) -> None:
    """Set up a scene in this process for the following shots."""
    global _stage
    _stage = SceneLayout(scene)


def draw_shot(shot: Shot) -> Pixels:
    """Return the picture of one frame of the scene that was set up in this process."""
    if _stage is None:
        raise RuntimeError("no scene was set up in this process")
    return _stage.drawn(shot)
