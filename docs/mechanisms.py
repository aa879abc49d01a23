"""Draw the mechanisms of the model: images/mechanism-*.svg.

python docs/mechanisms.py          # seconds

The sense in which a filament turns is computed from the equation of the model.
"""

from __future__ import annotations

from pathlib import Path

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Circle, Ellipse, Polygon, Rectangle
from pen import (
    DOWN,
    FLOW,
    INK,
    MOTOR,
    PAGE,
    PLASTID,
    SOFT,
    STYLE,
    UP,
    VACUOLE,
    WALL,
    arrow,
    blank,
    filament,
    note,
    ring,
    turn,
    written,
)

IMAGES = Path(__file__).parent / "images"


def turning(angle: float, torque: np.ndarray) -> float:
    """Return the rate at which a filament turns, counter-clockwise positive: q · torque.

    angle:   of the filament's direction p = (cos, sin)
    torque:  (2,), the bracket of the equation
    """
    return float(np.dot([-np.sin(angle), np.cos(angle)], torque))


def repelled(angle: float) -> float:
    """Return the turning rate by repulsion from d = e_x: torque -(p·d) d."""
    return turning(angle, np.array([-np.cos(angle), 0.0]))


def sheared(angle: float) -> float:
    """Return the turning rate in the shear flow u = y e_x: torque (p·∇) u."""
    return turning(angle, np.array([np.sin(angle), 0.0]))


def dragged(angle: float) -> float:
    """Return the turning rate by polar alignment with the flow u = e_x: torque u."""
    return turning(angle, np.array([1.0, 0.0]))


def tile(symbol: str) -> Axes:
    """Return a small drawing's axes, with the symbol of its coupling in the corner."""
    axes = blank(2.6, 2.0, (-1.3, 1.3), (-1.0, 1.0))
    axes.text(-1.22, 0.92, symbol, color=INK, size=13, ha="left", va="top")
    return axes


def stream(axes, rows):
    """Draw a uniform flow to the right."""
    for row in rows:
        for x in (-0.78, -0.08, 0.62):
            arrow(axes, (x, row), (x + 0.5, row), FLOW, width=1.0, head=6, alpha=0.6, z=1)
    axes.text(1.12, rows[-1] - 0.2, r"$\mathbf{u}$", color=FLOW, ha="center", va="center", size=12)


def anchored(axes, place):
    """Draw what holds a filament to the wall."""
    axes.add_patch(Circle(place, 0.055, fc=PAGE, ec=INK, lw=1.2, zorder=7))
    axes.add_patch(Circle(place, 0.018, fc=INK, ec="none", zorder=8))


def repulsion() -> Axes:
    """A filament on the curved surface turns away from d, up or down, whichever is nearer."""
    axes = tile(r"$\kappa$")
    for x in (-0.9, 0.9):
        axes.plot([x, x], [-0.9, 0.9], color=SOFT, lw=1.0)
    phi = np.linspace(np.pi, 2 * np.pi, 80)
    for level in (-0.68, 0.8):
        axes.plot(0.9 * np.cos(phi), level + 0.13 * np.sin(phi), color=SOFT, lw=0.8)
    axes.plot(0.9 * np.cos(phi), 0.06 + 0.13 * np.sin(phi), color=INK, lw=1.0, ls=(0, (4, 2)))
    for side in (-1, 1):
        arrow(axes, (side * 0.81, 0.0), (side * 0.895, 0.05), INK, width=1.0, head=7)
    axes.text(1.1, 0.06, r"$\pm\mathbf{d}$", ha="center", va="center", color=INK, size=11)
    for before, colour in ((0.5, UP), (0.5 + np.pi, DOWN)):
        turned(axes, (0.0, -0.06), before, 0.6, repelled, colour)
    return axes


def turned(axes, centre, before, by, rate, colour):
    """Draw a filament before and after it has turned, as `rate` says, and the arc between."""
    sense = np.sign(rate(before))
    after = before + by * sense
    for angle, faint in ((before, True), (after, False)):
        place = np.asarray(centre) + 0.17 * np.array([np.cos(angle), np.sin(angle)])
        filament(axes, place, angle, 0.6, colour, faint=faint, pivot=0, ends="+")
    turn(axes, centre, 0.62, before + 0.11 * sense, after - 0.12 * sense)


