"""The look of all figures: colours, type, sizes, and how they are saved."""

from __future__ import annotations

import hashlib
import io
import json
import os
import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import matplotlib
import numpy as np
import numpy.typing as npt
from matplotlib.figure import Figure

from ..display.colours import ZONE as ZONE
from ..model.errors import InputError
from ..model.grid import Array
from ..model.scales import Scales
from ..model.units import round_length
from . import looks, paper
from .looks import setting

__all__ = [
    "DOWN",
    "DPI",
    "INK",
    "LEGEND",
    "PAPER",
    "POLARITY",
    "QUIET",
    "SHADE",
    "SMALL",
    "SUFFIXES",
    "TYPE",
    "UP",
    "WIDE",
    "WIDTH",
    "ZONE",
    "blank",
    "colour_key",
    "marks",
    "mathtext",
    "place",
    "polarity_rgb",
    "save",
    "scale_bar",
    "signed",
    "state_rgb",
]


def __dir__() -> list[str]:
    return sorted(__all__)


POLARITY = looks.polarity_map()
"""Colours of P_z from -1 (green) through 0 (nearly black) to 1 (purple), darker for smaller |P_z|."""

INK = "#1b1720"
"""Text, outlines and streamlines."""
QUIET = "#a9a4b0"
"""Guide lines that should not attract attention."""
PAPER = "#f3f1f5"
"""Cut ends of the cell."""
UP = "#74399f"
"""Lines and points of upward streaming."""
DOWN = "#459951"
"""Lines and points of downward streaming."""
SHADE = "#d9d4e0"
"""Areas."""

WIDTH = 180.0
"""Width of a two-column figure in millimetres."""
DPI = 300
"""Dots per inch of saved bitmaps."""

# STIX comes with matplotlib, so the figures look the same on every machine.
WIDE = 120.0
"""Width in millimetres below which figures have small type."""
SMALL = {"font.size": 7.5, "axes.labelsize": 7.5, "xtick.labelsize": 7.0, "ytick.labelsize": 7.0}
"""That type, as changes of `TYPE`."""
TYPE: dict[Any, Any] = {
    "font.family": "STIXGeneral",
    "mathtext.fontset": "stix",
    "font.size": 10.0,
    "axes.labelsize": 10.0,
    "xtick.labelsize": 9.0,
    "ytick.labelsize": 9.0,
    "axes.linewidth": 0.6,
    "axes.edgecolor": INK,
    "axes.labelcolor": INK,
    "text.color": INK,
    "xtick.color": INK,
    "ytick.color": INK,
    "xtick.major.size": 2.5,
    "ytick.major.size": 2.5,
    "xtick.major.width": 0.6,
    "ytick.major.width": 0.6,
    "xtick.major.pad": 2.5,
    "ytick.major.pad": 2.5,
    "pdf.fonttype": 42,
    "svg.fonttype": "none",
}
"""Matplotlib settings shared by all figures; use as `with setting(TYPE)`."""


LEGEND: dict[str, Any] = {
    "loc": "lower left",
    "bbox_to_anchor": (-0.04, 0.97),
    "ncols": 3,
    "frameon": False,
    "fontsize": 9.0,
    "handlelength": 1.1,
    "handletextpad": 0.4,
    "columnspacing": 0.9,
    "markerscale": 2.2,
    "borderpad": 0.2,
    "numpoints": 1,
}
"""A legend in one row above its axes."""


def polarity_rgb(P_z: npt.ArrayLike) -> Array:
    """Return the colours (..., 3), in 0 to 1, of axial polarities (...) in -1 to 1 (dimensionless)."""
    values = np.clip(np.asarray(P_z, dtype=np.float64), -1.0, 1.0)
    colours: Array = np.asarray(looks.polarity_map()(0.5 * (values + 1.0)), dtype=np.float64)
    return colours[..., :3]


def state_rgb(P: Array, size_only: bool = False) -> Array:
    """Return the colours (..., 3) of order vectors (2, ...): of P_z, or of |P|, or of both if so chosen."""
    if looks.colours() == looks.DIRECTION:
        return looks.direction_rgb(P)
    return polarity_rgb(np.hypot(*P) if size_only else P[1])


_MATHTEXT = {
    "<": r"\langle ",
    ">": r"\rangle ",
    "·": r"\cdot ",
    "²": "^2",
    "^½": "^{1/2}",
    "∇": r"\nabla ",
    "μ": r"\mu ",
    "Π₀": r"\Pi_0",
    "max ": r"\max\,",
    "P": r"\mathbf{P}",
    "u": r"\mathbf{u}",
    "F": r"\mathbf{F}",
}


def mathtext(symbol: str) -> str:
    """Return a symbol of `cyclosis.diagnostics.QUANTITIES`, such as "<|u|²>^½", set as mathematics."""
    pattern = "|".join(map(re.escape, sorted(_MATHTEXT, key=len, reverse=True)))
    return "$" + re.sub(pattern, lambda found: _MATHTEXT[found.group()], symbol) + "$"


def blank(width: float, height: float) -> Figure:
    """Return an empty figure of `width` times `height` millimetres, independent of global state."""
    return paper.Figure(figsize=(width / 25.4, height / 25.4), facecolor="white")


def place(figure: Figure, left: float, bottom: float, width: float, height: float) -> Any:
    """Return new axes in a figure, at a place given in millimetres from its lower left corner."""
    across, up = figure.get_size_inches() * 25.4
    return figure.add_axes((left / across, bottom / up, width / across, height / up))


