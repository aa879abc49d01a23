"""Choices about all figures: the colours of states, the font, a style sheet of matplotlib, and units.

They hold within a `with looks.chosen(...)`. Without one, figures are as the rest of the package draws them.
"""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from contextvars import ContextVar
from types import MappingProxyType
from typing import Any

import matplotlib
import numpy as np
from matplotlib.colors import Colormap, LinearSegmentedColormap

from ..display.colours import BLUE, DARKEST, GAMMA, GREEN, ORANGE, PURPLE, WHEEL, Stops, diverging
from ..model.errors import InputError, choice, closest
from ..model.grid import Array
from ..model.scales import Scales
from ..model.units import chosen_scales, shown_in, table_of

__all__ = [
    "COLOURS",
    "DIRECTION",
    "WHEEL",
    "chosen",
    "colours",
    "direction_rgb",
    "polarity_map",
    "scales",
    "setting",
]


def __dir__() -> list[str]:
    return sorted(__all__)


DIRECTION = "direction"
"""The choice in which colours show the direction of P and its magnitude."""
_LISTED = ("berlin", "managua", "vanimo")
COLOURS = ("purple-green", "blue-orange", *_LISTED, DIRECTION)
"""The colours that there are, the usual ones first; all suit every kind of colour vision."""

_NONE: Mapping[str, Any] = MappingProxyType({})
_COLOURS: ContextVar[str] = ContextVar("colours", default=COLOURS[0])
_SETTINGS: ContextVar[Mapping[str, Any]] = ContextVar("settings", default=_NONE)


@contextmanager
def chosen(
    colours: str | None = None,
    font: str | None = None,
    sheet: str | os.PathLike[str] | None = None,
    scales: Scales | None = None,
) -> Iterator[None]:
    """Draw and save figures with other colours, another font, or a style sheet, within a `with`.

    `colours` are one of `COLOURS`: those of P_z, by names of which berlin, managua and vanimo are
    matplotlib's, or "direction", in which hue is the direction of P and dark is a small |P|. `font` is the
    name of an installed font. `sheet` is a file of matplotlib, or the name of one that it has; sizes of
    figures in millimetres take precedence over it. `scales` are those of a cell: figures of theory, sweeps,
    experiments and the vacuole then have seconds, µm and µm/s on their axes; figures of a run have the scales
    of its dataset. Raises `InputError` for names that do not exist.

    Example:
        >>> import cyclosis as cy
        >>> from cyclosis.figures import looks
        >>> from cyclosis.figures.snapshot import snapshot
        >>> params, grid = cy.Parameters(), cy.CylinderGrid(16, 16)
        >>> run = cy.simulate(params, grid, cy.initial.circumferential(grid), t_end=1.0)
        >>> with looks.chosen(colours="direction", font="DejaVu Sans"):
        ...     figure = snapshot(run.to_dataset(), 1.0)
        >>> len(figure.axes)
        3
    """
    if colours is not None:
        choice("colours", colours, COLOURS)
    if scales is not None:
        table_of(scales)
    settings = dict(_SETTINGS.get()) | _sheet(sheet) | _font(font)
    before = _COLOURS.set(colours or _COLOURS.get()), _SETTINGS.set(settings)
    try:
        with shown_in(scales):
            yield
    finally:
        _COLOURS.reset(before[0])
        _SETTINGS.reset(before[1])


def setting(base: Mapping[str, Any]) -> Any:
    """Return the context of matplotlib with the type of a figure, and what was chosen instead."""
    settings: dict[Any, Any] = {**base, **_SETTINGS.get()}
    return matplotlib.rc_context(settings)


def colours() -> str:
    """Return the name of the colours that are chosen."""
    return _COLOURS.get()


def scales() -> Scales | None:
    """Return the scales that are chosen, None if axes are dimensionless."""
    return chosen_scales()


def polarity_map() -> Colormap:
    """Return the colours of P_z from -1 to 1, on a scale from 0 to 1."""
    name = _COLOURS.get()
    if name in _LISTED:
        return matplotlib.colormaps[name]
    return _OWN.get(name, _OWN[COLOURS[0]])


def _segments(name: str, stops: Stops) -> Colormap:
    listed = [(0.5 + 0.5 * value, colour) for value, colour in stops]
    return LinearSegmentedColormap.from_list(name, listed, N=1024)


_OWN = {
    "purple-green": _segments("polarity", diverging(GREEN, PURPLE)),
    "blue-orange": _segments("blue-orange", diverging(ORANGE, BLUE)),
}


def direction_rgb(P: Array) -> Array:
    """Return the colours (..., 3) of order vectors P (2, ...): their direction as hue, |P| as brightness."""
    corners = np.array([[int(colour[k : k + 2], 16) / 255 for k in (1, 3, 5)] for colour in WHEEL]) ** GAMMA
    place = np.mod(np.arctan2(P[1], P[0]) / (0.5 * np.pi), 4.0)
    below = np.floor(place).astype(int) % 4
    share = (place - np.floor(place))[..., None]
    hue = (1 - share) * corners[below] + share * corners[(below + 1) % 4]
    size = np.clip(np.hypot(*P), 0.0, 1.0)[..., None]
    return np.asarray((hue * (DARKEST + (1 - DARKEST) * size)) ** (1 / GAMMA))


def _font(name: str | None) -> dict[str, Any]:
    if name is None:
        return {}
    from matplotlib.font_manager import findfont, fontManager

    try:
        findfont(name, fallback_to_default=False)
    except ValueError:
        known = sorted({each.name for each in fontManager.ttflist})
        raise InputError("font", name, "the name of an installed font", closest(name, known)) from None
    return {"font.family": [name], "mathtext.fontset": "stixsans" if "sans" in name.lower() else "stix"}


def _sheet(place: str | os.PathLike[str] | None) -> dict[str, Any]:
    if place is None:
        return {}
    from matplotlib import style as sheets

    if str(place) in sheets.library:
        known: Any = sheets.library[str(place)]
        return dict(known)
    try:
        read: Any = matplotlib.rc_params_from_file(place, fail_on_error=True, use_default_template=False)
        return dict(read)
    except (OSError, ValueError, KeyError, UnicodeDecodeError) as error:
        rule = "a style sheet of matplotlib, or the name of one"
        reason = " ".join(str(getattr(error, "strerror", None) or error).split())[:80]
        raise InputError("style", str(place), rule, f"check it ({reason})") from error