def shear() -> Axes:
    """Both directions of a filament turn towards the axis of the flow."""
    axes = tile(r"$\epsilon$")
    base, heights = -0.75, np.linspace(-0.8, 0.8, 9)
    axes.plot([base, base], [-0.85, 0.85], color=SOFT, lw=0.9)
    axes.plot(base + 0.42 * heights, heights, color=FLOW, lw=0.9, alpha=0.5)
    for y in heights[np.abs(heights) > 0.1]:
        arrow(axes, (base, y), (base + 0.42 * y, y), FLOW, width=1.0, head=6, alpha=0.8, z=1)
    axes.text(-0.3, 0.8, r"$\mathbf{u}$", color=FLOW, ha="center", va="center", size=12)
    for before, colour in ((1.15, UP), (1.15 + np.pi, DOWN)):
        turned(axes, (0.38, 0.0), before, 0.68, sheared, colour)
    return axes


def parallel() -> Axes:
    """A motor walks along a filament that points downstream."""
    axes = tile(r"$\alpha_u$")
    stream(axes, (-0.8, 0.8))
    filament(axes, (0, -0.12), 0.0, 1.7)
    for x, alpha in ((-0.5, 0.35), (0.0, 1.0)):
        axes.plot([x, x], [-0.06, 0.1], color=MOTOR, lw=1.6, alpha=alpha, zorder=5)
        axes.add_patch(Circle((x, 0.17), 0.115, fc=MOTOR, ec=PAGE, lw=0.8, alpha=alpha, zorder=6))
    arrow(axes, (0.16, 0.17), (0.62, 0.17), MOTOR, width=1.6, head=10)
    axes.text(0.4, 0.27, "walks", color=INK, ha="center")
    axes.text(0, -0.28, "stays as it is", color=INK, ha="center", va="top")
    return axes


def stalled(before: float, by: float, pivot: tuple[float, float]) -> Axes:
    """Return the drawing of a filament that a stalled motor turns about a point of the wall."""
    axes = tile(r"$\alpha_u$")
    stream(axes, (-0.8, 0.8))
    sense = np.sign(dragged(before))
    after = before + sense * by
    filament(axes, pivot, before, 1.0, pivot=0)
    filament(axes, pivot, after, 1.0, faint=True, pivot=0)
    axes.add_patch(Circle(pivot, 0.055, fc=PAGE, ec=INK, lw=1.2, zorder=7))
    axes.add_patch(Circle(pivot, 0.018, fc=INK, ec="none", zorder=8))
    p = np.array([np.cos(before), np.sin(before)])
    foot = pivot + 0.74 * p
    place = foot + 0.18 * np.array([-p[1], p[0]]) * sense
    axes.plot(*zip(foot, place, strict=True), color=MOTOR, lw=1.6, zorder=5)
    axes.add_patch(Circle(place, 0.115, fc=MOTOR, ec=PAGE, lw=0.8, zorder=6))
    arrow(axes, np.add(place, (0.14, 0)), np.add(place, (0.48, 0)), FLOW, width=1.9, head=11, z=7)
    axes.text(*np.add(place, (0.3, 0.1)), "drag", color=FLOW, ha="center")
    turn(axes, pivot, 0.42, before + 0.14 * sense, after - 0.16 * sense)
    return axes


def antiparallel() -> Axes:
    """A motor that walks upstream stalls, and its drag turns the filament."""
    return stalled(np.pi - 0.35, 1.15, (0.35, -0.42))


def perpendicular() -> Axes:
    """Drag on a motor turns a filament that points across the flow."""
    return stalled(np.pi / 2, 0.85, (-0.35, -0.5))


def bundling() -> Axes:
    """A filament turns to the mean direction of its neighbours."""
    axes = tile(r"$\alpha_p$")
    for x, y, lean in (
        *((-0.9, -0.1, 0.14), (-0.5, -0.35, -0.1), (-0.55, 0.42, 0.06)),
        *((0.55, 0.42, -0.07), (0.62, -0.4, 0.1), (0.95, -0.02, -0.12)),
    ):
        filament(axes, (x, y), np.pi / 2 + lean, 0.6, ends="")
    centre, before, after = (-0.12, -0.55), 0.62, 1.42
    filament(axes, centre, before, 0.62, faint=True, pivot=0)
    filament(axes, centre, after, 0.62, pivot=0, ends="")
    turn(axes, centre, 0.46, before + 0.12, after - 0.16)
    arrow(axes, (-0.05, 0.28), (-0.05, 0.88), INK, width=1.9, head=12)
    axes.text(0.04, 0.62, r"$\mathbf{P}$", color=INK, size=12)
    return axes


def advection() -> Axes:
    """A filament is carried along, more slowly than the fluid."""
    axes = tile(r"$\epsilon$")
    stream(axes, (-0.8, 0.8))
    filament(axes, (-0.45, 0.0), 1.1, 0.8, faint=True)
    filament(axes, (0.35, 0.0), 1.1, 0.8, ends="")
    arrow(axes, (-0.28, 0.0), (0.16, 0.0), INK, width=1.5, head=10)
    axes.text(-0.02, -0.24, r"$\epsilon\,\mathbf{u}$", color=INK, ha="center", size=12)
    return axes


