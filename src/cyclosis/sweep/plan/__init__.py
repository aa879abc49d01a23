"""The plan of a sweep, made from a configuration: its members, blocks and variables."""

from .sweep import Block as Block
from .sweep import Sweep as Sweep

__all__ = [
    "Block",
    "Sweep",
]


def __dir__() -> list[str]:
    return sorted(__all__)
