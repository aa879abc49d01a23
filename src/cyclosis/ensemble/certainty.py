"""When the final regime of a member is certain, not only likely.

There are three kinds of certainty:

* disorder: the bound of `cyclosis.stability.disorder` shows that the state can only decay;
* arrival: the state varies along one axis only, up to a weak remnant, and is close enough to a
  state that is steady (Newton's method) and linearly stable (all eigenvalues, along and across);
* relaxation: the state varies along one axis only, but is not there yet. The one-dimensional equation is then
  integrated until it arrives, provided that no perturbation across grows about the states on the way, and
  that it passes no saddle so closely that the neglected remnant could have changed the outcome.

A member whose regime is not certain is integrated in two dimensions up to t_end.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from ..analysis.signs import Signs
from ..contract.members import CertainEnd, Doubt
from ..model.definitions import TERM_NAMES
from ..model.grid import Array, CylinderGrid
from ..model.parameters import Parameters
from ..models import polar
from ..stability.disorder import Disorder
from ..stability.profiles.growth import across
from ..stability.profiles.reduced import Reduced, reduced_of
from ..stability.profiles.steady import relax, rms, steady
from .attractors import SAME, Attractor, Kind, attractor, kind, standard_state

UNEVEN = 0.05
"""Largest <|P - mean along an axis|²>^½, relative to the order, at which arrival is tested."""
RELAXABLE = 0.01
"""The same for relaxation."""
FIRST_STAGE, STAGE_GROWTH, LONGEST = 20.0, 1.5, 1e4
"""Relaxation is checked after a time of 20, then at intervals that grow by half, up to 10 000 in total."""
MOVED = 0.5
"""Root mean square change after which growth across is tested again."""
LONG_WAVES = 3
"""Number of wavenumbers across that are tested on the way; the longest waves grow first."""
NEAR = 0.2
"""Root mean square distance from a stable steady state within which no other one is searched."""
QUICK = 0.1
"""Relative rate of change above which a state counts as being in no attractor's basin."""
SLOW = 0.01
"""Relative rate of change above which a state is neither near a steady state nor slow enough to relax."""
STANDARD_TIME = 100.0
"""Time for which a standard state relaxes before Newton's method is used."""
ASK_AGAIN = 0.7
"""A member that is not certain is tested again when its remnant has fallen, or t risen, by this factor."""
SADDLE = 0.5
"""Smallest rate of change that may precede a faster one, in units of the square of the remnant."""