def diffusion() -> Axes:
    """A filament wanders over the surface."""
    axes = tile("$d^{(s)}$")
    steps = np.random.default_rng(3).normal(size=(2, 90))
    path = np.cumsum(steps, axis=1) * 0.055
    start, end = np.array([-0.6, -0.2]), np.array([0.62, 0.1])
    along = np.linspace(0, 1, path.shape[1])
    bridge = path - path[:, :1] - along * (path[:, -1:] - path[:, :1])
    x, y = start[:, None] + along * (end - start)[:, None] + bridge
    axes.plot(x, y, color=SOFT, lw=1.0, zorder=2)
    filament(axes, start, 1.25, 0.8, faint=True)
    filament(axes, end, 1.25, 0.8, ends="")
    return axes


def rotational_diffusion() -> Axes:
    """A filament turns at random."""
    axes = tile("$d^{(r)}$")
    centre, middle = np.array([0.0, -0.72]), np.pi / 2
    for angle in middle + np.array([-0.8, -0.4, 0.4, 0.8]):
        filament(axes, centre, angle, 1.15, faint=True, pivot=0)
    filament(axes, centre, middle, 1.15, pivot=0, ends="")
    turn(axes, centre, 1.32, middle - 0.07, middle - 0.75)
    turn(axes, centre, 1.32, middle + 0.07, middle + 0.62)
    return axes


def cell() -> Axes:
    """The cell: two streams in a thin layer along the wall, around the vacuole."""
    axes = blank(4.6, 3.3, (-3.1, 3.1), (-2.4, 2.05))
    left, right, squeeze = -2.4, 0.85, 0.5
    phi = np.linspace(-np.pi / 2, np.pi / 2, 90)
    for half, colour in ((phi[phi > 0], UP), (phi[phi < 0], DOWN)):
        edge = [(left - squeeze * np.cos(a), np.sin(a)) for a in half]
        edge += [(right, np.sin(a)) for a in half[::-1]]
        axes.add_patch(Polygon(edge, fc=colour, ec="none", alpha=0.85, zorder=1))
    for angle in np.radians([-64, -45, -26, -11, 11, 26, 45, 64]):
        reach, y = 0.4 * np.sin(2 * angle), np.sin(angle)
        for x in (-2.05, -1.05, -0.05):
            arrow(axes, (x - reach, y), (x + reach, y), PAGE, width=1.3, head=8, z=2)
    axes.plot([left - squeeze, right - 0.45], [0, 0], color=PAGE, lw=2.6, zorder=2)
    axes.plot(left - squeeze * np.cos(phi), np.sin(phi), color=SOFT, lw=1.4, zorder=2)
    for side in (-1, 1):
        axes.plot([left, right], [side, side], color=SOFT, lw=1.4, zorder=3)
    centre = np.array([right, 0.0])
    axes.add_patch(Ellipse(centre, 2 * squeeze, 2, fc=WALL, ec=SOFT, lw=1.0, zorder=3))
    ring(axes, centre, 0.93, 0.84, squeeze, PLASTID, z=3.2)
    ring(axes, centre, 0.84, 0.68, squeeze, UP, 1, z=3.3)
    ring(axes, centre, 0.84, 0.68, squeeze, DOWN, -1, z=3.3)
    axes.add_patch(Ellipse(centre, 1.36 * squeeze, 1.36, fc=VACUOLE, ec=INK, lw=1.1, zorder=4))
    axes.plot(*centre, "o", ms=2.5, color=INK, zorder=6)
    arrow(axes, centre, (right, 1.0), INK, width=1.0, head=7, z=6)
    axes.text(right - 0.07, 0.3, "$R$", color=INK, size=11, ha="right", zorder=7)
    for name, y, radius, angle in (
        ("cell wall", 1.3, 0.965, 60),
        ("chloroplasts", 0.82, 0.885, 38),
        ("filaments", 0.34, 0.76, 16),
        ("tonoplast", -0.16, 0.68, -8),
        ("vacuole", -0.66, 0.36, -50),
    ):
        a = np.radians(angle)
        target = (right + radius * squeeze * np.cos(a), radius * np.sin(a))
        note(axes, name, (1.62, y), target)
    note(axes, "indifferent zone", (-0.55, -1.45), (-0.3, -0.01), side="center")
    arrow(axes, (left, 1.3), (right, 1.3), INK, width=1.0, head=7, style="<|-|>")
    axes.text((left + right) / 2, 1.58, "$L$, periodic", color=INK, ha="center", va="center")
    corner = (-2.75, -1.35)
    arrow(axes, corner, (-2.05, -1.35), INK, width=1.4, head=9)
    arrow(axes, corner, (-2.75, -2.05), INK, width=1.4, head=9)
    axes.text(-1.97, -1.35, r"$\mathbf{e}_z$", color=INK, va="center", size=12)
    axes.text(-2.62, -1.95, r"$\mathbf{e}_\theta$", color=INK, va="center", size=12)
    return axes


