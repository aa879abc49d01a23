"""The colours of P, for the figures and for the explorer's page. Nothing heavy is imported here."""

from __future__ import annotations

Stops = tuple[tuple[float, str], ...]
"""Values from -1 to 1, in order, and their colours."""

MAGNITUDE = (0.0, 0.1, 0.33, 0.64, 1.0)
"""Values of |P_z| at which colours are given: closer near zero, so that weak order shows."""
# Green ends lighter than purple, so that the two directions stay apart in grayscale and for every kind of
# colour vision, while both are nearly black at P_z = 0.
PURPLE = ("#16111b", "#472860", "#74399f", "#9757c8", "#b377e3")
GREEN = ("#101811", "#2b5232", "#458951", "#63bf74", "#87ec98")
# Blue and orange differ for those to whom purple and green do not; orange ends lighter for the same reason.
BLUE = ("#11141b", "#1c3a63", "#2a5fa6", "#3f83d6", "#62a4f2")
ORANGE = ("#181410", "#573a16", "#96631c", "#d0892a", "#f9b04a")
WHEEL = ("#f08a3c", "#b377e3", "#15488f", "#87ec98")
"""Colours of |P| = 1 where P points to e_theta, e_z, -e_theta and -e_z; opposite ones differ in hue, and
neighbours that look alike without red or green differ in lightness. See tests/figures/test_looks.py."""
GAMMA, DARKEST = 2.2, 0.01
"""Between these four, and towards P = 0, colours are mixed as light: red, green and blue to the power
`GAMMA`. The light of P is that of its direction times |P|, and `DARKEST` of it remains at P = 0."""
ZONE = "#ffffff"
"""Indifferent zones."""


def diverging(down: tuple[str, ...], up: tuple[str, ...]) -> Stops:
    """Return the stops from `down`'s last colour at -1 to `up`'s last at 1; both first ones stand at 0."""
    return (
        *((-m, colour) for m, colour in zip(reversed(MAGNITUDE), reversed(down), strict=True)),
        *zip(MAGNITUDE, up, strict=True),
    )
