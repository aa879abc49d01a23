"""Bifurcation diagrams: a branch of states, and the branches that it crosses or ends in."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from typing import Any

import numpy as np

from ...analysis.zones import zone_angles
from ...model.doors import door
from ...model.errors import InputError, whole
from ..profiles.travelling import Drifting
from .branch import Branch, SpecialPoint
from .continuation import continue_branch

KNOWN = 0.25
"""A state within this distance of a branch, relative to `BESIDE`, belongs to that branch."""
FAINT = 1e-3
"""Order, mean or variation of P no larger counts as zero."""
BESIDE = 0.02
"""Distance from a branch point at which a new branch is started, root mean square of P."""


@door
def diagram(
    start: Any, parameter: str, bounds: Sequence[float], depth: int = 2, **options: Any
) -> list[Branch]:
    """Return the branch through a state and those reached from it, each once, in the order they are reached.

    `depth` is the number of times that a branch is left for another. At a pitchfork only one of two mirror
    images is continued. Branches whose states vary along the cell or oscillate are not continued: their
    points are listed in `Branch.points`. All other arguments and errors are those of `continue_branch`.

    Example:
        >>> import cyclosis as cy
        >>> state = cy.stability.cyclosis(cy.Parameters(kappa=0.5), n_theta=64)
        >>> found = cy.stability.diagram(state, "kappa", (0.45, 0.5), length=None, longest=0.1)
        >>> tilts = [abs(branch.measures["mean_P_theta"]).max() for branch in found]
        >>> [bool(tilt > 1e-3) for tilt in tilts]  # upright stripes, and those that branch off
        [False, True]
    """
    depth = whole("depth", depth, 0, 10, "the default is 2")
    found = [continue_branch(start, parameter, bounds, **options)]
    front = found[:]
    for _ in range(depth):
        begun: list[Branch] = []
        for branch in front:
            for point in branch.points:
                state = _beside(branch, point)
                if state is None or any(other.holds(state, KNOWN * BESIDE) for other in found):
                    continue
                begun.append(continue_branch(state, parameter, bounds, **options))
                found.append(begun[-1])
        front = begun
    return found


def _beside(branch: Branch, point: SpecialPoint) -> Drifting | None:
    """Return a state on the branch that crosses at a point, or None where none can be continued."""
    if point.kind not in ("branch point", "Hopf point") or point.axial_mode:
        return None
    for size in (BESIDE, -BESIDE):
        with suppress(InputError):
            return branch.switch(point, size)
    return None


def label(branch: Branch) -> str:
    """Return what the states of a branch are, in a few words, judged by the one in its middle."""
    P = branch.states[branch.parameter.size // 2]
    order, mean = float(np.sqrt(np.mean(np.sum(P**2, axis=0)))), np.abs(P.mean(axis=1))
    if order < FAINT:
        return "disorder"
    if np.ptp(P, axis=1).max() < FAINT:
        return "circumferential" if mean[0] > mean[1] else "unidirectional"
    count = zone_angles(P[1]).size
    if count == 0:
        return "uneven order"
    words = [w for w, there in (("tilted", mean[0] > FAINT), ("unequal", mean[1] > FAINT)) if there]
    if np.abs(P[0]).max() > FAINT and not words:
        words = ["wavy"]
    return ", ".join(words) + (" " if words else "") + ("stripes" if count == 2 else f"{count} stripes")
