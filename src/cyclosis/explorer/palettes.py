"""Colours of P_z for the page: those of the figures, and a pair for all kinds of colour vision."""

from __future__ import annotations

from dataclasses import dataclass

from ..display.colours import BLUE, GREEN, ORANGE, PURPLE, ZONE, Stops, diverging


@dataclass(frozen=True)
class Palette:
    """Colours of P_z: `stops` (value from -1 to 1, colour), in order, and that of indifferent zones."""

    name: str
    title: str
    stops: Stops
    zone: str = ZONE


PALETTES = (
    Palette("polarity", "purple and green", diverging(GREEN, PURPLE)),
    Palette("vision", "blue and orange, for every colour vision", diverging(ORANGE, BLUE)),
)
