"""Time in pictures: a square-root axis, and which times the frames of a movie show."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.ticker import MaxNLocator

from ..model.grid import Array
from ..model.scales import Scales
from ..model.units import time_unit

STEADY_SHARE = 0.3
"""Share of a movie that is even on the square-root scale; the rest is even along the path of P."""
_TICK_ROOM, _TICK_EMS = 0.14, 2.0
"""Least distance between ticks, as a fraction of the axis and in sizes of their type."""


def time_axis(ax: Any, first: float, last: float, scales: Scales | None = None) -> None:
    """Give axes a horizontal axis of time from `first` to `last` (dimensionless), on a square-root scale.

    Cyclosis forms early and settles late: this scale shows both, and time 0, which a logarithm would not.
    With `scales` the ticks are in seconds, minutes, hours or days.
    """

    def forward(t: Any) -> Any:
        return np.sqrt(np.maximum(np.asarray(t) - first, 0.0))

    ax.set_xscale("function", functions=(forward, lambda s: first + np.asarray(s) ** 2))
    ax.set_xlim(first, last)
    factor = time_unit(scales, last).factor
    wide = ax.get_position().width * ax.figure.get_figwidth()
    least = _TICK_EMS * ax.xaxis.get_major_ticks(1)[0].label1.get_size() / 72
    shown = ticks(factor * first, factor * last, max(_TICK_ROOM, least / wide))
    ax.set_xticks([time / factor for time in shown], [f"{time:g}" for time in shown])
    ax.minorticks_off()


def time_label(scales: Scales | None, last: float) -> str:
    """Return the label of an axis of time up to `last`, which says that it is not linear."""
    unit = time_unit(scales, last).name
    return f"$t$ ({unit + ', ' if unit else ''}square-root scale)"


def time_text(scales: Scales | None, time: float, digits: str = ".4g", last: float | None = None) -> str:
    """Return a time (dimensionless) as it stands above a picture, in the unit for times up to `last`."""
    unit = time_unit(scales, time if last is None else last)
    shown = format(unit.factor * time, ".3g" if scales is not None and "g" in digits else digits)
    return f"$t$ = {shown} {unit.name}".rstrip()


def ticks(first: float, last: float, room: float = _TICK_ROOM) -> list[float]:
    """Return round times from first to last, at least `room` of the square-root scale apart."""
    if first == 0:
        largest = int(np.floor(np.log10(last)))
        candidates = [k * 10.0**e for e in range(largest, largest - 4, -1) for k in (5, 2, 1)]
    else:
        candidates = [float(t) for t in reversed(MaxNLocator(5).tick_values(first, last))]
    chosen = [first]
    ceiling = 1.0 + room
    for time in [t for t in candidates if first < t <= last]:
        place = np.sqrt((time - first) / (last - first))
        if room <= place <= ceiling - room:
            chosen.append(time)
            ceiling = place
    return sorted(chosen)


def movie_times(times: Array, way: Array, count: int) -> Array:
    """Return increasing times (count,) for the frames of a movie, from the first to the last saved.

    `times` (n,) are those saved, `way` (n,) the distance that P has travelled by then. Most frames are
    spread evenly along that path, so that fast changes are shown slowly; a share of them is spread over
    time itself, so that the clock never stops.
    """
    first, span = times[0], times[-1] - times[0]
    share = STEADY_SHARE if way[-1] > 0 else 1.0
    # The square root is steep at its start: points between the saved times keep its inverse smooth.
    fine = np.union1d(times, first + span * np.linspace(0.0, 1.0, 2001) ** 2)
    clock = share * np.sqrt((fine - first) / span)
    clock += (1 - share) * np.interp(fine, times, way) / max(way[-1], 1e-300)
    found: Array = np.interp(np.linspace(0.0, clock[-1], count), clock, fine)
    return found