class Certainty:
    """What is known about one parameter point: its disorder bound, and the steady states found so far.

    Steady states are kept only to save work. They are computed from standard states, not from those of
    members, so that no result depends on earlier ones.
    """

    def __init__(self, params: Parameters, grid: CylinderGrid, **options: Any) -> None:
        self.cell = polar.problem(params, grid, **options)
        self.possible = params.shape is None
        complete = {term.name for term in self.cell.terms} == set(TERM_NAMES)
        self.disorder = Disorder(params, grid) if self.possible and complete else None
        self.problems: dict[int, Reduced] = {}
        self.known: dict[tuple[int, Kind], Attractor | None] = {}

    def judge(self, signs: Signs, fading: bool) -> CertainEnd | Doubt:
        """Return the verdict on a state that varies along one axis only, or why there is none.

        `fading` says whether the part that varies along the other axis has been observed to decay.
        """
        verdict: CertainEnd | Doubt = Doubt.YET
        order = float(signs.order)
        for axis, varying, mean in (
            (1, signs.vary_z, signs.mean_along_z),
            (0, signs.vary_theta, signs.mean_along_theta),
        ):
            uneven = float(varying)
            if self.possible and verdict is Doubt.YET and order > 0 and uneven <= UNEVEN * order:
                verdict = self._finish(axis, np.asarray(mean, dtype=np.complex128), uneven, order, fading)
        return verdict

    def inquiry(self) -> Inquiry:
        """Return a new inquiry into the final regime of one member."""
        return Inquiry(self)

    def remnant(self, signs: Signs) -> float:
        """Return the size of the smaller of the parts that vary along each axis, relative to the order."""
        return float(min(signs.vary_z, signs.vary_theta)) / max(float(signs.order), 1e-300)

    def disordered(self, signs: Signs) -> CertainEnd | None:
        """Return the verdict that a state can only become disordered, or None."""
        if self.disorder is None or not self.disorder.decays(
            float(signs.largest), float(signs.unevenness), float(signs.around)
        ):
            return None
        reason = "alpha_p is at most d_r and the order too weak ever to grow"
        return CertainEnd("disordered", reason, np.zeros((2, *self.cell.grid.shape)), np.nan, 0.0)

    def _finish(self, axis: int, mean: Any, uneven: float, order: float, fading: bool) -> CertainEnd | Doubt:
        problem = self._problem(axis)
        y = problem.from_packed(mean)
        found = self._arrived(problem, y, uneven)
        if found is not None:
            return self._verdict(found, y, "in the neighbourhood of a stable steady state", 0.0)
        if uneven > RELAXABLE * order or not fading:
            return Doubt.YET
        return self._relaxed(problem, y, uneven / order)

    def _relaxed(self, problem: Reduced, y: Array, remnant: float) -> CertainEnd | Doubt:
        time, stage, tested = 0.0, FIRST_STAGE, y
        rates = [rms(problem.rate(y)) / max(rms(y), 1e-300)]
        if rates[0] > SLOW:  # while the state moves, two dimensions are fast enough
            return Doubt.YET
        while time < LONGEST:
            now = relax(problem, y, stage)
            if now.failed:
                return Doubt.YET
            time, stage, y = time + stage, stage * STAGE_GROWTH, now.y
            rates.append(now.rate)
            if _passed_saddle(rates, remnant):
                return Doubt.YET
            if _moved(problem, y, tested) > MOVED:
                if not self._stable_across(problem, y):
                    return Doubt.YET
                tested = y
            found = self._arrived(problem, y, 0.0)
            if found is not None:
                return self._verdict(
                    found, y, "by the one-dimensional equation to a stable steady state", time
                )
        return Doubt.LASTING

    def _stable_across(self, problem: Reduced, y: Array) -> bool:
        return bool(np.all(across(problem, y, LONG_WAVES) < 0))

    def _arrived(self, problem: Reduced, y: Array, uneven: float) -> Attractor | None:
        """Return the stable steady state at which y has arrived, or None."""
        speed = rms(problem.rate(y)) / rms(y)
        if speed > QUICK:
            return None
        standard = self._standard(problem, kind(problem, y))
        if standard is not None and standard.captures(y, uneven):
            return standard
        if standard is not None and standard.stable and standard.distance(y) < NEAR:
            return None
        if speed > SLOW:
            return None
        state = steady(problem, y)
        if state is None or (standard is not None and standard.distance(state.y) < SAME):
            return None
        own = attractor(self.cell, problem, state)
        return own if own.captures(y, uneven) else None

    def _standard(self, problem: Reduced, of: Kind) -> Attractor | None:
        """Return the steady state that the standard state of a kind relaxes to."""
        key = (problem.axis, of)
        if key not in self.known:
            began = relax(problem, standard_state(problem, of), STANDARD_TIME)
            state = None if began.failed else steady(problem, began.y)
            self.known[key] = None if state is None else attractor(self.cell, problem, state)
        return self.known[key]

    def _verdict(self, found: Attractor, y: Array, reason: str, time: float) -> CertainEnd:
        problem = found.problem
        y = problem.shifted(found.steady.y, -found.shift(y))
        final = problem.state(y, self.cell.grid)
        return CertainEnd(found.regime, reason, final, found.rates.growth, time)

    def _problem(self, axis: int) -> Reduced:
        if axis not in self.problems:
            self.problems[axis] = reduced_of(self.cell, axis)
        return self.problems[axis]


def _moved(problem: Reduced, y: Array, before: Array) -> float:
    """Return how far a state has moved, not counting shifts of the whole state."""
    change = np.abs(problem.packed(y)) - np.abs(problem.packed(before))
    return float(np.sqrt(np.sum(change**2))) / problem.n


def _passed_saddle(rates: list[float], remnant: float) -> bool:
    """Return whether the motion, before it sped up again, was so slow that the remnant could affect it."""
    slowest, faster = rates[0], 0.0
    for rate in rates[1:]:
        slowest = min(slowest, rate)
        faster = max(faster, rate / slowest)
    return faster > 2.0 and slowest < SADDLE * remnant**2


@dataclass
class Inquiry:
    """The inquiry into the final regime of one member: when to test next, and its last remnant.

    Tests cost time. A member that is not certain is tested again when its remnant has fallen, or t risen, by
    the factor `ASK_AGAIN`; if the one-dimensional equation does not settle, it is not tested again.
    """

    certainty: Certainty
    ask_below: float = UNEVEN
    ask_after: float = np.inf
    remnant: float = np.inf

    def look(self, signs: Signs, t: float) -> CertainEnd | None:
        """Return the verdict on the member with these signs at a time, or None."""
        verdict = self.certainty.disordered(signs)
        remnant = self.certainty.remnant(signs)
        if remnant > UNEVEN:
            self.ask_below, self.ask_after = UNEVEN, np.inf
        elif verdict is None and (remnant <= self.ask_below or t >= self.ask_after):
            found = self.certainty.judge(signs, fading=remnant < self.remnant)
            verdict = found if isinstance(found, CertainEnd) else None
            lasting = found is Doubt.LASTING
            self.ask_below = 0.0 if lasting else ASK_AGAIN * remnant
            self.ask_after = np.inf if lasting else t / ASK_AGAIN
        self.remnant = remnant
        return verdict
