"""Pictures of records, as a person would see them."""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING, Any

import matplotlib
import numpy as np
from matplotlib.collections import LineCollection
from matplotlib.colors import LinearSegmentedColormap
from matplotlib.figure import Figure

from ...figures.style import DOWN, INK, QUIET, TYPE, UP, blank
from .body import Array

if TYPE_CHECKING:
    from .camera import Camera
    from .observe import Recording

WIDTH = 150.0
"""Width of a picture in millimetres."""
NARROW = 95.0
"""Width of a picture that is as high as wide."""
SPEED = LinearSegmentedColormap.from_list("speed", [DOWN, "#f3f1f5", UP])
"""Colours of a signed speed along the cell: downward, none, upward."""
MARK = "#ffb000"
"""The axis, the rim and the focus, on a dark picture."""


def picture(recording: Recording) -> Figure:
    """Return the picture of a record."""
    draw = {
        "piv": _piv,
        "film": _film,
        "kymograph": _kymograph,
        "tracks": _tracks,
        "orientation": _orientation,
        "mrv": _mrv,
    }[recording.kind]
    with matplotlib.rc_context(TYPE):
        return draw(recording)


def _canvas(camera: Camera, rows: int = 1) -> tuple[Figure, list[Any]]:
    """Return a figure with axes for pictures of the camera, one above the other."""
    width, height = camera.size_px
    wide = WIDTH - 18.0
    high = wide * height / width
    if high > 150.0:
        wide, high = wide * 150.0 / high, 150.0
    total = (high + 9.0) * rows + 10.0
    figure = blank(wide + 18.0, total)
    axes = []
    for k in range(rows):
        bottom = (total - (high + 9.0) * (k + 1) + 2.0) / total
        ax = figure.add_axes((13.0 / (wide + 18.0), bottom, wide / (wide + 18.0), high / total))
        ax.set_xlim(-0.5, width - 0.5)
        ax.set_ylim(height - 0.5, -0.5)
        ax.set_ylabel("y (px)")
        axes.append(ax)
    axes[-1].set_xlabel("x (px)")
    return figure, axes


def outline(ax: Any, camera: Camera, ends: tuple[float, float], colour: str, label: bool = True) -> None:
    """Draw the axis with its direction, the rim and the edge of what is in focus into a picture."""
    view = camera.view
    low, high = ends
    z = np.array([low, high])

    def line(across: float, **style: Any) -> None:
        x = view.centre_px[0] + view.radius_px * (across * view.e_across[0] + z * view.e_z[0])
        y = view.centre_px[1] + view.radius_px * (across * view.e_across[1] + z * view.e_z[1])
        ax.plot(x, y, color=colour, **style)

    for side in (-1.0, 1.0):
        line(side, linewidth=0.9)
        if camera.depth < 1:
            line(
                side * np.sin(view.sharp(camera.depth * view.radius_px)[1]),
                linewidth=0.7,
                linestyle=(0, (1, 2)),
            )
    line(0.0, linewidth=0.7, linestyle=(0, (6, 3)))
    if label:
        at = np.array(view.centre_px) + 0.55 * view.radius_px * view.e_z
        tip = at + 0.4 * view.radius_px * view.e_z
        arrow = {"arrowstyle": "-|>", "color": colour, "linewidth": 1.0, "shrinkA": 0, "shrinkB": 0}
        ax.annotate("", tip, at, arrowprops=arrow)
        place = tip + 0.14 * view.radius_px * view.e_across
        ax.annotate("$+z$", place, color=colour, ha="center", va="center")


def _ends(recording: Recording) -> tuple[float, float]:
    low, high = recording.data.attrs.get("ends", (0.0, 0.0))
    return float(low), float(high)


def _scale(ax: Any, camera: Camera, colour: str) -> None:
    """Draw a bar of a round length into the lower right corner."""
    width, height = camera.size_px
    longest = 0.25 * width * camera.pixel_um
    step = 10.0 ** np.floor(np.log10(longest))
    length = float(step * max(k for k in (1, 2, 5) if k * step <= longest))
    right, y = 0.97 * width, 0.94 * height
    ax.plot([right - length / camera.pixel_um, right], [y, y], color=colour, linewidth=2.0)
    text = f"{length / 1000:g} mm" if length >= 1000 else f"{length:g} µm"
    ax.text(right - 0.5 * length / camera.pixel_um, y - 0.025 * height, text, color=colour, ha="center")


