"""A branch of travelling states followed in one direction, step by step."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np
from scipy.optimize import brentq

from ...model.definitions import definition
from ...model.grid import Array
from ...model.parameters import Parameters
from .line import Complex, Line
from .linear import Inverse, Linearised
from .modes import NEUTRAL, modes
from .newton import LONGEST, TOLERANCE, largest, pair, phase, residual, size
from .torques import with_torques
from .travelling import TravellingState

Tangent = tuple[Complex, float, float]
"""A change of the state, of the drift and of v."""
ITERATIONS = 6
SHORTEST = 1e-3
"""Shortest step, relative to the longest."""
TURN = 0.9
"""Least cosine of the angle between the tangents at both ends of a step."""
NEARER = (0.1, 0.2, 0.3)
"""Distances from where stripes vanish, relative to that of a node, of the states that locate it."""
TAIL = 1e-2
"""The last moments, or waves of P, relative to the first, beyond which a state is unresolved."""
DIFFERENCE = 1e-5
"""Half the interval of the parameter, relative to its range, over which its effect is differenced."""
ACCURACY = 1e-4
"""Error of a located arc length, relative to the step."""


@dataclass(frozen=True, eq=False)
class Node:
    """A state a (N, p) with its drift V and the parameter's `value`, and the unit tangent (ta, tV, tv)."""

    a: Complex
    drift: float
    value: float
    residual: float
    tangent: Tangent
    rates: Complex

    @property
    def turned(self) -> Node:
        """The same node with the opposite tangent."""
        ta, tV, tv = self.tangent
        return replace(self, tangent=(-ta, -tV, -tv))


@dataclass(frozen=True, eq=False)
class Event:
    """What happens between two nodes."""

    kind: str
    value: float
    what: str
    frequency: float = 0.0


class Tracked:
    """The equations of travelling states over one parameter, with its range and numbers of unknowns."""

    def __init__(self, start: TravellingState, name: str, bounds: tuple[float, float], count: int) -> None:
        self.start, self.name, self.count, self.torques = start, name, count, start.torques
        self.low, self.high = bounds
        self.span = self.high - self.low
        allowed = definition("parameters", name)
        self.allowed = (allowed.minimum, allowed.maximum)
        self.line = lru_cache(maxsize=8)(self._line)

    def params(self, value: float) -> Parameters:
        """Return the parameters at a value of the one that changes."""
        return self.start.params.replace(**{self.name: value})

    def _line(self, value: float) -> Line:
        scaled = with_torques(self.params(value), self.torques)
        return Line(scaled, self.start.theta.size, len(self.start.moments) - 1)

    def first(self) -> Node:
        """Return the node of the state to start from, its tangent towards growing values."""
        line, value = self.line(self._at), self._at
        a = line.state(self.start.moments)
        zero = np.zeros_like(a)
        node = self.corrected(a, self.start.drift, value, (zero, 0.0, 1.0))
        assert node is not None
        node = node if node.tangent[2] >= 0 else node.turned
        return replace(node, rates=self.rates(node))

    @property
    def _at(self) -> float:
        return float(getattr(self.start.params, self.name))

    def corrected(self, a: Complex, drift: float, value: float, along: Tangent) -> Node | None:
        """Return the node in the plane through a guess across `along`, or None; its tangent is that way."""
        guess, place = (a, drift, value), phase(self.line(value), a)
        ta, tV, tv = along
        # <|P|²> counts δ_1 and δ_{-1}, which are conjugates, half each.
        across = np.zeros((2, *a.shape), dtype=np.complex128)
        across[:, 0] = 0.5 * np.conj(pair(ta)[:, 0])
        inverse: Inverse | None = None
        for iteration in range(ITERATIONS + 1):
            line = self.line(value)
            left = residual(line, a, drift)
            error = largest(line, left)
            if error < TOLERANCE and inverse is not None:
                found = _tangent(inverse)
                return Node(a, drift, value, error, found, np.zeros(0, dtype=np.complex128))
            if iteration == ITERATIONS or not np.isfinite(error):
                return None
            columns = [pair(line.slope(a)), pair(self._push(a, value))]
            square = np.array([[0.0, 0.0], [tV, tv]])
            operator = Linearised(line, a, drift)
            inverse = Inverse(operator, 0.0, columns, [place, across], square)
            moved = pair(a - guess[0])
            plane = np.sum(across * moved).real + tV * (drift - guess[1])
            plane += tv * (value - guess[2]) / self.span
            step, (faster, further) = inverse(-pair(left), [-np.sum(place * moved).real, -plane])
            if not np.all(np.isfinite(step)) or size(step[0]) > 4 * LONGEST:
                return None
            a, drift = a + step[0], drift + float(faster.real)
            value = float(np.clip(value + further.real * self.span, *self.allowed))
        return None

    def _push(self, a: Complex, value: float) -> Complex:
        step = DIFFERENCE * self.span
        low, high = (float(np.clip(value + way * step, *self.allowed)) for way in (-1, 1))
        return (self._line(high).rate(a) - self._line(low).rate(a)) * (self.span / (high - low))

    def rates(self, node: Node) -> Complex:
        """Return the leading growth rates, the rotation left out."""
        found = modes(self.line(node.value), node.a, node.drift, 0.0, self.count + 1)
        kept = [k for k in range(len(found.eigenvalues)) if k != found.rotation]
        return found.eigenvalues[kept][: self.count]


