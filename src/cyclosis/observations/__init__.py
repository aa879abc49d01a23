"""Measured cells: what a camera sees of one, and what it saw."""

from .microscope.observe import Recording as Recording
from .microscope.observe import observe as observe
from .view import View as View
