"""Thresholds of theory over the axes of a sweep, and any curves that the caller adds."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from contextlib import suppress
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from ..model.errors import InputError
from ..model.grid import Array
from ..model.parameters import Parameters
from ..stability.existence.boundaries import ALONG, quick_limits, rotating_limit, tilt_limit
from ..stability.uniform.dispersion import stripes_threshold, tilt_threshold
from .swept import Axis

POINTS = 600
"""Points along a curve."""
DISORDER = "$α_p = d^{(r)}$"
TILT = "U tilts beyond"
STRIPES = "U breaks into stripes beyond"
EXISTS = "C exists beyond"
STABLE = "C stable beyond"
TILTS = "C tilts before"
ROTATES = "O rotates beyond"
PLACES = 40
"""Points along a curve that needs Newton's method."""


class BorderCurve(NamedTuple):
    """A named curve: x (n,) and y (n,) in the units of the axes; NaN where it is broken."""

    name: str
    x: Array
    y: Array


def thresholds(params: Parameters | None, axes: Sequence[Axis]) -> list[BorderCurve]:
    """Return the thresholds over one or two swept axes, or none where they do not apply.

    * α_p = d_r, beyond which disorder is unstable, where either is an axis.
    * the α_u beyond which the unidirectional state tilts or breaks into stripes (`tilt_threshold`,
      `stripes_threshold`), where α_u is an axis, for any other axis.
    * the α_u beyond which two stripes exist (a fold, below α_p = d_r + d_s), and beyond which they are stable
      against unequal widths, likewise.
    * the κ below which stripes tilt, and above which circumferential order becomes tilted stripes that
      rotate, where κ is one of two axes.

    Over one axis a threshold is a vertical line at its value, from y = 0 to 100 (percent).
    """
    if params is None:
        return []
    found = [_disorder(params, axes)]
    for name, threshold in ((TILT, tilt_threshold), (STRIPES, stripes_threshold)):
        found.append(_alignment(name, threshold, params, axes))
    found += _stripes(params, axes)
    found += _repulsion(params, axes)
    return [curve for curve in found if curve is not None and np.isfinite(curve.x + curve.y).any()]


def given(curves: Iterable[Any]) -> list[BorderCurve]:
    """Return the caller's curves (name, x, y), checked. Raises `InputError` for anything else."""
    found = []
    for curve in curves:
        try:
            name, x, y = curve
            pair = np.asarray(x, dtype=np.float64), np.asarray(y, dtype=np.float64)
        except (TypeError, ValueError) as error:
            raise InputError("a curve", curve, "(name, x, y)", "give a name and two lists") from error
        if pair[0].ndim != 1 or pair[0].shape != pair[1].shape or not isinstance(name, str):
            raise InputError("a curve", name, "(name, x, y) with as many x as y", "give a name and two lists")
        found.append(BorderCurve(name, *pair))
    return found


def _disorder(params: Parameters, axes: Sequence[Axis]) -> BorderCurve | None:
    names = [axis.name for axis in axes]
    if "alpha_p" not in names and "d_r" not in names:
        return None
    if "alpha_p" in names and "d_r" in names:
        line = axes[0].between(POINTS)
        return BorderCurve(DISORDER, line, line)
    name, value = ("alpha_p", params.d_r) if "alpha_p" in names else ("d_r", float(params.alpha_p))
    return _crossing(DISORDER, axes, names.index(name), np.full(POINTS, value))


def _alignment(
    name: str, threshold: Callable[[Parameters], npt.NDArray[Any]], params: Parameters, axes: Sequence[Axis]
) -> BorderCurve | None:
    names = [axis.name for axis in axes]
    if "alpha_u" not in names:
        return None
    place = names.index("alpha_u")
    values = np.empty(POINTS)
    others = axes[1 - place].between(POINTS) if len(axes) == 2 else np.zeros(POINTS)
    own = len(axes) == 2 and hasattr(params, names[1 - place])
    for k, value in enumerate(others):
        try:
            here = params.replace(**{names[1 - place]: float(value)}) if own else params
            values[k] = float(threshold(here))
        except InputError:
            values[k] = np.nan
    values[~np.isfinite(values)] = np.nan
    return _crossing(name, axes, place, values)


