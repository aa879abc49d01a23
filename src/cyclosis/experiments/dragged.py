"""Two stripes with the drag of the vacuole on their flow: what `cyclosis.stability` has without it.

A profile that does not vary along the cell drives waves (m, 0) only, whose drag is β |m|:

    d_s P'' - d_r P + (1 - P²)(α_p P + α_u u) = 0,    (1 + μ m² + β |m|) u_m = F_m .

Its perturbations obey the equation of the model `coupled` itself, with the drag of every wave.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.optimize import brentq

from ..model.errors import InputError
from ..model.grid import Array, CylinderGrid
from ..model.parameters import Parameters
from ..models import coupled_model
from ..stability.existence.equal import Equal, EqualStripes
from ..stability.profiles.growth import along
from ..stability.profiles.reduced import Reduced, reduced_of
from ..stability.profiles.steady import relax, steady
from ..stability.profiles.travelling import flow

POINTS = 96
LENGTH = 5.0
LONG = 2000.0
"""Time for which tilted stripes are integrated before Newton's method takes over."""


def equation(params: Parameters, beta: float, points: int = POINTS) -> Reduced:
    """Return the equation of states that do not vary along the cell, with the drag β."""
    return reduced_of(coupled_model(beta).problem(params, CylinderGrid(points, 8, LENGTH)))


class DraggedStripes(EqualStripes):
    """Two equal stripes with the drag β; α_u is an argument throughout."""

    def __init__(self, params: Parameters, beta: float, points: int = POINTS) -> None:
        super().__init__(params, 2, points)
        self.line = equation(params, beta, points).line

    def full(self, alpha_u: float) -> Equal:
        """Return the steady state next to the one without drag; raises `InputError` if there is none."""
        found = self.beside(alpha_u, super().full(alpha_u).P)
        if found is None:
            rule = "where two stripes exist with the drag of the vacuole, and here none were found"
            raise InputError("the parameter point", self.point, rule, "raise alpha_u")
        return found


class Stripes(NamedTuple):
    """Two upright stripes: greatest and root mean square order and speed, and growth rates.

    `tilt` is that of a tilt towards the circumference, `widths` that of unequal widths, `bend` that of the
    longest wave along the cell. All dimensionless.
    """

    peak_order: float
    order: float
    peak_speed: float
    speed: float
    tilt: float
    widths: float
    bend: float


def stripes(params: Parameters, beta: float) -> tuple[Stripes, Array]:
    """Return the `Stripes` of the steady state with the drag β, and its P_z (points,).

    Raises `InputError` where there is none.
    """
    P = DraggedStripes(params, beta).full(float(params.alpha_u)).P
    line, y = equation(params, beta), np.concatenate([np.zeros(POINTS), P])
    found = steady(line, y)
    assert found is not None
    u = flow(line, y)[1]
    matrix = line.jacobian(y)
    tilt = float(np.linalg.eigvals(matrix[:POINTS, :POINTS]).real.max())
    upright = equation(params.replace(kappa=50.0), beta)  # so stiff that no tilt is the slowest mode
    widths = float(along(upright, found)[0][0].real)
    bend = float(np.linalg.eigvals(line.waves(y, 1)).real.max())
    sizes = [(float(np.abs(x).max()), float(np.sqrt(np.mean(x**2)))) for x in (P, u)]
    return Stripes(*sizes[0], *sizes[1], tilt, widths, bend), P


def tilt_rate(params: Parameters, beta: float) -> float:
    """Return the growth rate of a tilt of two upright stripes."""
    P = DraggedStripes(params, beta).full(float(params.alpha_u)).P
    matrix = equation(params, beta).jacobian(np.concatenate([np.zeros(POINTS), P]))
    return float(np.linalg.eigvals(matrix[:POINTS, :POINTS]).real.max())


def tilting_drag(params: Parameters, most: float) -> float:
    """Return the β from which on two stripes tilt, NaN if they do not up to `most`."""
    if tilt_rate(params, 0.0) >= 0:
        return 0.0
    if tilt_rate(params, most) < 0:
        return np.nan
    return float(brentq(lambda beta: tilt_rate(params, beta), 0.0, most, xtol=1e-6))


def tilting_alpha_p(params: Parameters, beta: float, least: float, most: float) -> float:
    """Return the α_p from which on two stripes tilt, between two values; NaN if they do not."""

    def rate(alpha_p: float) -> float:
        return tilt_rate(params.replace(alpha_p=alpha_p), beta)

    return float(brentq(rate, least, most, xtol=1e-4)) if rate(least) < 0 < rate(most) else np.nan


def tilted(params: Parameters, beta: float) -> tuple[float, float]:
    """Return mean P_theta and drift about the axis of the state in which tilted stripes end.

    Both are zero where they end upright.
    """
    line = equation(params, beta)
    theta = line.turn / POINTS * np.arange(POINTS)
    guess = np.concatenate([np.full(POINTS, 0.3), 0.8 * np.tanh(3 * np.sin(theta))])
    found = steady(line, relax(line, guess, LONG).y)
    return (np.nan, np.nan) if found is None else (float(found.y[:POINTS].mean()), found.drift)
