"""The velocity of a flow at the points of a computation, checked, for steady flows and for those of runs."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from ..model.arrays import series
from ..model.errors import InputError, number
from ..model.grid import Array, interpolate
from .flow import VacuoleFlow
from .unsteady import UnsteadyFlow


def peclet_number(value: Any) -> float:
    """Return a Péclet number, or raise `InputError`."""
    return number("peclet", value, 1e-6, 1e9, "give U R/D, or Scales.peclet of a diffusivity")


def is_flow(flow: Any) -> None:
    """Raise `InputError` for what is not a flow in the vacuole."""
    if not isinstance(flow, VacuoleFlow | UnsteadyFlow):
        rule = "a flow in the vacuole, steady or of a run"
        raise InputError("flow", flow, rule, "make one with cyclosis.vacuole.flow")


def beginning(flow: VacuoleFlow | UnsteadyFlow, t_end: Any) -> tuple[float, float]:
    """Return the first and the last time: a run is followed from its first frame, a steady flow from 0.

    Raises `InputError` for an end that is not later, or beyond the frames of a run.
    """
    if isinstance(flow, VacuoleFlow):
        return 0.0, number("t_end", t_end, 1e-9, 1e9, "give the duration in R/U")
    first, last = float(flow.times[0]), float(flow.times[-1])
    end = number("t_end", t_end, first, last, "give a time within the frames of the run")
    if end == first:
        raise InputError("t_end", end, f"later than the first frame, {first:g}", "give a later time")
    return first, end


def instants(name: str, given: Any, first: float, end: float, usual: Array) -> Array:
    """Return given times, checked, or the usual ones. Raises `InputError` for times out of range or order."""
    if given is None:
        return usual
    found = series(name, given, "give a list of times in R/U")
    if not found.size or not np.all((found >= first) & (found <= end)) or np.any(np.diff(found) <= 0):
        rule = f"increasing, from {first:g} to t_end = {end:g}"
        raise InputError(name, given, rule, "sort the times and leave out the others")
    return found


class Sampled:
    """A flow as arrays at chosen points, made by `sample` from a steady flow, for as long as they are needed.

    `window(a, b)` gives frames (n, ...) and their times (n,): one frame of a steady flow, or those that a
    cubic between the four nearest needs from a to b, which may not have a frame between them.
    """

    def __init__(self, flow: VacuoleFlow | UnsteadyFlow, sample: Callable[[VacuoleFlow], Array]) -> None:
        self._flow, self._sample = flow, sample
        self._kept: dict[int, Array] = {}
        self._stack: Array = np.empty(0)
        self._chosen = range(0)
        self.times = (
            np.zeros(1) if isinstance(flow, VacuoleFlow) else np.asarray(flow.times, dtype=np.float64)
        )

    def breaks(self, first: float, last: float) -> Array:
        """Return the times of frames after `first` and before `last`: a step must not pass over them."""
        return self.times[(self.times > first) & (self.times < last)]

    def window(self, a: float, b: float) -> tuple[Array, Array]:
        """Return the frames and times that the velocity from a to b follows from.

        The array is the same object as long as the frames are the same.
        """
        if isinstance(self._flow, VacuoleFlow):
            if 0 not in self._kept:
                self._kept[0] = self._sample(self._flow)
                self._stack = self._kept[0][None]
            return self._stack, self.times
        used = min(4, self.times.size)
        before = int(np.searchsorted(self.times, 0.5 * (a + b)))
        first = int(np.clip(before - used // 2, 0, self.times.size - used))
        chosen = range(first, first + used)
        if chosen != self._chosen:
            self._kept = {k: self._kept[k] for k in self._kept if k in chosen}
            for k in chosen:
                if k not in self._kept:
                    self._kept[k] = self._sample(self._flow.at_time(float(self.times[k])))
            self._stack, self._chosen = np.stack([self._kept[k] for k in chosen]), chosen
        return self._stack, self.times[first : first + used]


def on_points(radii: Array, shape: tuple[int, int]) -> Callable[[VacuoleFlow], Array]:
    """Return the function that samples a flow at radii on a grid of another shape: (3, n_r, n_theta, n_z)."""
    return lambda flow: interpolate(flow.volume(radii), shape)
