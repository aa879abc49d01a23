"""How a film is measured: window, frames of a pair and pairs in a mean, tried in the middle of the film."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from . import light
from .moving import RADIUS, Bools, Fields, Flow, between

RADII = (RADIUS, 15, 22)
"""Windows that are tried, until one is precise enough."""
PRECISE = 0.035
"""Standard error, as a share of the fastest displacements, with which a window is good enough."""
AVERAGED = 0.04
"""Standard error, as a share of the fastest displacements, that means of several pairs are to reach."""
MOST_AVERAGED = 8
"""Pairs in a mean, at most."""
FAR = 25.0
"""Way in pixels, at most, during the pairs of one mean."""
SLOW, AIM = 2.0, 3.0
"""Frames further apart are tried below this displacement in pixels, so that it becomes about the second."""
FAST = 95
"""Percentile of the displacements that counts as the fastest."""
KEPT = 0.8
"""Share of the measured samples that must be left with frames further apart."""
STILL_FRAMES = 16
"""Frames from which on what stands still can be told from what moves slowly."""
BETTER, FEW, NO_WORSE = 0.7, 10, 1.1
"""Relative error, as a share of that with it, at which a short film is rid of what stands still.

Its median has ghosts of what moves, which blur less from `FEW` frames on: there the last number counts.
"""


@dataclass(frozen=True)
class Plan:
    """How pairs are measured: `radius` of the window, `gap` frames from first to second, `average` pairs."""

    radius: int = RADIUS
    gap: int = 1
    average: int = 1


def without_still(pictures: Fields, radius: int | None) -> Fields:
    """Return frames without what stands still: their median, from `STILL_FRAMES` frames on.

    In shorter films what moves slowly is in the median, too. There both are tried on a pair in the middle:
    the median is taken out if the light that is left is explained much better by displacements.
    """
    count = len(pictures)
    if count < 3:
        return pictures
    clear = pictures - light.still(pictures)
    if count >= STILL_FRAMES:
        return clear
    whole, moving = (_tried(each, Plan(radius or RADIUS)) for each in (pictures, clear))
    limit = BETTER if count < FEW else NO_WORSE
    return clear if _unsure(moving) < limit * _unsure(whole) else pictures


def planned(
    pictures: Fields, live: Bools, radius: int | None, gap: int | None, average: int | None
) -> tuple[Plan, float]:
    """Return how to measure prepared frames, and the largest displacement of a pair in pixels.

    What is given stays. `live` (rows, columns) is where something moves.
    """
    plan = Plan(radius or RADIUS, gap or 1, average or 1)
    flow = _tried(pictures, plan)
    if gap is None:
        plan, flow = _further_apart(pictures, live, plan, flow)
    if radius is None:
        for wider in RADII[1:]:
            if _error(flow, live) <= PRECISE * _fastest(flow):
                break
            plan = replace(plan, radius=wider)
            flow = _tried(pictures, plan)
    fastest = _fastest(flow)
    if average is None and fastest > 0:
        wanted = (_error(flow, live) / (AVERAGED * fastest)) ** 2
        room = max(1, (len(pictures) - plan.gap) // 3)
        most = min(MOST_AVERAGED, room, max(1, int(FAR * plan.gap / fastest)))
        plan = replace(plan, average=int(np.clip(np.ceil(min(wanted, 100.0)), 1, most)))
    return plan, fastest


def _further_apart(pictures: Fields, live: Bools, plan: Plan, flow: Flow) -> tuple[Plan, Flow]:
    """Return the plan with frames so far apart that displacements are large, and its flow."""
    usual = _fastest(flow)
    if not 0 < usual < SLOW:
        return plan, flow
    gap = min(round(AIM / usual), (len(pictures) - 1) // 3)
    while gap > 1:
        wider = replace(plan, gap=gap)
        other = _tried(pictures, wider)
        shares = [float((each.consistent & live).mean()) for each in (other, flow)]
        errors = [_error(each, live) / n for each, n in ((other, gap), (flow, 1))]
        if shares[0] >= KEPT * shares[1] and errors[0] < errors[1]:
            return wider, other
        gap //= 2
    return plan, flow


def _tried(pictures: Fields, plan: Plan) -> Flow:
    first = (len(pictures) - 1 - plan.gap) // 2
    return between(pictures[first], pictures[first + plan.gap], plan.radius)


def _error(flow: Flow, live: Bools) -> float:
    """Return the error that three quarters of the samples stay below, where something moves."""
    chosen = flow.error[live]
    return float(np.percentile(chosen, 75)) if chosen.size else np.inf


def _unsure(flow: Flow) -> float:
    """Return the usual error of a displacement, as a share of the fastest ones."""
    return float(np.median(flow.error)) / max(_fastest(flow), 1e-6)


def _fastest(flow: Flow) -> float:
    """Return the fastest displacement that is no outlier, in pixels; 0 if none is measured."""
    way = np.hypot(*flow.v)
    known = flow.consistent & (flow.error < 0.3 * way)
    return float(np.percentile(way[known], FAST)) if known.sum() > 50 else 0.0
