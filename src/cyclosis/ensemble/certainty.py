"""When the final regime of a member is certain, and not merely likely.

Three ways lead to certainty:

* disorder: the bound of `cyclosis.stability.disorder` says that the state can only decay;
* arrival: the state varies along one axis only, up to a weak remnant, and lies within the neighbourhood of a
  state that is steady (Newton's method) and linearly stable (all eigenvalues, along and across);
* relaxation: it varies along one axis only, but is not there yet. Then the one-dimensional equation takes it
  there, provided that no perturbation across grows about the states on its way, and that it passes no
  saddle so closely that the remnant which was left out could have decided.

What is not certain is followed on, in two dimensions, to its t_end.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from typing import Any

import numpy as np

from ..model.definitions import TERM_NAMES
from ..model.grid import Array, CylinderGrid
from ..model.parameters import Parameters
from ..stability.disorder import Disorder
from ..stability.reduced import Reduced, reduced
from ..stability.relax import relax
from ..stability.spectrum import across
from ..stability.steady import rms, steady
from .attractors import SAME, Attractor, attractor
from .kinds import Kind, kind, standard_state
from .lanes import Signs

UNEVEN = 0.05
"""Largest <|P - mean along an axis|²>^½, relative to the order, at which arrival is asked about."""
RELAXABLE = 0.01
"""The same for relaxation."""
FIRST_STAGE, STAGE_GROWTH, LONGEST = 20.0, 1.5, 1e4
"""Relaxation is looked at after a time of 20, then at intervals that grow by half, up to 10 000 in all."""
MOVED = 0.5
"""Root mean square change after which growth across is looked at anew."""
LONG_WAVES = 3
"""Wavenumbers across that are looked at on the way; the longest waves grow first."""
NEAR = 0.2
"""Root mean square distance from a stable steady state within which no other one is looked for."""
QUICK = 0.1
"""Relative rate of change above which a state is in nobody's neighbourhood."""
SLOW = 0.01
"""Relative rate of change above which a state is neither near a steady state nor slow enough to relax."""
STANDARD_TIME = 100.0
"""Time that a standard state is given to relax before Newton's method takes over."""
SADDLE = 0.5
"""Least rate of change that may precede a faster one, in units of the square of the remnant."""


class Doubt(Enum):
    """Why nothing is certain: not yet, or because the one-dimensional equation does not settle either."""

    YET = "not yet"
    LASTING = "the one-dimensional equation has not settled either"


@dataclass(frozen=True, eq=False)
class Verdict:
    """What is certain: the regime, why, and the final state (2, n_theta, n_z).

    `eigenvalue` is the largest growth rate of perturbations of that state, `relaxation` the time that the
    one-dimensional equation took to get there; both dimensionless.
    """

    regime: str
    reason: str
    state: Array
    eigenvalue: float
    relaxation: float


