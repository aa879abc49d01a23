"""Points of a branch with the tangent and the growth rates there."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...model.grid import Array
from ..profiles.slowest import Vector, cutoff, leading, most_waves, settled
from ..profiles.steady import UNIFORM, rms
from .curve import Curve

NEUTRAL = 1e-10
"""Growth rates smaller than this are indistinguishable from zero."""
MOST_WAVES = 256
"""Most axial wavenumbers examined for each state of a branch."""


@dataclass(frozen=True, eq=False)
class Node:
    """A point X of a curve (see `curve`), its unit tangent and the growth rates of its perturbations.

    `along` (many,) are those of perturbations that do not vary along the cell, by decreasing real part, the
    neutral shift left out; `across` (waves,) is the leading one at each axial wavenumber 1, 2, ...;
    `residual` is that of the equations between the grid points.
    """

    X: Array
    tangent: Array
    along: Vector
    across: Vector
    residual: float

    @property
    def stable(self) -> bool:
        """Whether every perturbation decays, at a rate distinguishable from zero."""
        return bool(self.along[0].real < -NEUTRAL and np.all(self.across.real < -NEUTRAL))

    @property
    def unstable(self) -> int:
        """How many growth rates of the first kind are positive."""
        return int(np.sum(self.along.real > NEUTRAL))

    @property
    def undecided(self) -> int:
        """How many growth rates are indistinguishable from zero."""
        rates = np.concatenate([self.along, self.across])
        return int(np.sum(np.abs(rates.real) <= NEUTRAL))


class Linearisation:
    """The linearisation along a curve; `waves` says whether perturbations along the cell are included."""

    def __init__(self, curve: Curve, waves: bool) -> None:
        self.curve, self.waves = curve, waves

    def node(self, X: Array, like: Array | None) -> Node:
        """Return the `Node` at a point, its tangent pointing along `like`."""
        return self.with_tangent(X, self.curve.tangent(X, like))

    def with_tangent(self, X: Array, tangent: Array) -> Node:
        """Return the `Node` at a point whose tangent is known."""
        along = self.along(X)
        across = self.across(X) if self.waves else along[:0]
        return Node(X, tangent, along, across, self.curve.between(X))

    def along(self, X: Array) -> Vector:
        """Return the growth rates of perturbations that do not vary along the cell."""
        curve = self.curve
        slope = curve.slope(X[:-2])
        neutral = slope if rms(slope) > UNIFORM else None
        largest = cutoff(curve.at(curve.value(X)))
        return leading(curve.operator(X), curve.problem(curve.value(X)).k, largest, neutral)

    def across(self, X: Array, first: int = 1, last: int | None = None) -> Vector:
        """Return the leading growth rate of each axial wavenumber, in the co-moving frame.

        It stops once all larger wavenumbers are `settled`.
        """
        curve = self.curve
        params = curve.at(curve.value(X))
        problem, largest = curve.problem(curve.value(X)), cutoff(params)
        turning = X[-2] * curve.derivative if X[-2] else 0.0
        rates: list[complex] = []
        for j in range(first, (last or min(MOST_WAVES, most_waves(params, problem.wavenumber))) + 1):
            matrix = problem.waves(X[:-2], j) + turning
            rates.append(complex(leading(matrix, problem.k, largest)[0]))
            if settled(matrix, params.mu, j * problem.wavenumber):
                break
        return np.array(rates)
