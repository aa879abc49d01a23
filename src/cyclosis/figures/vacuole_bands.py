"""The bands that a flow in the vacuole consists of on average, straight and twisted, for comparison."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from ..model.arrays import series
from ..model.errors import InputError, number
from ..model.grid import Array, CylinderGrid
from ..vacuole.flow import VacuoleFlow, of_surface
from ..vacuole.helix import helical_bands

SIDE = 48
"""Points around the bands, and along them where they wind."""
ALONG = 16
"""Points along straight bands."""
PECLETS = np.geomspace(1.0, 1e4, 13)
"""Péclet numbers U R/D of the curves."""
SHORTEST = 0.2
"""Shortest pitch to compare with, in R."""
FAINT = 1e-9
"""Speed below which there are no bands, in U."""


def mean_bands(flow: VacuoleFlow) -> tuple[Array, float]:
    """Return the speed (n_theta,) of the bands of a flow over φ = θ - 2πz/pitch, in U, and their pitch in R.

    The pitch is that of the strongest wave of the wall's velocity that varies around the axis, infinite if it
    is straight. The speed is the velocity along the helix, averaged over all places of one φ; its own mean is
    left out. Raises `InputError` for anything but a steady flow, and for one without bands.
    """
    if not isinstance(flow, VacuoleFlow):
        rule, remedy = "a VacuoleFlow", "use cyclosis.vacuole.flow(run, t=...)"
        raise InputError("flow", type(flow).__name__, rule, remedy)
    highest = flow.modes.shape[1] // 2
    m = np.roll(np.arange(-highest, highest + 1), -highest)
    size = np.hypot(*np.abs(flow.modes)) * (m != 0)[:, None]
    row, column = np.unravel_index(np.argmax(size), size.shape)
    if size[row, column] < FAINT:
        rule = "one that varies around the axis"
        raise InputError("flow", flow, rule, "choose a time at which the cytoplasm streams")
    Q = float(-flow.q[column] / m[row])
    # The mean over all places of one φ keeps the waves of this helix, and only them.
    along = np.array([Q, 1.0]) / np.hypot(Q, 1.0)
    wave = np.tensordot(along, flow.modes, axes=1)
    harmonics = np.zeros(flow.grid.n_theta // 2 + 1, np.complex128)
    for n in range(1, highest + 1):
        turns = -Q * n * flow.grid.length / (2 * np.pi)
        j = round(turns)
        if abs(turns - j) < 1e-9 * max(1, abs(j)) and abs(j) < flow.q.size:
            harmonics[n] = wave[n, j] if j >= 0 else wave[-n, -j].conj()
    return np.fft.irfft(harmonics, flow.grid.n_theta, norm="forward"), 2 * np.pi / Q if Q else np.inf


def wound(profile: npt.ArrayLike, pitch: float) -> VacuoleFlow:
    """Return the flow of bands with speeds (n,) around φ that wind with a pitch in R; infinite: straight."""
    straight = np.isinf(pitch)
    grid = CylinderGrid(SIDE, ALONG if straight else SIDE, 1.0 if straight else abs(pitch))
    given = np.asarray(profile, dtype=np.float64)
    waves = np.fft.rfft(given, norm="forward")
    kept = np.zeros(SIDE // 2 + 1, np.complex128)
    count = min(kept.size - 1, (given.size + 1) // 2)
    kept[:count] = waves[:count]
    return of_surface(grid, helical_bands(grid, np.fft.irfft(kept, SIDE, norm="forward"), pitch), "zero_flux")


def compared(flow: VacuoleFlow, pitch: Any) -> tuple[Array, float]:
    """Return the mean bands of a flow and the pitch to compare straight ones with.

    That is `pitch`, or that of the bands, or one turn in the length of the cell where they are straight.
    Raises `InputError` for a pitch that is 0 or not finite.
    """
    profile, own = mean_bands(flow)
    if pitch is None:
        return profile, own if np.isfinite(own) else float(flow.grid.length)
    value = number("pitch", pitch, -1e3, 1e3, "give the advance along z in one turn, in R")
    if abs(value) < SHORTEST:
        rule = f"at least {SHORTEST:g} in size, in radii"
        raise InputError("pitch", value, rule, "the flow of tighter turns does not reach inside")
    return profile, value


def peclet_numbers(given: Any) -> Array:
    """Return increasing Péclet numbers (n,), the usual ones if none are given, or raise `InputError`."""
    if given is None:
        return PECLETS
    remedy = "give U R/D of some substances, at least two"
    found = series("peclets", given, remedy)
    if found.size < 2 or not np.all(found > 0) or np.any(np.diff(found) <= 0):
        raise InputError("peclets", given, "at least two increasing numbers above 0", remedy)
    return found


def legend_of(pitch: float) -> str:
    """Return the name of bands of a pitch in a legend."""
    return "straight" if np.isinf(pitch) else f"pitch {pitch:.4g} $R$"
