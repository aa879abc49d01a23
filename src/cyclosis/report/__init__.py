"""Runs, sweeps, files and machines in a few lines of text."""

from .again import configured as configured
from .facts import contents as contents
from .facts import facts as facts
from .machine import machine as machine
from .run import summary as summary
from .run import tree as tree