def motor() -> Axes:
    """The motor: vesicles walk along a filament, which the wall holds, and drag the fluid with them."""
    axes = blank(4.6, 3.3, (0.0, 10.0), (0.0, 7.17))
    axes.add_patch(Rectangle((0, 6.3), 10, 1.0, fc=VACUOLE, ec="none", zorder=0))
    axes.add_patch(Rectangle((0, 0), 10, 0.72, fc=WALL, ec="none", zorder=0))
    x = np.linspace(0, 10, 300)
    axes.plot(x, 6.3 + 0.05 * np.sin(3.2 * x), color=INK, lw=1.2)
    for middle in (1.35, 3.95, 6.55, 9.15):
        axes.add_patch(Ellipse((middle, 1.3), 2.4, 1.0, fc=PLASTID, ec="none", zorder=1))
    for at in (1.7, 4.25, 6.3):
        axes.plot([at, at], [1.72, 2.4], color=SOFT, lw=1.6, zorder=2)
    axes.plot([1.1, 6.9], [2.45, 2.45], color=UP, lw=7, solid_capstyle="round", zorder=3)
    for s in np.arange(1.3, 7.0, 0.42):
        axes.plot([s - 0.09, s, s - 0.09], [2.53, 2.45, 2.37], color=PAGE, lw=1.0, zorder=4)
    for place, sign in ((0.6, "−"), (7.4, "+")):
        axes.text(place, 2.44, sign, color=UP, size=14, weight="bold", ha="center", va="center")
    for at, size in ((2.3, 0.6), (4.9, 0.68)):
        axes.add_patch(Circle((at, 4.3), size, fc=MOTOR, ec=PAGE, lw=1, zorder=6))
        for lean in (-0.36, 0.36):
            axes.plot([at, at + 0.35 * lean, at + lean], [3.7, 3.2, 2.66], color=INK, lw=1.5, zorder=5)
            axes.add_patch(Ellipse((at + lean, 2.67), 0.3, 0.18, fc=INK, ec="none", zorder=5))
        arrow(axes, (at + size + 0.06, 4.3), (at + size + 1.05, 4.3), MOTOR, width=2.3, head=13, z=6)
    axes.text(6.15, 4.58, r"$\mathbf{F}$", color=MOTOR, size=13, ha="center")
    # No slip at the chloroplasts, no stress at the tonoplast: the parabola of a film.
    base, bottom, top = 7.95, 1.85, 6.3
    heights = np.linspace(bottom, top, 10)
    speed = 1.75 * (1 - ((top - heights) / (top - bottom)) ** 2)
    axes.plot([base, base], [bottom, top], color=SOFT, lw=0.9)
    axes.plot(base + speed, heights, color=FLOW, lw=1.0, alpha=0.6)
    for y, length in zip(heights[1:-1], speed[1:-1], strict=True):
        arrow(axes, (base, y), (base + length, y), FLOW, width=1.3, head=8)
    axes.text(9.6, 2.9, r"$\mathbf{u}$", color=FLOW, size=14, ha="center")
    axes.text(0.25, 6.75, "vacuole", color=INK, va="center")
    axes.text(0.25, 0.36, "cell wall", color=INK, va="center")
    axes.text(3.95, 1.28, "chloroplast", color=INK, va="center", ha="center", zorder=5)
    note(axes, "tonoplast", (4.6, 6.78), (4.1, 6.33))
    note(axes, "vesicle", (0.8, 5.5), (1.9, 4.75), side="center")
    note(axes, "myosin", (3.6, 3.25), (4.7, 3.3), side="center")
    note(axes, "actin filament", (6.55, 3.35), (6.2, 2.6), side="center")
    return axes


DRAWINGS = {
    drawing.__name__: drawing
    for drawing in (
        *(cell, motor, repulsion, shear, parallel, antiparallel, perpendicular),
        *(bundling, advection, diffusion, rotational_diffusion),
    )
}
"""The drawings by the names of their files, `mechanism-NAME.svg`. Those of terms have the terms' names."""


def main() -> None:
    """Write every drawing."""
    with matplotlib.rc_context(STYLE):
        for name, drawing in DRAWINGS.items():
            (IMAGES / f"mechanism-{name}.svg").write_text(written(drawing()))


if __name__ == "__main__":
    main()
