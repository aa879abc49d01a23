"""The circulation across the axis that winding bands drive, against their pitch."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Circle

from ..model.doors import door
from ..model.errors import InputError, number
from ..vacuole.helix import axis_speed, radial_stream
from . import quantities
from .looks import setting
from .style import DOWN, INK, QUIET, TYPE, UP, WIDTH, blank, place

__all__ = [
    "SHOWN",
    "vacuole_pitch",
]


def __dir__() -> list[str]:
    return sorted(__all__)


SHOWN = (1.5, 2.8222629826, 5.0, 10.0)
"""Pitches whose stream functions are drawn, in R; the second is that of the fastest circulation."""
# Places in millimetres.
_LEFT, _BELOW, _HIGH, _ABOVE, _SECTION, _GAP = 15.0, 11.0, 58.0, 6.0, 27.0, 7.0


@door
def vacuole_pitch(pitches: tuple[float, ...] = SHOWN, width: float = WIDTH) -> Figure:
    """Return the figure of the circulation that bands sin(θ - 2πz/pitch) of speed 1 drive, against the pitch.

    On the left the speed across the axis on the axis, and the largest ψ, the flux that circulates; the law of
    the third power, which holds for slow twist, is dashed, and the fastest marked. On the right streamlines
    of the circulation on sections, in steps of a sixth of the largest ψ, for four pitches. Dimensionless;
    `width` is in millimetres. Raises `InputError` unless four pitches are given.

    Example:
        >>> from cyclosis.figures.vacuole_pitch import vacuole_pitch
        >>> len(vacuole_pitch().axes)
        5
    """
    if len(pitches) != 4:
        raise InputError("pitches", pitches, "four numbers", "choose those to draw")
    speeds = axis_speed(pitches)
    width = number("width", width, 130.0, 1000.0, "choose a width in millimetres")
    with setting(TYPE):
        figure = blank(width, _BELOW + _HIGH + _ABOVE)
        across = width - _LEFT - 2 * _SECTION - 3 * _GAP
        ax = place(figure, _LEFT, _BELOW, across, _HIGH)
        _curves(ax, pitches, speeds)
        for k, (pitch, speed) in enumerate(zip(pitches, speeds, strict=True)):
            left = _LEFT + across + _GAP + (k % 2) * (_SECTION + _GAP)
            bottom = _BELOW - 6.0 + (1 - k // 2) * (_SECTION + 8.0)
            _circulation(place(figure, left, bottom, _SECTION, _SECTION), float(pitch), float(speed))
        return figure


def _curves(ax: Any, pitches: tuple[float, ...], speeds: Any) -> None:
    pitch = np.geomspace(0.8, 60.0, 400)
    Q = 2 * np.pi / pitch
    speed = axis_speed(pitch)
    ax.plot(pitch, Q**3 / 24, color=QUIET, linewidth=1.1, dashes=(4, 2), label=r"$Q^3/24$, slow twist")
    ax.plot(pitch, speed, color=INK, linewidth=1.5, label="speed on the axis")
    ax.plot(pitch, [_largest(q) for q in Q], color=UP, linewidth=1.5, label=r"largest $\psi$")
    ax.scatter(pitches, speeds, color=INK, s=16, zorder=3, linewidths=0)
    best = int(np.argmax(speed))
    ax.annotate(
        f"pitch {quantities.words(SHOWN[1], 'length', '.4f')}\n"
        f"speed {quantities.words(float(axis_speed(SHOWN[1])), 'speed', '.5f')}",
        (pitch[best], speed[best]),
        xytext=(-12, 16),
        textcoords="offset points",
        fontsize=9.0,
        ha="right",
        va="center",
    )
    ax.set(xscale="log", yscale="log", xlim=(0.8, 60), ylim=(1e-6, 0.5))
    ax.set_xticks([1, 3, 10, 30], ["1", "3", "10", "30"])
    ax.minorticks_off()
    quantities.name(ax.xaxis, "pitch", "length", "in radii")
    ax.spines[["top", "right"]].set_visible(False)
    ax.legend(loc="lower left", frameon=False, fontsize=9.0, handlelength=1.6)


def _largest(Q: float) -> float:
    """Return the largest ψ of bands sin φ of speed 1."""
    r = np.linspace(0.0, 1.0, 201)
    return float(np.abs(radial_stream(1, Q, r)[:, 0]).max() * Q / np.hypot(1.0, Q))


def _circulation(ax: Any, pitch: float, speed: float) -> None:
    Q = 2 * np.pi / pitch
    across = np.linspace(-1.0, 1.0, 161)
    x, y = np.meshgrid(across, across, indexing="ij")
    r, phi = np.minimum(np.hypot(x, y), 1.0), np.arctan2(y, x)
    radii = np.linspace(0.0, 1.0, 401)
    psi = np.interp(r, radii, radial_stream(1, Q, radii)[:, 0]) * np.sin(phi)
    levels = np.arange(-5.5, 6.0) / 6 * np.abs(psi).max()
    colours = [DOWN if level > 0 else UP for level in levels]
    ax.contour(across, across, psi.T, levels=levels, colors=colours, linewidths=0.9, linestyles="solid")
    ax.add_patch(Circle((0, 0), 1.0, facecolor="none", edgecolor=INK, linewidth=0.8))
    ax.set(xlim=(-1.03, 1.03), ylim=(-1.03, 1.03), aspect="equal")
    ax.set_axis_off()
    told = f"pitch {quantities.words(pitch, 'length')}: {quantities.words(speed, 'speed', '.2g')}"
    ax.set_title(told, fontsize=9.0, pad=1.0)
