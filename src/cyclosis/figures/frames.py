"""Frames of a run's dataset: reading one, finding those at given times, or some that show its course."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt
import xarray

from ..analysis.zones import zone_angles
from ..model.arrays import numbers
from ..model.doors import door
from ..model.errors import InputError, number
from ..model.grid import Array, CylinderGrid, covered, resolved
from ..model.instants import instant
from ..model.wording import beside

SETTLED = 0.995
"""Share of the whole path of P after which a story ends: later frames hardly differ."""
IN_MEMORY = 2**28
"""Runs whose P takes no more bytes than this are read at once, which is faster than frame by frame."""
_DIMS = ("time", "component", "theta", "z")
_CLOSED = ("time", "component", "theta", "s")


def grid_of(dataset: Any) -> CylinderGrid:
    """Return the grid of a run's dataset.

    Raises `InputError` if it is not the dataset of a run, has no fields, is that of a closed cell, or holds
    only a part of the cell, as a selection does.
    """
    if is_closed(dataset):
        rule = "the periodic cylinder, for which alone this is defined"
        raise InputError("the surface of the run", "a closed cell", rule, "use a run of another model")
    for name in ("P", "u"):
        if name not in dataset or dataset[name].dims != _DIMS or "time" not in dataset.coords:
            found, rule = list(dataset.data_vars), "P and u over (time, component, theta, z), and others"
            raise InputError("the dataset's variables", found, rule, "use the dataset of a run")
    length = number("length", dataset.attrs.get("length"), 1e-9, 1e9, "keep the dataset's attribute `length`")
    for name, period in (("theta", 2 * np.pi), ("z", length)):
        if name in dataset.coords:
            covered(name, dataset[name].values, period, "the dataset")
    return CylinderGrid(dataset.sizes["theta"], dataset.sizes["z"], length)


def is_closed(dataset: Any) -> bool:
    """Return whether a dataset is that of a run on a closed surface, with P and u over theta and s.

    Raises `InputError` for anything that is not a dataset.
    """
    if not isinstance(dataset, xarray.Dataset):
        raise InputError("dataset", type(dataset).__name__, "an xarray.Dataset", "use the dataset of a run")
    return all(name in dataset and dataset[name].dims == _CLOSED for name in ("P", "u"))


def in_memory(dataset: xarray.Dataset) -> xarray.Dataset:
    """Return a run's dataset, loaded into memory if it is small."""
    return dataset.compute() if dataset["P"].nbytes <= IN_MEMORY else dataset


def frame(dataset: xarray.Dataset, index: int) -> tuple[Array, Array]:
    """Return P and u of one frame, both (2, n_theta, n_z) or (2, n_theta, n_s), dimensionless."""
    now = dataset.isel(time=index)
    return np.asarray(now["P"].values, dtype=np.float64), np.asarray(now["u"].values, dtype=np.float64)


def peak_speed(dataset: xarray.Dataset) -> float:
    """Return the largest recorded speed of a run, dimensionless."""
    if "peak_speed" in dataset:
        return float(dataset["peak_speed"].max())
    return max(float(np.hypot(*frame(dataset, index)[1]).max()) for index in range(dataset.sizes["time"]))


@door
def indices_at(dataset: xarray.Dataset, times: npt.ArrayLike, name: str = "times") -> list[int]:
    """Return the frames nearest to increasing times (n,).

    Raises `InputError` for times outside the dataset, not increasing, or so close that two of them select
    the same frame.
    """
    saved = np.asarray(dataset["time"].values, dtype=np.float64)
    wanted = numbers(name, times, "a list of times", "give numbers")
    if wanted.ndim != 1 or wanted.size == 0:
        raise InputError(name, times, "a list of at least one time", "give numbers")
    first, last = instant(saved[0]), instant(saved[-1])
    for time in wanted.tolist():
        if not first <= instant(time) <= last:
            rule = f"within the dataset, from {beside(first, time)} to {beside(last, time)}"
            raise InputError(name, time, rule, "choose a time that was saved")
    found = [int(np.argmin(np.abs(saved - time))) for time in wanted]
    if np.any(np.diff(found) < 1):
        rule = "increasing, each with its own saved frame"
        raise InputError(name, wanted.tolist(), rule, "spread them, or save more often")
    return found


def travelled(dataset: xarray.Dataset) -> Array:
    """Return the distance (time,) that P has travelled by each frame: the sum of <|P(t + dt) - P(t)|²>^½."""
    way, before = [0.0], dataset["P"].isel(time=0).values
    weights = area_shares(dataset)
    for index in range(1, dataset.sizes["time"]):
        now = dataset["P"].isel(time=index).values
        way.append(way[-1] + mean_square(now - before, weights))
        before = now
    return np.array(way)


def mean_square(field: Array, weights: Array | None = None) -> float:
    """Return <|v|²>^½ of a vector field (2, ...), by shares (...) of the area if points differ in it."""
    square = np.sum(field**2, axis=0)
    return float(np.sqrt(np.mean(square) if weights is None else np.sum(weights * square)))


def area_shares(dataset: xarray.Dataset) -> Array | None:
    """Return the shares of the points in the area, or None where all are the same."""
    if "area_weight" not in dataset:
        return None
    area = np.asarray(dataset["area_weight"].values, dtype=np.float64)
    return np.asarray(area / area.sum())


def story(dataset: xarray.Dataset, count: int) -> list[int]:
    """Return `count` frames, in order, that show how the state developed.

    They are spaced evenly along the path of P: fast changes get more frames than slow ones. The first is the
    initial state, the last the state once it hardly changes, however long the run continued. Raises
    `InputError` for fewer than `count` frames.
    """
    frames = dataset.sizes["time"]
    if frames < count:
        raise InputError("the number of saved frames", frames, f"at least {count}", "save more often")
    way = travelled(dataset)
    shares = np.linspace(0.0, SETTLED, count)
    chosen = np.abs(way[:, None] - shares * way[-1]).argmin(axis=0)
    # Each gets its own frame: where several fell on one, later ones move on, then back from the end.
    offset = np.arange(count)
    chosen = np.maximum.accumulate(chosen - offset) + offset
    return [int(i) for i in np.minimum(chosen, frames - count + offset)]


@door
def facing_zone(P: npt.ArrayLike, beside: float = 0.25) -> float:
    """Return a viewing angle in [0, 2π) that shows an indifferent zone of a state (2, n_theta, n_z).

    The zone appears `beside` radians left of the middle, with the upward stream on its right. Without a zone
    along the cell the most strongly ordered meridian faces the viewer.
    """
    return facing(resolved(np.asarray(P, dtype=np.float64)[1]).mean(axis=1), beside)


def facing(profile: Array, beside: float = 0.25) -> float:
    """Return the viewing angle that shows a zone of a profile (n_theta,) of P_z, as `facing_zone` does."""
    angles = zone_angles(profile)
    theta = 2 * np.pi * np.arange(profile.size) / profile.size
    if angles.size == 0:
        return float(theta[np.argmax(np.abs(profile))])
    rising = [a for a in angles if np.interp(a + 0.1, theta, profile, period=2 * np.pi) > 0]
    return float(np.mod((rising or list(angles))[0] + beside, 2 * np.pi))
