"""The flow in the vacuole during a run, between its saved frames."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import lru_cache
from typing import Any

import numpy as np

from ..display.shown import shown
from ..model.errors import InputError, number
from ..model.grid import Array, CylinderGrid
from ..model.instants import instant
from ..model.wording import beside
from .flow import VacuoleFlow
from .tables import Complex, spectrum_of

INTERPOLATIONS = ("cubic", "linear")
"""How the flow between frames follows from them."""
KEPT = 16
"""Frames whose waves are kept."""


@shown
@dataclass(frozen=True, eq=False, repr=False)
class UnsteadyFlow:
    """The flow in the vacuole during a run: Stokes flow has no memory, so each moment is a `VacuoleFlow`.

    `times` (n,) are those of the saved frames, in R/U. Between them the waves of the wall's velocity follow
    the cubic through the four nearest frames, or are linear in time; at a frame they are exactly its own.
    Make one with `cyclosis.vacuole.flow`. Frames are read when they are needed.

    Example:
        >>> import numpy as np
        >>> import cyclosis as cy
        >>> params, grid = cy.Parameters(), cy.CylinderGrid(16, 16)
        >>> run = cy.simulate(params, grid, cy.initial.stripes(grid, magnitude=0.5), t_end=4.0)
        >>> flow = cy.vacuole.flow(run)
        >>> flow.times, flow.at_time(2.5).grid == grid
        (array([0., 1., 2., 3., 4.]), True)
        >>> u = cy.flow(params, grid, run.frames[2])
        >>> bool(np.allclose(flow.at_time(2.0).surface, u))
        True
    """

    grid: CylinderGrid
    times: Array
    frame: Callable[[int], Array] = field(repr=False)
    closure: str = "zero_flux"
    interpolation: str = "cubic"
    _kept: Any = field(init=False, repr=False)

    def __post_init__(self) -> None:
        kept = lru_cache(maxsize=KEPT)(lambda index: spectrum_of(self.frame(index)))
        object.__setattr__(self, "_kept", kept)

    def at_time(self, t: float) -> VacuoleFlow:
        """Return the flow at a time of the run. Raises `InputError` for times outside its frames."""
        return VacuoleFlow(self.grid, self.modes_at(t), self.closure)

    def modes_at(self, t: float) -> Complex:
        """Return the waves of the wall's velocity at a time; see `VacuoleFlow.modes`.

        Example:
            >>> import cyclosis as cy
            >>> params, grid = cy.Parameters(), cy.CylinderGrid(16, 16)
            >>> run = cy.simulate(params, grid, cy.initial.stripes(grid, magnitude=0.5), t_end=4.0)
            >>> cy.vacuole.flow(run).modes_at(0.5).shape
            (2, 15, 8)
        """
        time = instant(number("t", t, -1e12, 1e12, "give a time of the run"))
        first, last = float(self.times[0]), float(self.times[-1])
        if not first <= time <= last:
            rule = f"within the saved frames, from {beside(first, time)} to {beside(last, time)}"
            raise InputError("t", time, rule, "choose a time of the run")
        after = int(np.searchsorted(self.times, time))
        if self.times[after] == time:
            return np.array(self._kept(after))
        count = min(len(self.times), 4 if self.interpolation == "cubic" else 2)
        low = min(max(after - count // 2, 0), len(self.times) - count)
        near = self.times[low : low + count]
        out = np.zeros_like(self._kept(low))
        for k, here in enumerate(near):
            others = np.delete(near, k)
            out += np.prod((time - others) / (here - others)) * self._kept(low + k)
        return out

    def __repr__(self) -> str:
        n_theta, n_z = self.grid.shape
        span = f"t = {self.times[0]:g} to {self.times[-1]:g}"
        return (
            f"UnsteadyFlow({n_theta} x {n_z}, length {self.grid.length:g}, {len(self.times)} frames, {span})"
        )
