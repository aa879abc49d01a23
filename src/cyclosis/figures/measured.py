"""Figures of measured cells: the image with its geometry, the unrolled map, and the comparison with a run."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import numpy.typing as npt
from matplotlib.figure import Figure

from ..model.doors import door
from ..model.errors import InputError, whole
from ..model.units import PURE, scales_of_measurement
from . import looks, quantities
from .looks import setting
from .style import DOWN, INK, QUIET, TYPE, UP, WIDTH, blank, place

__all__ = [
    "MOST_ARROWS",
    "comparison",
    "measurement",
]


def __dir__() -> list[str]:
    return sorted(__all__)


MOST_ARROWS = 900
"""Vectors that are drawn, at most."""
_HALF = 78.0
"""Width of the map in millimetres."""


@door
def measurement(
    obs: Any,
    data: Any,
    image: npt.ArrayLike | None = None,
    depth_um: float | None = None,
    frame: int | None = None,
) -> Figure:
    """Return a figure of a measurement: the image with what was seen on it, and the unrolled map.

    `obs` is an `Observation` with a view, `data` its dataset on the surface, and `image` (rows, columns) a
    picture of the cell, if there is one. The image shows the axis, the rim, the edge of the sharp cap for a
    depth of field `depth_um`, and the vectors, purple towards +z and green against it; crosses are those
    that do not count. The map has the velocity along the cell in the same colours, as a share of its
    largest size. `frame` chooses one of several times; by default it is the one of the fastest flow.

    Example:
        >>> import cyclosis as cy
        >>> from cyclosis.figures.measured import measurement
        >>> frame = cy.observations.gridded([0, 50, 100], [0, 50], [[5.0] * 3] * 2, [[0.0] * 3] * 2)
        >>> seen = cy.observations.Observation((frame,)).view(100.0, 0.0, (0.0, 25.0), mirrored=False)
        >>> len(measurement(seen, seen.on_surface()).axes)
        3
    """
    view = obs.camera
    if view is None:
        raise InputError("obs", "without a view", "a measurement with a view", "call its method view")
    with looks.chosen(scales=scales_of_measurement(data)), setting(TYPE):
        height = 82.0
        figure = blank(WIDTH, height)
        ax = place(figure, 12.0, 12.0, WIDTH - _HALF - 24.0, height - 22.0)
        chosen = _chosen(data, "u", frame)
        picture = None if image is None else np.asarray(image, dtype=np.float64)
        held = obs.frames[chosen if len(obs.frames) == data.sizes["time"] else 0] if obs.frames else None
        _image(ax, obs, view, held, picture, depth_um)
        second = place(figure, WIDTH - _HALF, 12.0, _HALF - 26.0, height - 22.0)
        name = "u" if "u" in data else "angle"
        values = (
            data["u"].isel(time=chosen).sel(component="z").values
            if name == "u"
            else np.degrees(data["angle"].isel(time=chosen).values)
        )
        shown = _map(
            second,
            data,
            values,
            looks.polarity_map() if name == "u" else "twilight",
            None if name == "u" else 90.0,
        )
        plain = {"1": "U", "s-1": "R/s", "frame-1": "R/frame"}.get(data[name].attrs.get("units", ""), "")
        unit = quantities.unit("speed") if name == "u" else PURE
        label = rf"$u_z$ ({unit.name or plain})" if name == "u" else "angle from +z (degrees)"
        quantities.ticks(_key(figure, shown, WIDTH - 22.0, 12.0, height - 22.0, label).yaxis, unit)
        second.set_title("on the surface" + _when(data, chosen), fontsize=10.0)
    return figure


@door
def comparison(data: Any, frame: int | None = None) -> Figure:
    """Return the figure measured | model | residual of the dataset of a `Comparison`, at one frame.

    Without `frame` it is the one of the fastest measured flow.

    Colours are the velocity along the cell as a share of the largest, arrows the velocity. The residual is
    that of u_z in units of the noise, or as a share of the peak where the noise is not known.

    Example:
        >>> import cyclosis as cy
        >>> from cyclosis.figures.measured import comparison
        >>> params, grid = cy.Parameters(), cy.CylinderGrid(16, 16)
        >>> run = cy.simulate(params, grid, cy.initial.stripes(grid), t_end=1.0)
        >>> fit = cy.observations.compare(run.to_dataset().isel(time=[1])[["u"]], run)
        >>> [ax.get_title() for ax in comparison(fit.dataset).axes[:3]]
        ['measured', 'model', 'residual']
    """
    chosen = _chosen(data, "measured", frame)
    now = data.isel(time=chosen)
    with looks.chosen(scales=scales_of_measurement(data)), setting(TYPE):
        height = 88.0
        figure = blank(WIDTH, height)
        largest = float(np.nanmax(np.abs(now["measured"].sel(component="z").values)))
        for k, name in enumerate(("measured", "model", "residual")):
            ax = place(figure, 12.0 + 50.0 * k, 12.0, 44.0, height - 22.0)
            values = now[name].sel(component="z").values
            if name == "residual":
                most = max(float(np.nanquantile(np.abs(values), 0.99)), 1e-12)
                shown = _map(ax, now, values, "RdBu_r", most)
                told = "noise" if "noise" in data["residual"].attrs.get("long_name", "") else "peak"
                _key(figure, shown, 159.0, 12.0, height - 22.0, f"in units of the {told}")
            else:
                shown = _map(ax, now, values, looks.polarity_map(), largest)
                _arrows(ax, now, now[name].values)
            if k:
                ax.set_ylabel("")
            title = name + ("" if k else _when(data, chosen))
            if k == 0 and quantities.unit("speed") is not PURE:
                title += f", up to {quantities.words(largest, 'speed')}"
            ax.set_title(title, fontsize=10.0)
    return figure


def _chosen(data: Any, name: str, frame: int | None) -> int:
    """Return the number of the frame to show: the one asked for, or that of the fastest flow."""
    count = data.sizes["time"]
    if frame is not None:
        return whole("frame", frame, -count, count - 1, "the dataset has no other") % count
    if name not in data or count == 1:
        return 0
    places = [dim for dim in data[name].dims if dim not in ("time", "component")]
    square = (data[name] ** 2).sum("component", skipna=False).mean(places)
    return int(np.argmax(np.nan_to_num(square.values)))


def _when(data: Any, frame: int) -> str:
    """Return the time of a frame in words, where there are several."""
    time = float(data["time"].values[frame])
    return f", t = {quantities.words(time, 'time')}" if data.sizes["time"] > 1 else ""


def _image(ax: Any, obs: Any, view: Any, frame: Any, image: Any, depth_um: float | None) -> None:
    """Draw the image with axis, rim, cap and vectors."""
    if image is not None:
        picture = image.mean(axis=0) if image.ndim == 3 else image
        low, high = np.quantile(picture, (0.01, 0.995))
        ax.imshow(picture, cmap="gray", vmin=low, vmax=max(high, low + 1e-9), interpolation="bilinear")
    line = "#ffffff" if image is not None else INK
    ends = _ends(view, frame, image)
    for phi, style, width in ((0.0, (0, (6, 3)), 0.7), (-math.pi / 2, "-", 1.0), (math.pi / 2, "-", 1.0)):
        _meridian(ax, view, phi, ends, line, style, width)
    if depth_um is not None and obs.pixel_um is not None:
        _, cap = view.sharp(depth_um / obs.pixel_um)
        if cap == cap and cap < 0.99 * math.pi / 2:
            for phi in (-cap, cap):
                _meridian(ax, view, phi, ends, "#e0a526", "-", 0.8)
    top = ends[0] + 0.9 * (ends[1] - ends[0])
    tip, tail = (view.to_image(view.facing, at) for at in (top, top - 0.3))
    ax.annotate(
        "",
        (float(tip[0]), float(tip[1])),
        (float(tail[0]), float(tail[1])),
        arrowprops={"arrowstyle": "->", "color": line},
    )
    ax.text(float(tip[0]), float(tip[1]), " +z", color=line, fontsize=8.0, va="center", clip_on=True)
    if frame is not None and frame.vx is not None:
        _vectors(ax, view, frame, image)
    elif frame is not None and frame.angle is not None:
        _lines(ax, frame)
    if image is not None:
        ax.set(xlim=(-0.5, image.shape[-1] - 0.5), ylim=(image.shape[-2] - 0.5, -0.5))
    elif not ax.yaxis_inverted():
        ax.invert_yaxis()
    ax.set(aspect="equal", xlabel="x (px)", ylabel="y (px), down")
    ax.set_title("in the image", fontsize=10.0)


def _ends(view: Any, frame: Any, image: Any) -> tuple[float, float]:
    """Return the least and largest z that the image or the samples have."""
    if image is not None:
        x = np.array([0, image.shape[-1], 0, image.shape[-1]], dtype=float)
        y = np.array([0, 0, image.shape[-2], image.shape[-2]], dtype=float)
    elif frame is not None and frame.x.size:
        x, y = frame.x, frame.y
    else:
        return 0.0, 1.0
    along = ((x - view.centre_px[0]) * view.e_z[0] + (y - view.centre_px[1]) * view.e_z[1]) / view.radius_px
    return float(along.min()), float(along.max())


def _meridian(
    ax: Any, view: Any, phi: float, ends: tuple[float, float], colour: str, style: Any, width: float
) -> None:
    x, y, _ = view.to_image(np.full(2, view.facing + phi), np.array(ends))
    ax.plot(x, y, color=colour, linestyle=style, linewidth=width)


def _vectors(ax: Any, view: Any, frame: Any, image: Any) -> None:
    """Draw the vectors of a frame, coloured by their direction along the cell."""
    step = max(1, math.ceil(frame.x.size / MOST_ARROWS))
    at = np.arange(frame.x.size)[::step]
    good, bad = at[frame.good[at]], at[~frame.good[at]]
    ax.plot(frame.x[bad], frame.y[bad], "x", color=QUIET, markersize=2.2, markeredgewidth=0.5)
    speed = np.hypot(np.nan_to_num(frame.vx[good]), np.nan_to_num(frame.vy[good]))
    if not good.size or not speed.max():
        return
    spacing = math.sqrt(
        max(float(np.ptp(frame.x)) * float(np.ptp(frame.y)), 1.0) / max(frame.x.size / step, 1)
    )
    size = 1.6 * spacing / max(float(np.quantile(speed, 0.95)), 1e-300)
    along = frame.vx[good] * view.e_z[0] + frame.vy[good] * view.e_z[1]
    light = ("#c99bf0", "#87ec98") if image is not None else (UP, DOWN)
    ax.quiver(
        frame.x[good],
        frame.y[good],
        np.nan_to_num(frame.vx[good]) * size,
        np.nan_to_num(frame.vy[good]) * size,
        color=np.where(along > 0, light[0], light[1]),
        angles="xy",
        scale_units="xy",
        scale=1.0,
        width=0.004,
    )


def _lines(ax: Any, frame: Any) -> None:
    step = max(1, math.ceil(frame.x.size / MOST_ARROWS))
    at = np.flatnonzero(frame.good)[::step]
    c, s = np.cos(frame.angle[at]), -np.sin(frame.angle[at])
    ax.quiver(
        frame.x[at],
        frame.y[at],
        c,
        s,
        color=UP,
        angles="xy",
        pivot="mid",
        headwidth=0,
        headlength=0,
        headaxislength=0,
        width=0.003,
        scale=40.0,
    )


def _map(ax: Any, data: Any, values: npt.NDArray[np.float64], colours: Any, largest: float | None) -> Any:
    """Draw values (theta, z) as a map; what was not measured stays light."""
    theta, z = np.asarray(data["theta"].values), np.asarray(data["z"].values)
    most = largest or max(float(np.nanmax(np.abs(values))), 1e-12)
    ax.set_facecolor("#eeecef")
    shown = ax.pcolormesh(
        _edges(theta), _edges(z), values.T, cmap=colours, vmin=-most, vmax=most, rasterized=True
    )
    ax.set(xlabel="θ (rad)", aspect="equal")
    if quantities.name(ax.yaxis, "z", "length") is PURE:
        ax.set_ylabel("z (R)")
    return shown


def _arrows(ax: Any, data: Any, u: npt.NDArray[np.float64]) -> None:
    theta, z = np.asarray(data["theta"].values), np.asarray(data["z"].values)
    i, j = (np.arange(n)[max(n // 32, 0) :: max(1, n // 16)] for n in (theta.size, z.size))
    part = u[:, i][:, :, j]
    size = float(np.nanmax(np.hypot(*u)))
    if np.isfinite(size) and size > 0:
        xx, yy = np.meshgrid(theta[i], z[j], indexing="ij")
        ax.quiver(xx, yy, part[0], part[1], color="#ffffff", scale=14.0 * size, width=0.006, pivot="mid")


def _edges(axis: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    if axis.size == 1:
        return np.array([axis[0] - 0.5, axis[0] + 0.5])
    middle = 0.5 * (axis[1:] + axis[:-1])
    return np.concatenate([[2 * axis[0] - middle[0]], middle, [2 * axis[-1] - middle[-1]]])


def _key(figure: Figure, shown: Any, left: float, bottom: float, height: float, label: str) -> Any:
    ax = place(figure, left, bottom + 0.15 * height, 3.0, 0.7 * height)
    figure.colorbar(shown, cax=ax, label=label)
    return ax
