"""Where something happens along a branch: folds, branch points, Hopf points.

Between two nodes a and b the branch is parametrised by the arc length σ along a's tangent. A quantity that
changes sign in between is located by Brent's method, with the equations solved at each value of σ:

* the parameter's part of the tangent: a fold, or, where the determinant of the equations bordered by the
  tangent changes sign too, the apex of a pitchfork: there the state has become symmetric, and beyond it
  the branch is its own mirror image;
* the j-th largest growth rate: a branch point if it is real, a Hopf point if it is one of a pair;
* the same for each axial wavenumber;
* the part of the state that varies: there stripes vanish into a uniform state.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq

from ...model.grid import Array
from ..profiles.steady import rms
from .points import NEUTRAL, Linearisation, Node

ACCURACY = 1e-7
"""Error of a located arc length, relative to that between the nodes."""
EVEN = 1e-3
"""The same where the parameter is an even function of the distance, so that its error is the square."""
SAME = 1e-2
"""Relative difference of arc lengths below which a fold and a zero eigenvalue are one event."""
REAL = 1e-6
"""Frequency below which an eigenvalue counts as real."""
BESIDE = 0.1
"""Distance from a turning point, relative to that between the nodes, at which both sides are compared."""
AMPLITUDES = (0.005, 0.01, 0.015, 0.02)
"""Distances from the place where stripes vanish of the states that locate it, smaller if node a is nearer."""


class LostError(Exception):
    """Newton's method lost the branch between two nodes."""


@dataclass(frozen=True, eq=False)
class Event:
    """What happens at a node between two others, at the arc length `place` behind the first.

    `what` is "fold", "apex", "vanish", "branch" or "Hopf"; `wave` the axial mode that it concerns, or 0, and
    `frequency` that of the critical perturbation.
    """

    what: str
    place: float
    node: Node
    frequency: float = 0.0
    wave: int = 0

    @property
    def last(self) -> bool:
        """Whether the branch ends here."""
        return self.what in ("apex", "vanish")


