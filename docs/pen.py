"""What the drawings of mechanisms.py consist of: colours, arrows, filaments, labels, and SVG files.

Each drawing is one file that suits light and dark pages: its colours are variables, which follow the page's
colour scheme.
"""

from __future__ import annotations

import io
import re

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import FancyArrowPatch, Polygon

from cyclosis.display.colours import BLUE, GREEN, ORANGE, PURPLE

COLOURS = {
    "ink": ("#23262d", "#e8eaf0"),
    "soft": ("#868c98", "#949cab"),
    "up": (PURPLE[3], PURPLE[4]),
    "down": (GREEN[2], GREEN[3]),
    "flow": (BLUE[2], BLUE[4]),
    "motor": (ORANGE[3], ORANGE[4]),
    "wall": ("#cfc8ba", "#5a564e"),
    "plastid": ("#9dc08b", "#48663f"),
    "vacuole": ("#e3edf9", "#1b2838"),
    "page": ("#ffffff", "#131416"),
}
"""Colours on light and on dark pages."""
STAND_IN = {name: f"#0102{k:02x}" for k, name in enumerate(COLOURS, 16)}
"""What matplotlib is given; `written` replaces it by the variable of that name."""
INK, SOFT, UP, DOWN, FLOW, MOTOR, WALL, PLASTID, VACUOLE, PAGE = STAND_IN.values()

STYLE = {
    "svg.fonttype": "path",
    "svg.hashsalt": "cyclosis",
    "mathtext.fontset": "stix",
    "font.size": 9.5,
    "hatch.linewidth": 0.6,
}


def blank(width: float, height: float, x: tuple[float, float], y: tuple[float, float]) -> Axes:
    """Return axes that fill a figure of a size in inches."""
    axes = Figure(figsize=(width, height)).add_axes((0, 0, 1, 1))
    axes.set(xlim=x, ylim=y, aspect="equal")
    axes.set_axis_off()
    return axes


def arrow(axes, start, end, colour=INK, width=1.2, bend=0.0, head=7.0, style="-|>", alpha=1.0, z=4.0):
    """Draw an arrow; `bend` > 0 curves it clockwise."""
    axes.add_patch(
        FancyArrowPatch(
            *(start, end),
            arrowstyle=style,
            connectionstyle=f"arc3,rad={bend}",
            mutation_scale=head,
            linewidth=width,
            color=colour,
            shrinkA=0,
            shrinkB=0,
            alpha=alpha,
            zorder=z,
            capstyle="round",
        )
    )


def turn(axes, centre, radius, start, end, colour=INK):
    """Draw an arc with an arrowhead from one angle to another."""
    angles = np.linspace(start, end, 40)
    x, y = centre[0] + radius * np.cos(angles), centre[1] + radius * np.sin(angles)
    axes.plot(x[:-4], y[:-4], color=colour, lw=1.3, solid_capstyle="round", zorder=6)
    arrow(axes, (x[-6], y[-6]), (x[-1], y[-1]), colour, width=1.3, head=9, z=6)


def filament(axes, centre, angle, length=1.0, colour=UP, faint=False, ends="−+", width=4.5, pivot=0.5):
    """Draw a filament, with chevrons that point to its plus end.

    pivot:  which point of it lies at `centre`: 0 is the minus end, 1 the plus end
    """
    p = np.array([np.cos(angle), np.sin(angle)])
    q = np.array([-p[1], p[0]])
    minus = np.asarray(centre) - pivot * length * p
    plus = minus + length * p
    alpha = 0.35 if faint else 1.0
    axes.plot(
        *zip(minus, plus, strict=True), color=colour, lw=width, solid_capstyle="round", alpha=alpha, zorder=3
    )
    size = 0.0088 * width
    if not faint:
        for s in np.arange(0.12, length - 0.04, 0.14):
            tip = minus + s * p
            marks = [tip - size * p + 0.8 * size * q, tip, tip - size * p - 0.8 * size * q]
            axes.plot(*zip(*marks, strict=True), color=PAGE, lw=0.8, zorder=3.5, solid_capstyle="round")
    if not faint:
        for sign, place in {"−": minus - 0.12 * p, "+": plus + 0.12 * p}.items():
            if sign in ends:
                axes.text(*place, sign, ha="center", va="center", color=colour, weight="bold", zorder=5)
    return minus, plus


def note(axes, text, place, target, side="left"):
    """Write a label with a thin line to what it names."""
    axes.annotate(
        text,
        target,
        place,
        color=INK,
        ha=side,
        va="center",
        arrowprops={"arrowstyle": "-", "color": SOFT, "lw": 0.8, "shrinkA": 2, "shrinkB": 0},
        zorder=9,
    )


def ring(axes, centre, outer, inner, squeeze, colour, half=None, z=3.0):
    """Fill the ring between two radii, or its upper (1) or lower (-1) half."""
    start, end = {None: (0, 2 * np.pi), 1: (0, np.pi), -1: (np.pi, 2 * np.pi)}[half]
    phi = np.linspace(start, end, 120)
    out = np.array([outer * squeeze * np.cos(phi), outer * np.sin(phi)])
    back = np.array([inner * squeeze * np.cos(phi), inner * np.sin(phi)])[:, ::-1]
    axes.add_patch(Polygon(np.hstack([out, back]).T + centre, fc=colour, ec="none", zorder=z))


def written(axes: Axes) -> str:
    """Return a drawing as SVG whose colours follow the page."""
    file = io.StringIO()
    axes.figure.savefig(file, format="svg", transparent=True, metadata={"Date": None, "Creator": None})
    text = file.getvalue()
    for name, stand_in in STAND_IN.items():
        text = text.replace(stand_in, f"var(--{name})")
    light, dark = ("".join(f"--{name}:{pair[k]};" for name, pair in COLOURS.items()) for k in range(2))
    style = f"<style>svg{{{light}}}@media (prefers-color-scheme:dark){{svg{{{dark}}}}}</style>"
    return re.sub(r"(<svg[^>]*>)", rf"\1\n {style}", text, count=1)
