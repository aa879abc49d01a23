"""Computing one block of a sweep: its members, and the numbers that are stored of each."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import Any

import jax
import numpy as np
import numpy.typing as npt

from ...contract.model import Array, Quantity
from ...contract.system import System
from ...ensemble import OUTCOMES, Member, Outcome, follow
from ...model.precision import double
from ..plan.sweep import Sweep
from .block_file import Arrays


def compute(sweep: Sweep, index: int) -> Arrays:
    """Compute one block and return its variables: an array (members, ...) for each of `sweep.variables`.

    Raises `InputError` if there is no such block, or if a member's initial state cannot be made.
    """
    return computed(sweep, sweep.block(index).members)


def computed(sweep: Sweep, numbers: Sequence[int]) -> Arrays:
    """Compute some members of a sweep, given by their numbers, and return their variables.

    Raises `InputError` if there is no such member, or if its initial state cannot be made.
    """
    members = [sweep.build(number) for number in numbers]
    outcomes = follow(members, sweep.settings)
    evaluate = _Evaluation(sweep)
    rows = [
        _row(member, outcome) | evaluate(member, outcome.state, outcome.t_final)
        for member, outcome in zip(members, outcomes, strict=True)
    ]
    return {
        item.name: np.array([row[item.name] for row in rows], dtype=item.dtype) for item in sweep.variables
    }


def _row(member: Member, outcome: Outcome) -> dict[str, npt.ArrayLike]:
    """Return the standard variables of a member by name, and its final state."""
    model = member.model
    return {
        "regime": model.regimes.index(outcome.regime) if model.regimes else -1,
        "status": OUTCOMES.index(outcome.status),
        "t_final": outcome.t_final,
        "t_order": outcome.t_order,
        "eigenvalue": outcome.eigenvalue,
        "evaluations": outcome.evaluations,
        "seconds": outcome.seconds,
        **model.member_row(member, outcome),
        model.state_name: outcome.state,
    }


class _Evaluation:
    """Computes the quantities that a sweep stores, in double precision."""

    def __init__(self, sweep: Sweep) -> None:
        wanted = {item.name for item in sweep.variables}
        self.quantities = tuple(item for item in sweep.model.quantities if item.name in wanted)
        self.terms = tuple(sweep.tables["run"]["terms"])
        self.systems: dict[tuple[Any, Any], System] = {}

    def __call__(self, member: Member, state: Array, t: float) -> dict[str, npt.ArrayLike]:
        """Return the quantities of a state of a member at a time, by name."""
        model, params = member.model, member.params_at(t)
        point = (params, member.grid)
        if point not in self.systems:
            self.systems = {
                point: model.system(model.problem(params, member.grid, self.terms, shape=state.shape), True)
            }
        system = self.systems[point]
        with double():
            modes = model.modes(system, state)
            found: dict[str, npt.ArrayLike] = jax.device_get(_measured(system, modes, self.quantities))
        return found


@partial(jax.jit, static_argnames="quantities")
def _measured(system: System, modes: Any, quantities: tuple[Quantity, ...]) -> dict[str, Any]:
    now = system.at(modes)
    return {item.name: item.compute(system, now) for item in quantities}