def _film(recording: Recording) -> Figure:
    frames = recording.data["frames"].values
    figure, (above, below) = _canvas(recording.camera, 2)
    above.imshow(frames[0], cmap="gray", vmin=0, vmax=230, aspect="auto")
    outline(above, recording.camera, _ends(recording), MARK)
    _scale(above, recording.camera, "white")
    seconds = recording.camera.frame_s
    above.set_title("one frame", loc="left", pad=2.0)
    few = frames[: min(len(frames), max(4, int(40 / max(recording.camera.px_per_frame, 1e-9))))]
    below.imshow(few.max(axis=0), cmap="gray", vmin=0, vmax=230, aspect="auto")
    below.set_title(f"brightest of {len(few)} frames, {len(few) * seconds:.3g} s", loc="left", pad=2.0)
    return figure


def _piv(recording: Recording) -> Figure:
    data, camera = recording.data, recording.camera
    figure, (ax,) = _canvas(camera)
    ax.set_facecolor("#f8f7f9")
    vx, vy = data["vx"].values[-1], data["vy"].values[-1]
    along = vx * camera.view.e_z[0] + vy * camera.view.e_z[1]
    x, y = np.meshgrid(data["x"].values, data["y"].values)
    size = np.hypot(vx, vy)
    peak = float(np.nanpercentile(size, 99)) if np.isfinite(size).any() else 1.0
    step = float(np.diff(data["x"].values[:2])[0]) if data.sizes["x"] > 1 else 16.0
    good = ~data["mask"].values & ~data["flag"].values[-1]
    drawn = ax.quiver(
        x[good],
        y[good],
        vx[good],
        vy[good],
        along[good],
        cmap=_dark(),
        clim=(-peak, peak),
        angles="xy",
        scale_units="xy",
        scale=max(peak, 1e-9) / (1.3 * step),
        width=0.0022,
    )
    wrong = data["flag"].values[-1]
    if wrong.any():
        ax.plot(x[wrong], y[wrong], "x", color="#c03030", markersize=4, label="wrong")
        ax.legend(loc="upper right", frameon=False)
    outline(ax, camera, _ends(recording), INK)
    _scale(ax, camera, INK)
    ax.quiverkey(drawn, 0.8, 1.03, peak, f"{peak:.2g} px/frame", labelpos="E", coordinates="axes")
    ax.set_title(f"t = {float(data['time'][-1]):.4g} R/U", loc="left", pad=2.0)
    return figure


def _dark() -> LinearSegmentedColormap:
    """Return colours of a signed speed that can be seen on white."""
    return LinearSegmentedColormap.from_list("speed", [DOWN, "#8d8794", UP])


def _tracks(recording: Recording) -> Figure:
    data, camera = recording.data, recording.camera
    figure, (ax,) = _canvas(camera)
    track, x, y = (data[name].values for name in ("track", "x", "y"))
    starts = np.concatenate([[0], np.flatnonzero(np.diff(track)) + 1, [track.size]])
    pieces = [np.stack([x[a:b], y[a:b]], -1) for a, b in pairwise(starts)]
    way = np.array([(piece[-1] - piece[0]) @ camera.view.e_z for piece in pieces])
    peak = max(float(np.abs(way).max()), 1e-9)
    ax.add_collection(LineCollection(pieces, array=way, cmap=_dark(), clim=(-peak, peak), linewidths=0.8))
    ends = np.array([piece[-1] for piece in pieces])
    ax.plot(ends[:, 0], ends[:, 1], ".", color=INK, markersize=1.6)
    outline(ax, camera, _ends(recording), QUIET)
    _scale(ax, camera, INK)
    ax.set_title(f"{len(pieces)} tracks; dots mark where they end", loc="left", pad=2.0)
    return figure


