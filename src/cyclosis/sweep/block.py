"""One block of a sweep: its members computed, and each made into the numbers that are stored of it."""

from __future__ import annotations

from functools import partial
from typing import Any

import jax
import numpy as np
import numpy.typing as npt

from ..analysis.diagnostics import QUANTITIES
from ..analysis.regimes import REGIMES
from ..dataset.contents import listed_zones
from ..ensemble import OUTCOMES, Member, Outcome, follow
from ..model.grid import Array, CylinderGrid
from ..model.parameters import Parameters
from ..model.precision import double
from ..model.system import System, system
from .packed import Arrays
from .plan import Sweep


def compute(sweep: Sweep, index: int) -> Arrays:
    """Compute one block and return its variables: an array (members, ...) for each of `sweep.variables`.

    Raises `InputError` for an index that no block has, and for a member whose initial state cannot be made.
    """
    members = [sweep.build(number) for number in sweep.block(index).members]
    outcomes = follow(members, sweep.settings)
    evaluate = _Evaluation(sweep)
    rows = [
        _row(member, outcome) | evaluate(member, outcome.state, outcome.t_final)
        for member, outcome in zip(members, outcomes, strict=True)
    ]
    return {
        item.name: np.array([row[item.name] for row in rows], dtype=item.dtype) for item in sweep.variables
    }


def amplitude(profile: Array) -> float:
    """Return the amplitude of the first harmonic of a periodic profile (n_theta,): a of a cos(theta - b)."""
    return 2.0 * float(abs(np.fft.rfft(profile, norm="forward")[1]))


def _row(member: Member, outcome: Outcome) -> dict[str, npt.ArrayLike]:
    """Return what is stored of every member, less the quantities, by name; and the final state."""
    angles, widths, count = listed_zones(outcome.state)
    start = member.state()[1].mean(axis=1)
    return {
        "regime": REGIMES.index(outcome.regime),
        "status": OUTCOMES.index(outcome.status),
        "t_final": outcome.t_final,
        "t_order": outcome.t_order,
        "eigenvalue": outcome.eigenvalue,
        "evaluations": outcome.evaluations,
        "seconds": outcome.seconds,
        "zone_count": count,
        "zone_angle": angles,
        "stripe_width": widths,
        "profile": outcome.profile,
        "initial_k0": start.mean(),
        "initial_m1": amplitude(start),
        "P": outcome.state,
    }


class _Evaluation:
    """Evaluates the quantities that a sweep stores, in double precision."""

    def __init__(self, sweep: Sweep) -> None:
        wanted = {item.name for item in sweep.variables}
        self.names = tuple(item.name for item in QUANTITIES if item.name in wanted)
        self.terms = tuple(sweep.tables["run"]["terms"])
        self.cells: dict[tuple[Parameters, CylinderGrid], System] = {}

    def __call__(self, member: Member, state: Array, t: float) -> dict[str, npt.ArrayLike]:
        """Return the quantities of a state of a member at a time, by name."""
        params = member.params_at(t)
        point = (params, member.grid)
        if point not in self.cells:
            self.cells = {point: system(params, member.grid, self.terms)}
        cell = self.cells[point]
        with double():
            found: dict[str, npt.ArrayLike] = jax.device_get(
                _measured(cell, cell.spectrum(state), self.names)
            )
        return found


@partial(jax.jit, static_argnames="names")
def _measured(cell: System, spectrum: Any, names: tuple[str, ...]) -> dict[str, Any]:
    now = cell.at(spectrum)
    return {item.name: item.compute(cell, now) for item in QUANTITIES if item.name in names}
