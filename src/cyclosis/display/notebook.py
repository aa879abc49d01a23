"""How a notebook shows Parameters, a grid or a run: a short tree beside a small picture, as HTML."""

from __future__ import annotations

import base64
from collections.abc import Iterable
from html import escape
from io import BytesIO

import numpy as np
import numpy.typing as npt

from .colours import GREEN, PURPLE, ZONE, diverging

HEIGHT = 110
"""Height of a picture, CSS pixels."""
INK = "currentColor"


def text_tree(title: str, rows: Iterable[tuple[str, str]]) -> str:
    """Return a title and its branches, given as (name, text), as lines of text."""
    pairs = list(rows)
    wide = max((len(name) for name, _ in pairs), default=0)
    ends = ["├"] * (len(pairs) - 1) + ["└"]
    lines = [f"{end}─ {name:<{wide}}  {text}" for end, (name, text) in zip(ends, pairs, strict=False)]
    return "\n".join([title, *lines])


def tree(title: str, rows: Iterable[tuple[str, str]], picture: str = "") -> str:
    """Return HTML of a title, its branches as (name, text), and a picture beside them."""
    words = escape(text_tree(title, rows))
    style = "display:flex;gap:1.2em;align-items:center"
    return f'<div style="{style}"><pre style="margin:0;background:none">{words}</pre>{picture}</div>'


def map_of(P: npt.NDArray[np.float64], length: float) -> str:
    """Return an image of P_z, theta across and z up, in the colours of the figures.

    `P` is (2, n_theta, n_z); `length` the axial period. Dimensionless.
    """
    words = "P_z on the unwrapped surface, the angle across and the axis up"
    return _image(_coloured(P[1].T[::-1]), 2 * np.pi / length, words)


def closed_map_of(P: npt.NDArray[np.float64], s: npt.NDArray[np.float64], r: npt.NDArray[np.float64]) -> str:
    """Return an image of P_s on an equal-area map of a closed surface: r (theta - π) across and s up.

    `P` is (2, n_theta, n_s), at arc lengths `s` (n_s,) from the south pole with radii `r` (n_s,).
    """
    length, half = float(s[0] + s[-1]), np.pi * float(r.max())
    rows, columns = 2 * HEIGHT, max(8, round(4 * HEIGHT * half / length))
    up = (rows - 0.5 - np.arange(rows)) * length / rows
    radius = np.interp(up, [0.0, *s, length], [0.0, *r, 0.0])[:, None]
    angle = np.pi + ((np.arange(columns) + 0.5) * 2 / columns - 1) * half / np.maximum(radius, 1e-9)
    inside = np.abs(angle - np.pi) <= np.pi
    theta = 2 * np.pi * np.arange(P.shape[1]) / P.shape[1]
    nearest = np.abs(up[:, None] - s).argmin(axis=1)
    shown = [np.interp(at, theta, P[1, :, k], period=2 * np.pi) for at, k in zip(angle, nearest, strict=True)]
    opacity = np.where(inside, 255.0, 0.0)[:, :, None]
    pixels = np.concatenate([_coloured(np.array(shown)), opacity], axis=2)
    return _image(pixels, 2 * half / length, "P_s on an equal-area map, the angle across and the axis up")


def _coloured(values: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    """Return the colours (..., 3), 0 to 255, of polarities (...)."""
    at, colours = zip(*diverging(GREEN, PURPLE), strict=True)
    rgb = np.array([[int(colour[k : k + 2], 16) for k in (1, 3, 5)] for colour in colours])
    shown = np.clip(values, -1.0, 1.0)
    return np.stack([np.interp(shown, at, rgb[:, k]) for k in range(3)], axis=-1)


def _image(pixels: npt.NDArray[np.float64], aspect: float, words: str) -> str:
    """Return an image of pixels (rows, columns, 3 or 4), 0 to 255, as wide as `aspect` times its height."""
    from PIL import Image

    file = BytesIO()
    Image.fromarray(pixels.astype(np.uint8)).save(file, "png")
    data = base64.b64encode(file.getvalue()).decode()
    width = min(3 * HEIGHT, max(12, round(HEIGHT * aspect)))
    return f'<img alt="{words}" width="{width}" height="{HEIGHT}" src="data:image/png;base64,{data}">'


def cylinder(length: float) -> str:
    """Return a drawing of a cylinder of radius 1 and a length, to scale."""
    scale = min((HEIGHT - 24) / length, 40.0)
    r, h = max(1.5, scale), scale * length
    rim = 0.28 * r
    middle, top = r + 2, (HEIGHT - h) / 2
    path = (
        f"M{middle - r:.1f},{top:.1f}v{h:.1f}a{r:.1f},{rim:.1f} 0 0 0 {2 * r:.1f},0v{-h:.1f}"
        f"a{r:.1f},{rim:.1f} 0 0 0 {-2 * r:.1f},0a{r:.1f},{rim:.1f} 0 0 0 {2 * r:.1f},0"
    )
    return (
        f'<svg role="img" aria-label="the cylinder, to scale" width="{2 * r + 4:.0f}" height="{HEIGHT}">'
        f'<path d="{path}" fill="none" stroke="{INK}"/></svg>'
    )


def alignments(alpha_p: float, alpha_u: float) -> str:
    """Return a drawing of where a cell stands in the plane of bundling and flow alignment, 0 to 1 each."""
    side, margin = HEIGHT - 24, 16
    x, y = (margin + side * min(max(alpha_p, 0.0), 1.0), 4 + side * (1 - min(max(alpha_u, 0.0), 1.0)))
    text, centre = f'font-size="11" fill="{INK}" text-anchor="middle"', f"{4 + side / 2:.0f}"
    return (
        f'<svg role="img" aria-label="alpha_p across, alpha_u up, 0 to 1" width="{HEIGHT}" height="{HEIGHT}">'
        f'<rect x="{margin}" y="4" width="{side}" height="{side}" fill="none" stroke="{INK}" opacity="0.5"/>'
        f'<circle cx="{x:.1f}" cy="{y:.1f}" r="4.5" fill="{PURPLE[-1]}" stroke="{ZONE}"/>'
        f'<text x="{margin + side / 2:.0f}" y="{HEIGHT - 6}" {text}>α_p</text>'
        f'<text x="8" y="{centre}" {text} transform="rotate(-90 8 {centre})">α_u</text></svg>'
    )