def colour_key(ax: Any, title: str = "$P_z$", signed: bool = True) -> None:
    """Draw the colours of P_z into narrow upright axes, up-streaming on top; from 0 on if not `signed`."""
    if looks.colours() == looks.DIRECTION:
        _direction_key(ax)
        return
    low = -1.0 if signed else 0.0
    levels = np.linspace(low, 1.0, 512)
    ax.imshow(polarity_rgb(levels)[:, None, :], extent=(0, 1, low, 1), origin="lower", aspect="auto")
    if signed:
        ax.axhline(0.0, color=ZONE, linewidth=1.2)
    ax.set_xticks([])
    ax.set_yticks([-1, 0, 1] if signed else [0, 1], ["−1", "0", "1"] if signed else ["0", "1"])
    ax.yaxis.tick_right()
    ax.set_title(title, pad=5.0, fontsize=matplotlib.rcParams["font.size"])


def _direction_key(ax: Any) -> None:
    """Draw the colours of directions upright, with |P| from 0 to 1 across."""
    angle, size = np.meshgrid(np.linspace(-np.pi, np.pi, 361), np.linspace(0.0, 1.0, 32), indexing="ij")
    P = size * np.stack([np.cos(angle), np.sin(angle)])
    ax.imshow(looks.direction_rgb(P), extent=(0, 1, -2, 2), origin="lower", aspect="auto")
    ax.set_xticks([0, 1], ["0", "1"], fontsize=7.0)
    ax.set_yticks([-2, -1, 0, 1, 2], ["←", "↓", "→", "↑", "←"], family="DejaVu Sans")
    ax.yaxis.tick_right()
    ax.set_title(r"$\mathbf{P}$", pad=5.0, fontsize=matplotlib.rcParams["font.size"])


_BELOW = 2.0
"""Largest distance between a solid and its scale bar, in millimetres."""


def scale_bar(ax: Any, scales: Scales | None, box: Sequence[float]) -> None:
    """Draw a bar of a round length below the picture of a solid with edges `box`, in radii, given scales."""
    if scales is None:
        return
    left, right, bottom, _ = box
    length, name = round_length(scales, 0.6 * (right - left))
    low, high = ax.get_ylim()
    radius = 25.4 * ax.figure.get_figheight() * ax.get_position().height / (high - low)  # in millimetres
    middle, below = 0.5 * (left + right), bottom - min(0.12, _BELOW / radius)
    ends = [middle - 0.5 * length, middle + 0.5 * length]
    ax.plot(ends, [below, below], color=INK, linewidth=1.6, solid_capstyle="butt", clip_on=False)
    ax.annotate(
        name, (middle, below), (0, -2.0), textcoords="offset points", ha="center", va="top", fontsize=8.0,
        annotation_clip=False,
    )  # fmt: skip


SUFFIXES = (".png", ".pdf", ".svg", ".eps")
"""Formats of figures."""


def signed(figure: Figure, *sources: Any) -> Figure:
    """Return a figure that `save` marks by the SHA-256 of the configurations of what it was drawn from.

    A source is the dataset of a run, a sweep or an experiment, which has this digest, or any configuration as
    a plain table, of which it is the digest of its canonical JSON.

    Example:
        >>> import cyclosis as cy
        >>> from cyclosis.figures import style
        >>> from cyclosis.figures.snapshot import snapshot
        >>> params, grid = cy.Parameters(), cy.CylinderGrid(16, 16)
        >>> data = cy.simulate(params, grid, cy.initial.stripes(grid), t_end=1.0).to_dataset()
        >>> style.signed(snapshot(data), data).get_label()[:20]
        'configuration_sha256'
        >>> style.signed(style.blank(80.0, 40.0), {"alpha_p": 1.0}).get_label()[-8:]
        '6b73ef01'
    """
    figure.set_label(marks(*sources))
    return figure


def marks(*sources: Any) -> str:
    """Return in words the SHA-256 of configurations, or the digests of sweeps: see `signed`."""
    return "; ".join(filter(None, map(_mark, sources)))


def _mark(source: Any) -> str:
    if isinstance(source, Mapping) and not hasattr(source, "attrs"):
        text = json.dumps(source, sort_keys=True, separators=(",", ":"), default=str)
        return f"configuration_sha256 {hashlib.sha256(text.encode()).hexdigest()}"
    names = ("configuration_sha256", "digest")
    return "; ".join(f"{name} {source.attrs[name]}" for name in names if name in source.attrs)


def save(figure: Figure, path: str | os.PathLike[str]) -> Path:
    """Write a figure as PNG (300 dpi), PDF, SVG or EPS, by the suffix of `path`, and return the path.

    The file appears complete or not at all, and replaces an existing one. Its metadata name the program, and
    the SHA-256 of the configuration of a `signed` figure. Raises `InputError` for
    other suffixes and for places that cannot be written to.

    Example:
        >>> from cyclosis.figures import style
        >>> style.save(style.blank(80.0, 40.0), "empty.png").name
        'empty.png'
        >>> style.save(style.blank(80.0, 40.0), "empty.bmp")
        Traceback (most recent call last):
            ...
        cyclosis.model.errors.InputError: path = 'empty.bmp' cannot be used: ...
    """
    from ..dataset.whole import whole  # loads all that files need, which drawing alone does not

    target = Path(path)
    kind = target.suffix.lower()
    if kind not in SUFFIXES:
        rule = "a file name that ends in .png, .pdf, .svg or .eps"
        raise InputError("path", str(target), rule, "change its suffix")
    drawn = io.BytesIO()
    try:
        with setting(TYPE):
            figure.savefig(drawn, dpi=DPI, format=kind[1:], metadata=paper.metadata(figure, kind[1:]))
        with whole(target) as new:
            new.write_bytes(drawn.getvalue())
    except OSError as error:
        raise InputError(
            "path", str(target), "in a folder that can be written to", f"choose another ({error.strerror})"
        ) from error
    return target
