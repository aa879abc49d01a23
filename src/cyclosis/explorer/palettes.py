"""Colours of P_z for the page: those of the figures, and a pair for every kind of colour vision."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Palette:
    """Colours of P_z: `stops` (value from -1 to 1, colour), increasing, and that of indifferent zones."""

    name: str
    title: str
    stops: tuple[tuple[float, str], ...]
    zone: str = "#ffffff"


# The steps are closer near zero, so that weak order shows.
_MAGNITUDE = (0.0, 0.1, 0.33, 0.64, 1.0)


def _diverging(name: str, title: str, down: tuple[str, ...], up: tuple[str, ...]) -> Palette:
    lower = [(-m, colour) for m, colour in zip(_MAGNITUDE[:0:-1], down[:0:-1], strict=True)]
    return Palette(name, title, (*lower, *zip(_MAGNITUDE, up, strict=True)))


PALETTES = (
    _diverging(
        "polarity",
        "purple and green",
        ("#131316", "#2b5232", "#458951", "#63bf74", "#87ec98"),
        ("#131316", "#472860", "#74399f", "#9757c8", "#b377e3"),
    ),
    _diverging(
        "vision",
        "blue and orange, for every colour vision",
        ("#131316", "#5a3410", "#a45c12", "#e08a1e", "#ffc266"),
        ("#131316", "#16365c", "#1f5fa8", "#3b86dd", "#6fb3ff"),
    ),
)
