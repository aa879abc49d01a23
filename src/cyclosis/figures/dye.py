"""Dye in the vacuole as a movie: a cross-section, and a section along the axis, as the flow carries it."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

import numpy as np

from ..model.doors import door
from ..model.errors import InputError, number, whole
from ..model.grid import Array
from ..vacuole.transport import Transport
from . import quantities
from .encode import Output
from .looks import setting
from .scene import Pixels
from .style import INK, QUIET, TYPE

__all__ = [
    "COLOURS",
    "SIZE",
    "dye",
]


def __dir__() -> list[str]:
    return sorted(__all__)


SIZE = (6.4, 2.4)
"""Inches of a frame."""
COLOURS = "magma_r"


@door
def dye(
    transport: Transport,
    path: str | os.PathLike[str],
    seconds: float = 8.0,
    height: int = 360,
    about: str = "",
) -> Path:
    """Write the frames of a scalar in the vacuole as a movie, MP4 or GIF by suffix, and return its path.

    On the left is the cross-section at half of the length, on the right the section along the axis through
    θ = 0 and π. Colours run from 0, or the least value if it is negative, to the largest of the first frame.
    Times are in R/U; `height` is in pixels, even; `about` goes to the comment of the file. Raises
    `InputError` for fewer than two frames: give `cyclosis.vacuole.transport` some `frames`.

    Example:
        >>> import numpy as np
        >>> import cyclosis as cy
        >>> from cyclosis.figures.dye import dye
        >>> grid = cy.CylinderGrid(16, 16)
        >>> flow = cy.vacuole.flow_of_state(cy.Parameters(), grid, cy.initial.stripes(grid))
        >>> drop = lambda r, theta, z: np.exp(-4 * (z - 2.5) ** 2) + 0 * r * theta
        >>> run = cy.vacuole.transport(flow, 50.0, start=drop, t_end=1.0, n_r=8, frames=[0.0, 1.0])
        >>> dye(run, "dye.gif", seconds=0.5, height=120).name
        'dye.gif'
    """
    if not isinstance(transport, Transport) or len(transport.frames) < 2:
        rule = "the result of cyclosis.vacuole.transport with at least 2 frames"
        raise InputError("transport", transport, rule, "give its frames=[...]")
    seconds = number("seconds", seconds, 0.1, 3600.0, "choose a duration")
    height = whole("height", height, 60, 2160, "choose a number of pixels")
    low, high = min(float(transport.frames[0].min()), 0.0), float(transport.frames[0].max())
    with Output(path, len(transport.frames), seconds, about) as output, setting(TYPE):
        for c, t in zip(transport.frames, transport.frame_times, strict=True):
            output.add(_picture(transport, c, float(t), low, high, height))
    return Path(path)


def _picture(transport: Transport, c: Array, t: float, low: float, high: float, height: int) -> Pixels:
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=SIZE, dpi=height / SIZE[1])
    canvas = FigureCanvasAgg(figure)
    shades: dict[str, Any] = {
        "cmap": COLOURS,
        "vmin": low,
        "vmax": max(high, low + 1e-12),
        "shading": "gouraud",
    }
    across = figure.add_axes((0.01, 0.06, 0.3, 0.84))
    theta = np.append(transport.theta, 2 * np.pi)
    section = np.concatenate([c, c[:, :1]], axis=1)[:, :, c.shape[2] // 2]
    axis = np.full((1, theta.size), section[0].mean())
    r = np.concatenate([[0.0], transport.r])
    x, y = (np.multiply.outer(r, part) for part in (np.cos(theta), np.sin(theta)))
    across.pcolormesh(x, y, np.concatenate([axis, section]), **shades)
    across.plot(np.cos(theta), np.sin(theta), color=QUIET, linewidth=0.8)
    across.set_aspect("equal")
    across.set_axis_off()
    along = figure.add_axes((0.395, 0.2, 0.585, 0.64))
    half = transport.theta.size // 2
    z = np.append(transport.z, 2 * transport.z[-1] - transport.z[-2])
    plane = np.concatenate([c[::-1, half], c[:, 0]])
    plane = np.concatenate([plane, plane[:, :1]], axis=1)
    along.pcolormesh(z, np.concatenate([-transport.r[::-1], transport.r]), plane, **shades)
    along.set(xlim=(z[0], z[-1]), ylim=(-1, 1))
    quantities.name(along.xaxis, "z", "length", "R")
    quantities.name(along.yaxis, "x", "length", "R")
    when = quantities.words(t, "time", ".1f", "R/U")
    figure.text(0.395, 0.89, f"t = {when}, Pe = {transport.peclet:g}", color=INK)
    canvas.draw()  # type: ignore[no-untyped-call]
    pixels = np.asarray(canvas.buffer_rgba())[..., :3]  # type: ignore[no-untyped-call]
    rows, columns = (n - n % 2 for n in pixels.shape[:2])  # the encoder needs even sizes
    return np.ascontiguousarray(pixels[:rows, :columns])
