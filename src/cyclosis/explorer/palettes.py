"""Colours of P for the page: those of the figures, and a pair for all kinds of colour vision."""

from __future__ import annotations

from dataclasses import dataclass

from ..display.colours import BLUE, DARKEST, GAMMA, GREEN, ORANGE, PURPLE, WHEEL, ZONE, Stops, diverging


@dataclass(frozen=True)
class Wheel:
    """Colours of the direction of P: those of e_theta, e_z, -e_theta and -e_z, mixed as light."""

    colours: tuple[str, ...] = WHEEL
    gamma: float = GAMMA
    darkest: float = DARKEST


@dataclass(frozen=True)
class Palette:
    """Colours of P_z: `stops` (value from -1 to 1, colour), in order, and that of indifferent zones.

    With a `wheel` the cell shows the direction of P and |P| instead; the flow inside keeps `stops`.
    """

    name: str
    title: str
    stops: Stops
    zone: str = ZONE
    wheel: Wheel | None = None


PALETTES = (
    Palette("polarity", "purple and green", diverging(GREEN, PURPLE)),
    Palette("vision", "blue and orange, for every colour vision", diverging(ORANGE, BLUE)),
    Palette(
        "direction", "direction of filaments, also around the cell", diverging(GREEN, PURPLE), wheel=Wheel()
    ),
)
