"""What an experiment is: a claim, how it is tested, and the result."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

from ..display.shown import shown

if TYPE_CHECKING:
    import xarray
    from matplotlib.figure import Figure

    from .lab import Lab

AGREES, IN_PART, DOES_NOT = OUTCOMES = ("agrees", "in part", "does not")
"""Whether a claim holds: as the paper says, with a reservation that the sentence names, or not."""


@shown
@dataclass(frozen=True)
class Verdict:
    """Whether a claim holds: `outcome`, one of `OUTCOMES`, and a sentence with the numbers that decide it.

    Example:
        >>> from cyclosis.experiments import Verdict
        >>> Verdict("agrees", "100 of 100 cells").outcome
        'agrees'
    """

    outcome: str
    measured: str

    def __str__(self) -> str:
        return f"{self.outcome}: {self.measured}"


@shown
@dataclass(frozen=True)
class Experiment:
    """A virtual experiment.

    `claim` is the paper's, in our words, `headline` the same in one short sentence, `source` its place in the
    paper, `method` what is done and measured. `seeds` is the number of seeds of the full form and
    `quick_seeds` that of the quick one. `measure` makes the dataset, from which alone `verdict`, `decisive`
    (the one number that decides, with its interval) and `draw` follow: a stored dataset gives the same again.

    Example:
        >>> from cyclosis.experiments import experiment
        >>> chosen = experiment("timescales")
        >>> chosen.name, chosen.seeds > chosen.quick_seeds
        ('timescales', True)
        >>> chosen.claim.split(",")[0]
        'A vesicle walks along a filament in much less time than it takes to turn it'
    """

    name: str
    headline: str
    claim: str
    source: str
    method: str
    seeds: int
    quick_seeds: int
    measure: Callable[[Lab], xarray.Dataset]
    verdict: Callable[[xarray.Dataset], Verdict]
    decisive: Callable[[xarray.Dataset], str]
    draw: Callable[[xarray.Dataset], Figure]
