"""Virtual experiments: the claims of Woodhouse & Goldstein (2013) tested on the model cell, with verdicts."""

from .catalogue import NAMES as NAMES
from .catalogue import experiment as experiment
from .experiment import Experiment as Experiment
from .experiment import Verdict as Verdict
from .perform import Performance as Performance
from .perform import perform as perform

__all__ = [
    "NAMES",
    "Experiment",
    "Performance",
    "Verdict",
    "experiment",
    "perform",
]


def __dir__() -> list[str]:
    return sorted(__all__)
