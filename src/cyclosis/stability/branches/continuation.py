"""Branches of steady and steadily drifting states, by pseudo-arclength continuation.

From a point X of the curve (see `curve`) a step of length s along the unit tangent t is corrected by Newton's
method on the equations and t · (X_new - X) = s, so that folds, where the parameter turns back, are points
like any others. Steps grow where two corrections are enough, shrink where more than three are needed, and
are repeated at half the length where the tangent turns by more than 25 degrees. `events` finds the special
points between any two of these.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from ...model.definitions import definition
from ...model.doors import door
from ...model.errors import InputError, choice, number, whole
from ...model.grid import Array, CylinderGrid, interpolate
from ...model.parameters import Parameters
from ..profiles.slowest import Vector, most_waves
from ..profiles.steady import UNIFORM, rms
from ..profiles.travelling import LENGTH, flow
from .branch import Branch
from .curve import Curve
from .descriptions import end_point, special_point
from .follow import Track
from .points import MOST_WAVES, Linearisation, Node

NUMBERS = ("alpha_p", "alpha_u", "epsilon", "d_s", "d_r", "kappa", "mu", "repulsion_angle", "force_exponent")
FINER = 4
"""Points among which maxima are sought, for each point of the grid."""
NEAR = 0.1
"""Root mean square distance from the state to start from within which a steady state must lie."""


@door
def continue_branch(
    start: Any,
    parameter: str,
    bounds: Sequence[float],
    length: float | None = LENGTH,
    count: int = 8,
    longest: float = 0.02,
    most: int = 2000,
) -> Branch:
    """Return the branch of states through `start` as one parameter varies, in both directions from it.

    `start` is a `Profile`, a `Drifting` state or anything else with `theta`, `P` (n_theta,) or (2, n_theta),
    `params` and, if it drifts, `drift`. `parameter` is any of `Parameters` that is a number. The branch ends
    where the parameter leaves `bounds` (low, high), where stripes vanish into a uniform state, where it
    would continue as its own mirror image, where the grid does not resolve it, or after `most` points a side.
    Growth rates are given for `count` perturbations that do not vary along the cell and for waves along a
    cell of this `length`, in radii, unless it is None. `longest` is the longest step: the root mean square
    change of P together with that of the parameter relative to its whole range.

    Raises `InputError` for fields and for anything that is not such a parameter, range or steady state.

    Example:
        >>> import cyclosis as cy
        >>> state = cy.stability.cyclosis(cy.Parameters(alpha_p=0.3), n_theta=64)
        >>> branch = cy.stability.continue_branch(state, "alpha_u", (0.4, 0.6), length=None, longest=0.1)
        >>> branch.points[-1].sentence, bool(branch.stable.all())
        ('End at alpha_u = 0.6: this is the end of the range.', True)
    """
    params, y, drift = _started(start)
    low, high = _range(params, parameter, bounds)
    longest = number("longest", longest, 1e-5, 1.0, "the default is 0.02")
    count = whole("count", count, 1, 10_000, "the default is 8")
    most = whole("most", most, 1, 10**6, "the default is 2000")
    varies = rms(y - np.repeat(y.reshape(2, -1).mean(axis=1), y.size // 2)) > UNIFORM
    grid = _grid(params, parameter, (low, high), y.size // 2, length)
    curve = Curve(params, parameter, grid, high - low, varies)
    linear = Linearisation(curve, length is not None)
    first = _begin(linear, y, drift)
    forth = Track(linear, first, low, high, longest, most)
    back = None if forth.closed else Track(linear, _turned(first, -1.0), low, high, longest, most)
    return _branch(linear, first, back, forth, count, length)


def _started(start: Any) -> tuple[Parameters, Array, float]:
    params, P = getattr(start, "params", None), np.asarray(getattr(start, "P", None))
    theta = np.asarray(getattr(start, "theta", None))
    usable = isinstance(params, Parameters) and P.dtype.kind == "f" and theta.ndim == 1 and theta.size >= 16
    if not usable or P.shape not in (theta.shape, (2, theta.size)):
        rule = "a Profile, a Drifting state or the like with theta, P and params"
        raise InputError("start", start, rule, "make one by cyclosis(params) or drifting(params)")
    assert isinstance(params, Parameters)
    for name, value in params.items():
        if isinstance(value, np.ndarray):
            raise InputError(name, value, "one number for a branch", "simulate a cell with fields instead")
    both = P if P.ndim == 2 else np.stack([np.zeros_like(P), P])
    return params, np.asarray(both.ravel(), dtype=np.float64), float(getattr(start, "drift", 0.0))


def _range(params: Parameters, parameter: str, bounds: Sequence[float]) -> tuple[float, float]:
    choice("parameter", parameter, NUMBERS)
    allowed = definition("parameters", parameter)
    try:
        low, high = (number("bounds", b, allowed.minimum, allowed.maximum, "change it") for b in bounds)
    except (TypeError, ValueError) as error:
        if isinstance(error, InputError):
            raise
        raise InputError("bounds", bounds, "two numbers (low, high)", "give both ends") from error
    here = getattr(params, parameter)
    if not low < high or not low <= here <= high:
        rule = f"(low, high) with low < high and {parameter} = {here!r} of the start between them"
        raise InputError("bounds", (low, high), rule, "widen them or start elsewhere")
    return low, high


def _grid(
    params: Parameters, parameter: str, bounds: tuple[float, float], n: int, length: Any
) -> CylinderGrid:
    """Return a grid with room for every axial wavenumber that is examined."""
    line = CylinderGrid(n, 8, LENGTH if length is None else length)
    if length is None:
        return line
    spacing = 2 * np.pi / line.length
    most = max(most_waves(params.replace(**{parameter: value}), spacing) for value in bounds)
    waves = min(MOST_WAVES, most)
    return line.resized(n, max(8, 2 * waves + 2))


def _begin(linear: Linearisation, y: Array, drift: float) -> Node:
    """Return the first node, at the parameter's value of the start."""
    curve = linear.curve
    guess = curve.point(y, drift, float(getattr(curve.params, curve.name)))
    fixed = np.append(np.zeros(guess.size - 1), 1.0)
    found = curve.correct(guess, guess, fixed, NEAR)
    if found is None:
        rule = f"steady, or steadily drifting, to within {NEAR:g}"
        raise InputError("start", "this state", rule, "let it relax, or use more points")
    return linear.node(found[0], None)


