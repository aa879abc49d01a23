"""Where two stripes exist and where they are stable, as curves: α_u over another parameter."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt
from scipy.optimize import brentq

from ...display.shown import shown
from ...model.arrays import series
from ...model.definitions import definition
from ...model.doors import door
from ...model.errors import InputError, choice, number
from ...model.grid import Array, CylinderGrid
from ...model.parameters import Parameters
from ..profiles.elliptic import front_threshold
from ..profiles.profile import check
from ..profiles.reduced import reduced
from ..uniform.dispersion import growth_rates
from ..uniform.uniform import check_numbers, orders
from .crossings import existing_from, stable_from
from .equal import EqualStripes
from .thresholds import Threshold, fold_with_error, threshold_with_error

if TYPE_CHECKING:
    import xarray

ALONG = ("alpha_p", "d_s", "d_r", "mu")
"""Parameters other than α_u that affect straight stripes."""
COARSE = 64
"""Points around the cell for curves that are only drawn."""
STRONGEST = 10.0
"""Largest κ that is examined."""
ROUND = 1e-9
"""A value of α_p within this relative distance of d_r + d_s is taken to equal it."""


@shown
@dataclass(frozen=True, eq=False)
class Limits:
    """Existence and stability of two stripes over a parameter, dimensionless; arrays (points,).

    `exists` is the α_u above which they exist: the fold for α_p < d_r + d_s, the pitchfork at it, and 0 above
    it; `stable` that above which they are stable against perturbations of P_z that do not vary along the
    cell. `exists_error` and `stable_error` are their errors; NaN where there is no limit. `front` is the
    prediction of the motion of fronts for `stable`. `values` are those of the parameter called `name`.

    Example:
        >>> import cyclosis as cy
        >>> found = cy.stability.limits(cy.Parameters(), [0.1])
        >>> found.exists.tolist(), bool(abs(found.front / found.stable - 1)[0] < 0.01)
        ([0.0], True)
        >>> sorted(found.to_dataset().data_vars)[:3]
        ['exists', 'exists_error', 'front']
    """

    name: str
    values: Array
    exists: Array
    exists_error: Array
    stable: Array
    stable_error: Array
    front: Array

    def to_dataset(self) -> xarray.Dataset:
        """Return the limits as an `xarray.Dataset` over the parameter."""
        import xarray

        rows = ("exists", "exists_error", "stable", "stable_error", "front")
        data = {row: (self.name, getattr(self, row)) for row in rows}
        return xarray.Dataset(data, coords={self.name: self.values})


@door
def limits(params: Parameters, values: npt.ArrayLike, name: str = "alpha_p") -> Limits:
    """Return the `Limits` of two stripes at `values` (points,) of "alpha_p", "d_s", "d_r" or "mu".

    `params` gives all other parameters; its alpha_u is ignored. Where there is no limit it is NaN.
    Raises `InputError` for values out of range, fields, and parameters with an oblique d.

    Example:
        >>> import cyclosis as cy
        >>> found = cy.stability.limits(cy.Parameters(), [0.1, 0.15], "alpha_p")
        >>> found.stable.round(5)  # the more filaments bundle, the less flow is needed
        array([0.00747, 0.0016 ])
    """
    choice("name", name, ALONG)
    check(params)
    allowed = definition("parameters", name)
    given = series(name, values, "give numbers").tolist()
    checked = [number(name, value, allowed.minimum, allowed.maximum, "give numbers") for value in given]
    rows = np.array([_row(params.replace(**{name: value})) for value in checked]).reshape(-1, 5)
    return Limits(name, np.array(checked), *rows.T)


def _row(params: Parameters) -> tuple[float, float, float, float, float]:
    """Return existence, its error, stability, its error and the value for fronts at one point."""
    onset = params.d_r + params.d_s
    alpha_p = float(params.alpha_p)
    if abs(alpha_p - onset) < ROUND * onset:
        params = params.replace(alpha_p=onset)
    ends = _pair(fold_with_error, params) if alpha_p <= onset * (1 + ROUND) else (0.0, 0.0)
    front = np.nan
    with suppress(InputError):
        front = front_threshold(params)
    return (*ends, *_pair(threshold_with_error, params), front)


def _pair(sought: Callable[[Parameters], Threshold], params: Parameters) -> tuple[float, float]:
    try:
        found = sought(params)
    except InputError:
        return np.nan, np.nan
    return found.alpha_u, found.error


@door
def quick_limits(params: Parameters) -> tuple[float, float]:
    """Return the α_u above which two stripes exist, and are stable, on one grid of `COARSE` points.

    Accurate to a part in 10³ where zones are no narrower than those of Figure 4: for drawing. NaN where there
    is no limit. Raises `InputError` for fields and an oblique d.
    """
    check(params)
    problem = EqualStripes(params, 2, COARSE)
    onset = params.d_r + params.d_s
    exists, stable = (0.0 if params.alpha_p > onset else np.nan), np.nan
    if params.alpha_p == onset and params.force_exponent == 2:
        exists = float(onset * (1 + params.mu))  # the pitchfork
    if params.alpha_p < onset:
        with suppress(InputError):
            exists = existing_from(problem).alpha_u
    with suppress(InputError):
        stable = stable_from(problem).alpha_u
    return exists, stable


@door
def tilt_limit(params: Parameters) -> float:
    """Return the κ below which the filaments of two equal stripes tilt, all along the cell: exact.

    κ is subtracted from every growth rate of P_theta and changes nothing else, so that the limit is the
    largest of these at κ = 0. d must point along theta. NaN where there are no such stripes. Raises
    `InputError` for fields and an oblique d.
    """
    check(params)
    still = params.replace(kappa=0.0)
    try:
        state = EqualStripes(still, 2, COARSE).full(float(params.alpha_u))
    except InputError:
        return np.nan
    line = reduced(still, CylinderGrid(COARSE, 8))
    tilting = line.jacobian(np.concatenate([np.zeros(COARSE), state.P]))[:COARSE, :COARSE]
    return float(np.linalg.eigvals(tilting).real.max())


@door
def rotating_limit(params: Parameters) -> float:
    """Return the κ above which circumferential order is unstable to a wave that rotates about the axis.

    There the growth rate of the wave m = 1, q = 0 about it passes through zero; the tilted stripes begin as
    this wave. NaN where there is no such κ from 0 to 10. Raises `InputError` for fields and an
    oblique d.
    """

    def growth(kappa: float) -> float:
        try:
            rates = growth_rates(params.replace(kappa=kappa), "circumferential", 1.0, 0.0)
        except InputError:  # repulsion has become too strong for such a state
            return 1.0
        return float(rates[0].real)

    check_numbers(params)
    orders(params.replace(kappa=1.0), "circumferential")  # refuses an oblique d
    low, high = growth(0.0), growth(STRONGEST)
    if not low < 0 < high:
        return np.nan
    return float(brentq(growth, 0.0, STRONGEST, xtol=1e-12))
