"""Storing a sweep: blocks in safely written files, a folder of them, and reading it back."""

from .store import Store as Store
from .store import versions as versions

__all__ = [
    "Store",
    "versions",
]


def __dir__() -> list[str]:
    return sorted(__all__)
