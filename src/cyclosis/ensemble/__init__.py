"""Ensembles: many members at once, each integrated until its final regime is certain."""

from .members import FINISH as FINISH
from .members import OUTCOMES as OUTCOMES
from .members import EnsembleSettings as EnsembleSettings
from .members import Member as Member
from .members import Outcome as Outcome
from .run import default_lanes as default_lanes
from .run import follow as follow

__all__ = [
    "FINISH",
    "OUTCOMES",
    "EnsembleSettings",
    "Member",
    "Outcome",
    "default_lanes",
    "follow",
]


def __dir__() -> list[str]:
    return sorted(__all__)
