"""How fast a wall takes up a scalar, a sealed vacuole mixes, and bands of the wall exchange.

In a helical flow the slowest mode of c_t + v·∇c = ∇²c / Pe with a uniform wall depends on r and φ = θ - k z
alone (it is positive, hence unique). Its rate times Pe, λ in units of D/R², is the Sherwood number 2 k R/D of
uptake. A straight flow does not change it: λ = 5.783186, the square of the first zero of J_0, at every Pe.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from ..model.doors import door
from ..model.errors import InputError, number
from .flow import VacuoleFlow
from .refined import refined
from .sampled import peclet_number
from .section import Section, section, turns
from .walls import Absorbing, Sealed, Wall

SLOWEST = 10
"""Modes of smallest |λ| among which the slowest is sought."""


@door
def uptake(flow: VacuoleFlow, peclet: float, wall: Wall = Absorbing()) -> float:  # noqa: B008  (immutable)
    """Return the Sherwood number of uptake: the decay rate of the mean in units of D/R².

    Long after the start the mean decays as exp(-Sh t/Pe), t in R/U. `wall` is `Absorbing()` or
    `Exchange(biot)`. For straight and helical flows; dimensionless. Raises `InputError` for other flows, for
    a sealed wall and for a Péclet number out of range.

    Example:
        >>> import cyclosis as cy
        >>> grid = cy.CylinderGrid(16, 16)
        >>> flow = cy.vacuole.flow(grid, cy.flow(cy.Parameters(), grid, cy.initial.stripes(grid)))
        >>> round(cy.vacuole.uptake(flow, peclet=1000.0), 6)  # straight: as without flow
        5.783186
        >>> round(cy.vacuole.uptake(flow, 1000.0, cy.vacuole.Exchange(0.1)), 6)
        0.195083
    """
    pe = peclet_number(peclet)
    if not isinstance(wall, Wall) or wall.biot == 0:
        raise InputError("wall", wall, "Absorbing() or Exchange(biot)", "a sealed wall takes up nothing")
    return refined(lambda size: _slowest(section(flow, *size, biot=wall.biot), pe), pe)


@door
def mixing_rate(flow: VacuoleFlow, peclet: float) -> float:
    """Return the rate, in units of D/R², at which differences in a sealed vacuole disappear.

    Of the slowest mode that depends on r and φ = θ - k z alone, so that it has the symmetry of the flow;
    without flow it is 3.389958 + k². Differences along a long cell disappear as slowly as `dispersion` says.
    Raises `InputError` for flows that are not straight or helical, and for a Péclet number out of range.

    Example:
        >>> import cyclosis as cy
        >>> grid = cy.CylinderGrid(16, 16)
        >>> flow = cy.vacuole.flow(grid, cy.flow(cy.Parameters(), grid, cy.initial.stripes(grid)))
        >>> round(cy.vacuole.mixing_rate(flow, peclet=1000.0), 6)
        3.389958
    """
    pe = peclet_number(peclet)
    return refined(lambda size: _slowest(section(flow, *size, biot=Sealed().biot), pe), pe)


@door
def band_exchange(flow: VacuoleFlow, peclet: float, wavenumber: float) -> float:
    """Return the amplitude of the mean flux through a wall that holds c = cos(q z), in units of D/R.

    `wavenumber` is q in 1/R; the mean is over θ, at fixed z. Steady: what some bands across the axis give
    off, others take up. Without flow it is q I_1(q)/I_0(q). For straight flows, in which it grows as
    Pe^(1/2), and helical ones. Dimensionless; raises `InputError` for other flows and for values out of
    range.

    Example:
        >>> import cyclosis as cy
        >>> grid = cy.CylinderGrid(16, 16)
        >>> flow = cy.vacuole.flow(grid, cy.flow(cy.Parameters(), grid, cy.initial.stripes(grid)))
        >>> q = 2 * 3.141592653589793 / 5
        >>> still, stirred = (cy.vacuole.band_exchange(flow, pe, q) for pe in (1e-3, 100.0))
        >>> round(still, 5), stirred > 5 * still
        (0.66599, True)
    """
    pe = peclet_number(peclet)
    q = number("wavenumber", wavenumber, 1e-3, 1e3, "give 2π over the distance of bands, in 1/R")
    turns(flow)
    return refined(lambda size: _band_flux(section(flow, *size, biot=np.inf, q=q), pe), pe)


def _band_flux(problem: Section, pe: float) -> float:
    from scipy.special import ive

    f, q = problem.functions, problem.q
    carried = ive(0, q * f.r) / ive(0, q) * np.exp(q * (f.r - 1))
    source = pe * problem.weak(problem.velocity * carried[:, None])
    y = np.linalg.solve(problem.decay(pe), source)
    axial = y[problem.n == 0]
    return float(abs(q * ive(1, q) / ive(0, q) + f.wall_slope[0, : axial.size] @ axial))


def _slowest(problem: Section, pe: float) -> float:
    """Return the smallest decay rate by diffusion and Pe times advection, without the constant."""
    varies = problem.rates > 0
    matrix = problem.real(problem.decay(pe))[np.ix_(varies, varies)]
    return float(np.min(_smallest(matrix).real))


def _smallest(matrix: npt.NDArray[Any]) -> npt.NDArray[Any]:
    """Return the eigenvalues of smallest modulus, by inverse iteration."""
    from scipy.linalg import lu_factor, lu_solve
    from scipy.sparse.linalg import LinearOperator, eigs

    factors = lu_factor(matrix)
    inverse = LinearOperator(matrix.shape, matvec=lambda v: lu_solve(factors, v), dtype=float)
    start = np.ones(matrix.shape[0])
    return 1 / eigs(inverse, k=SLOWEST, v0=start, return_eigenvectors=False)
