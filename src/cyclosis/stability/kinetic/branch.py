"""Branches of travelling states of the kinetic model over one parameter, by pseudo-arclength continuation.

A point is X = (a, V, v): the moments, the drift, and v = λ/Λ with λ the parameter and Λ its range's width. A
step of length s along the unit tangent, in |X|² = <|P|²> + V² + v², is corrected by Newton's method on the
equations of `newton` and on t · (X_new - X) = s, so that a fold, where the parameter turns back, is a point
like any other. Every step is an exact solution of the bordered linear equations (see `linear`).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from ...display.shown import shown
from ...model.definitions import definition
from ...model.doors import door
from ...model.errors import InputError, choice, number, whole
from ...model.grid import Array
from ..branches.branch import SpecialPoint
from ..branches.continuation import NUMBERS
from .line import Complex
from .modes import NEUTRAL
from .track import Node, Track, Tracked
from .travelling import TravellingState, value

if TYPE_CHECKING:
    import xarray


@shown
@dataclass(frozen=True, eq=False)
class KineticBranch:
    """Travelling states over one parameter, in order along the branch, dimensionless.

    `parameter` and `drift` (points,) belong to `states` (points,), a list of `TravellingState`.
    `eigenvalues` (points, count) are the growth rates of perturbations that do not vary along the cell, the
    largest real part first, the rotation left out (NaN beyond those found); `stable` (points,) says where all
    of them decay. `points` lists folds, changes of stability between two states ("branch point", "Hopf
    point"), and both ends with the reason, as `SpecialPoint`. `start` is the index of the first state.

    Example:
        >>> import cyclosis as cy
        >>> params = cy.Parameters(kappa=0.1, d_r=0.1, d_s=0.05)
        >>> state = cy.kinetic.travelling_state(params, n_theta=16, modes=12)
        >>> branch = cy.kinetic.continuation(state, "alpha_u", (0.45, 0.5), longest=0.3, count=2)
        >>> len(branch.states) == branch.parameter.size, dict(branch.to_dataset().sizes)["special"]
        (True, 2)
        >>> len(branch.of("end"))
        2
    """

    name: str
    parameter: Array
    drift: Array
    states: list[TravellingState]
    eigenvalues: Complex
    stable: npt.NDArray[np.bool_]
    points: list[SpecialPoint]
    start: int

    def of(self, kind: str) -> list[SpecialPoint]:
        """Return the special points of a kind."""
        return [point for point in self.points if point.kind == kind]

    def to_dataset(self) -> xarray.Dataset:
        """Return the branch as an `xarray.Dataset` over `point`, special points over `special`."""
        import xarray

        first = self.states[self.start]
        along = ("point", "component", "theta")
        data: dict[str, Any] = {
            "P": (along, np.stack([state.P for state in self.states])),
            "u": (along, np.stack([state.u for state in self.states])),
            "drift": ("point", self.drift),
            "growth": (("point", "rate"), self.eigenvalues.real),
            "frequency": (("point", "rate"), self.eigenvalues.imag),
            "stable": ("point", self.stable),
            "between": ("point", [state.between for state in self.states]),
        }
        for key in ("kind", "value", "index", "sentence", "ends"):
            data[f"special_{key}"] = ("special", [getattr(point, key) for point in self.points])
        others = {name: float(number) for name, number in first.params.items() if name != self.name}
        return xarray.Dataset(
            data,
            coords={
                self.name: ("point", self.parameter),
                "theta": first.theta,
                "component": ["theta", "z"],
            },
            attrs={"parameter": self.name, "torques": first.torques, **others},
        )

    def __str__(self) -> str:
        low, high = self.parameter.min(), self.parameter.max()
        head = f"{self.parameter.size} travelling states over {self.name} = {low:.6g} to {high:.6g}, "
        return "\n".join(
            [f"{head}{int(self.stable.sum())} of them stable.", *(p.sentence for p in self.points)]
        )


@door
def continuation(
    start: TravellingState,
    parameter: str,
    bounds: Sequence[float],
    count: int = 4,
    longest: float = 0.1,
    most: int = 200,
) -> KineticBranch:
    """Return the `KineticBranch` through a travelling state as one parameter varies, both ways from it.

    `parameter` is any of `Parameters` that is a number. The branch ends where the parameter leaves `bounds`
    (low, high), where the stripes vanish, where points or modes no longer resolve the state, where Newton's
    method finds no further one, or after `most` states a side; the last of `points` says why. Growth rates
    are given for `count` perturbations besides the rotation. `longest` is the longest step: the root mean
    square change of P together with that of the parameter relative to its range. Raises `InputError` for
    anything that is not such a state, parameter or range.

    Example:
        >>> import cyclosis as cy
        >>> params = cy.Parameters(kappa=0.1, d_r=0.1, d_s=0.05)
        >>> state = cy.kinetic.travelling_state(params, n_theta=16, modes=12)
        >>> branch = cy.kinetic.continuation(state, "kappa", (0.09, 0.1), longest=0.3, count=2)
        >>> bool(branch.stable.all()), branch.of("end")[0].sentence
        (True, 'End at kappa = 0.09: this is the end of the range.')
    """
    if not isinstance(start, TravellingState):
        raise InputError("start", start, "a TravellingState", "make one by cyclosis.kinetic.travelling_state")
    low, high = _range(start, parameter, bounds)
    count = whole("count", count, 1, 50, "the default is 4")
    longest = number("longest", longest, 1e-4, 1.0, "the default is 0.1")
    most = whole("most", most, 1, 10**5, "the default is 200")
    tracked = Tracked(start, parameter, (low, high), count)
    first = tracked.first()
    forth = Track(tracked, first, longest, most)
    back = Track(tracked, first.turned, longest, most)
    return _branch(tracked, back, first, forth)


def _branch(tracked: Tracked, back: Track, first: Node, forth: Track) -> KineticBranch:
    nodes = [*back.nodes[::-1], first, *forth.nodes]
    begin = len(back.nodes)
    points = [_end(tracked, nodes[0], 0, back)]
    events = [(begin - i, event) for i, event in back.events[::-1]]
    events += [(begin + i, event) for i, event in forth.events]
    for index, event in events:
        sentence = f"{event.kind.capitalize()} at {tracked.name} = {event.value:.8g}: {event.what}."
        points.append(SpecialPoint(event.kind, event.value, index, sentence, 0, event.frequency))
    points.append(_end(tracked, nodes[-1], len(nodes) - 1, forth))
    rates = np.full((len(nodes), tracked.count), np.nan, dtype=np.complex128)
    states = []
    for k, node in enumerate(nodes):
        rates[k, : len(node.rates)] = node.rates[: tracked.count]
        params = tracked.params(node.value)
        left = (node.drift, node.residual, params, tracked.torques)
        states.append(value(tracked.line(node.value), node.a, *left))
    return KineticBranch(
        tracked.name,
        np.array([node.value for node in nodes]),
        np.array([node.drift for node in nodes]),
        states,
        rates,
        np.array([bool(np.all(node.rates.real < -NEUTRAL)) for node in nodes]),
        points,
        begin,
    )


def _end(tracked: Tracked, node: Node, index: int, track: Track) -> SpecialPoint:
    at = node.value if track.last is None else track.last
    return SpecialPoint("end", at, index, f"End at {tracked.name} = {at:.8g}: {track.end}.", ends=True)


def _range(start: TravellingState, parameter: str, bounds: Sequence[float]) -> tuple[float, float]:
    choice("parameter", parameter, NUMBERS)
    try:
        low, high = (float(each) for each in bounds)
    except (TypeError, ValueError) as error:
        raise InputError("bounds", bounds, "two numbers (low, high)", "write both") from error
    allowed, at = definition("parameters", parameter), float(getattr(start.params, parameter))
    if not (allowed.minimum <= low < high <= allowed.maximum):
        rule = f"two numbers low < high within {allowed.minimum:g} to {allowed.maximum:g}"
        raise InputError("bounds", (low, high), rule, "change them")
    if not low <= at <= high:
        raise InputError("bounds", (low, high), f"a range that holds {parameter} = {at:g}", "widen it")
    return low, high
