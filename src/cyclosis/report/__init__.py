"""Runs, sweeps, files and machines in a few lines of text."""

from .machine import machine as machine
from .run import summary as summary
from .run import tree as tree
