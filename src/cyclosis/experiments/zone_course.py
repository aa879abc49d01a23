"""How stripes settle along a cell of any length: how many, how steep their zones, how often these wind."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from ..analysis.diagnostics import diagnose
from ..analysis.zones import crossings
from ..dynamics.simulate import simulate
from ..model import initial
from ..model.errors import InputError
from ..model.grid import Array, CylinderGrid, interpolate
from ..model.parameters import Parameters
from ..model.system import flow
from ..stability import cyclosis

PARAMS = Parameters(alpha_p=1.0, alpha_u=0.5)
POINTS = 9.6
"""Grid points a radius along the axis: those of 48 points in a cell of length 5."""
POINTS_OF_THEORY = 96
"""Points around the axis on which the neutral rotation is neutral to 1e-8, below all rates here."""
UNFELT = 1e-4
"""Slope below which zones are straight to what steps and grid can tell."""


def grid_of(length: float) -> CylinderGrid:
    """Return the grid of a cell, as fine along the axis at every length."""
    return CylinderGrid(48, 2 * int(np.ceil(0.5 * POINTS * length)), length)


class Course(NamedTuple):
    """One cell at given times.

    `paired` is the share of circles with two zones (times,), `slope` the root mean square slope of the
    pattern (times,), `winding` its turns along the cell (times,), `tail` the spectral tail at the end.
    """

    paired: Array
    slope: Array
    winding: Array
    tail: float


def follow(length: float, seed: int, times: tuple[float, ...]) -> Course:
    """Return the `Course` of a disordered cell at increasing `times`, the last of which ends it."""
    grid = grid_of(length)
    states = _states(grid, seed, times)
    paired = np.array([two_zones(P) for P in states])
    slopes = np.array([slope(P, length) for P in states])
    tail = float(diagnose(PARAMS, grid, states[-1])["spectral_tail"])
    windings = np.rint([_turns(P).sum() / (2 * np.pi) for P in states])
    return Course(paired, slopes, windings, tail)


def picture(
    length: float, seed: int, times: tuple[float, ...], shape: tuple[int, int]
) -> tuple[Array, Array]:
    """Return P and u (times, 2, *shape) of the cell that `follow` follows, on a grid of another shape."""
    grid = grid_of(length)
    states = _states(grid, seed, times)
    flows = [flow(PARAMS, grid, P) for P in states]
    return np.array([interpolate(P, shape) for P in states]), np.array([interpolate(u, shape) for u in flows])


def _states(grid: CylinderGrid, seed: int, times: tuple[float, ...]) -> list[Array]:
    state = initial.disordered(grid, seed=seed)
    run = simulate(PARAMS, grid, state, times[-1], save_at=times, rtol=1e-3)
    if run.status not in ("completed", "steady"):
        raise InputError("the run", run.status, "completed", "take more points a radius")
    return [run.frames[k] for k in range(len(run.times) - len(times), len(run.times))]


def two_zones(P: Array) -> float:
    """Return the share of circles z = const on which P_z of P (2, n_theta, n_z) changes sign twice."""
    return float(np.mean(crossings(P) == 2))


def _turns(P: Array) -> Array:
    """Return by how much the pattern turns from each circle to the next (n_z,), in radians."""
    wave = np.fft.fft(P[1], axis=0)[1]
    return np.angle(np.roll(wave, -1) * np.conj(wave))


def slope(P: Array, length: float) -> float:
    """Return the root mean square of dφ/dz, φ(z) the angle about the axis of the pattern at z."""
    return float(np.sqrt(np.mean(_turns(P) ** 2))) * P.shape[2] / length


def first_for_good(paired: npt.ArrayLike, times: npt.ArrayLike) -> float:
    """Return the first of `times` (n,) from which on all circles have two zones; NaN if that is none."""
    good = np.asarray(paired) >= 1.0
    since = int(np.argmin(good[::-1])) if not good.all() else good.size
    return float(np.asarray(times)[good.size - since]) if since > 0 else np.nan


def decay(slopes: npt.ArrayLike, times: npt.ArrayLike) -> float:
    """Return the rate at which slopes (n,) decay over the later half of `times`; NaN if they are unfelt."""
    y, t = np.asarray(slopes), np.asarray(times)
    late = (t >= 0.5 * t[-1]) & (y > UNFELT)
    return float(-np.polyfit(t[late], np.log(y[late]), 1)[0]) if late.sum() > 2 else np.nan


def straightening(length: float) -> float:
    """Return the rate, by theory, at which the longest wave of two stripes along a cell decays."""
    modes = cyclosis(PARAMS, POINTS_OF_THEORY).spectrum(1, axial_mode=1, length=length)
    return float(-modes.eigenvalues[0].real)
