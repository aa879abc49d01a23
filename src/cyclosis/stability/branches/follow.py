"""A branch continued in one direction, step by step."""

from __future__ import annotations

import numpy as np

from ..profiles.travelling import UNRESOLVED
from .events import Between, Event, LostError
from .points import Linearisation, Node

SHORTEST = 1e-4
"""Shortest step, relative to the longest."""
TURN = 0.9
"""Least cosine of the angle between the tangents at both ends of a step."""
ASIDE = 0.77
"""Part of a step taken instead of one that lands where a growth rate is indistinguishable from zero."""
EDGE = 1e-12
"""Distance from the end of the range, relative to it, at which it counts as reached."""


class Track:
    """One side of a first node: the `nodes` after it, and what happens at some of them.

    `events` are pairs of a node's number and its `Event`; `end` says why the track ends, and is None where
    the last event is the end. `low` and `high` bound the parameter, `longest` the steps, `most` the nodes.
    """

    def __init__(
        self, linear: Linearisation, first: Node, low: float, high: float, longest: float, most: int
    ) -> None:
        self.linear, self.curve, self.low, self.high = linear, linear.curve, low, high
        self.longest, self.most = longest, most
        self.nodes: list[Node] = []
        self.events: list[tuple[int, Event]] = []
        self.end: str | None = None
        self.away, self.closed = 0.0, False
        self._follow(first)

    def _follow(self, first: Node) -> None:
        node, step = first, 0.5 * self.longest
        while True:
            room = self._room(node)
            if room <= EDGE:
                self.end = "this is the end of the range"
            elif node.residual > UNRESOLVED:
                self.end = f"{self.curve.n} points around the axis no longer resolve the state"
            elif self._returned(first, node):
                self.closed = True
                self.end = "the branch has closed upon itself"
            elif len(self.nodes) >= self.most:
                self.end = f"the limit of {self.most} points is reached"
            elif step < SHORTEST * self.longest:
                self.end = "Newton's method finds no further state, however short the step"
            if self.end is not None:
                return
            taken = self._step(node, min(step, room), room <= step)
            if taken is None:
                step = 0.5 * min(step, room)
                continue
            found, iterations, events = taken
            for event in events:
                self.events.append((len(self.nodes), event))
                self.nodes.append(event.node)
            if events and events[-1].last:
                return
            self.nodes.append(found)
            node = found
            step = min(self.longest, step * (1.5 if iterations <= 2 else 0.7 if iterations > 3 else 1.0))

    def _returned(self, first: Node, node: Node) -> bool:
        """Return whether the track has left its first node and come back to it."""
        self.away = max(self.away, abs(float(node.X[-1] - first.X[-1])))
        ahead = node.tangent[-1] * first.tangent[-1] >= 0
        return self.away > 2 * self.longest and ahead and self.curve.apart(node.X, first.X) <= self.longest

    def _room(self, node: Node) -> float:
        """Return the arc length, along the tangent, to the end of the range ahead."""
        speed = float(node.tangent[-1])
        if speed == 0:
            return np.inf
        edge = (self.high if speed > 0 else self.low) / self.curve.span
        return max(0.0, float((edge - node.X[-1]) / speed))

    def _step(
        self, node: Node, step: float, to_edge: bool, again: bool = False
    ) -> tuple[Node, int, list[Event]] | None:
        """Return the node one step ahead, the iterations it took and what happens in between, or None."""
        curve, tangent = self.curve, node.tangent
        row = curve.weights * tangent
        if to_edge:
            row = np.append(np.zeros(row.size - 1), 1.0)
        corrected = curve.correct(node.X + step * tangent, node.X, row, step)
        if corrected is None:
            return None
        X, iterations = corrected
        found = self.linear.node(X, tangent)
        if not np.sum(curve.weights * tangent * found.tangent) >= TURN:
            return None
        if not again and not to_edge and found.undecided > node.undecided:
            return self._step(node, ASIDE * step, False, True)
        try:
            return found, iterations, Between(self.linear, node, found).events()
        except LostError:
            return None
