"""Taylor dispersion: how a flow spreads a scalar along a sealed vacuole that is long or periodic.

Long after R²/(3.39 D) the mean over the section spreads with D_eff = D (1 + <|∇χ|²>), where χ solves

    Pe v·∇χ - ∇²χ = -Pe (v_z - <v_z>),   χ_r = 0 at r = 1

In a straight flow v_z = Σ b_n r^n cos(n θ + δ_n) the first term is 0. With Pe = 1,
χ_n = b_n [r^{n+2}/(4(n+1)) - (n+2) r^n/(4n(n+1))] cos(n θ + δ_n), and <|∇χ|²> = -<χ v_z> is

    c = Σ b_n² (3n + 4)/(8 n (n+1)² (n+2)),   D_eff/D = 1 + c Pe²

Everything is dimensionless.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from ..display.shown import shown
from ..model.doors import door
from ..model.errors import InputError
from .flow import VacuoleFlow
from .refined import refined
from .sampled import peclet_number
from .section import Section, section, winding
from .steady import cell_problem


@shown
@dataclass(frozen=True)
class Dispersion:
    """Spreading along the cell: `coefficient` = (D_eff/D - 1)/Pe², and the `peclet` it holds at.

    Of a straight flow the coefficient is the same at every Pe; without one `peclet` is None.

    Example:
        >>> import cyclosis as cy
        >>> cy.vacuole.Dispersion(coefficient=0.1, peclet=20.0).ratio
        41.0
    """

    coefficient: float
    peclet: float | None = None

    @property
    def ratio(self) -> float:
        """D_eff/D. Raises `InputError` if no Péclet number was given."""
        if self.peclet is None:
            raise InputError("peclet", None, "given for D_eff/D", "call dispersion(flow, peclet)")
        return 1 + self.coefficient * self.peclet**2


@door
def dispersion(flow: VacuoleFlow, peclet: float | None = None, n_r: int = 24) -> Dispersion:
    """Return the Taylor dispersion of a steady flow along the cell.

    `peclet` = U R/D may be left out for a straight flow along z, whose coefficient is the closed series; in
    every other flow the coefficient depends on it. A helical flow is solved in (r, φ), any other in
    the whole vacuole on its own grid and `n_r` radii. The vacuole is periodic; end caps are not modelled.
    Dimensionless. Raises `InputError` for a missing Péclet number, or one out of range or too high to solve.

    Example:
        >>> import numpy as np
        >>> import cyclosis as cy
        >>> grid = cy.CylinderGrid(16, 16)
        >>> wall = np.stack([np.zeros((16, 16)), np.sin(grid.theta)[:, None] * np.ones(16)])
        >>> straight = cy.vacuole.dispersion(cy.vacuole.flow(grid, wall))
        >>> round(96 * straight.coefficient, 12)  # 7/96
        7.0
        >>> phase = grid.theta[:, None] - 2 * np.pi * grid.z / grid.length
        >>> twisted = cy.vacuole.flow(grid, np.sin(phase) * np.array([0.78, 0.62])[:, None, None])
        >>> cy.vacuole.dispersion(twisted, peclet=10.0).coefficient < straight.coefficient
        True
    """
    along = winding(flow)
    pe = None if peclet is None else peclet_number(peclet)
    axial = np.abs(flow.modes[1, :, 0])
    plain = np.abs(flow.modes[0]).max(initial=0.0) <= 1e-12 * max(axial.max(initial=0.0), 1e-300)
    if along == 0 and plain and axial[0] <= 1e-12 * axial.max(initial=0.0):
        return Dispersion(series(2 * axial[1 : axial.size // 2 + 1]), pe)
    if pe is None:
        rule = "given, because the dispersion of this flow depends on it"
        raise InputError("peclet", peclet, rule, "call dispersion(flow, peclet)")
    if along is None:
        return Dispersion(cell_problem(flow, pe, n_r), pe)
    return Dispersion(refined(lambda size: _coefficient(section(flow, *size, biot=0.0), pe), pe), pe)


def series(amplitudes: npt.ArrayLike) -> float:
    """Return c of a straight flow with waves of amplitudes b_1, b_2, ... around the wall, in units of U.

    Example:
        >>> from cyclosis.vacuole.taylor import series
        >>> round(series([1.0]) * 96, 12)
        7.0
    """
    b = np.asarray(amplitudes, dtype=np.float64)
    n = np.arange(1.0, b.size + 1)
    return float(np.sum(b**2 * (3 * n + 4) / (8 * n * (n + 1) ** 2 * (n + 2))))


def _coefficient(problem: Section, pe: float) -> float:
    """Return <|∇χ|²>/Pe², from the cell problem in the modes without the constant."""
    varies = problem.rates > 0
    source = problem.real(-problem.project(problem.velocity[2]))[varies]
    chi = np.linalg.solve(problem.real(problem.decay(pe))[np.ix_(varies, varies)], source)
    return float(np.sum(problem.rates[varies] * chi**2))
