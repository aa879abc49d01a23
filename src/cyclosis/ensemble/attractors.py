"""Stable steady states of one parameter point, and sufficient conditions for a state to end in one."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from ..analysis.regimes import regime
from ..contract.model import Problem
from ..model.grid import Array, interpolate
from ..stability.profiles.growth import GrowthRates, growth_along, rates_about
from ..stability.profiles.reduced import Reduced, reduced_of
from ..stability.profiles.steady import Steady, rms, steady

TILTED = 0.1
"""Mean of the component across the stripes above which they count as tilted."""
FULL, LEAN = 0.9, 0.5


class Kind(NamedTuple):
    """The appearance of a state: the number of sign changes of its stronger component, and which one that is.

    `sign` is the sign of its mean if it has no stripes; `lean` that of the other component's mean, 0 if weak.
    """

    stripes: int
    component: int
    sign: int
    lean: int


def kind(problem: Reduced, y: Array) -> Kind:
    """Return the `Kind` of a state y (2n,)."""
    both = y.reshape(2, problem.n)
    component = int(np.sum(both[1] ** 2) >= np.sum(both[0] ** 2))
    main, other = both[component], both[1 - component]
    up = main > 0
    stripes = int(np.sum(up != np.roll(up, 1)))
    mean = float(other.mean())
    lean = int(np.sign(mean)) if abs(mean) > TILTED else 0
    return Kind(stripes, component, 0 if stripes else int(np.sign(main.mean())), lean)


def standard_state(problem: Reduced, of: Kind) -> Array:
    """Return a state of this kind: uniform, or with equal stripes."""
    x = problem.turn / problem.n * np.arange(problem.n)
    both = np.zeros((2, problem.n))
    wave = 2 * np.pi / problem.turn * x
    both[of.component] = FULL * (np.tanh(3 * np.sin(of.stripes / 2 * wave)) if of.stripes else of.sign)
    both[1 - of.component] = LEAN * of.lean
    return (both / np.maximum(1.0, np.hypot(*both) / FULL)).ravel()


REMNANT = 0.1
"""Largest square of the neglected part, in units of the slowest decay rate: its effect is below a tenth."""
SLOW_LIMIT = 0.3
"""Largest amplitude of the slowest mode."""
SLOW_DEFECT = 0.5
"""Largest part of the slowest mode's motion not given by linear theory: a saddle is twice as far."""
SLOW_FLOOR = 0.01
"""Amplitude of the slowest mode below which its motion is not checked."""
SAME = 1e-3
"""Root mean square difference below which two steady states are the same."""
REFINED = 1.5
"""Refinement factor of the finer grid on which a steady state must exist and be stable too."""
ALIKE = 0.05
"""Largest root mean square difference between the states on the two grids."""
MARGIN = 1e-5
"""Smallest decay rate on the finer grid: slower decay cannot be distinguished from none."""


@dataclass(frozen=True, eq=False)
class Attractor:
    """A steady or drifting state that is uniform along an axis, the growth rates about it, and its regime."""

    problem: Reduced
    steady: Steady
    rates: GrowthRates
    regime: str
    confirmed: bool

    @property
    def stable(self) -> bool:
        """Whether every small perturbation decays, on this grid and on the finer one."""
        return self.rates.growth < 0 and self.confirmed

    def shift(self, y: Array) -> float:
        """Return the distance by which y must be shifted to fit this state best."""
        if self.steady.uniform:
            return 0.0
        problem = self.problem
        product = np.conj(problem.packed(self.steady.y)) * problem.packed(y)
        fine = 16 * problem.n
        padded = np.zeros(fine, dtype=complex)
        index = np.rint(problem.k * problem.turn / (2 * np.pi)).astype(int)
        padded[index] = product
        distance = float(np.argmax(np.fft.fft(padded).real)) * problem.turn / fine
        for _ in range(3):
            wave = product * np.exp(-1j * problem.k * distance)
            slope, bend = np.sum(problem.k * wave.imag), -np.sum(problem.k**2 * wave.real)
            if bend < 0:
                distance -= float(slope / bend)
        return distance

    def distance(self, y: Array) -> float:
        """Return the root mean square distance of y from this state, after the best shift."""
        return rms(self.problem.shifted(y, self.shift(y)) - self.steady.y)

    def captures(self, y: Array, uneven: float) -> bool:
        """Return whether a state with mean y, and a part of size `uneven` that varies across, must end here.

        Sufficient conditions: everything but the slowest mode is so weak that its second-order effect, at
        most its square, is small compared with the slowest decay; and along the slowest mode the state
        already approaches as in linear theory, so that there is no saddle between it and this state.
        """
        if not self.stable:
            return False
        moved = self.problem.shifted(y, self.shift(y))
        offset = moved - self.steady.y
        mode = self.rates.slowest
        slow = complex(mode.left @ offset)
        share = slow * mode.right
        if mode.eigenvalue.imag != 0:
            share = 2 * share
        rest = rms(offset - share.real)
        decay = -self.rates.growth
        if rest**2 + uneven**2 > REMNANT * decay or abs(slow) > SLOW_LIMIT:
            return False
        motion = self.problem.rate(moved) + self.steady.drift * self.problem.slope(moved)
        defect = abs(complex(mode.left @ motion) - mode.eigenvalue * slow)
        return defect <= -mode.eigenvalue.real * max(SLOW_DEFECT * abs(slow), SLOW_FLOOR)


def attractor(cell: Problem, line: Reduced, state: Steady) -> Attractor:
    """Return the `Attractor` of a steady state of a cell; `line` is its `Reduced` equation."""
    grid = cell.grid
    waves = (grid.shape[line.axis] - 1) // 2
    name = regime(cell.params, grid, line.state(state.y, grid)).name
    rates = rates_about(line, state, waves)
    sure = rates.growth < 0 and _confirmed(cell, line, state)
    return Attractor(line, state, rates, name, sure)


def _confirmed(cell: Problem, line: Reduced, state: Steady) -> bool:
    """Return whether a state is steady and stable on a finer grid too.

    A coarse grid pins zones: stripes of unequal widths that would drift in the equations are steady on it.
    """
    if state.uniform:
        return True
    n = 2 * round(0.5 * REFINED * line.n)
    shape, fine = (cell.grid.n_theta, n), (1, n)
    if line.axis == 1:
        shape, fine = (n, cell.grid.n_z), (n, 1)
    finer = reduced_of(replace(cell, grid=cell.grid.resized(*shape)), line.axis)
    both = np.expand_dims(state.y.reshape(2, -1), 1 + line.axis)
    found = steady(finer, interpolate(both, fine).ravel())
    if found is None:
        return False
    back = interpolate(np.expand_dims(found.y.reshape(2, -1), 1 + line.axis), both.shape[1:])
    if rms(back.ravel() - state.y) > ALIKE:
        return False
    return growth_along(finer, found) < -MARGIN