def _tangent(inverse: Inverse) -> Tangent:
    """Return the unit tangent by the equations whose last row is a tangent nearby."""
    x, (V, v) = inverse(np.zeros_like(inverse.operator.columns[..., 0]), [0.0, 1.0])
    found = (x[0], float(V.real), float(v.real))
    long = float(np.sqrt(product(found, found)))
    return (found[0] / long, found[1] / long, found[2] / long)


class Track:
    """One side of a first node: the `nodes` after it, what happens before some of them, and why it ends.

    `last` is the parameter where the branch ends if that is beyond the last node.
    """

    def __init__(self, tracked: Tracked, first: Node, longest: float, most: int) -> None:
        self.tracked, self.longest, self.most = tracked, longest, most
        self.nodes: list[Node] = []
        self.events: list[tuple[int, Event]] = []
        self.last: float | None = None
        self.end = self._follow(first)

    def _follow(self, node: Node) -> str:
        step = 0.5 * self.longest
        while True:
            room = self._room(node)
            if room <= 1e-12:
                return "this is the end of the range"
            if unresolved(node.a):
                return "its points or modes no longer resolve the state"
            if len(self.nodes) >= self.most:
                return f"the limit of {self.most} states is reached"
            if step < SHORTEST * self.longest:
                return "Newton's method finds no further state, however short the step"
            found = self._step(node, min(step, room), room <= step)
            if found is None:
                step = 0.5 * min(step, room)
                continue
            if shapes(node, found) <= 0:
                self.last = self._vanishing(node, found)
                return "here the stripes vanish into a uniform state"
            self.events += [(len(self.nodes) + 1, event) for event in self._between(node, found)]
            self.nodes.append(found)
            node, step = found, min(self.longest, 1.5 * step)

    def _room(self, node: Node) -> float:
        """Return the arc length, along the tangent, to the end of the range ahead."""
        speed = node.tangent[2]
        if speed == 0:
            return np.inf
        edge = self.tracked.high if speed > 0 else self.tracked.low
        return max(0.0, (edge - node.value) / self.tracked.span / speed)

    def _ahead(self, node: Node, step: float, to_edge: bool = False) -> Node | None:
        """Return the node a step ahead, without its growth rates."""
        tracked, (ta, tV, tv) = self.tracked, node.tangent
        along = (np.zeros_like(ta), 0.0, 1.0) if to_edge else node.tangent
        value = node.value + step * tv * tracked.span
        if to_edge:
            value = tracked.high if tv > 0 else tracked.low
        value = float(np.clip(value, *tracked.allowed))
        found = tracked.corrected(node.a + step * ta, node.drift + step * tV, value, along)
        if found is None:
            return None
        return found if product(found.tangent, node.tangent) >= 0 else found.turned

    def _step(self, node: Node, step: float, to_edge: bool) -> Node | None:
        found = self._ahead(node, step, to_edge)
        if found is None or product(found.tangent, node.tangent) < TURN:
            return None
        return replace(found, rates=self.tracked.rates(found))

    def _between(self, first: Node, last: Node) -> list[Event]:
        """Return the folds and changes of stability between two nodes, in order of discovery."""
        found: list[Event] = []
        whole = self._whole(first, last)
        turns = first.tangent[2] * last.tangent[2] < 0
        if turns:

            def speed(place: float) -> float:
                return self._at(first, last, place, whole).tangent[2]

            place = brentq(speed, 0.0, whole, xtol=ACCURACY * whole)
            node = self._at(first, last, place, whole)
            found.append(Event("fold", node.value, "here the parameter turns back"))
        growing = [int(np.sum(node.rates.real > NEUTRAL)) for node in (first, last)]
        changed = abs(growing[1] - growing[0])
        if changed and not (turns and changed == 1):
            share = _crossing(first.rates.real, last.rates.real, min(growing))
            value = first.value + share * (last.value - first.value)
            frequency = abs(float(last.rates[min(growing)].imag))
            kind = "Hopf point" if frequency > 1e-6 else "branch point"
            what = "an oscillation" if frequency > 1e-6 else "a perturbation"
            found.append(Event(kind, value, f"the growth rate of {what} changes sign", frequency))
        return found

    def _vanishing(self, first: Node, last: Node) -> float:
        """Return the parameter where stripes vanish: near there it is even in their amplitude."""
        ahead, behind = shapes(first, first), shapes(first, last)
        place = ahead / (ahead - behind) * self._whole(first, last)
        near = [self._at(first, last, (1 - share) * place, np.inf) for share in NEARER]
        squares = np.array([shapes(node, node) for node in near])
        powers = np.stack([np.ones(len(near)), squares, squares**2], axis=1)
        return float(np.linalg.solve(powers, [node.value for node in near])[0])

    def _whole(self, first: Node, last: Node) -> float:
        """Return the arc length between two nodes, along the tangent at the first."""
        step = (last.value - first.value) / self.tracked.span
        return product(first.tangent, (last.a - first.a, last.drift - first.drift, step))

    def _at(self, first: Node, last: Node, place: float, whole: float) -> Node:
        if place in (0.0, whole):
            return first if place == 0.0 else last
        found = self._ahead(first, place)
        return first if found is None else found


def _crossing(first: Array, last: Array, index: int) -> float:
    """Return the share of the step at which the rate of an index is zero, by linear interpolation."""
    low, high = float(first[index]), float(last[index])
    return float(np.clip(low / (low - high), 0.0, 1.0)) if low != high else 0.5


def product(x: Tangent, y: Tangent) -> float:
    """Return the scalar product whose square is |X|²."""
    return float(np.vdot(x[0][0], y[0][0]).real) + x[1] * y[1] + x[2] * y[2]


def shapes(x: Node, y: Node) -> float:
    """Return the scalar product of what varies of P in two nodes."""
    middle = x.a.shape[1] // 2
    return float(np.vdot(x.a[0], y.a[0]).real - (np.conj(x.a[0, middle]) * y.a[0, middle]).real)


def unresolved(a: Complex) -> bool:
    """Return whether the last moment, or the shortest wave of P, is too large."""
    sizes = np.sqrt(np.sum(np.abs(a) ** 2, axis=1))
    waves = np.abs(a[0])
    last = max(float(waves[0]), float(waves[-1]))
    return bool(sizes[-1] > TAIL * sizes[:2].max() or last > TAIL * waves.max())