def _orientation(recording: Recording) -> Figure:
    data, camera = recording.data, recording.camera
    figure, (above, below) = _canvas(camera, 2)
    image = data["image"].values[-1].astype(float)
    above.imshow(image, cmap="gray", aspect="auto", vmax=np.percentile(image, 99.8))
    outline(above, camera, _ends(recording), MARK)
    _scale(above, camera, "white")
    above.set_title("filaments", loc="left", pad=2.0)
    angle, coherency = data["angle"].values[-1], data["coherency"].values[-1]
    hue = np.mod(angle, 180.0) / 180.0
    dark = np.percentile(image, 1)
    strong = np.clip((image - dark) / max(np.percentile(image, 99.5) - dark, 1), 0, 1)
    colour = matplotlib.colors.hsv_to_rgb(
        np.stack([hue, np.clip(1.3 * coherency, 0, 1), np.clip(1.1 * strong**0.7, 0, 1)], -1)
    )
    below.imshow(colour, aspect="auto")
    below.set_title("colour: direction of the texture, saturated where it is parallel", loc="left", pad=2.0)
    _wheel(below)
    return figure


def _wheel(ax: Any) -> None:
    """Draw the colours of directions as a half wheel into the upper left corner."""
    inset = ax.inset_axes((0.015, 0.70, 0.17, 0.27))
    x, y = np.meshgrid(np.linspace(-1, 1, 161), np.linspace(0, 1, 81))
    r = np.hypot(x, y)
    hue = np.mod(np.arctan2(y, x), np.pi) / np.pi
    shown = matplotlib.colors.hsv_to_rgb(np.stack([hue, np.ones_like(hue), np.ones_like(hue)], -1))
    alpha = ((r < 1) & (r > 0.5)).astype(float)
    inset.imshow(np.concatenate([shown, alpha[..., None]], -1), origin="lower", extent=(-1, 1, 0, 1))
    for degrees, place, side in (
        (0, (1.05, 0.0), "left"),
        (90, (0.0, 1.04), "center"),
        (180, (-1.05, 0.0), "right"),
    ):
        inset.text(*place, f"{degrees}°", color="white", fontsize=7.0, ha=side, va="bottom")
    inset.set_xlim(-1.5, 1.5)
    inset.set_ylim(0, 1.35)
    inset.set_axis_off()


def _kymograph(recording: Recording) -> Figure:
    data, camera = recording.data, recording.camera
    place, seconds = data["place"].values * camera.pixel_um, data["seconds"].values
    wide, high = WIDTH - 20.0, 85.0
    with_label = blank(wide + 22.0, high + 16.0)
    box = (15.0 / (wide + 22.0), 11.0 / (high + 16.0), wide / (wide + 22.0), high / (high + 16.0))
    ax = with_label.add_axes(box)
    extent = (place[0], place[-1], seconds[-1] + camera.frame_s, 0.0)
    ax.imshow(data["image"].values, cmap="gray", aspect="auto", extent=extent, interpolation="nearest")
    ax.set_xlabel(("z" if data.attrs["line"] == "along" else "place across the cell") + " (µm)")
    ax.set_ylabel("time (s)")
    degrees = float(np.degrees(np.median(data["phi"].values)))
    where = (
        f"along the cell, {degrees:.0f}° from the middle"
        if data.attrs["line"] == "along"
        else "across the cell"
    )
    ax.set_title(f"kymograph {where}", loc="left", pad=2.0)
    return with_label


def _mrv(recording: Recording) -> Figure:
    data = recording.data
    speed: Array = data["speed"].values[-1]
    side = 0.5 * speed.shape[0] * float(data.attrs["pixel_mm"])
    total = (NARROW + 34.0, NARROW + 14.0)
    figure = blank(*total)
    ax = figure.add_axes((14.0 / total[0], 10.0 / total[1], (NARROW - 4) / total[0], (NARROW - 4) / total[1]))
    top = float(data.attrs["venc_mm_per_s"])
    inside = np.abs(speed[data["inside"].values])
    peak = min(top, float(np.percentile(inside, 99.5))) if inside.size else top
    shown = ax.imshow(speed, cmap=SPEED, vmin=-peak, vmax=peak, extent=(-side, side, -side, side))
    angle = np.linspace(0, 2 * np.pi, 200)
    radius = recording.camera.radius_um / 1000
    ax.plot(radius * np.cos(angle), radius * np.sin(angle), color=INK, linewidth=0.8)
    ax.set_xlabel("mm")
    ax.set_ylabel("mm")
    bar = figure.add_axes(
        ((NARROW + 12.0) / total[0], 10.0 / total[1], 3.0 / total[0], (NARROW - 4) / total[1])
    )
    figure.colorbar(shown, cax=bar).set_label("velocity along the cell (mm/s)")
    ax.set_title(f"slice at z = {float(data.attrs['slice_z']):.3g} R", loc="left", pad=2.0)
    return figure
