"""Storing a sweep: blocks in safely written files, a folder of them, and reading it back."""

from .store import Store as Store
from .store import versions as versions