def _stripes(params: Parameters, axes: Sequence[Axis]) -> list[BorderCurve]:
    """Return where two stripes exist and where they are stable, if α_u is an axis."""
    names = [axis.name for axis in axes]
    if "alpha_u" not in names:
        return []
    place = names.index("alpha_u")
    other = names[1 - place] if len(axes) == 2 else None
    low = float(axes[place].edges[0])
    if other in ("force_exponent", "repulsion_angle"):  # stripes depend on them, the curves here do not
        return []
    if other not in ALONG:
        pair = _limits(params, None, 0.0)
        return [
            _crossing(name, axes, place, np.full(POINTS, value))
            for name, value in zip((STABLE, EXISTS), pair[::-1], strict=True)
            if value > low
        ]
    line = axes[1 - place].between(2 * PLACES)
    # Curves are steep where stripes begin, however wide the axis.
    near = np.geomspace(max(line[0], 1e-3 * line[-1]), line[-1], PLACES)
    onset = [params.d_r + params.d_s] if other == "alpha_p" else []
    at = np.unique(np.maximum(np.concatenate([line[::2], near, onset]), 0.0))
    at = at[(at >= line[0]) & (at <= line[-1])]
    pairs = np.full((at.size, 2), np.nan)
    for k, value in enumerate(at):
        pairs[k] = _limits(params, other, float(value))
        if other == "alpha_p" and value > params.d_r + params.d_s and pairs[k, 1] < low:
            break  # beyond, stripes are stable on the whole axis
    pairs[pairs[:, 0] == 0, 0] = np.nan
    return [
        BorderCurve(name, *((at, values) if place == 1 else (values, at)))
        for name, values in zip((STABLE, EXISTS), pairs.T[::-1], strict=True)
    ]


def _repulsion(params: Parameters, axes: Sequence[Axis]) -> list[BorderCurve]:
    """Return where stripes begin to tilt and where circumferential order ends, if κ is one of two axes."""
    names = [axis.name for axis in axes]
    if len(axes) != 2 or "kappa" not in names:
        return []
    place = names.index("kappa")
    other, at = names[1 - place], axes[1 - place].between(PLACES)
    if other not in dict(params.items()):
        return []
    found = []
    for name, limit in ((TILTS, tilt_limit), (ROTATES, rotating_limit)):
        values = np.full(at.size, np.nan)
        for k, value in enumerate(at):
            with suppress(InputError):
                values[k] = limit(params.replace(**{other: float(value)}))
        found.append(BorderCurve(name, *((at, values) if place == 1 else (values, at))))
    return found


def _limits(params: Parameters, name: str | None, value: float) -> tuple[float, float]:
    numbers = tuple(sorted((key, number) for key, number in params.items() if key not in ("alpha_u", name)))
    if any(isinstance(number, np.ndarray) for _, number in numbers):
        return np.nan, np.nan
    return _remembered(numbers, name, value)


@lru_cache(maxsize=4096)
def _remembered(numbers: tuple[tuple[str, Any], ...], name: str | None, value: float) -> tuple[float, float]:
    try:
        values: dict[str, Any] = dict(numbers) | ({name: value} if name else {})
        return quick_limits(Parameters(**values))
    except InputError:
        return np.nan, np.nan


def _crossing(name: str, axes: Sequence[Axis], place: int, values: Array) -> BorderCurve:
    """Return the curve on which axis `place` takes `values` (POINTS,) along the other, or from 0 to 100."""
    along = axes[1 - place].between(POINTS) if len(axes) == 2 else np.linspace(0.0, 100.0, POINTS)
    return BorderCurve(name, along, values) if place == 1 else BorderCurve(name, values, along)
