"""Fitting the model to a measurement: estimates, what they are worth, and what cannot be told."""

from .fit import fit as fit
from .result import Direction as Direction
from .result import Fit as Fit

__all__ = [
    "Direction",
    "Fit",
    "fit",
]


def __dir__() -> list[str]:
    return sorted(__all__)