class Between:
    """The piece of a branch from node a to node b."""

    def __init__(self, linear: Linearisation, a: Node, b: Node) -> None:
        self.linear, self.curve, self.a, self.b = linear, linear.curve, a, b
        self.row = self.curve.weights * a.tangent
        self.whole = float(self.row @ (b.X - a.X))

    def events(self) -> list[Event]:
        """Return what happens in between, in order. Raises `LostError` where the branch is lost."""
        vanishing = self._vanishing()
        if vanishing is None:
            found = self._passed()
            ends = [i for i, event in enumerate(found) if event.last]
            return found[: ends[0] + 1] if ends else found
        if vanishing.place <= SAME * self.whole:
            return [vanishing]
        before = Between(self.linear, self.a, vanishing.node)._passed()
        near = (1 - SAME) * vanishing.place
        return [*(event for event in before if not event.last and event.place < near), vanishing]

    def _passed(self) -> list[Event]:
        turns = self._turns()
        found = turns + self._crossings([event.place for event in turns]) + self._waves()
        return sorted(found, key=lambda event: event.place)

    def _at(self, place: float) -> Array:
        guess = self.a.X + place / self.whole * (self.b.X - self.a.X)
        found = self.curve.correct(guess, self.a.X, self.row, 0.5 * max(self.whole, abs(place)), polish=True)
        if found is None:
            raise LostError
        return found[0]

    def _root(
        self, function: Callable[[Array], float], first: float, last: float, accuracy: float = ACCURACY
    ) -> float:
        """Return where a function of X is zero whose values at a and b have different signs."""

        def of_place(place: float) -> float:
            if place in (0.0, self.whole):
                return first if place == 0.0 else last
            return function(self._at(place))

        return float(brentq(of_place, 0.0, self.whole, xtol=accuracy * self.whole))

    def _event(self, what: str, place: float, frequency: float = 0.0, wave: int = 0) -> Event:
        return Event(what, place, self.linear.node(self._at(place), self.a.tangent), frequency, wave)

    def _vanishing(self) -> Event | None:
        """Return where stripes vanish, from states of small amplitude A: everything else is smooth in A²."""
        if not self.curve.varies or varying(self.a.X) @ varying(self.b.X) > 0:
            return None
        shape = varying(self.a.X)
        first, last = float(shape @ shape), float(shape @ varying(self.b.X))
        place = self.whole * first / (first - last)
        nearer = min(1.0, place / AMPLITUDES[-1])
        near = [self._at(place - nearer * distance) for distance in AMPLITUDES]
        square = np.array([rms(varying(X)) ** 2 for X in near])
        square /= square.max()
        powers = np.stack([square**0, square, square**2, square**3], axis=1)
        X = np.linalg.solve(powers, [np.append(uniform(X), X[-2:]) for X in near])[0]
        tangent = X - near[0]
        tangent[-2:] = 0.0
        node = self.linear.with_tangent(X, tangent / self.curve.length(tangent))
        return Event("vanish", float(self.row @ (X - self.a.X)), node, abs(float(X[-2])))

    def _turns(self) -> list[Event]:
        first, last = float(self.a.tangent[-1]), float(self.b.tangent[-1])
        if first * last >= 0:
            return []

        def speed(X: Array) -> float:
            return float(self.curve.tangent(X, self.a.tangent)[-1])

        place = self._root(speed, first, last, EVEN)
        if self._orientation(max(0.0, place - BESIDE * self.whole)) != self._orientation(
            min(self.whole, place + BESIDE * self.whole)
        ):
            return [self._event("apex", place)]
        return [self._event("fold", self._root(speed, first, last))]

    def _orientation(self, place: float) -> float:
        """Return the sign of the determinant of the equations bordered by the tangent."""
        X = self._at(place)
        tangent = self.curve.tangent(X, self.a.tangent)
        bordered = np.vstack([self.curve.matrix(X, self.a.X), self.curve.weights * tangent])
        return float(np.linalg.slogdet(bordered)[0])

    def _crossings(self, turns: list[float]) -> list[Event]:
        first, last = self.a.along.real, self.b.along.real
        low, high = sorted(int(np.sum(rates > 0)) for rates in (first, last))
        found: list[Event] = []
        for j in range(low, high):
            if min(abs(first[j]), abs(last[j])) < NEUTRAL:
                continue

            def growth(X: Array, j: int = j) -> float:
                return float(self.linear.along(X)[j].real)

            place = self._root(growth, float(first[j]), float(last[j]))
            if any(abs(place - turn) < SAME * self.whole for turn in turns):
                continue
            frequency = abs(float(self.linear.along(self._at(place))[j].imag))
            what, frequency = ("Hopf", frequency) if frequency > REAL else ("branch", 0.0)
            if any(abs(place - event.place) < SAME * self.whole and event.what == what for event in found):
                continue
            found.append(self._event(what, place, frequency=frequency))
        return found

    def _waves(self) -> list[Event]:
        found = []
        for j, (first, last) in enumerate(zip(self.a.across, self.b.across, strict=False), start=1):
            if first.real * last.real >= 0 or min(abs(first.real), abs(last.real)) < NEUTRAL:
                continue

            def growth(X: Array, j: int = j) -> float:
                return float(self.linear.across(X, j, j)[0].real)

            place = self._root(growth, first.real, last.real)
            frequency = abs(float(self.linear.across(self._at(place), j, j)[0].imag))
            what = "Hopf" if frequency > REAL else "branch"
            found.append(self._event(what, place, frequency=frequency, wave=j))
        return found


def uniform(X: Array) -> Array:
    """Return the mean of the state y (2n,) of a point, at every grid point."""
    both = X[:-2].reshape(2, -1)
    return np.repeat(both.mean(axis=1), both.shape[1])


def varying(X: Array) -> Array:
    """Return the state y (2n,) of a point less its mean."""
    return X[:-2] - uniform(X)