class Certainty:
    """What is known of one parameter point: its disorder bound, and the steady states met so far.

    Steady states are kept only to save work. They are found from standard states, not from the members
    that ask, so that no answer depends on what was asked before.
    """

    def __init__(self, params: Parameters, grid: CylinderGrid, **options: Any) -> None:
        self.params, self.grid = params, grid
        self.options = options
        self.possible = params.shape is None
        complete = set(options.get("terms") or TERM_NAMES) == set(TERM_NAMES)
        self.disorder = Disorder(params, grid) if self.possible and complete else None
        self.problems: dict[int, Reduced] = {}
        self.known: dict[tuple[int, Kind], Attractor | None] = {}

    def judge(self, signs: Signs, fading: bool) -> Verdict | Doubt:
        """Return what is certain of a state that varies along one axis only, or why nothing is.

        `fading` says that what varies along the other axis has been seen to decay.
        """
        verdict: Verdict | Doubt = Doubt.YET
        order = float(signs.order)
        for axis, varying, mean in (
            (1, signs.vary_z, signs.mean_along_z),
            (0, signs.vary_theta, signs.mean_along_theta),
        ):
            uneven = float(varying)
            if self.possible and verdict is Doubt.YET and order > 0 and uneven <= UNEVEN * order:
                verdict = self._finish(axis, np.asarray(mean, dtype=np.complex128), uneven, order, fading)
        return verdict

    def remnant(self, signs: Signs) -> float:
        """Return the smaller of the parts of a state that vary along either axis, relative to its order."""
        return float(min(signs.vary_z, signs.vary_theta)) / max(float(signs.order), 1e-300)

    def disordered(self, signs: Signs) -> Verdict | None:
        """Return that a state can only become disordered, or None."""
        if self.disorder is None or not self.disorder.decays(
            float(signs.largest), float(signs.unevenness), float(signs.around)
        ):
            return None
        reason = "alpha_p is at most d_r and the order too weak ever to grow"
        return Verdict("disordered", reason, np.zeros((2, *self.grid.shape)), np.nan, 0.0)

    def _finish(self, axis: int, mean: Any, uneven: float, order: float, fading: bool) -> Verdict | Doubt:
        problem = self._problem(axis)
        y = problem.from_packed(mean)
        found = self._arrived(problem, y, uneven)
        if found is not None:
            return self._verdict(found, y, "in the neighbourhood of a stable steady state", 0.0)
        if uneven > RELAXABLE * order or not fading:
            return Doubt.YET
        return self._relaxed(problem, y, uneven / order)

    def _relaxed(self, problem: Reduced, y: Array, remnant: float) -> Verdict | Doubt:
        time, stage, looked = 0.0, FIRST_STAGE, y
        rates = [rms(problem.rate(y)) / max(rms(y), 1e-300)]
        if rates[0] > SLOW:  # two dimensions are quick enough as long as anything moves
            return Doubt.YET
        while time < LONGEST:
            now = relax(problem, y, stage)
            if now.failed:
                return Doubt.YET
            time, stage, y = time + stage, stage * STAGE_GROWTH, now.y
            rates.append(now.rate)
            if _passed_saddle(rates, remnant):
                return Doubt.YET
            if _moved(problem, y, looked) > MOVED:
                if not self._steadfast(problem, y):
                    return Doubt.YET
                looked = y
            found = self._arrived(problem, y, 0.0)
            if found is not None:
                return self._verdict(
                    found, y, "by the one-dimensional equation to a stable steady state", time
                )
        return Doubt.LASTING

    def _steadfast(self, problem: Reduced, y: Array) -> bool:
        return bool(np.all(across(problem, y, LONG_WAVES) < 0))

    def _arrived(self, problem: Reduced, y: Array, uneven: float) -> Attractor | None:
        """Return the stable steady state in whose neighbourhood y lies."""
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
        own = attractor(self.params, self.grid, problem, state, **self.options)
        return own if own.captures(y, uneven) else None

    def _standard(self, problem: Reduced, of: Kind) -> Attractor | None:
        """Return the steady state that the standard state of a kind relaxes to."""
        key = (problem.axis, of)
        if key not in self.known:
            began = relax(problem, standard_state(problem, of), STANDARD_TIME)
            state = None if began.failed else steady(problem, began.y)
            self.known[key] = (
                None if state is None else attractor(self.params, self.grid, problem, state, **self.options)
            )
        return self.known[key]

    def _verdict(self, found: Attractor, y: Array, reason: str, time: float) -> Verdict:
        problem = found.problem
        final = problem.shifted(found.steady.y, -found.shift(y))
        return Verdict(found.regime, reason, problem.state(final, self.grid), found.spectrum.growth, time)

    def _problem(self, axis: int) -> Reduced:
        if axis not in self.problems:
            self.problems[axis] = reduced(self.params, self.grid, axis, **self.options)
        return self.problems[axis]


def _moved(problem: Reduced, y: Array, before: Array) -> float:
    """Return how far a state has moved, shifts as a whole left out."""
    change = np.abs(problem.packed(y)) - np.abs(problem.packed(before))
    return float(np.sqrt(np.sum(change**2))) / problem.n


def _passed_saddle(rates: list[float], remnant: float) -> bool:
    """Return whether the motion, before it became faster again, was slower than the remnant might move it."""
    slowest, faster = rates[0], 0.0
    for rate in rates[1:]:
        slowest = min(slowest, rate)
        faster = max(faster, rate / slowest)
    return faster > 2.0 and slowest < SADDLE * remnant**2
