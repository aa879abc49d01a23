"""Measured cells: what a camera sees of one, and what it saw."""

from .view import View as View