def _turned(node: Node, way: float) -> Node:
    return replace(node, tangent=way * node.tangent)


def _branch(
    linear: Linearisation, first: Node, back: Track | None, forth: Track, count: int, length: float | None
) -> Branch:
    """Return the branch from one end, through the first node, to the other."""
    curve = linear.curve
    behind = back.nodes if back is not None else []
    nodes, start = [*reversed(behind), first, *forth.nodes], len(behind)
    points = []
    for track, way in ((back, -1), (forth, 1)):
        if track is None:
            continue
        points += [special_point(curve, event, start + way * (1 + i)) for i, event in track.events]
        if track.end is not None:
            index = start + way * len(track.nodes)
            points.append(end_point(curve, curve.value(nodes[index].X), index, track.end))
    points.sort(key=lambda point: point.index)
    value = np.array([curve.value(node.X) for node in nodes])
    states = np.array([node.X[:-2].reshape(2, curve.n) for node in nodes])
    return Branch(
        curve.name,
        value,
        curve.grid.theta,
        states,
        np.array([node.X[-2] for node in nodes]),
        _table([node.along[:count] for node in nodes]),
        _table([node.across for node in nodes]),
        np.array([node.stable for node in nodes]),
        np.array([node.unstable for node in nodes]),
        np.array([node.residual for node in nodes]),
        _measures(curve, value, states),
        points,
        start,
        curve.params,
        (forth.low, forth.high),
        length,
    )


def _table(rows: list[Vector]) -> Vector:
    """Return rows of different lengths as one array, NaN where they are too short."""
    found = np.full((len(rows), max(row.size for row in rows)), np.nan, dtype=np.complex128)
    for place, row in zip(found, rows, strict=True):
        place[: row.size] = row
    return found


def _measures(curve: Curve, value: Array, states: Array) -> dict[str, Array]:
    """Return numbers of each state; the largest |P| and |u| are those of its interpolant."""
    flows = np.array([flow(curve.problem(float(v)), y.ravel()) for v, y in zip(value, states, strict=True)])
    order, speed = (np.hypot(*np.moveaxis(_finer(fields), 1, 0)) for fields in (states, flows))
    return {
        "max_P": order.max(axis=1),
        "max_u": speed.max(axis=1),
        "mean_P_theta": states[:, 0].mean(axis=1),
        "mean_P_z": states[:, 1].mean(axis=1),
        "rms_P": np.sqrt(np.mean(order**2, axis=1)),
        "rms_u": np.sqrt(np.mean(speed**2, axis=1)),
    }


def _finer(fields: Array) -> Array:
    """Return periodic fields (points, 2, n) on four times as many points."""
    return interpolate(fields[..., None], (FINER * fields.shape[-1], 1))[..., 0]
