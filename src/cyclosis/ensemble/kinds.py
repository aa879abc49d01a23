"""Kinds of states that are uniform along one axis, and a standard state of each to start from."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..model.grid import Array
from ..stability.reduced import Reduced

TILTED = 0.1
"""Mean of the component across the stripes beyond which they count as tilted."""
FULL, LEAN = 0.9, 0.5


class Kind(NamedTuple):
    """How a state looks: sign changes of its stronger component, and which of the two that is.

    `sign` is that of its mean where it has no stripes; `lean` that of the other component's mean, 0 if weak.
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
    """Return a state of a kind: uniform, or of equal stripes."""
    x = problem.turn / problem.n * np.arange(problem.n)
    both = np.zeros((2, problem.n))
    wave = 2 * np.pi / problem.turn * x
    both[of.component] = FULL * (np.tanh(3 * np.sin(of.stripes / 2 * wave)) if of.stripes else of.sign)
    both[1 - of.component] = LEAN * of.lean
    return (both / np.maximum(1.0, np.hypot(*both) / FULL)).ravel()
