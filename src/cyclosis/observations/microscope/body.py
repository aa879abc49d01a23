"""The body that a camera looks at: a convex surface of revolution with velocities and filaments on it."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np
import numpy.typing as npt

from ...dynamics.trajectory import Trajectory
from ...model.arrays import series
from ...model.errors import InputError, number
from ...model.instants import instant
from ...model.wording import beside

if TYPE_CHECKING:
    import xarray

Array = npt.NDArray[np.float64]

FINER = 2
"""Grids are made this many times finer, by Fourier interpolation, before splines are put through them."""
FRAMES = 4
"""Frames through which a field is interpolated in time: a cubic."""
KEPT = 6
"""Fields whose splines are kept."""


class Body(Protocol):
    """A cell in space: positions are (3, n) = (x, y, z) in radii, z along the axis; vectors likewise.

    `times` are those of the saved frames, in R/U; between them fields follow the cubic through the four
    nearest. `ends` are the least and the largest z, and `period` is the length after which a cell without
    ends repeats itself, or None.
    """

    times: Array
    ends: tuple[float, float]
    period: float | None
    area: float

    def radius_at(self, z: Array) -> Array:
        """Return the distance of the surface from the axis at heights z, NaN beyond the ends."""

    def normal(self, xyz: Array) -> Array:
        """Return the outward unit normals at positions."""

    def velocity(self, xyz: Array, t: float) -> Array:
        """Return the velocity at positions, in U."""

    def filaments(self, xyz: Array, t: float) -> Array:
        """Return the mean direction P of the filaments at positions."""

    def scattered(self, count: int, rng: np.random.Generator) -> Array:
        """Return positions that are spread evenly over the surface."""

    def held(self, xyz: Array) -> Array:
        """Return the positions of the surface next to positions that are nearly on it."""


def body_of(source: Any) -> Body:
    """Return the body of a run (`Trajectory`) or of its dataset. Raises `InputError` for anything else."""
    from ...figures.frames import is_closed
    from .cylinder import Cylinder
    from .revolved import Revolved

    data = source.to_dataset() if isinstance(source, Trajectory) else source
    if not hasattr(data, "data_vars"):
        rule = "a run, or the dataset of a run"
        raise InputError("source", type(source).__name__, rule, "open a file with cyclosis.open_dataset")
    if "time" not in data.dims and "time" in data.coords:
        data = data.expand_dims("time")
    return Revolved(data) if is_closed(data) else Cylinder(data)


class Series:
    """A field of a run at any time between its frames: the cubic through the four nearest ones.

    `made` turns one saved frame into an array that may be combined linearly. With a single frame the field is
    the same at all times.
    """

    def __init__(self, times: Array, made: Callable[[int], Array]) -> None:
        self.times, self._made = times, made
        self._frames: dict[int, Array] = {}
        self._last: tuple[float, Array] | None = None

    def at(self, t: float) -> Array:
        """Return the field at a time. Raises `InputError` for times outside the run."""
        if self._last is not None and self._last[0] == t:
            return self._last[1]
        value = self._between(within(self.times, t))
        self._last = (t, value)
        return value

    def _between(self, t: float) -> Array:
        if len(self.times) == 1:
            return self._frame(0)
        after = int(np.searchsorted(self.times, t))
        if self.times[min(after, len(self.times) - 1)] == t:
            return self._frame(after)
        count = min(len(self.times), FRAMES)
        low = min(max(after - count // 2, 0), len(self.times) - count)
        near = self.times[low : low + count]
        parts = []
        for k, here in enumerate(near):
            others = np.delete(near, k)
            parts.append(np.prod((t - others) / (here - others)) * self._frame(low + k))
        return np.asarray(sum(parts))

    def _frame(self, index: int) -> Array:
        if index not in self._frames:
            while len(self._frames) >= KEPT:
                self._frames.pop(next(iter(self._frames)))
            self._frames[index] = self._made(index)
        return self._frames[index]


def within(times: Array, t: float, name: str = "time") -> float:
    """Return a time of a run. Raises `InputError` for times outside its frames, unless there is only one."""
    if len(times) == 1:
        return float(t)
    time = instant(number(name, t, -1e12, 1e12, "give a time of the run"))
    first, last = instant(float(times[0])), instant(float(times[-1]))
    if not first <= time <= last:
        rule = f"within the saved frames, from {beside(first, time)} to {beside(last, time)}"
        raise InputError(name, time, rule, "choose a time of the run, or fewer frames")
    return float(np.clip(time, times[0], times[-1]))


def saved_times(data: xarray.Dataset) -> Array:
    """Return the times (n,) of the frames of a dataset. Raises `InputError` if there are none."""
    times = np.asarray(data["time"].values, dtype=np.float64)
    if times.size == 0:
        raise InputError("the number of saved frames", 0, "at least 1", "save fields during the run")
    return times


def chosen(body: Body, times: npt.ArrayLike | None, all_: bool) -> Array:
    """Return the times at which a field is measured, in R/U: by default all frames, or the last one."""
    if times is None:
        return body.times if all_ else body.times[-1:]
    given = series("times", times, "give times of the run")
    for each in given.tolist():
        within(body.times, each, "times")
    return given
