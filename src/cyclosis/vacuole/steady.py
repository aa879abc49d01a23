"""Steady scalars in any steady flow: Pe v·∇c - ∇²c = Pe s, with the wall in exchange or held.

In modes scaled so that diffusion is the identity, advection is skew: (1 + Pe K) x = b with the eigenvalues of
K imaginary. GMRES solves it in a number of iterations that grows as Pe.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from ..display.shown import shown
from ..model.doors import door
from ..model.errors import InputError, whole
from ..model.grid import Array
from .flow import VacuoleFlow
from .sampled import Sampled, on_points, peclet_number
from .transport import equation, measures
from .walls import Wall, pattern_on

if TYPE_CHECKING:
    from .spectral_scalar import ScalarSystem, Space

TOLERANCE = 1e-10
"""Residual, relative to the right-hand side."""
KRYLOV = 200
"""Iterations before GMRES starts again; each keeps one vector of modes."""
RESTARTS = 10


@shown
@dataclass(frozen=True, eq=False)
class Steady:
    """A steady scalar: `c` (n_r, n_theta, n_z) at `r`, `theta`, `z`, dimensionless but for the unit of c.

    `wall_slope` (n_theta, n_z) is c_r at the wall: what diffuses in, in units of D c/R. `mean`, `variance`
    and `gradient` = <|∇c|²> are over the vacuole.

    Example:
        >>> import numpy as np
        >>> import cyclosis as cy
        >>> grid = cy.CylinderGrid(16, 16, length=5.0)
        >>> flow = cy.vacuole.flow(grid, cy.flow(cy.Parameters(), grid, cy.initial.stripes(grid)))
        >>> bands = cy.vacuole.Held(lambda theta, z: np.cos(2 * np.pi * z / 5) + 0 * theta)
        >>> found = cy.vacuole.steady(flow, 10.0, bands, n_r=12)
        >>> found.c.shape, round(float(abs(np.fft.rfft(found.wall_slope.mean(0))[1]) / 8), 2)
        ((12, 16, 16), 0.81)
    """

    c: Array
    wall_slope: Array
    mean: float
    variance: float
    gradient: float
    r: Array
    theta: Array
    z: Array
    weights: Array


@door
def steady(
    flow: VacuoleFlow, peclet: float, wall: Wall, n_r: int = 24, shape: tuple[int, int] | None = None
) -> Steady:
    """Return the steady scalar in a steady flow whose wall is `Held` or in `Exchange` with a pattern.

    Points are `n_r` along the radius and `shape`, by default the grid of the flow. Dimensionless: Pe = U R/D.
    Raises `InputError` for other walls, values out of range, and a Péclet number for which the solver does
    not converge on these points.

    Example: a wall that is held at one value fills the vacuole with it.
        >>> import cyclosis as cy
        >>> grid = cy.CylinderGrid(16, 8, length=5.0)
        >>> flow = cy.vacuole.flow(grid, cy.flow(cy.Parameters(), grid, cy.initial.stripes(grid)))
        >>> found = cy.vacuole.steady(flow, 10.0, cy.vacuole.Held(2.0), n_r=8)
        >>> round(found.mean, 9), round(found.variance, 9)
        (2.0, 0.0)
    """
    from ..model.precision import double

    pe = peclet_number(peclet)
    if not isinstance(wall, Wall) or wall.biot == 0:
        raise InputError(
            "wall", wall, "Held(pattern) or Exchange(biot, outside)", "a sealed wall sets no value"
        )
    with double():
        where, system = _problem(flow, pe, wall, n_r, shape)
        source = np.asarray(system.nonlinear((np.zeros(where.rates.shape, complex), 0.0)))
        modes = solved(where, system, pe, source)
        values = where.synthesise(modes) + np.asarray(system.lift)
        pattern = pattern_on(wall, where.grid.theta, where.grid.z)
        mean, variance, gradient = measures(where, wall, pattern, modes, values)[:3]
        slope = where.slope_at_wall(modes)
        if np.isinf(wall.biot):
            slope = slope + where.on_wall(where.harmonic_slope(pattern))
        else:  # the condition at the wall holds weakly: c at the wall is more accurate than its slope
            slope = -wall.biot * (where.value_at_wall(modes) - pattern)
    f, grid = where.functions, where.grid
    return Steady(values, slope, mean, variance, gradient, f.r, grid.theta, grid.z, f.weights)


def cell_problem(flow: VacuoleFlow, peclet: float, n_r: int, shape: tuple[int, int] | None = None) -> float:
    """Return (D_eff/D - 1)/Pe² = <|∇χ|²>/Pe² of any steady flow; see `cyclosis.vacuole.taylor`.

    Example:
        >>> import numpy as np
        >>> import cyclosis as cy
        >>> from cyclosis.vacuole.steady import cell_problem
        >>> grid = cy.CylinderGrid(16, 8)
        >>> wall = np.stack([np.zeros((16, 8)), np.sin(grid.theta)[:, None] * np.ones(8)])
        >>> round(96 * cell_problem(cy.vacuole.flow(grid, wall), 10.0, n_r=8), 9)
        7.0
    """
    from ..model.precision import double
    from .walls import Sealed

    pe = peclet_number(peclet)
    with double():
        where, system = _problem(flow, pe, Sealed(), n_r, shape)
        axial = np.asarray(system.velocity[0][2])
        chi = solved(where, system, pe, -where.analyse(axial))
    return float(np.sum(where.rates * np.abs(chi) ** 2 * where.twice)) / pe**2


def _problem(
    flow: Any, pe: float, wall: Wall, n_r: int, shape: tuple[int, int] | None
) -> tuple[Space, ScalarSystem]:
    from .spectral_scalar import space

    if not isinstance(flow, VacuoleFlow):
        raise InputError("flow", flow, "a steady flow in the vacuole", "take flow.at_time(t) of a run")
    n_r = whole("n_r", n_r, 4, 512, "give the number of points along the radius")
    where = space(flow.grid if shape is None else flow.grid.resized(*shape), n_r, wall.biot)
    sampled = Sampled(flow, on_points(where.functions.r, where.grid.shape))
    return where, equation(where, sampled.window(0.0, 0.0), pe, wall)[0]


def solved(
    where: Space, system: ScalarSystem, pe: float, source: npt.NDArray[np.complex128]
) -> npt.NDArray[np.complex128]:
    """Return the modes y of rates y/Pe - <∇f* · v y f> = source, without the constant of a sealed wall."""
    from scipy.sparse.linalg import LinearOperator, gmres

    size = np.sqrt(where.rates)
    scale = np.divide(1.0, size, out=np.zeros_like(size), where=size > 0)
    weight = np.sqrt(where.twice)
    shape = where.rates.shape

    def packed(modes: Any) -> Array:
        return np.ascontiguousarray(np.asarray(modes) * weight).view(float).ravel()

    def unpacked(x: Array) -> npt.NDArray[np.complex128]:
        made: npt.NDArray[np.complex128] = x.view(np.complex128).reshape(shape) / weight
        return made

    def applied(x: Array) -> Array:
        moved = _carried()(system, unpacked(x) * scale)
        return x - pe * packed(np.asarray(moved) * scale)

    right = pe * packed(source * scale)
    if not np.any(right):
        return np.zeros(shape, complex)
    operator = LinearOperator((right.size, right.size), matvec=applied, dtype=float)
    x, stopped = gmres(operator, right, rtol=TOLERANCE, restart=KRYLOV, maxiter=RESTARTS)
    if stopped:
        rule = f"low enough for the solver to converge in {KRYLOV * RESTARTS} iterations"
        raise InputError("peclet", pe, rule, "lower it, or follow cyclosis.vacuole.transport to a late time")
    return unpacked(x) * scale


@cache
def _carried() -> Any:
    import jax

    def carried(system: ScalarSystem, modes: Any) -> Any:
        alone = system._replace(lift=0.0 * system.lift, forcing=0.0 * system.forcing)
        return alone.nonlinear((modes, 0.0))

    return jax.jit(carried)
