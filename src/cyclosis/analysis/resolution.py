"""What a grid resolves: how fast noise decays on it, how stiff the equation is, which grid is fine enough."""

from __future__ import annotations

import numpy as np

from ..model.definitions import definition
from ..model.grid import CylinderGrid
from ..model.parameters import Parameters
from ..model.system import System
from .diagnostics import TAIL_FRACTION

UNDERRESOLVED_TAIL = 1e-2
"""Spectral tail (see the diagnostics) above which a run is marked underresolved."""
NOISE_DECAY = 1e-8
"""The tail is judged once diffusion alone has damped the initial noise in it by this factor."""
ACROSS = 5.0
"""Resolved wavenumber times width of a zone on a grid that is fine enough. tanh(x/w) has the spectrum
exp(-π k w/2): its tail, beyond two thirds of this, is 5e-3, half the limit."""
ALIGNED = 0.25
"""Share of α_u in the rate that steepens zones, fitted to the coarsest grids that resolve runs from
disorder."""
FINER = 1.5
"""Factor to a finer grid if by the width of zones this one should be fine enough."""


def decay_time(system: System) -> float:
    """Return the time in which diffusion alone damps noise in the spectral tail."""
    largest = (float(np.max(waves)) for waves in (system.space.m, system.space.q))
    k = TAIL_FRACTION * min(most for most in largest if most > 0)  # one axial point has no waves along z
    return damped_after(system, k)


def damped_after(system: System, k: float) -> float:
    """Return the time in which diffusion alone damps noise of wavenumber k."""
    diffuses = any(term.name == "diffusion" for term in system.terms)
    damping = float(system.values.d_s) * k**2 if diffuses else 0.0
    return -np.log(NOISE_DECAY) / damping if damping > 0 else 0.0


def stiffness(system: System) -> float:
    """Return about the largest |eigenvalue| of the right-hand side: diffusion and local relaxation.

    The local relaxation, about -2 α_p - α_u - κ, adds to the stiffness of diffusion.
    """
    values = system.values
    stiffest = float(values.d_s) * float(np.max(np.asarray(system.space.k2))) + float(values.d_r)
    local = sum(float(np.max(value)) for value in (2 * values.alpha_p, values.alpha_u, values.kappa))
    return stiffest + local


def largest_wavenumber(params: Parameters) -> float | None:
    """Return the wavenumber that must be resolved, or None if it cannot be estimated.

    Zones between stripes are about w = (2 d_s/(α_p + α_u/4 - d_r))^½ wide, in radii, and it is 5/w.
    """
    drive = float(np.max(params.alpha_p)) + ALIGNED * float(np.max(params.alpha_u)) - params.d_r
    if params.d_s <= 0 or drive <= 0:
        return None
    return float(ACROSS * np.sqrt(drive / (2 * params.d_s)))


def enough(params: Parameters, grid: CylinderGrid) -> tuple[int, int] | None:
    """Return a finer grid (n_theta, n_z) that should resolve a cell, or None if none can be estimated.

    Multiples of 8, at least as fine as the grid in either direction; see `largest_wavenumber`.
    """
    largest = largest_wavenumber(params)
    if largest is None:
        return None
    needed = (2 * largest, largest * grid.length / np.pi)
    out = tuple(max(8 * int(np.ceil(n / 8)), own) for n, own in zip(needed, grid.shape, strict=True))
    if grid.n_z == 1:
        out = (out[0], 1)
    if out == grid.shape:
        out = tuple(own if own == 1 else 8 * int(np.ceil(FINER * own / 8)) for own in grid.shape)
    return (out[0], out[1]) if max(out) <= definition("grid", "n_theta").maximum else None


def finer(params: Parameters, grid: CylinderGrid) -> str:
    """Return the remedy for a grid that is too coarse, in words."""
    points = enough(params, grid)
    if points is None:
        return "use more grid points"
    return f"use more grid points: {points[0]} x {points[1]} should do"
