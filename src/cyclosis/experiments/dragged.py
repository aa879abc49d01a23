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
from ..stability.profiles.reduced import Reduced, reduced_of
from ..stability.profiles.steady import relax, steady
from ..stability.profiles.travelling import flow
from ..stability.uniform.dispersion import stripes_threshold

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

    `share` is the part of the motors' power that is dissipated in the vacuole; `tilt` is the growth rate of a
    tilt towards the circumference, `widths` that of unequal widths, `bend` that of the longest wave along
    the cell. All dimensionless.
    """

    peak_order: float
    order: float
    peak_speed: float
    speed: float
    share: float
    tilt: float
    widths: float
    bend: float


def stripes(params: Parameters, beta: float) -> Stripes:
    """Return the `Stripes` of the steady state with the drag β. Raises `InputError` where there is none."""
    line, y = upright(params, beta)
    u = flow(line, y)[1]
    m = np.arange(POINTS // 2 + 1)
    power = np.abs(np.fft.rfft(u)) ** 2
    share = float(beta * (m @ power) / ((1 + params.mu * m**2 + beta * m) @ power))
    sizes = [(float(np.abs(x).max()), float(np.sqrt(np.mean(x**2)))) for x in (y[POINTS:], u)]
    matrix = line.jacobian(y)
    # Of perturbations of P_z alone the first that is not the neutral rotation, which changes no widths.
    axial = np.linalg.eigvals(matrix[POINTS:, POINTS:])
    widths = float(np.delete(axial, np.argmin(np.abs(axial))).real.max())
    bend = float(np.linalg.eigvals(line.waves(y, 1)).real.max())
    return Stripes(*sizes[0], *sizes[1], share, _tilt(matrix), widths, bend)


def tilt_rate(params: Parameters, beta: float) -> float:
    """Return the growth rate of a tilt of two upright stripes; raises `InputError` where there are none."""
    line, y = upright(params, beta)
    return _tilt(line.jacobian(y))


def upright(params: Parameters, beta: float) -> tuple[Reduced, Array]:
    """Return the equation and the steady state (2 points,) of two upright stripes."""
    P = DraggedStripes(params, beta).full(float(params.alpha_u)).P
    return equation(params, beta), np.concatenate([np.zeros(POINTS), P])


def _tilt(matrix: Array) -> float:
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
    """Return |<P_theta>| and |drift| of the state in which tilted stripes end; zero if that is upright."""
    line = equation(params, beta)
    theta = line.turn / POINTS * np.arange(POINTS)
    guess = np.concatenate([np.full(POINTS, 0.3), 0.8 * np.tanh(3 * np.sin(theta))])
    found = steady(line, relax(line, guess, LONG).y)
    return (np.nan, np.nan) if found is None else (abs(float(found.y[:POINTS].mean())), abs(found.drift))


def breaking_up(params: Parameters, beta: float) -> float:
    """Return the α_u above which one stream breaks up into stripes.

        α_u = α_p² (1 + μ + β) (2a + d_s) / (3 d_r a),    a = α_p - d_r

    Its perturbations of wavenumber m = 1 drive a flow that is resisted by 1 + μ + β Z(1, 0), and Z(1, 0) = 1.
    """
    return float(stripes_threshold(params)) * (1 + params.mu + beta) / (1 + params.mu)
