"""Travelling states of the one-dimensional kinetic equation, by Newton's method.

The unknowns are a state a and its drift V in da/dt + V a' = 0. Its place is fixed by requiring that it has
not moved from the first guess: <guess', a - guess> = 0. Every step is an exact solution (see `linear`).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .line import Complex, Line, mirrored
from .linear import Inverse, Linearised

TOLERANCE = 1e-11
"""Largest |da/dt + V a'|, over moments and points, of a state that counts as found."""
ITERATIONS = 12
LONGEST = 0.5
"""Longest step, root mean square of all moments, which keeps Newton's method near its guess."""
EVEN = 1e-7
"""Root mean square slope below which a state counts as uniform."""


@dataclass(frozen=True, eq=False)
class Found:
    """A state a (N, p) that moves at the speed `drift`; `residual` is the largest |da/dt + V a'|."""

    a: Complex
    drift: float
    residual: float


def residual(line: Line, a: Complex, drift: float) -> Complex:
    """Return da/dt + V a' (N, p)."""
    return line.rate(a) + drift * line.slope(a)


def largest(line: Line, a: Complex) -> float:
    """Return the largest value of amplitudes (N, p) at the points, over all moments."""
    return float(np.abs(a @ line.waves.T).max())


def pair(a: Complex) -> Complex:
    """Return real perturbations (N, p), which are the same for m_n and m_n*, as a pair (2, N, p)."""
    return np.stack([a, mirrored(a)])


def size(a: Complex) -> float:
    """Return the root mean square over theta of all moments together."""
    return float(np.sqrt(np.sum(np.abs(a) ** 2)))


def travelling(line: Line, guess: Complex, drift: float = 0.0) -> Found | None:
    """Return the travelling state next to a guess (N, p), or None where Newton's method finds none there."""
    a = guess
    place = phase(line, guess)
    for _ in range(ITERATIONS):
        left = residual(line, a, drift)
        error = largest(line, left)
        if error < TOLERANCE:
            return Found(a, drift, error)
        operator = Linearised(line, a, drift)
        inverse = Inverse(operator, 0.0, [pair(line.slope(a))], [place])
        moved = float(np.sum(place * pair(a - guess)).real)
        step, faster = inverse(-pair(left), [-moved])
        if not np.all(np.isfinite(step)) or size(step[0]) > LONGEST:
            return None
        a, drift = a + 0.5 * (step[0] + mirrored(step[1])), drift + float(faster[0].real)
    return None


def phase(line: Line, a: Complex) -> Complex:
    """Return the row (2, N, p) that gives the shift of a perturbation along theta, of a state that varies."""
    slope = line.slope(a)
    row = np.conj(pair(slope))
    return np.asarray(row / max(2 * size(slope) ** 2, EVEN**2), dtype=np.complex128)
