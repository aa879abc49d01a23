"""Stable steady states of one parameter point, and what it takes to be sure of ending in one of them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from ..analysis.regimes import regime
from ..model.grid import Array, CylinderGrid, interpolate
from ..model.parameters import Parameters
from ..stability.reduced import Reduced, reduced
from ..stability.spectrum import Spectrum, along, spectrum
from ..stability.steady import Steady, rms, steady

REMNANT = 0.1
"""Largest square of what is neglected, in units of the slowest decay rate: its effect stays below a tenth."""
SLOW_LIMIT = 0.3
"""Largest amplitude of the slowest mode."""
SLOW_DEFECT = 0.5
"""Largest part of the slowest mode's motion that linear theory does not give: a saddle is twice as far."""
SLOW_FLOOR = 0.01
"""Amplitude of the slowest mode below which its motion needs no check."""
SAME = 1e-3
"""Root mean square difference below which two steady states are the same."""
REFINED = 1.5
"""Factor of the finer grid on which a steady state must be found again, and found stable."""
ALIKE = 0.05
"""Root mean square difference that the finer grid may make."""
MARGIN = 1e-5
"""Least decay rate there: what decays more slowly is not told from what does not decay at all."""


@dataclass(frozen=True, eq=False)
class Attractor:
    """A steady (or steadily drifting) state that is uniform along an axis, its spectrum, and its regime."""

    problem: Reduced
    steady: Steady
    spectrum: Spectrum
    regime: str
    confirmed: bool

    @property
    def stable(self) -> bool:
        """Whether every small perturbation decays, on this grid and on the finer one."""
        return self.spectrum.growth < 0 and self.confirmed

    def shift(self, y: Array) -> float:
        """Return the distance by which y must be moved to lie best upon this state."""
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
        """Return the root mean square distance of y, best moved, from this state."""
        return rms(self.problem.shifted(y, self.shift(y)) - self.steady.y)

    def captures(self, y: Array, uneven: float) -> bool:
        """Return whether a state with the mean y, and `uneven` the size of what varies across, must end here.

        Sure of it makes: all but the slowest mode is so weak that its second-order effect, at most its
        square, is small beside the slowest decay; and along the slowest mode the state already comes in
        as linear theory has it, so that nothing stands between it and this state.
        """
        if not self.stable:
            return False
        moved = self.problem.shifted(y, self.shift(y))
        offset = moved - self.steady.y
        mode = self.spectrum.slowest
        slow = complex(mode.left @ offset)
        share = slow * mode.right
        if mode.eigenvalue.imag != 0:
            share = 2 * share
        rest = rms(offset - share.real)
        decay = -self.spectrum.growth
        if rest**2 + uneven**2 > REMNANT * decay or abs(slow) > SLOW_LIMIT:
            return False
        motion = self.problem.rate(moved) + self.steady.drift * self.problem.slope(moved)
        defect = abs(complex(mode.left @ motion) - mode.eigenvalue * slow)
        return defect <= -mode.eigenvalue.real * max(SLOW_DEFECT * abs(slow), SLOW_FLOOR)


def attractor(
    params: Parameters, grid: CylinderGrid, problem: Reduced, state: Steady, **options: Any
) -> Attractor:
    """Return what there is to know of a steady state; `options` are those of its `Reduced` equation."""
    waves = (grid.shape[problem.axis] - 1) // 2
    name = regime(params, grid, problem.state(state.y, grid)).name
    rates = spectrum(problem, state, waves)
    sure = rates.growth < 0 and _confirmed(params, grid, problem, state, options)
    return Attractor(problem, state, rates, name, sure)


def _confirmed(
    params: Parameters, grid: CylinderGrid, problem: Reduced, state: Steady, options: dict[str, Any]
) -> bool:
    """Return whether a state is steady and stable on a finer grid too.

    A coarse grid pins zones: stripes of unequal widths that the equations would let drift stand still on it.
    """
    if state.uniform:
        return True
    n = 2 * round(0.5 * REFINED * problem.n)
    shape, fine = (grid.n_theta, n), (1, n)
    if problem.axis == 1:
        shape, fine = (n, grid.n_z), (n, 1)
    finer = reduced(params, grid.resized(*shape), problem.axis, **options)
    both = np.expand_dims(state.y.reshape(2, -1), 1 + problem.axis)
    found = steady(finer, interpolate(both, fine).ravel())
    if found is None:
        return False
    back = interpolate(np.expand_dims(found.y.reshape(2, -1), 1 + problem.axis), both.shape[1:])
    if rms(back.ravel() - state.y) > ALIKE:
        return False
    return bool(along(finer, found)[0][0].real < -MARGIN)
