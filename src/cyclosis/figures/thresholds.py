"""Thresholds of theory over the axes of a sweep: closed forms, and whatever curves the caller adds."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from ..model.errors import InputError
from ..model.grid import Array
from ..model.parameters import Parameters
from ..stability.dispersion import stripes_threshold, tilt_threshold
from .swept import Axis

POINTS = 600
"""Points along a curve."""
DISORDER = "$α_p = d^{(r)}$"
TILT = "U tilts beyond"
STRIPES = "U breaks into stripes beyond"


class Curve(NamedTuple):
    """A named curve: x (n,) and y (n,) in the units of the axes; NaN where it is broken."""

    name: str
    x: Array
    y: Array


def thresholds(params: Parameters | None, axes: Sequence[Axis]) -> list[Curve]:
    """Return the closed-form thresholds over one or two swept axes, or none where they do not apply.

    * α_p = d_r, beyond which disorder is unstable, where either is an axis.
    * the α_u beyond which the unidirectional state tilts or breaks into stripes (`tilt_threshold`,
      `stripes_threshold`), where α_u is an axis: against whatever the other axis is.

    Over one axis a threshold is the upright line of its value, from y = 0 to 100 (percent).
    """
    if params is None:
        return []
    found = [_disorder(params, axes)]
    for name, threshold in ((TILT, tilt_threshold), (STRIPES, stripes_threshold)):
        found.append(_alignment(name, threshold, params, axes))
    return [curve for curve in found if curve is not None and np.isfinite(curve.x + curve.y).any()]


def given(curves: Iterable[Any]) -> list[Curve]:
    """Return the caller's curves (name, x, y) checked. Raises `InputError` for anything else."""
    found = []
    for curve in curves:
        try:
            name, x, y = curve
            pair = np.asarray(x, dtype=np.float64), np.asarray(y, dtype=np.float64)
        except (TypeError, ValueError) as error:
            raise InputError("a curve", curve, "(name, x, y)", "give a name and two lists") from error
        if pair[0].ndim != 1 or pair[0].shape != pair[1].shape or not isinstance(name, str):
            raise InputError("a curve", name, "(name, x, y) with as many x as y", "give a name and two lists")
        found.append(Curve(name, *pair))
    return found


def _disorder(params: Parameters, axes: Sequence[Axis]) -> Curve | None:
    names = [axis.name for axis in axes]
    if "alpha_p" not in names and "d_r" not in names:
        return None
    if "alpha_p" in names and "d_r" in names:
        line = axes[0].between(POINTS)
        return Curve(DISORDER, line, line)
    name, value = ("alpha_p", params.d_r) if "alpha_p" in names else ("d_r", float(params.alpha_p))
    return _crossing(DISORDER, axes, names.index(name), np.full(POINTS, value))


def _alignment(
    name: str, threshold: Callable[[Parameters], npt.NDArray[Any]], params: Parameters, axes: Sequence[Axis]
) -> Curve | None:
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


def _crossing(name: str, axes: Sequence[Axis], place: int, values: Array) -> Curve:
    """Return the curve on which axis `place` takes `values` (POINTS,) along the other, or from 0 to 100."""
    along = axes[1 - place].between(POINTS) if len(axes) == 2 else np.linspace(0.0, 100.0, POINTS)
    return Curve(name, along, values) if place == 1 else Curve(name, values, along)
